//! The design: what the file says, editable, one to one; and what can be wrong with it.

use maille_geometry::Vec3;
use nalgebra::{Rotation3, UnitQuaternion};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

pub mod error;
pub mod formula;
mod formulas;
mod parameters;
mod repeat;
pub mod shape;

pub use error::InvalidInput;
pub use parameters::{Parameter, TAKEN};
pub use shape::{CurveKind, PathPart, Shape};

/// Name in [`Design::varied`] of the factor by which distances between elements were multiplied.
pub const SPACING: &str = "spacing";

/// How far the segments and arcs that stand for a smooth curve may be from it, in reference radii, where a design does not say.
pub const CURVE_TOLERANCE: f64 = 1e-6;

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
    /// How far the segments and arcs that stand for a smooth curve may be from it; [`CURVE_TOLERANCE`] reference radii if not given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub curve_tolerance: Option<f64>,
    /// Accept tori that overlap in the starting state.
    #[serde(default)]
    pub allow_initial_overlap: bool,
    /// Lattice vectors of the sheet.
    pub lattice: LatticeSpec,
    /// The rigid elements of one cell.
    pub elements: Vec<ElementSpec>,
    /// Numbers that a study has set, by their names: columns of its tables. No part of a design file.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub varied: BTreeMap<String, f64>,
    /// Named numbers, in the order of the file.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub parameters: Vec<Parameter>,
    /// Formulas over the parameters, by the place of the number that each gives: `lattice.a1[0]`,
    /// `elements[2].rings[0].major_radius`. The number itself is at its place as well.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub formulas: BTreeMap<String, String>,
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
    /// Whether a1 is the only one: the design is a chain. a2 then stands across it, so long that chains side by side do not touch.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub single: bool,
}

/// a2 of a design with a single lattice vector is so many times as long as its elements reach from the line along a1.
const ASIDE: f64 = 10.0;

impl LatticeSpec {
    /// That of a chain of these elements along a1, whose rings without a minor radius have `minor_radius`.
    pub fn single(a1: [f64; 3], elements: &[ElementSpec], minor_radius: Option<f64>) -> Self {
        // An a1 without a direction is refused by itself.
        let a1_or_x = if a1[0].hypot(a1[1]) > 0.0 { a1 } else { [1.0, 0.0, 0.0] };
        let (length, norm) = (a1_or_x[0].hypot(a1_or_x[1]), |v: [f64; 3]| v[0].hypot(v[1]).hypot(v[2]));
        let (u, w) = ([a1_or_x[0] / length, a1_or_x[1] / length], [-a1_or_x[1] / length, a1_or_x[0] / length]);
        let across = |c: [f64; 3]| {
            norm([c[0] - u[0] * (c[0] * u[0] + c[1] * u[1]), c[1] - u[1] * (c[0] * u[0] + c[1] * u[1]), c[2]])
        };
        let wire = |ring: &RingSpec| ring.minor_radius.or(minor_radius).unwrap_or(0.0);
        let reach = elements.iter().flat_map(|e| {
            let rings =
                e.rings.iter().map(|ring| across(e.center) + norm(ring.offset) + ring.major_radius + wire(ring));
            let curve = |curve: &CurveSpec| {
                let wire = curve.minor_radius.or(minor_radius).unwrap_or(0.0);
                across(e.center) + norm(curve.offset) + curve.shape.reach() + wire
            };
            rings.chain(e.curves.iter().map(curve)).collect::<Vec<_>>()
        });
        let far = ASIDE * reach.fold(0.0, f64::max).max(f64::MIN_POSITIVE);
        LatticeSpec { a1, a2: [far * w[0], far * w[1], 0.0], single: true }
    }

    /// The direction of a1, in degrees.
    pub fn direction_deg(&self) -> f64 {
        self.a1[1].atan2(self.a1[0]).to_degrees()
    }
}

/// A rigid body made of rings and other closed curves.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ElementSpec {
    /// Unique in the design.
    pub name: String,
    /// Position of the element's reference point.
    pub center: [f64; 3],
    /// One ring, or several that are rigidly joined.
    #[serde(default)]
    pub rings: Vec<RingSpec>,
    /// Tubes round other closed curves, rigidly joined with the rings.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub curves: Vec<CurveSpec>,
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

