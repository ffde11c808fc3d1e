//! A number of a design, named by its place in the file: `lattice.a1.x`, `elements.standing-*.rings.major_radius`.

use maille::{
    design::{Design, ElementSpec, RingSpec, SPACING},
    error::InvalidInput,
    fit::NumberKind,
    formula::is_name,
};
use std::{fmt, str::FromStr};

/// The place of a number, or of several that take one value.
#[derive(Clone, Debug, PartialEq)]
pub struct NumberPath {
    text: String,
    place: Place,
}

#[derive(Clone, Debug, PartialEq)]
enum Place {
    MinorRadius,
    ReferenceRadius,
    /// The factor of all distances between elements, from those of the design.
    Spacing,
    /// A parameter of the design.
    Parameter,
    /// Which lattice vector, and which of its components.
    Lattice(usize, usize),
    /// Of the elements of this name, in which `*` stands for anything.
    Center(String, usize),
    /// The same; of this ring, or of all.
    Ring(String, Option<usize>, OfRing),
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum OfRing {
    MajorRadius,
    MinorRadius,
    Normal(usize),
    Offset(usize),
}

/// The forms of a path, for errors.
const FORMS: &str = "write the name of a parameter, minor_radius, reference_radius, lattice.a1.x, elements.NAME.center.z, \
                     elements.NAME.rings.major_radius (of all its rings) or elements.NAME.rings.0.offset.x; * in NAME stands for anything";

impl FromStr for NumberPath {
    type Err = InvalidInput;

    fn from_str(text: &str) -> Result<Self, InvalidInput> {
        let parts: Vec<&str> = text.split('.').collect();
        let wrong = || InvalidInput::new("vary", format!("\"{text}\" names no number of a design"), FORMS);
        place(&parts).map(|place| NumberPath { text: text.to_owned(), place }).ok_or_else(wrong)
    }
}

const AXES: [&str; 3] = ["x", "y", "z"];

fn place(parts: &[&str]) -> Option<Place> {
    let axis = |name: &str| AXES.iter().position(|axis| *axis == name);
    Some(match *parts {
        ["minor_radius"] => Place::MinorRadius,
        ["reference_radius"] => Place::ReferenceRadius,
        [SPACING] => Place::Spacing,
        [name] if is_name(name) => Place::Parameter,
        ["lattice", "a1", last] => Place::Lattice(0, axis(last)?),
        ["lattice", "a2", last] => Place::Lattice(1, axis(last)?),
        ["elements", ref name @ .., "center", last] if !name.is_empty() => Place::Center(name.join("."), axis(last)?),
        ["elements", ref rest @ ..] => {
            // A name may have dots.
            let at = rest.iter().rposition(|part| *part == "rings").filter(|at| *at > 0)?;
            let index = rest.get(at + 1).and_then(|ring| ring.parse().ok());
            let of_ring = match rest[at + 1 + usize::from(index.is_some())..] {
                ["major_radius"] => OfRing::MajorRadius,
                ["minor_radius"] => OfRing::MinorRadius,
                ["normal", last] => OfRing::Normal(axis(last)?),
                ["offset", last] => OfRing::Offset(axis(last)?),
                _ => return None,
            };
            Place::Ring(rest[..at].join("."), index, of_ring)
        }
        _ => return None,
    })
}

impl fmt::Display for NumberPath {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

impl NumberPath {
    /// For names of folders: `standing-major_radius`.
    pub fn label(&self) -> String {
        let short = self.text.replace("elements.", "").replace(".rings", "");
        let pieces = short.split(['.', '*', '-']).filter(|piece| !piece.is_empty());
        pieces.collect::<Vec<_>>().join("-")
    }

    /// The design with `value` at this place. Refused where the design has no such place.
    pub fn set(&self, design: &Design, value: f64) -> Result<Design, InvalidInput> {
        if self.parameter().is_some() {
            let first = |problems: Vec<InvalidInput>| problems.into_iter().next().expect("an error has a problem");
            return set_parameters(design, &[(&self.text, value)]).map_err(first);
        }
        if self.place == Place::Spacing {
            return Ok(design.spaced(value));
        }
        let mut out = design.clone();
        let numbers = self.numbers(&mut out);
        if numbers.is_empty() {
            let elements: Vec<_> =
                design.elements.iter().map(|e| format!("{} ({} rings)", e.name, e.rings.len())).collect();
            let problem = format!("{} has no number {}", design.name, self.text);
            return Err(InvalidInput::new("vary", problem, format!("its elements are {}", elements.join(", "))));
        }
        numbers.into_iter().for_each(|number| *number = value);
        let mut out = out.settled();
        if self.place != Place::MinorRadius {
            out.varied.insert(self.text.clone(), value);
        }
        Ok(out)
    }

