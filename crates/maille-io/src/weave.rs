//! Weaves with a name, as designs for rings of any size.
//!
//! All rings of a weave are alike, so that a placement is a set of ratios to the major radius R. Those here leave the
//! smallest gap as large as it can be: where one distance between two rings grows, another falls. The rings fit if
//! their wire is thinner than that distance. `crates/maille-io/tests/it/weaves.rs` checks this, and the links.

use crate::write_design;
use maille::{
    design::{Design, ElementSpec, LatticeSpec, RingSpec, Source},
    lattice::Cell,
    model::Model,
    topology,
};
use miette::Diagnostic;
use std::{collections::BTreeMap, fmt};
use thiserror::Error;

/// A weave with a name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Weave {
    /// Rows of rings that lean to and fro, each through four of the next rows.
    European4In1,
    /// Rows of rings that lean along the row, each through three of either next row.
    European6In1,
    /// Flat rings on a square grid, joined by standing ones.
    Japanese4In1,
    /// Flat rings on a triangular grid, joined by standing ones.
    Japanese6In1,
    /// Japanese 4-in-1 with every ring doubled.
    Japanese8In2,
    /// Japanese 6-in-1 with every ring doubled.
    Japanese12In2,
    /// European 4-in-1 with every ring doubled.
    KingsMail,
}

/// The rings of a weave: all alike.
#[derive(Clone, Debug, PartialEq)]
pub struct Rings {
    /// Major radius R.
    pub major: f64,
    /// Minor radius r.
    pub minor: f64,
    /// Unit of both, if it has a name.
    pub unit: Option<String>,
}

/// Proportions of which a weave cannot be assembled.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum WeaveError {
    /// A radius is no length, or the ring has no hole.
    #[error("rings of major radius {major} and minor radius {minor} have no hole, or no wire")]
    NoRing {
        /// Major radius.
        major: f64,
        /// Minor radius.
        minor: f64,
    },
    /// The wire is too thick.
    #[error("{weave} does not assemble: {} and {} would fuse, {overlap}{unit} deep", rings[0], rings[1])]
    TooThick {
        /// Name of the weave.
        weave: &'static str,
        /// The rings that overlap most.
        rings: [String; 2],
        /// How deep.
        overlap: f64,
        /// Major radius asked for.
        major: f64,
        /// Minor radius asked for.
        minor: f64,
        /// Minor radius at which rings of this major radius touch.
        thickest: f64,
        /// Major radius at which wire of this minor radius touches.
        smallest: f64,
        /// What follows each of these lengths: a space and their unit, or nothing.
        unit: Box<str>,
    },
}

impl Diagnostic for WeaveError {
    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        Some(Box::new(match self {
            Self::NoRing { .. } => {
                "the major radius goes to the middle of the wire, the minor radius is half of the wire: 0 < minor < major"
                    .to_owned()
            }
            Self::TooThick { major, minor, thickest, smallest, unit, .. } => format!(
                "rings of major radius {major}{unit} take a minor radius below {thickest}{unit}; a minor radius of \
                 {minor}{unit} takes rings of major radius above {smallest}{unit}"
            ),
        }))
    }
}