/// A tube round a closed curve that is no circle, and where it sits in its element.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CurveSpec {
    /// Form of the core curve, in its own frame.
    pub shape: Shape,
    /// Where the z axis of the form points; any non-zero length.
    #[serde(default = "z_axis")]
    pub normal: [f64; 3],
    /// Where its x axis points: what of this vector is across the normal.
    #[serde(default = "x_axis")]
    pub along: [f64; 3],
    /// Origin of the form relative to the element's centre.
    #[serde(default)]
    pub offset: [f64; 3],
    /// Minor radius r of this tube alone.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub minor_radius: Option<f64>,
}

fn z_axis() -> [f64; 3] {
    CurveSpec::Z
}

fn x_axis() -> [f64; 3] {
    CurveSpec::X
}

impl CurveSpec {
    /// The normal that is not written.
    pub const Z: [f64; 3] = [0.0, 0.0, 1.0];
    /// The direction of the form's x axis that is not written.
    pub const X: [f64; 3] = [1.0, 0.0, 0.0];

    /// A form in its element's own frame.
    pub fn of(shape: Shape) -> Self {
        CurveSpec { shape, normal: Self::Z, along: Self::X, offset: [0.0; 3], minor_radius: None }
    }

    /// From the form's frame to the element's. None where its normal is zero, or its x axis points along the normal.
    pub fn rotation(&self) -> Option<UnitQuaternion<f64>> {
        let normal = Vec3::from(self.normal);
        let normal = (normal / normal.amax()).try_normalize(0.0)?;
        let along = Vec3::from(self.along);
        let along = along / along.amax();
        let x = (along - normal * normal.dot(&along)).try_normalize(1e-9)?;
        let frame = Rotation3::from_basis_unchecked(&[x, normal.cross(&x), normal]);
        Some(UnitQuaternion::from_rotation_matrix(&frame))
    }
}

impl Design {
    /// The same design with another common minor radius; rings with their own keep it.
    pub fn with_minor_radius(&self, minor_radius: f64) -> Self {
        Self { minor_radius: Some(minor_radius), ..self.clone() }.settled()
    }

    /// The same rings `factor` times as far apart: lattice vectors and centres of elements are multiplied.
    pub fn spaced(&self, factor: f64) -> Self {
        let mut out = self.clone();
        let centers = out.elements.iter_mut().map(|element| &mut element.center);
        centers.chain([&mut out.lattice.a1, &mut out.lattice.a2]).flatten().for_each(|x| *x *= factor);
        *out.varied.entry(SPACING.into()).or_insert(1.0) *= factor;
        out.settled()
    }

    /// The same design with every length multiplied by `factor`.
    pub fn scaled(&self, factor: f64) -> Self {
        let mut out = self.clone();
        let scale = |v: &mut [f64; 3]| v.iter_mut().for_each(|x| *x *= factor);
        out.varied.retain(|name, _| name == SPACING);
        out.minor_radius = out.minor_radius.map(|r| r * factor);
        out.reference_radius *= factor;
        out.curve_tolerance = out.curve_tolerance.map(|tolerance| tolerance * factor);
        scale(&mut out.lattice.a1);
        scale(&mut out.lattice.a2);
        for element in &mut out.elements {
            scale(&mut element.center);
            for ring in &mut element.rings {
                ring.major_radius *= factor;
                ring.minor_radius = ring.minor_radius.map(|r| r * factor);
                scale(&mut ring.offset);
            }
            for curve in &mut element.curves {
                curve.shape.scale(factor);
                curve.minor_radius = curve.minor_radius.map(|r| r * factor);
                scale(&mut curve.offset);
            }
        }
        out.settled()
    }

