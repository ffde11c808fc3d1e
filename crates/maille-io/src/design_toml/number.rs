//! A number of a design, named by its place in the file: `lattice.a1.x`, `elements.standing-*.rings.major_radius`.

use maille::{
    design::{Design, RingSpec},
    error::InvalidInput,
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
    /// Which lattice vector, and which of its components.
    Lattice(usize, usize),
    /// Of the elements of this name, in which `*` stands for anything.
    Elements(String, OfElement),
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum OfElement {
    Center(usize),
    /// Of this ring, or of all.
    Ring(Option<usize>, OfRing),
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum OfRing {
    MajorRadius,
    MinorRadius,
    Normal(usize),
    Offset(usize),
}

/// The forms of a path, for errors.
const FORMS: &str = "write minor_radius, reference_radius, lattice.a1.x, elements.NAME.center.z, \
                     elements.NAME.rings.major_radius (of all its rings) or elements.NAME.rings.0.offset.x; * in NAME stands for anything";

impl FromStr for NumberPath {
    type Err = InvalidInput;

    fn from_str(text: &str) -> Result<Self, InvalidInput> {
        let parts: Vec<&str> = text.split('.').collect();
        let axis = |name: &str| ["x", "y", "z"].iter().position(|axis| *axis == name);
        let place = match parts[..] {
            ["minor_radius"] => Some(Place::MinorRadius),
            ["reference_radius"] => Some(Place::ReferenceRadius),
            ["lattice", "a1", name] => axis(name).map(|axis| Place::Lattice(0, axis)),
            ["lattice", "a2", name] => axis(name).map(|axis| Place::Lattice(1, axis)),
            ["elements", ..] => of_elements(&parts[1..], axis),
            _ => None,
        };
        let wrong = || InvalidInput::new("vary", format!("\"{text}\" names no number of a design"), FORMS);
        place.map(|place| NumberPath { text: text.to_owned(), place }).ok_or_else(wrong)
    }
}

/// `NAME.center.x` and the like; a name may have dots.
fn of_elements(parts: &[&str], axis: impl Fn(&str) -> Option<usize>) -> Option<Place> {
    let of_ring = |last: &[&str]| match *last {
        ["major_radius"] => Some(OfRing::MajorRadius),
        ["minor_radius"] => Some(OfRing::MinorRadius),
        ["normal", name] => axis(name).map(OfRing::Normal),
        ["offset", name] => axis(name).map(OfRing::Offset),
        _ => None,
    };
    let at = parts.iter().rposition(|part| ["center", "rings"].contains(part)).filter(|at| *at > 0)?;
    let field = match (parts[at], &parts[at + 1..]) {
        ("center", [name]) => OfElement::Center(axis(name)?),
        ("rings", [ring, last @ ..]) if ring.parse::<usize>().is_ok() => {
            OfElement::Ring(ring.parse().ok(), of_ring(last)?)
        }
        ("rings", last) => OfElement::Ring(None, of_ring(last)?),
        _ => return None,
    };
    Some(Place::Elements(parts[..at].join("."), field))
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
        let mut out = design.clone();
        match &self.place {
            Place::MinorRadius => out.minor_radius = Some(value),
            Place::ReferenceRadius => out.reference_radius = value,
            Place::Lattice(0, axis) => out.lattice.a1[*axis] = value,
            Place::Lattice(_, axis) => out.lattice.a2[*axis] = value,
            Place::Elements(pattern, field) => {
                let mut set = 0;
                for element in out.elements.iter_mut().filter(|element| matches(pattern, &element.name)) {
                    match *field {
                        OfElement::Center(axis) => {
                            element.center[axis] = value;
                            set += 1;
                        }
                        OfElement::Ring(index, of_ring) => {
                            let rings = element.rings.iter_mut().enumerate();
                            for (_, ring) in rings.filter(|(k, _)| index.is_none_or(|index| index == *k)) {
                                set_ring(ring, of_ring, value);
                                set += 1;
                            }
                        }
                    }
                }
                if set == 0 {
                    return Err(self.nowhere(design));
                }
            }
        }
        Ok(out)
    }

    fn nowhere(&self, design: &Design) -> InvalidInput {
        let elements = design.elements.iter().map(|e| format!("{} ({} rings)", e.name, e.rings.len()));
        let problem = format!("{} has no number {}", design.name, self.text);
        InvalidInput::new("vary", problem, format!("its elements are {}", elements.collect::<Vec<_>>().join(", ")))
    }
}

fn set_ring(ring: &mut RingSpec, of_ring: OfRing, value: f64) {
    match of_ring {
        OfRing::MajorRadius => ring.major_radius = value,
        OfRing::MinorRadius => ring.minor_radius = Some(value),
        OfRing::Normal(axis) => ring.normal[axis] = value,
        OfRing::Offset(axis) => ring.offset[axis] = value,
    }
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
            "radius",
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
