//! The design: what the file says, editable, one to one.

use crate::error::InvalidInput;
use serde::{Deserialize, Serialize};

/// Version of the design file that this program reads.
pub const DESIGN_SCHEMA: u32 = 1;

/// Where a design's topology and proportions come from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Source {
    /// The thesis's text fixes topology and proportions.
    ThesisText,
    /// Only the number or the directions are known: the rest is ours.
    Reconstruction,
    /// Another publication or a makers' table.
    Literature,
    /// A user's own.
    #[default]
    Own,
}

/// A periodic sheet of rigid elements, as written in a design file. Lengths in the file's unit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Design {
    /// Version of the file format; only [`DESIGN_SCHEMA`] is known.
    #[serde(default = "default_schema")]
    pub schema: u32,
    /// Short name, as `1.1`.
    pub name: String,
    /// One line on what it is.
    #[serde(default)]
    pub title: String,
    /// Where it comes from.
    #[serde(default)]
    pub source: Source,
    /// Name of the unit of length (`mm`); a label that scales nothing.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unit: Option<String>,
    /// Minor radius r of every ring that gives none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub minor_radius: Option<f64>,
    /// The R of the ratio r/R; all tolerances scale with it.
    pub reference_radius: f64,
    /// Accept tori that overlap in the starting state.
    #[serde(default)]
    pub allow_initial_overlap: bool,
    /// Lattice vectors of the sheet.
    pub lattice: LatticeSpec,
    /// The rigid elements of one cell.
    pub elements: Vec<ElementSpec>,
}

fn default_schema() -> u32 {
    DESIGN_SCHEMA
}

/// Lattice vectors, in the sheet's plane (z = 0).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LatticeSpec {
    /// First lattice vector.
    pub a1: [f64; 3],
    /// Second lattice vector.
    pub a2: [f64; 3],
}

/// A rigid body made of rings.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ElementSpec {
    /// Unique in the design.
    pub name: String,
    /// Position of the element's reference point.
    pub center: [f64; 3],
    /// One ring, or several that are rigidly joined.
    pub rings: Vec<RingSpec>,
}

/// A torus: major radius R, minor radius r, and where it sits in its element.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RingSpec {
    /// Radius R of the core circle.
    pub major_radius: f64,
    /// Normal of the core circle's plane; any non-zero length.
    pub normal: [f64; 3],
    /// Centre of the ring relative to the element's centre.
    #[serde(default)]
    pub offset: [f64; 3],
    /// Minor radius r of this ring alone.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub minor_radius: Option<f64>,
}

impl Design {
    /// The same design with another common minor radius; rings with their own keep it.
    pub fn with_minor_radius(&self, minor_radius: f64) -> Self {
        Self { minor_radius: Some(minor_radius), ..self.clone() }
    }

    /// The same rings `factor` times as far apart: lattice vectors and centres of elements are multiplied.
    pub fn spaced(&self, factor: f64) -> Self {
        let mut out = self.clone();
        let centers = out.elements.iter_mut().map(|element| &mut element.center);
        centers.chain([&mut out.lattice.a1, &mut out.lattice.a2]).flatten().for_each(|x| *x *= factor);
        out
    }

    /// The same design with every length multiplied by `factor`.
    pub fn scaled(&self, factor: f64) -> Self {
        let mut out = self.clone();
        let scale = |v: &mut [f64; 3]| v.iter_mut().for_each(|x| *x *= factor);
        out.minor_radius = out.minor_radius.map(|r| r * factor);
        out.reference_radius *= factor;
        scale(&mut out.lattice.a1);
        scale(&mut out.lattice.a2);
        for element in &mut out.elements {
            scale(&mut element.center);
            for ring in &mut element.rings {
                ring.major_radius *= factor;
                ring.minor_radius = ring.minor_radius.map(|r| r * factor);
                scale(&mut ring.offset);
            }
        }
        out
    }

