//! `--at direction=30,l2=-0.125`: a row of a record; `--at roomiest`: a state that is found now.

use maille::search::extreme::Extreme;
use std::fmt;

/// Which row of a record is meant.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct At {
    /// Direction of the pull, degrees.
    pub direction: Option<f64>,
    /// l2 of the row.
    pub l2: Option<f64>,
    /// Frame of a simulation, from 0.
    pub frame: Option<usize>,
}

/// What is to be shown: a row of a record or a frame, or an extreme of the design.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Place {
    At(At),
    Extreme(Extreme),
}

/// Reads `roomiest`, `tightest`, or a place in a record.
pub fn parse_place(text: &str) -> Result<Place, String> {
    match text.trim() {
        "roomiest" => Ok(Place::Extreme(Extreme::LargestClearance)),
        "tightest" => Ok(Place::Extreme(Extreme::ThickestWire)),
        _ => parse_at(text).map(Place::At),
    }
}

/// Reads `direction=30,l2=-0.125`; what is not named stays open.
pub fn parse_at(text: &str) -> Result<At, String> {
    let mut at = At::default();
    for part in text.split(',') {
        let wrong = || format!("\"{part}\" is not a place; give direction=30,l2=-0.125");
        let (key, value) = part.split_once('=').ok_or_else(wrong)?;
        if key.trim() == "frame" {
            let frame = value.trim().parse().map_err(|_| format!("\"{part}\" is not a frame; give frame=12"))?;
            if at.frame.replace(frame).is_some() {
                return Err("frame is given twice".into());
            }
            continue;
        }
        let value: f64 = value.trim().parse().ok().filter(|x: &f64| x.is_finite()).ok_or_else(wrong)?;
        let slot = match key.trim() {
            "direction" => &mut at.direction,
            "l2" => &mut at.l2,
            _ => return Err(wrong()),
        };
        if slot.replace(value).is_some() {
            return Err(format!("{} is given twice", key.trim()));
        }
    }
    Ok(at)
}

impl At {
    /// Whether a row of this direction and l2 is meant.
    pub fn fits(&self, direction_deg: f64, l2: f64) -> bool {
        let same = |wanted: Option<f64>, x: f64| wanted.is_none_or(|w| (w - x).abs() < 1e-9);
        same(self.direction, direction_deg) && same(self.l2, l2)
    }
}

impl fmt::Display for At {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.direction, self.l2) {
            (Some(d), Some(l2)) => write!(f, "direction={d},l2={l2}"),
            (Some(d), None) => write!(f, "direction={d}"),
            (None, Some(l2)) => write!(f, "l2={l2}"),
            (None, None) => write!(f, "any place"),
        }
    }
}
