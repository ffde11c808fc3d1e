//! Numbers that a question may have.

use maille_design::InvalidInput;

/// Directions, in degrees, and strains are at most this in size: beyond, a float has too few digits left for a direction, or for a width
/// to be held.
pub(super) const MOST: f64 = 1e6;

pub(super) fn finite(field: &str, x: f64) -> Result<(), InvalidInput> {
    match x.is_finite() {
        true => Ok(()),
        false => Err(InvalidInput::new(field, format!("{x} is not a number"), "give a finite number")),
    }
}

pub(super) fn within(field: &str, what: &str, x: f64) -> Result<(), InvalidInput> {
    match x.abs() <= MOST {
        _ if !x.is_finite() => finite(field, x),
        true => Ok(()),
        false => Err(InvalidInput::new(field, format!("{what} = {x} is out of range"), format!("give up to {MOST}"))),
    }
}

/// Whether a width can be held at 1 + l2 times the written one.
pub(super) fn width(l2: f64) -> Result<(), InvalidInput> {
    within("l2", "l2", l2)?;
    match l2 > -1.0 {
        true => Ok(()),
        false => {
            let problem = format!("l2 = {l2} would press the sheet to nothing");
            Err(InvalidInput::new("l2", problem, "give values above -1 (0 holds the width)"))
        }
    }
}
