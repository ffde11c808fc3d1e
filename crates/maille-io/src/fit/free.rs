//! Which numbers of a design a fit may move, and between which bounds: `minor_radius=0.05:0.15`, `elements.*.rings.major_radius=30%`.

use crate::design_toml::NumberPath;
use maille::{
    design::{Design, Parameter},
    error::InvalidInput,
    fit::FreeNumber,
};
use std::{fmt, str::FromStr};

/// Numbers that are named to be free.
#[derive(Clone, Debug, PartialEq)]
pub struct FreeSpec {
    /// Where they stand.
    pub path: NumberPath,
    /// Their bounds; `None`: those of the parameter in the file.
    pub bounds: Option<Bounds>,
}

/// Bounds of a free number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bounds {
    /// These, in the file's unit.
    Between(f64, f64),
    /// This share of its size below and above its value.
    Share(f64),
}

const FORM: &str =
    "write minor_radius=0.05:0.15 with the least and the largest value, or minor_radius=30% for so much less and more";

impl FromStr for FreeSpec {
    type Err = InvalidInput;

    fn from_str(text: &str) -> Result<Self, InvalidInput> {
        let (path, bounds) = match text.split_once('=') {
            None => (text, None),
            Some((path, bounds)) => {
                let read = self::bounds(bounds.trim());
                let wrong = || InvalidInput::new("free", format!("\"{bounds}\" are no bounds"), FORM);
                (path, Some(read.ok_or_else(wrong)?))
            }
        };
        let path = path.trim().parse::<NumberPath>().map_err(|e| InvalidInput { field: "free".into(), ..e })?;
        Ok(FreeSpec { path, bounds })
    }
}

fn bounds(text: &str) -> Option<Bounds> {
    let number = |text: &str| text.trim().parse::<f64>().ok().filter(|x| x.is_finite());
    if let Some(percent) = text.strip_suffix('%') {
        return number(percent.trim_start_matches('±')).filter(|x| *x > 0.0).map(|x| Bounds::Share(x / 100.0));
    }
    let (min, max) = text.split_once(':')?;
    Some(Bounds::Between(number(min)?, number(max)?)).filter(|b| matches!(b, Bounds::Between(min, max) if min < max))
}

impl fmt::Display for FreeSpec {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.bounds {
            None => write!(f, "{}", self.path),
            Some(Bounds::Between(min, max)) => write!(f, "{}={min}:{max}", self.path),
            Some(Bounds::Share(share)) => write!(f, "{}={}%", self.path, share * 100.0),
        }
    }
}

impl FreeSpec {
    /// The free number of a design that it names, whose places must have one value.
    fn number(&self, design: &Design) -> Result<FreeNumber, InvalidInput> {
        let wrong = |problem: String, help: String| Err(InvalidInput::new("free", problem, help));
        let values = self.path.values(design);
        let Some(&value) = values.first() else {
            let names: Vec<_> = design.elements.iter().map(|e| e.name.as_str()).take(12).collect();
            let problem = format!("{} has no number {}", design.name, self.path);
            return wrong(problem, format!("its elements are {}", names.join(", ")));
        };
        if let Some(other) = values.iter().find(|other| **other != value) {
            let problem = format!("{} is the place of different numbers, {value} and {other}", self.path);
            return wrong(problem, "let `free-each` move each of them by itself, or name fewer".into());
        }
        let (min, max) = match self.bounds {
            Some(Bounds::Between(min, max)) => (min, max),
            Some(Bounds::Share(share)) if value != 0.0 => (value - share * value.abs(), value + share * value.abs()),
            Some(Bounds::Share(_)) => {
                let problem = format!("{} is 0: a share of it is no range", self.path);
                return wrong(problem, format!("give its least and largest value, as {}=-0.1:0.1", self.path));
            }
            None => {
                let of_file = self.path.parameter().and_then(|name| design.parameters.iter().find(|p| p.name == name));
                match of_file {
                    Some(Parameter { min: Some(min), max: Some(max), .. }) => (*min, *max),
                    _ => return wrong(format!("{} has no bounds", self.path), FORM.into()),
                }
            }
        };
        if value < min || value > max {
            let problem = format!("{} is {value}, which is not between {min} and {max}", self.path);
            return wrong(problem, "begin between the bounds".into());
        }
        Ok(FreeNumber { name: self.path.to_string(), value, min, max, kind: self.path.kind() })
    }
}