    /// Checks every field that can be judged without geometry between elements, and returns all that is wrong.
    ///
    /// Overlap and links need the compiled model: see `Model`.
    pub fn problems(&self) -> Vec<InvalidInput> {
        let mut out = Vec::new();
        let mut bad = |field: String, problem: String, help: &str| out.push(InvalidInput::new(field, problem, help));
        if self.schema != DESIGN_SCHEMA {
            bad("schema".into(), format!("version {} is not known", self.schema), "this program reads schema = 1");
        }
        if self.name.trim().is_empty() {
            bad("name".into(), "is empty".into(), "give the design a short name");
        }
        let positive = |x: f64| x.is_finite() && x > 0.0;
        if !positive(self.reference_radius) {
            bad(
                "reference_radius".into(),
                format!("{} is not a positive length", self.reference_radius),
                "give the major radius that ratios such as r = R/10 refer to",
            );
        }
        let mut rings = self.elements.iter().flat_map(|e| &e.rings);
        let no_minor_radius = self.minor_radius.is_none() && rings.all(|ring| ring.minor_radius.is_none());
        if no_minor_radius && self.elements.iter().any(|e| !e.rings.is_empty()) {
            bad(
                "minor_radius".into(),
                "is missing".into(),
                "add minor_radius = 0.1, the wire's radius, or give each ring its own",
            );
        }
        if let Some(r) = self.minor_radius
            && !positive(r)
        {
            bad(
                "minor_radius".into(),
                format!("{r} is not a positive length"),
                "give the wire's radius (half of its diameter)",
            );
        }
        for (field, a) in [("lattice.a1", self.lattice.a1), ("lattice.a2", self.lattice.a2)] {
            if !a.iter().all(|x| x.is_finite()) {
                bad(field.into(), format!("{a:?} is not finite"), "give three finite numbers");
            } else if a[2] != 0.0 {
                bad(
                    field.into(),
                    format!("z = {} leaves the sheet's plane", a[2]),
                    "lattice vectors lie in the plane z = 0",
                );
            } else if a == [0.0; 3] {
                bad(field.into(), "is zero".into(), "give the translation to the next cell");
            }
        }
        let (a, b) = (self.lattice.a1, self.lattice.a2);
        let cross = a[0] * b[1] - a[1] * b[0];
        let lengths = (a[0].hypot(a[1])) * (b[0].hypot(b[1]));
        if lengths.is_finite() && lengths > 0.0 && cross.abs() < 1e-9 * lengths {
            bad("lattice.a2".into(), format!("{b:?} is parallel to a1 = {a:?}"), "give two independent translations");
        }
        if self.elements.is_empty() {
            bad("elements".into(), "there is none".into(), "add an [[elements]] table with at least one ring");
        }
        for (i, e) in self.elements.iter().enumerate() {
            let at = format!("elements[{i}]");
            if let Some(j) = self.elements[..i].iter().position(|o| o.name == e.name) {
                bad(
                    format!("{at}.name"),
                    format!("\"{}\" is already the name of elements[{j}]", e.name),
                    "give every element a name of its own",
                );
            }
            if !e.center.iter().all(|x| x.is_finite()) {
                bad(format!("{at}.center"), format!("{:?} is not finite", e.center), "give three finite numbers");
            }
            if e.rings.is_empty() {
                bad(format!("{at}.rings"), "there is none".into(), "give at least { major_radius, normal }");
            }
            for (k, ring) in e.rings.iter().enumerate() {
                let at = format!("{at}.rings[{k}]");
                if !positive(ring.major_radius) {
                    bad(
                        format!("{at}.major_radius"),
                        format!("{} is not a positive length", ring.major_radius),
                        "give the radius of the ring's core circle",
                    );
                }
                if !ring.normal.iter().all(|x| x.is_finite()) {
                    bad(
                        format!("{at}.normal"),
                        format!("{:?} is not finite", ring.normal),
                        "give three finite numbers",
                    );
                } else if ring.normal == [0.0; 3] {
                    bad(format!("{at}.normal"), "is zero".into(), "give any non-zero vector, as [0.0, 0.0, 1.0]");
                }
                if !ring.offset.iter().all(|x| x.is_finite()) {
                    bad(
                        format!("{at}.offset"),
                        format!("{:?} is not finite", ring.offset),
                        "give three finite numbers",
                    );
                }
                match ring.minor_radius.or(self.minor_radius) {
                    None if no_minor_radius => {}
                    None => bad(
                        format!("{at}.minor_radius"),
                        "is given neither here nor for the whole design".into(),
                        "add minor_radius = … at the top of the file, or to this ring",
                    ),
                    Some(r) if ring.minor_radius.is_some() && !positive(r) => bad(
                        format!("{at}.minor_radius"),
                        format!("{r} is not a positive length"),
                        "give the wire's radius (half of its diameter)",
                    ),
                    Some(r) if positive(r) && positive(ring.major_radius) && r >= ring.major_radius => bad(
                        if ring.minor_radius.is_some() {
                            format!("{at}.minor_radius")
                        } else {
                            format!("{at}.major_radius")
                        },
                        format!("minor radius {r} is not smaller than major radius {}", ring.major_radius),
                        "a ring has a hole only if r < R",
                    ),
                    Some(_) => {}
                }
            }
        }
        out
    }
}
