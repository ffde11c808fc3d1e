//! Designs with free numbers.

use crate::sensitivity::DesignVector;
use maille_design::{Design, InvalidInput};
use serde::{Deserialize, Serialize};

/// A number of a design that may change.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FreeNumber {
    /// What it is called.
    pub name: String,
    /// Its value at first.
    pub value: f64,
    /// Least value.
    pub min: f64,
    /// Largest value.
    pub max: f64,
    /// What it is, where that is known.
    pub kind: NumberKind,
}

/// What a free number is. Where all are radii, bounds of all designs of the family are known.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum NumberKind {
    /// Major radii of rings: the larger, the further links reach.
    MajorRadius,
    /// Minor radii of rings: the smaller, the further links reach.
    MinorRadius,
    /// Anything else.
    Other,
}

/// The design with other values of its free numbers.
pub type Make<'a> = dyn Fn(&[f64]) -> Result<Design, Vec<InvalidInput>> + Sync + 'a;

/// Designs that differ in some numbers.
pub struct Family<'a> {
    /// The numbers, in the order of [`Self::make`].
    pub numbers: Vec<FreeNumber>,
    /// The design with these values.
    pub make: &'a Make<'a>,
}

impl Family<'_> {
    /// Whether it can be searched.
    ///
    /// # Errors
    /// Without numbers, and for bounds that are not finite, in the wrong order or beside the value.
    pub(super) fn check(&self) -> Result<(), InvalidInput> {
        if self.numbers.is_empty() {
            return Err(InvalidInput::new("free", "no number of the design is free", "name one or more"));
        }
        for FreeNumber { name, value, min, max, .. } in &self.numbers {
            let wrong = |problem: String, help: &str| Err(InvalidInput::new(name, problem, help));
            if ![value, min, max].iter().all(|x| x.is_finite()) {
                return wrong(format!("{value} between {min} and {max}"), "give finite numbers");
            }
            if min >= max {
                return wrong(format!("its least value {min} is not below its largest, {max}"), "give a smaller one");
            }
            if value < min || value > max {
                return wrong(format!("{value} is not between {min} and {max}"), "begin between the bounds");
            }
        }
        Ok(())
    }

    /// How the design changes with each number, per share of the number's range.
    ///
    /// # Errors
    /// What is wrong with the designs on both sides of a number.
    pub(super) fn rates(&self, values: &[f64]) -> Result<Vec<DesignVector>, InvalidInput> {
        let rate = |(k, number): (usize, &FreeNumber)| {
            let beside = |value: f64| {
                let mut moved = values.to_vec();
                moved[k] = value;
                (self.make)(&moved).ok().filter(|_| (number.min..=number.max).contains(&value))
            };
            let rate = DesignVector::by_number(values[k], &beside).ok_or_else(|| {
                let problem = format!("no design with a value beside {}", values[k]);
                InvalidInput::new(&number.name, problem, "give it wider bounds, or another value")
            })?;
            Ok(rate.times(number.max - number.min))
        };
        self.numbers.iter().enumerate().map(rate).collect()
    }

    /// Whether all free numbers are radii.
    pub(super) fn of_radii(&self) -> bool {
        self.numbers.iter().all(|number| number.kind != NumberKind::Other)
    }

    /// The design whose links reach furthest, where all free numbers are radii.
    pub(super) fn loosest(&self) -> Option<Design> {
        let end = |number: &FreeNumber| match number.kind {
            NumberKind::MajorRadius => Some(number.max),
            NumberKind::MinorRadius => Some(number.min),
            NumberKind::Other => None,
        };
        let ends = self.numbers.iter().map(end).collect::<Option<Vec<f64>>>()?;
        (self.make)(&ends).ok().map(|design| Design { allow_initial_overlap: true, ..design })
    }
}