    /// The same place of each element and ring by itself, where it is the place of several.
    pub fn each(&self, design: &Design) -> Vec<NumberPath> {
        let one = |text: String, place: Place| NumberPath { text, place };
        let elements = |pattern: &String| {
            let pattern = pattern.clone();
            design.elements.iter().filter(move |element| matches(&pattern, &element.name))
        };
        match &self.place {
            Place::Center(name, axis) => {
                let last = self.text.rsplit('.').next().unwrap_or_default();
                let of = |e: &ElementSpec| {
                    one(format!("elements.{}.center.{last}", e.name), Place::Center(e.name.clone(), *axis))
                };
                elements(name).map(of).collect()
            }
            Place::Ring(name, index, of_ring) => {
                let rings = elements(name).flat_map(|e| (0..e.rings.len()).map(move |k| (e, k)));
                let rings = rings.filter(|(_, k)| index.is_none_or(|index| index == *k));
                let of = |(e, k): (&ElementSpec, usize)| {
                    let place = Place::Ring(e.name.clone(), Some(k), *of_ring);
                    one(format!("elements.{}.rings.{k}.{}", e.name, of_ring.name()), place)
                };
                rings.map(of).collect()
            }
            _ => vec![self.clone()],
        }
    }

    /// The values of a design at this place, as many as it has places.
    pub fn values(&self, design: &Design) -> Vec<f64> {
        match (&self.place, self.parameter()) {
            (Place::Spacing, _) => vec![1.0],
            (_, Some(name)) => design.parameters.iter().filter(|p| p.name == name).map(|p| p.value).collect(),
            _ => {
                let mut design = design.clone();
                let common = design.minor_radius;
                let rings = design.elements.iter_mut().flat_map(|element| &mut element.rings);
                rings.for_each(|ring| ring.minor_radius = ring.minor_radius.or(common));
                self.numbers(&mut design).into_iter().map(|number| *number).collect()
            }
        }
    }

    /// Whether it is a radius.
    pub fn kind(&self) -> NumberKind {
        match self.place {
            Place::MinorRadius | Place::Ring(_, _, OfRing::MinorRadius) => NumberKind::MinorRadius,
            Place::Ring(_, _, OfRing::MajorRadius) => NumberKind::MajorRadius,
            _ => NumberKind::Other,
        }
    }

    /// Whether it is a length: components of a normal are none, and what a parameter is, is not known.
    pub fn is_length(&self) -> bool {
        !matches!(self.place, Place::Parameter | Place::Spacing | Place::Ring(_, _, OfRing::Normal(_)))
    }

    /// Whether it is the factor of all distances, which is set after all others.
    pub fn is_spacing(&self) -> bool {
        self.place == Place::Spacing
    }

    /// The parameter of that name, if it is one.
    pub fn parameter(&self) -> Option<&str> {
        (self.place == Place::Parameter).then_some(&self.text)
    }

    /// The numbers of a design at this place.
    fn numbers<'a>(&self, design: &'a mut Design) -> Vec<&'a mut f64> {
        match &self.place {
            Place::MinorRadius => vec![design.minor_radius.get_or_insert_default()],
            Place::ReferenceRadius => vec![&mut design.reference_radius],
            Place::Parameter | Place::Spacing => Vec::new(),
            Place::Lattice(0, axis) => vec![&mut design.lattice.a1[*axis]],
            Place::Lattice(_, axis) => vec![&mut design.lattice.a2[*axis]],
            Place::Center(name, axis) => {
                named(&mut design.elements, name).map(|element| &mut element.center[*axis]).collect()
            }
            Place::Ring(name, index, of_ring) => {
                let rings = named(&mut design.elements, name).flat_map(|element| element.rings.iter_mut().enumerate());
                let rings = rings.filter(|(k, _)| index.is_none_or(|index| index == *k));
                rings.map(|(_, ring)| of_ring.of(ring)).collect()
            }
        }
    }
}