/// The free numbers of a design: `together` one for all places of a pattern, `each` one for each place; if neither names any, all parameters of
/// its file that have both bounds.
///
/// # Errors
/// For a number that the design has not, that is named twice, or that lies beside its bounds, and where there is none.
pub fn free_numbers(
    design: &Design,
    together: &[FreeSpec],
    each: &[FreeSpec],
) -> Result<Vec<FreeNumber>, InvalidInput> {
    let mut specs: Vec<FreeSpec> = together.to_vec();
    for spec in each {
        let one = |path| FreeSpec { path, bounds: spec.bounds };
        let before = specs.len();
        specs.extend(spec.path.each(design).into_iter().map(one));
        if specs.len() == before {
            spec.number(design)?;
        }
    }
    if specs.is_empty() {
        let bounded = design.free_parameters().filter(|p| p.min.is_some() && p.max.is_some());
        let paths = bounded.filter_map(|p| p.name.parse().ok());
        specs.extend(paths.map(|path| FreeSpec { path, bounds: None }));
    }
    if specs.is_empty() {
        let problem = format!("{} has no parameters with bounds, and no number is named that may move", design.name);
        return Err(InvalidInput::new("free", problem, FORM));
    }
    let mut out: Vec<FreeNumber> = Vec::new();
    for spec in &specs {
        let number = spec.number(design)?;
        if number.name == "reference_radius" {
            let help = "name the radii of rings: the reference radius is only the unit of tolerances";
            return Err(InvalidInput::new("free", "reference_radius changes no limit", help));
        }
        if out.iter().any(|known| known.name == number.name) {
            return Err(InvalidInput::new("free", format!("{} is named twice", number.name), "name it once"));
        }
        out.push(number);
    }
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;
    use maille::fit::NumberKind;

    fn design() -> Design {
        crate::read_design("1.1", crate::builtin("1.1").unwrap()).unwrap()
    }

    fn specs(texts: &[&str]) -> Vec<FreeSpec> {
        texts.iter().map(|text| text.parse().unwrap()).collect()
    }

    #[test]
    fn numbers_and_their_bounds() {
        let found = free_numbers(
            &design(),
            &specs(&["minor_radius=0.05:0.2"]),
            &specs(&["elements.*.rings.major_radius=±20%"]),
        );
        let found = found.unwrap();
        assert_eq!(found.len(), 4);
        assert_eq!((found[0].value, found[0].min, found[0].max), (0.1, 0.05, 0.2));
        assert_eq!(found[0].kind, NumberKind::MinorRadius);
        assert_eq!(found[2].name, "elements.standing-0.rings.0.major_radius");
        assert!((found[2].max - 1.2).abs() < 1e-12 && found[2].kind == NumberKind::MajorRadius);
    }

    #[test]
    fn what_cannot_be_free_is_refused() {
        let refused = |together: &[&str], each: &[&str]| {
            let error = free_numbers(&design(), &specs(together), &specs(each)).unwrap_err();
            format!("{}; {}", error.problem, error.help)
        };
        assert!(refused(&[], &[]).contains("no parameters with bounds"));
        assert!(refused(&["minor_radius"], &[]).contains("has no bounds"));
        assert!(refused(&["elements.round.rings.major_radius=10%"], &[]).contains("flat"));
        assert!(refused(&[], &["elements.round.rings.major_radius=10%"]).contains("flat"));
        assert!(refused(&["minor_radius=10%", "minor_radius=20%"], &[]).contains("named twice"));
        assert!(refused(&["minor_radius=0.2:0.3"], &[]).contains("not between"));
        assert!(refused(&["elements.flat.center.x=10%"], &[]).contains("is 0"));
        assert!(refused(&["reference_radius=10%"], &[]).contains("changes no limit"));
        for wrong in ["minor_radius=", "minor_radius=3", "minor_radius=2:1", "minor_radius=-5%", "lattice.a1=1:2"] {
            assert!(wrong.parse::<FreeSpec>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn parameters_of_the_file_are_free_within_their_bounds() {
        let text = include_str!("../../../../examples/parameters/square.toml");
        let design = crate::read_design("square", text).unwrap();
        let bounded = design.free_parameters().filter(|p| p.min.is_some() && p.max.is_some()).count();
        assert!(bounded > 0);
        assert_eq!(free_numbers(&design, &[], &[]).unwrap().len(), bounded);
    }
}