/// Centre, normal and name of a ring, in units of R.
struct Placed(&'static str, [f64; 3], [f64; 3]);

impl Weave {
    /// All of them.
    pub const ALL: [Weave; 7] = [
        Weave::European4In1,
        Weave::European6In1,
        Weave::Japanese4In1,
        Weave::Japanese6In1,
        Weave::Japanese8In2,
        Weave::Japanese12In2,
        Weave::KingsMail,
    ];

    /// Name of the weave and of its built-in design.
    pub fn name(self) -> &'static str {
        match self {
            Weave::European4In1 => "european-4-in-1",
            Weave::European6In1 => "european-6-in-1",
            Weave::Japanese4In1 => "japanese-4-in-1",
            Weave::Japanese6In1 => "japanese-6-in-1",
            Weave::Japanese8In2 => "japanese-8-in-2",
            Weave::Japanese12In2 => "japanese-12-in-2",
            Weave::KingsMail => "kings-mail",
        }
    }

    fn title(self) -> &'static str {
        match self {
            Weave::European4In1 => "European 4-in-1",
            Weave::European6In1 => "European 6-in-1",
            Weave::Japanese4In1 => "Japanese 4-in-1",
            Weave::Japanese6In1 => "Japanese 6-in-1",
            Weave::Japanese8In2 => "Japanese 8-in-2",
            Weave::Japanese12In2 => "Japanese 12-in-2",
            Weave::KingsMail => "King's mail (European 8-in-2)",
        }
    }

    /// What holds what, as lines of a comment.
    fn comment(self) -> &'static [&'static str] {
        match self {
            Weave::European4In1 => &[
                "European 4-in-1: rows of rings that lean to and fro about x. Each ring goes through two",
                "of the row above and two of the row below.",
            ],
            Weave::European6In1 => &[
                "European 6-in-1: rows of rings that lean along the row, to and fro from row to row. Each",
                "ring goes through three of the row above and three of the row below.",
            ],
            Weave::Japanese4In1 => &[
                "Japanese 4-in-1: flat rings on a square grid; a standing ring of the same size joins every",
                "two neighbours. Each flat ring holds four, each standing ring two. The links are those of 1.1.",
            ],
            Weave::Japanese6In1 => &[
                "Japanese 6-in-1: flat rings on a triangular grid; a standing ring of the same size joins",
                "every two neighbours. Each flat ring holds six, each standing ring two. The links are those",
                "of 3.1.",
            ],
            Weave::Japanese8In2 => &[
                "Japanese 8-in-2: Japanese 4-in-1 with every ring doubled. Each flat ring holds eight, each",
                "standing ring four. The links are those of 5.1.",
            ],
            Weave::Japanese12In2 => &[
                "Japanese 12-in-2: Japanese 6-in-1 with every ring doubled. Each flat ring holds twelve,",
                "each standing ring four. The links are those of 5.2.",
            ],
            Weave::KingsMail => &[
                "King's mail: European 4-in-1 with every ring doubled, the two of a pair side by side along",
                "their normal. Each ring goes through eight.",
            ],
        }
    }

    /// Lattice vectors and rings, in units of R.
    fn placement(self) -> ([[f64; 3]; 2], Vec<Placed>) {
        match self {
            Weave::European4In1 => {
                let (px, py, lean) = (2.5024, 1.2467, 34.143_f64.to_radians());
                let (s, c) = lean.sin_cos();
                let rings = vec![
                    Placed("row-a", [0.0; 3], [0.0, s, c]),
                    Placed("row-b", [px / 2.0, -py / 2.0, 0.0], [0.0, -s, c]),
                ];
                ([[px, 0.0, 0.0], [0.0, py, 0.0]], rings)
            }
            Weave::European6In1 => {
                let (px, py, lean) = (0.8929, 2.3722, 32.39_f64.to_radians());
                let (s, c) = lean.sin_cos();
                let rings =
                    vec![Placed("row-a", [0.0; 3], [s, 0.0, c]), Placed("row-b", [0.0, py / 2.0, 0.0], [-s, 0.0, c])];
                ([[px, 0.0, 0.0], [0.0, py, 0.0]], rings)
            }
            Weave::KingsMail => {
                let (px, py, lean, apart) = (2.3493, 1.2473, 38.941_f64.to_radians(), 0.3494 / 2.0);
                let (s, c) = lean.sin_cos();
                let (y, z) = (apart * s, apart * c);
                let (bx, by) = (px / 2.0, -py / 2.0);
                let rings = vec![
                    Placed("row-a-upper", [0.0, y, z], [0.0, s, c]),
                    Placed("row-a-lower", [0.0, -y, -z], [0.0, s, c]),
                    Placed("row-b-upper", [bx, by - y, z], [0.0, -s, c]),
                    Placed("row-b-lower", [bx, by + y, -z], [0.0, -s, c]),
                ];
                ([[px, 0.0, 0.0], [0.0, py, 0.0]], rings)
            }
            Weave::Japanese4In1 => japanese(2.0 * 2.0_f64.sqrt(), None, &SQUARE),
            Weave::Japanese6In1 => japanese(3.0, None, &TRIANGULAR),
            Weave::Japanese8In2 => japanese(3.0104, Some(0.4185), &SQUARE),
            Weave::Japanese12In2 => japanese(3.247, Some(0.3341), &TRIANGULAR),
        }
    }

    /// Whether its coordinates have √3 in them.
    fn is_triangular(self) -> bool {
        matches!(self, Weave::Japanese6In1 | Weave::Japanese12In2)
    }

    /// The design of these rings, called `name`; refused where they would fuse.
    pub fn design(self, name: &str, rings: &Rings) -> Result<Design, WeaveError> {
        let (major, minor) = (rings.major, rings.minor);
        if !(minor > 0.0 && minor < major && major.is_finite()) {
            return Err(WeaveError::NoRing { major, minor });
        }
        let digits = |most: f64| (most - major.log10().floor()).clamp(0.0, 300.0) as i32;
        // A triangular grid that is rounded to fewer has no turn by 60° any more.
        let (digits, of_normals) = if self.is_triangular() { (digits(13.0), 14) } else { (digits(5.0), 6) };
        let length = |x: f64| round(x * major, digits);
        let (lattice, placed) = self.placement();
        let element = |Placed(name, center, normal): Placed| ElementSpec {
            name: name.into(),
            center: center.map(length),
            rings: vec![RingSpec {
                major_radius: major,
                normal: normal.map(|x| round(x, of_normals)),
                offset: [0.0; 3],
                minor_radius: None,
            }],
            curves: Vec::new(),
        };
        let design = Design {
            schema: maille::design::DESIGN_SCHEMA,
            name: name.into(),
            title: self.title().into(),
            source: Source::Own,
            unit: rings.unit.clone(),
            minor_radius: Some(minor),
            reference_radius: major,
            curve_tolerance: None,
            allow_initial_overlap: false,
            lattice: LatticeSpec { a1: lattice[0].map(length), a2: lattice[1].map(length), single: false },
            elements: placed.into_iter().map(element).collect(),
            varied: BTreeMap::new(),
            parameters: Vec::new(),
            formulas: BTreeMap::new(),
        };
        match self.clearance(&design) {
            Some((distance, pair)) if distance <= 2.0 * minor => Err(WeaveError::TooThick {
                weave: self.title(),
                rings: pair,
                overlap: significant(2.0 * minor - distance, f64::round),
                major,
                minor,
                thickest: significant(distance / 2.0, f64::floor),
                smallest: significant(2.0 * minor * major / distance, f64::ceil),
                unit: rings.unit.as_ref().map_or(String::new(), |unit| format!(" {unit}")).into(),
            }),
            _ => Ok(design),
        }
    }

    /// The aspect ratio (inner diameter / wire diameter) above which the weave assembles as it is placed here: where the wire
    /// is as thick as the least distance of two core circles.
    pub fn smallest_aspect_ratio(self) -> f64 {
        let thin = Rings { major: 1.0, minor: 1e-3, unit: None };
        let design = self.design(self.name(), &thin).expect("every weave takes thin wire");
        let distance = self.clearance(&design).map_or(f64::NAN, |(distance, _)| distance);
        2.0 / distance - 1.0
    }

    /// Least distance of two core circles of the start, with their rings.
    fn clearance(self, design: &Design) -> Option<(f64, [String; 2])> {
        let tolerant = Design { allow_initial_overlap: true, ..design.clone() };
        let model = Model::compile(&tolerant, Cell::PRIMITIVE).ok()?;
        let (gap, pair) = topology::smallest_gap(&model, &model.start)?;
        let distance = (gap + model.contact_distance(pair.ring_a, pair.ring_b)) * model.unit;
        Some((distance, [model.ring_label(pair.ring_a, [0, 0]), model.ring_label(pair.ring_b, pair.shift)]))
    }

    /// The design as a file with comments. `placed`: words on how its rings were placed, where they have not the largest gaps;
    /// `schema`: path of the JSON Schema, for editors.
    pub fn file(self, design: &Design, placed: Option<&str>, schema: Option<&str>) -> String {
        let (major, minor) = (design.reference_radius, design.minor_radius.unwrap_or(f64::NAN));
        let mut out = schema.map_or(String::new(), |path| format!("#:schema {path}\n"));
        for line in self.comment() {
            out += &format!("# {line}\n");
        }
        let assembles = match placed {
            // Of the placement with the largest gaps.
            Some(_) => self.smallest_aspect_ratio(),
            None => {
                let thickest = self.clearance(design).map_or(f64::NAN, |(distance, _)| distance / 2.0);
                (major - thickest) / thickest
            }
        };
        out += &format!(
            "#\n# Inner diameter {:.4}, wire {:.4}: aspect ratio {:.2}. The weave assembles above {:.2}.\n",
            2.0 * (major - minor),
            2.0 * minor,
            (major - minor) / minor,
            assembles,
        );
        let placed = placed.unwrap_or("The placement is the one with the largest gaps");
        out += &format!("# {placed}; strains are relative to it.\n\n");
        for line in write_design(design).lines() {
            out += match line.split(' ').next().unwrap_or_default() {
                "unit" => "# The unit of all lengths in this file.\n",
                "minor_radius" => "# Half of the wire's diameter.\n",
                "reference_radius" => {
                    "# R, from the centre of a ring to the middle of its wire; tolerances are relative to it.\n"
                }
                "[lattice]" => "# The sheet repeats by these two translations.\n",
                "[[elements]]" if !out.contains("[[elements]]") => {
                    "# Each element is a rigid body, here of one ring; `normal` stands upright on the ring's plane.\n"
                }
                _ => "",
            };
            out += line;
            out += "\n";
        }
        out
    }
}