    /// The same design with lattice, centres and offsets to 13 decimals of the reference radius and normals to 14: without
    /// the last bits of what was computed, which are noise.
    pub fn rounded(&self) -> Self {
        let mut out = self.clone();
        let decimals = (13.0 - self.reference_radius.log10().floor()).clamp(0.0, 300.0) as usize;
        let round = |v: &mut [f64; 3], decimals: usize| {
            // + 0.0 makes −0 equal to 0
            v.iter_mut().for_each(|x| *x = format!("{x:.decimals$}").parse().unwrap_or(*x) + 0.0);
        };
        round(&mut out.lattice.a1, decimals);
        round(&mut out.lattice.a2, decimals);
        for element in &mut out.elements {
            round(&mut element.center, decimals);
            for ring in &mut element.rings {
                round(&mut ring.normal, 14);
                round(&mut ring.offset, decimals);
            }
            for curve in &mut element.curves {
                round(&mut curve.normal, 14);
                round(&mut curve.along, 14);
                round(&mut curve.offset, decimals);
            }
        }
        out.settled()
    }

    /// Checks every field that can be judged without geometry between elements, and returns all that is wrong.
    ///
    /// Overlap and links need the compiled model: see `Model`.
    pub fn problems(&self) -> Vec<InvalidInput> {
        let mut out = self.problems_of_fields();
        out.extend(self.problems_of_formulas());
        out
    }

    /// The same but for parameters and formulas.
    fn problems_of_fields(&self) -> Vec<InvalidInput> {
        let mut out = Problems::default();
        if self.schema != DESIGN_SCHEMA {
            out.add("schema", format!("version {} is not known", self.schema), "this program reads schema = 1");
        }
        if self.name.trim().is_empty() {
            out.add("name", "is empty", "give the design a short name");
        }
        let help = "give the major radius that ratios such as r = R/10 refer to";
        if out.positive("reference_radius", self.reference_radius, help) {
            self.add_problem_of_reference(&mut out);
        }
        if self.lacks_minor_radii() && self.elements.iter().any(|e| !e.rings.is_empty() || !e.curves.is_empty()) {
            out.add(
                "minor_radius",
                "is missing",
                "add minor_radius = 0.1, the wire's radius, or give each ring its own",
            );
        }
        if let Some(r) = self.minor_radius.filter(|r| out.positive("minor_radius", *r, WIRE_RADIUS)) {
            self.add_problem_of_wire(r, &mut out);
        }
        if let Some(tolerance) = self.curve_tolerance {
            out.positive("curve_tolerance", tolerance, "give the deviation that is allowed, as 1e-6");
        }
        self.lattice.add_problems(&mut out);
        if self.elements.is_empty() {
            out.add("elements", "there is none", "add an [[elements]] table with at least one ring");
        }
        for (i, e) in self.elements.iter().enumerate() {
            let at = format!("elements[{i}]");
            if let Some(j) = self.elements[..i].iter().position(|o| o.name == e.name) {
                let problem = format!("\"{}\" is already the name of elements[{j}]", e.name);
                out.add(format!("{at}.name"), problem, "give every element a name of its own");
            }
            out.finite(format!("{at}.center"), &e.center);
            if e.rings.is_empty() && e.curves.is_empty() {
                out.add(format!("{at}.rings"), "there is none", "give at least { major_radius, normal }");
            }
            for (k, ring) in e.rings.iter().enumerate() {
                self.add_problems_of(ring, &format!("{at}.rings[{k}]"), &mut out);
            }
            for (k, curve) in e.curves.iter().enumerate() {
                self.add_problems_of_curve(curve, &format!("{at}.curves[{k}]"), &mut out);
            }
        }
        out.0
    }

    /// The design's own wire is too thick for some of its rings: one mistake, said once.
    fn add_problem_of_wire(&self, r: f64, out: &mut Problems) {
        let rings = self.elements.iter().flat_map(|e| &e.rings).filter(|ring| ring.minor_radius.is_none());
        let too_small: Vec<f64> = rings.map(|ring| ring.major_radius).filter(|x| is_positive(*x) && *x <= r).collect();
        let Some(least) = too_small.iter().copied().min_by(f64::total_cmp) else { return };
        let of = match too_small.len() {
            1 => format!("the major radius of a ring, {least}"),
            n => format!("the major radius of {n} rings, {least} of the smallest"),
        };
        let mut help = "a ring has a hole only if r < R".to_owned();
        if 0.5 * r < least {
            help += &format!("; is this a diameter? Then write {}", 0.5 * r);
        }
        out.add("minor_radius", format!("{r} is not smaller than {of}"), &help);
    }

