//! `--at direction=30,l2=-0.125`: a row of a record; `--at roomiest`: a state that is found now.

use maille::search::extreme::Extreme;
use maille_io::roll::{Axis, RollKey, Sought};
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
    /// Where the axis of a roll is.
    pub axis: Option<Axis>,
    /// Cells of a tube that go round.
    pub wrap: Option<u32>,
    /// The curvature that was given.
    pub curvature: Option<f64>,
    /// What was sought of a tube or at a given curvature.
    pub sought: Option<Sought>,
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
        if key.trim() == "axis" {
            let axis = Axis::BOTH.into_iter().find(|axis| axis.name() == value.trim());
            let axis = axis.ok_or_else(|| format!("\"{part}\" is not an axis; give axis=below or axis=above"))?;
            if at.axis.replace(axis).is_some() {
                return Err("axis is given twice".into());
            }
            continue;
        }
        if key.trim() == "wrap" {
            let cells = value.trim().parse().map_err(|_| format!("\"{part}\" is not a tube; give wrap=12"))?;
            if at.wrap.replace(cells).is_some() {
                return Err("wrap is given twice".into());
            }
            continue;
        }
        if key.trim() == "sought" {
            let names = || Sought::AT_TURN.map(Sought::name).join(", ");
            let sought = Sought::named(value.trim());
            let sought = sought.ok_or_else(|| format!("\"{part}\" is not sought of rolls; give one of {}", names()))?;
            if at.sought.replace(sought).is_some() {
                return Err("sought is given twice".into());
            }
            continue;
        }
        let value: f64 = value.trim().parse().ok().filter(|x: &f64| x.is_finite()).ok_or_else(wrong)?;
        let slot = match key.trim() {
            "direction" => &mut at.direction,
            "l2" => &mut at.l2,
            "curvature" => &mut at.curvature,
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
        let of_rolls = self.axis.is_some() || self.wrap.is_some() || self.curvature.is_some() || self.sought.is_some();
        same(self.direction, direction_deg) && same(self.l2, l2) && !of_rolls
    }

    /// Whether this roll is meant. Of a given turn that is the one with the widest gaps where it is not said what was sought.
    pub fn fits_roll(&self, roll: &RollKey) -> bool {
        let usual = || if roll.sought == Sought::Tightest { Sought::Tightest } else { Sought::Roomiest };
        let sought = self.sought.unwrap_or_else(usual);
        same(self.direction, roll.direction_deg)
            && self.axis.is_none_or(|wanted| wanted == roll.axis)
            && self.wrap.is_none_or(|wanted| roll.wrap == Some(wanted))
            && self.curvature.is_none_or(|wanted| roll.at_curvature.is_some_and(|given| same(Some(wanted), given)))
            && sought == roll.sought
    }
}

fn same(wanted: Option<f64>, x: f64) -> bool {
    wanted.is_none_or(|w| (w - x).abs() < 1e-9)
}

impl fmt::Display for At {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let numbers = [("direction", self.direction), ("l2", self.l2), ("curvature", self.curvature)];
        let numbers = numbers.into_iter().filter_map(|(key, value)| Some(format!("{key}={}", value?)));
        let words = [
            self.axis.map(|axis| format!("axis={}", axis.name())),
            self.wrap.map(|cells| format!("wrap={cells}")),
            self.sought.map(|sought| format!("sought={}", sought.name())),
        ];
        let parts: Vec<String> = numbers.chain(words.into_iter().flatten()).collect();
        f.write_str(if parts.is_empty() { "any place".to_owned() } else { parts.join(",") }.as_str())
    }
}