/// Direction of a chain: name, cosine, sine.
type Chain = (&'static [&'static str; 3], f64, f64);

const SQUARE: [Chain; 2] = [
    (&["standing-0", "standing-0-left", "standing-0-right"], 1.0, 0.0),
    (&["standing-90", "standing-90-left", "standing-90-right"], 0.0, 1.0),
];
const HALF_ROOT_3: f64 = 0.866_025_403_784_438_6;
const TRIANGULAR: [Chain; 3] = [
    (&["standing-0", "standing-0-left", "standing-0-right"], 1.0, 0.0),
    (&["standing-60", "standing-60-left", "standing-60-right"], 0.5, HALF_ROOT_3),
    (&["standing-120", "standing-120-left", "standing-120-right"], -0.5, HALF_ROOT_3),
];

/// Flat rings on a grid of spacing `a`, standing rings between neighbours; all doubled, `apart` along their normals.
fn japanese(a: f64, apart: Option<f64>, chains: &[Chain]) -> ([[f64; 3]; 2], Vec<Placed>) {
    let second = &chains[1];
    let lattice = [[a, 0.0, 0.0], [a * second.1, a * second.2, 0.0]];
    let flat = [0.0, 0.0, 1.0];
    let mut rings = match apart {
        None => vec![Placed("flat", [0.0; 3], flat)],
        Some(d) => {
            vec![Placed("flat-upper", [0.0, 0.0, d / 2.0], flat), Placed("flat-lower", [0.0, 0.0, -d / 2.0], flat)]
        }
    };
    for &(names, cos, sin) in chains {
        let at = |left: f64| [a / 2.0 * cos - left * sin, a / 2.0 * sin + left * cos, 0.0];
        let normal = [-sin, cos, 0.0];
        match apart {
            None => rings.push(Placed(names[0], at(0.0), normal)),
            Some(d) => {
                rings.push(Placed(names[1], at(d / 2.0), normal));
                rings.push(Placed(names[2], at(-d / 2.0), normal));
            }
        }
    }
    (lattice, rings)
}

/// `x` with this many decimals; −0 is 0.
fn round(x: f64, decimals: i32) -> f64 {
    format!("{x:.*}", decimals.unsigned_abs() as usize).parse().unwrap_or(x) + 0.0
}

/// Four significant digits, rounded by `how`.
fn significant(x: f64, how: fn(f64) -> f64) -> f64 {
    let unit = 10_f64.powf(x.log10().floor() - 3.0);
    let digits = how(x / unit) * unit;
    format!("{digits:.12}").parse().unwrap_or(digits)
}