    /// A reference radius far above the size of everything is a typing error: tolerances, gaps and pictures are relative to it.
    fn add_problem_of_reference(&self, out: &mut Problems) {
        let largest = |sizes: &mut dyn Iterator<Item = f64>| sizes.fold(0.0, f64::max);
        let of_rings = largest(&mut self.elements.iter().flat_map(|e| &e.rings).map(|ring| ring.major_radius));
        let of_curves = largest(&mut self.elements.iter().flat_map(|e| &e.curves).map(|curve| curve.shape.size()));
        let (size, what) = match of_rings >= of_curves {
            true => (of_rings, "the largest major_radius"),
            false => (of_curves, "the largest length of a curve"),
        };
        if is_positive(size) && self.reference_radius > REFERENCE_RATIO * size {
            let problem = format!("{} is far above {what}, {size}", self.reference_radius);
            out.add("reference_radius", problem, "give the major radius of a ring: tolerances are relative to it");
        }
    }

    /// Whether neither the design nor any ring has a minor radius.
    fn lacks_minor_radii(&self) -> bool {
        let own = |e: &ElementSpec| {
            let curves = e.curves.iter().map(|curve| curve.minor_radius);
            e.rings.iter().map(|ring| ring.minor_radius).chain(curves).any(|own| own.is_some())
        };
        self.minor_radius.is_none() && !self.elements.iter().any(own)
    }

    /// How far the segments and arcs that stand for a smooth curve may be from it.
    pub fn tolerance_of_curves(&self) -> f64 {
        self.curve_tolerance.unwrap_or(CURVE_TOLERANCE * self.reference_radius)
    }

    /// How far smooth curves are from the segments and arcs that stand for them, at most, at sampled points. None without such curves.
    pub fn curve_deviation(&self) -> Option<f64> {
        let curves = self.elements.iter().flat_map(|e| &e.curves);
        let deviations = curves.filter_map(|curve| curve.shape.deviation(self.tolerance_of_curves()));
        deviations.filter(|deviation| *deviation > 0.0).max_by(f64::total_cmp)
    }

    fn add_problems_of_curve(&self, curve: &CurveSpec, at: &str, out: &mut Problems) {
        if out.finite(format!("{at}.normal"), &curve.normal) && curve.normal == [0.0; 3] {
            out.add(format!("{at}.normal"), "is zero", "give any non-zero vector, as [0.0, 0.0, 1.0]");
        } else if out.finite(format!("{at}.along"), &curve.along) && curve.rotation().is_none() {
            let problem =
                format!("{:?} does not tell how the curve is turned about its normal {:?}", curve.along, curve.normal);
            out.add(format!("{at}.along"), problem, "give a vector across the normal: where the curve's x axis points");
        }
        out.finite(format!("{at}.offset"), &curve.offset);
        let form = format!("{at}.{}", curve.shape.name());
        if let Some((name, problem, help)) = curve.shape.problem() {
            out.add(format!("{form}.{name}"), problem, help);
        } else if is_positive(self.reference_radius) && is_positive(self.tolerance_of_curves()) {
            self.add_problems_of_tube(curve, at, out);
        }
    }

    /// What is wrong with the tube round a curve whose form is right.
    fn add_problems_of_tube(&self, curve: &CurveSpec, at: &str, out: &mut Problems) {
        let form = format!("{at}.{}", curve.shape.name());
        let Some(pieces) = curve.shape.pieces(self.tolerance_of_curves()) else {
            let problem = format!(
                "more than {} arcs would be needed for curve_tolerance = {}",
                shape::MOST_PIECES,
                self.tolerance_of_curves()
            );
            out.add(form, problem, "allow a larger curve_tolerance");
            return;
        };
        let Some(r) = curve.minor_radius.or(self.minor_radius) else {
            if !self.lacks_minor_radii() {
                let help = "add minor_radius = … at the top of the file, or to this curve";
                out.add(format!("{at}.minor_radius"), "is given neither here nor for the whole design", help);
            }
            return;
        };
        let own = curve.minor_radius.is_some();
        let field = if own { format!("{at}.minor_radius") } else { form };
        if own && !out.positive(field.clone(), r, WIRE_RADIUS) || !is_positive(r) {
            return;
        }
        if let Some(tightest) = shape::tightest(&pieces).filter(|tightest| r >= *tightest) {
            let problem = format!("minor radius {r} is not smaller than the curve's least radius {tightest:.6}");
            out.add(field, problem, "a wire cannot bend more sharply than that: take a thinner one, or a wider curve");
            return;
        }
        if let Some(gap) = curve.shape.overlap(&pieces, r) {
            let problem = format!(
                "the tube runs into itself: its core comes as near to itself as {gap:.6}, the wire is {} thick",
                2.0 * r
            );
            out.add(field, problem, "take a smaller minor_radius, or a curve that keeps away from itself");
        }
    }

