//! Which maps chapter 6 needs.

use crate::map::{MINIMA, SCALED, STEPS};
use maille::{
    design::{Design, Source},
    error::InvalidInput,
    lattice::Cell,
    relaxation::{limit::EnergyOptions, target::Protocol},
    search::ExactOptions,
    survey::{CellChoice, MapQuestion, Method},
};
use maille_io::{Quantity, run::Map};
use std::path::Path;

/// Designs of the thesis, in its order.
pub const DESIGNS: [&str; 13] =
    ["1.1", "1.2", "1.3", "2", "3.1", "3.2", "3.3", "3.4", "4.1", "4.2", "4.3", "5.1", "5.2"];
/// Divisors of R: the minor radii of the thesis.
const DIVISORS: [u32; 2] = [10, 20];
/// The rectangular cell of a triangular lattice.
const RECTANGULAR: [[i32; 2]; 2] = [[1, 0], [-1, 2]];
/// Two cells of 3.x and the thesis's corner distances, with a threshold as large as a plot can show.
pub(crate) const CORNERS: [&str; 3] = ["3.1", "3.2", "3.3"];
const CORNERS_TAU: f64 = 0.1;
/// Between markers of the energy method on exact curves, and where directions are few.
const MARKERS_DEG: f64 = 15.0;
/// Statement 5: 1.1 in another size. No power of two, so that rounding differs.
const SCALE: (&str, f64) = ("1.1", 7.3);

/// The l2 that chapter 6 shows of 1.1 and 1.2; of the other designs all but the first.
const L2: [f64; 6] = [-0.375, -0.25, -0.125, 0.0, 0.125, 0.25];
/// l2 of the energy method where only its cost is asked.
const COST_L2: [f64; 3] = [-0.25, 0.0, 0.25];
/// Designs whose cost is shown (Figure 6.1). Of one pull of each every step is kept, with --quick of the first two.
pub(crate) const COSTS: [&str; 4] = ["1.1", "3.1", "2", "5.2"];
const STEPPED_DEG: f64 = 30.0;
const STEPPED_L2: [f64; 2] = [-0.25, 0.25];

/// Designs whose minima statement 8 speaks of.
pub const NOTCHED: [&str; 2] = ["1.2", "4.3"];
/// Those directions: the minima, and this far beside them.
pub const MINIMA_DEG: [f64; 6] = [0.0, 0.5, 89.5, 90.0, 90.5, 179.5];

/// A design of the chapter.
pub struct Chosen {
    /// Its name in the thesis, which its records have.
    pub name: &'static str,
    /// The design.
    pub design: Design,
    /// The file that it was given by, where it is not built in.
    pub given: Option<String>,
}

/// A map with its design.
pub struct Planned {
    /// Name of its record.
    pub name: String,
    /// The design, with the radius of the map.
    pub design: Design,
    /// The map.
    pub map: Map,
}

/// The l2 that chapter 6 shows of a design.
pub(crate) fn shown_l2(design: &str) -> &'static [f64] {
    if ["1.1", "1.2"].contains(&design) { &L2 } else { &L2[1..] }
}

/// Every map of the chapter; their records go into folders below `records`. `quick` leaves out most of the energy
/// method and every second direction.
pub fn plan(chosen: &[Chosen], quick: bool, records: &Path) -> Result<Vec<Planned>, InvalidInput> {
    let rectangular = Cell::new(RECTANGULAR)?;
    Ok(chosen.iter().flat_map(|chosen| maps_of(chosen, quick, rectangular, records)).collect())
}

/// The maps of one design.
fn maps_of(Chosen { name, design, .. }: &Chosen, quick: bool, rectangular: Cell, records: &Path) -> Vec<Planned> {
    let mut maps = Vec::new();
    let mut add = |design: &Design, divisor: u32, words: &str, method, cell, directions_deg: Vec<f64>, l2: &[f64]| {
        let name = format!("{}-R{divisor}-{words}", design.name);
        let map = Map {
            question: MapQuestion {
                method,
                cells: CellChoice::from(cell),
                directions_deg,
                l2: l2.to_vec(),
                extremes: false,
            },
            quantity: Quantity::Lambda1,
            out: Some(records.join(&name)),
            sensitivities: false,
            overwrite: false,
        };
        let minor_radius = design.reference_radius / f64::from(divisor);
        maps.push(Planned { name, design: design.with_minor_radius(minor_radius), map });
    };
    let name = *name;
    let turn = |step: f64| -> Vec<f64> { (0..(180.0 / step) as u32).map(|k| step * f64::from(k)).collect() };
    let all = turn(if quick { 15.0 } else { 7.5 });
    let exact = || Method::Exact(ExactOptions::default());
    let energy = Method::Energy;
    let usual = EnergyOptions::default;
    let (own, l2) = (Cell::PRIMITIVE, shown_l2(name));
    let by_text = design.source == Source::ThesisText;
    let sheared = name.starts_with("3.");
    for divisor in DIVISORS {
        add(design, divisor, "exact", exact(), own, all.clone(), l2);
        if sheared && !(quick && name == "3.4") {
            add(design, divisor, "exact-rectangular", exact(), rectangular, all.clone(), l2);
        }
        if NOTCHED.contains(&name) {
            add(design, divisor, &format!("exact{MINIMA}"), exact(), own, MINIMA_DEG.to_vec(), l2);
        }
        if by_text && !quick {
            add(design, divisor, "energy", energy(usual()), own, turn(MARKERS_DEG), l2);
            if sheared {
                let (words, directions) = ("energy-rectangular", turn(MARKERS_DEG));
                add(design, divisor, words, energy(usual()), rectangular, directions, &[-0.25, 0.0]);
            }
        }
    }
    if COSTS[..if quick { 2 } else { 4 }].contains(&name) {
        let method = energy(EnergyOptions { steps: true, ..usual() });
        add(design, 10, &format!("energy{STEPS}"), method, own, vec![STEPPED_DEG], &STEPPED_L2);
    }
    // The energy method's cost alone.
    if if quick { ["1.1", "3.1"].contains(&name) } else { !by_text } {
        add(design, 10, "energy", energy(usual()), own, turn(30.0), &COST_L2);
    }
    if CORNERS.contains(&name) && !(quick && name != "3.1") {
        // The peaks and 10° beside them tell whether one is wider.
        let peaks = [30.0, 90.0, 150.0].map(|peak| [peak - 10.0, peak, peak + 10.0]).concat();
        let (directions, l2) = if quick { (peaks, &[0.0][..]) } else { (turn(MARKERS_DEG), l2) };
        for (words, cell) in [("corners", own), ("corners-rectangular", rectangular)] {
            let options = EnergyOptions { protocol: Protocol::Corners, tau: CORNERS_TAU, ..usual() };
            add(design, 10, words, energy(options), cell, directions.clone(), l2);
        }
    }
    if name == SCALE.0 {
        let scaled = Design { name: design.name.clone() + SCALED, ..design.scaled(SCALE.1) };
        add(&scaled, 10, "exact", exact(), own, turn(15.0), &[-0.25, 0.0]);
    }
    maps
}