/// The design with other values of its parameters, all at once: columns of tables.
pub fn set_parameters(design: &Design, values: &[(&str, f64)]) -> Result<Design, Vec<InvalidInput>> {
    let mut out = design.with_parameters(values)?;
    out.varied.extend(values.iter().map(|(name, value)| ((*name).to_owned(), *value)));
    Ok(out)
}

impl OfRing {
    /// As paths have it.
    fn name(self) -> String {
        match self {
            OfRing::MajorRadius => "major_radius".into(),
            OfRing::MinorRadius => "minor_radius".into(),
            OfRing::Normal(axis) => format!("normal.{}", AXES[axis]),
            OfRing::Offset(axis) => format!("offset.{}", AXES[axis]),
        }
    }

    fn of(self, ring: &mut RingSpec) -> &mut f64 {
        match self {
            OfRing::MajorRadius => &mut ring.major_radius,
            OfRing::MinorRadius => ring.minor_radius.get_or_insert_default(),
            OfRing::Normal(axis) => &mut ring.normal[axis],
            OfRing::Offset(axis) => &mut ring.offset[axis],
        }
    }
}

/// The elements whose name is of a pattern.
fn named<'a>(elements: &'a mut [ElementSpec], pattern: &str) -> impl Iterator<Item = &'a mut ElementSpec> {
    elements.iter_mut().filter(move |element| matches(pattern, &element.name))
}

/// Whether a name is of a pattern, in which `*` stands for any characters.
fn matches(pattern: &str, name: &str) -> bool {
    match pattern.split_once('*') {
        None => pattern == name,
        Some((before, after)) => name.strip_prefix(before).is_some_and(|rest| {
            (0..=rest.len()).filter(|&k| rest.is_char_boundary(k)).any(|k| matches(after, &rest[k..]))
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn design() -> Design {
        crate::read_design("1.1", crate::builtin("1.1").unwrap()).unwrap()
    }

    #[test]
    fn numbers_are_set_at_their_place() {
        let set = |path: &str, value: f64| path.parse::<NumberPath>().unwrap().set(&design(), value).unwrap();
        let standing = set("elements.standing-*.rings.major_radius", 0.5);
        let radii: Vec<f64> = standing.elements.iter().map(|e| e.rings[0].major_radius).collect();
        assert_eq!(radii, [1.0, 0.5, 0.5]);
        assert_eq!(set("lattice.a2.y", 3.0).lattice.a2, [0.0, 3.0, 0.0]);
        assert_eq!(set("elements.flat.center.z", 0.25).elements[0].center[2], 0.25);
        assert_eq!(set("elements.*.rings.0.minor_radius", 0.05).elements[2].rings[0].minor_radius, Some(0.05));
        assert_eq!(set("elements.standing-0.rings.normal.x", 0.5).elements[1].rings[0].normal, [0.5, 1.0, 0.0]);
        assert_eq!(set("minor_radius", 0.07).minor_radius, Some(0.07));
        assert_eq!(set("reference_radius", 2.0).reference_radius, 2.0);
    }

    #[test]
    fn labels_are_short() {
        let label = |path: &str| path.parse::<NumberPath>().unwrap().label();
        assert_eq!(label("elements.standing-*.rings.major_radius"), "standing-major_radius");
        assert_eq!(label("lattice.a1.x"), "lattice-a1-x");
    }

    #[test]
    fn what_is_no_number_is_refused() {
        for wrong in [
            "",
            "4radius",
            "lattice.a3.x",
            "lattice.a1",
            "elements.flat",
            "elements.rings.major_radius",
            "elements.flat.rings.2",
            "elements.flat.center.w",
        ] {
            let error = wrong.parse::<NumberPath>().unwrap_err();
            assert!(error.problem.contains("names no number") && error.help.contains("lattice.a1.x"), "{wrong}");
        }
        let error = "elements.round.rings.major_radius".parse::<NumberPath>().unwrap().set(&design(), 1.0).unwrap_err();
        assert!(error.help.contains("flat (1 rings), standing-0"), "{}", error.help);
        let error = "elements.flat.rings.3.minor_radius".parse::<NumberPath>().unwrap().set(&design(), 1.0);
        assert!(error.is_err());
    }
}