    fn add_problems_of(&self, ring: &RingSpec, at: &str, out: &mut Problems) {
        let major_radius =
            out.positive(format!("{at}.major_radius"), ring.major_radius, "give the radius of the ring's core circle");
        if out.finite(format!("{at}.normal"), &ring.normal) && ring.normal == [0.0; 3] {
            out.add(format!("{at}.normal"), "is zero", "give any non-zero vector, as [0.0, 0.0, 1.0]");
        }
        out.finite(format!("{at}.offset"), &ring.offset);
        let Some(r) = ring.minor_radius.or(self.minor_radius) else {
            if !self.lacks_minor_radii() {
                let help = "add minor_radius = … at the top of the file, or to this ring";
                out.add(format!("{at}.minor_radius"), "is given neither here nor for the whole design", help);
            }
            return;
        };
        let own = ring.minor_radius.is_some();
        // That of the design is judged once.
        let minor_radius =
            if own { out.positive(format!("{at}.minor_radius"), r, WIRE_RADIUS) } else { is_positive(r) };
        if minor_radius && major_radius && r >= ring.major_radius && own {
            let problem = format!("minor radius {r} is not smaller than major radius {}", ring.major_radius);
            out.add(format!("{at}.minor_radius"), problem, "a ring has a hole only if r < R");
        }
    }
}

/// The reference radius is at most so many times the largest size of a design.
const REFERENCE_RATIO: f64 = 100.0;

const WIRE_RADIUS: &str = "give the wire's radius (half of its diameter)";

fn is_positive(x: f64) -> bool {
    x.is_finite() && x > 0.0
}

/// What is wrong with a design.
#[derive(Default)]
struct Problems(Vec<InvalidInput>);

impl Problems {
    fn add(&mut self, field: impl Into<String>, problem: impl Into<String>, help: &str) {
        self.0.push(InvalidInput::new(field, problem, help));
    }

    /// Whether `x` is a positive length.
    fn positive(&mut self, field: impl Into<String>, x: f64, help: &str) -> bool {
        if !is_positive(x) {
            self.add(field, format!("{x} is not a positive length"), help);
        }
        is_positive(x)
    }

    /// Whether `v` is finite.
    fn finite(&mut self, field: impl Into<String>, v: &[f64; 3]) -> bool {
        let finite = v.iter().all(|x| x.is_finite());
        if !finite {
            self.add(field, format!("{v:?} is not finite"), "give three finite numbers");
        }
        finite
    }
}

impl LatticeSpec {
    fn add_problems(&self, out: &mut Problems) {
        let (a, b) = (self.a1, self.a2);
        for (field, a) in [("lattice.a1", a), ("lattice.a2", b)] {
            if !out.finite(field, &a) {
                continue;
            }
            if a[2] != 0.0 {
                let problem = format!("z = {} leaves the sheet's plane", a[2]);
                out.add(field, problem, "lattice vectors lie in the plane z = 0");
            } else if a == [0.0; 3] {
                out.add(field, "is zero", "give the translation to the next cell");
            }
        }
        let cross = a[0] * b[1] - a[1] * b[0];
        let lengths = (a[0].hypot(a[1])) * (b[0].hypot(b[1]));
        if lengths.is_finite() && lengths > 0.0 && cross.abs() < 1e-9 * lengths {
            out.add("lattice.a2", format!("{b:?} is parallel to a1 = {a:?}"), "give two independent translations");
        }
    }
}
