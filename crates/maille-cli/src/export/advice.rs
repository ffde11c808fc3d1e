//! What is said about a mesh: rings that would fuse, gaps, sizes.

use super::destination::FormatArg;
use crate::{
    exit::{self, wrong},
    output,
    source::Source,
};
use maille::{state::State, topology};
use maille_io::Tile;
use maille_mesh::{Format, Scene};
use miette::{Report, Result};

/// Refuses a clearance that linked rings cannot have: one runs through the other, so their cores are no farther apart than its radius.
/// All pairs of a large tile would be looked at.
pub fn possible(clearance: f64, mm: f64, source: &Source) -> Result<()> {
    let radius = source.model.largest_radius * source.model.unit * mm;
    if clearance <= radius {
        return Ok(());
    }
    let help = "linked rings cannot be that far apart; --scale writes a larger sheet";
    let problem =
        format!("--min-clearance {clearance:?} mm is more than the largest ring's radius, {} mm", short(radius));
    Err(wrong(exit::USAGE, problem, help))
}

/// What would fuse, and what would help.
pub fn fuse(close: &maille_mesh::TooClose, clearance: f64, mm: f64, source: &Source) -> Report {
    let design = &source.design;
    let [a, b] = &close.rings;
    let [x, y, z] = [close.place.x, close.place.y, close.place.z].map(|x| (x * 1e3).round() / 1e3 + 0.0);
    let how = match close.gap < 0.0 {
        true => format!("overlap by {:.3} mm", -close.gap),
        false => format!("are {} mm apart", short(close.gap)),
    };
    // Where the facets have taken more than a thousandth of what is asked for.
    let facets = match close.gap >= 0.0 && close.torus_gap - close.gap > 1e-3 * clearance {
        true => format!(" as meshes, {} mm as tori,", short(close.torus_gap)),
        false => String::new(),
    };
    let more = match close.pairs {
        1 => "no other pair of the cell is".to_owned(),
        n => format!("{n} pairs of the cell are"),
    };
    let thinner = match (close.minor_radius_factor, design.minor_radius) {
        (None, _) => "no minor radius gives that in this state".to_owned(),
        (Some(f), Some(r)) if common_wire(design) => {
            format!("minor_radius = {} would give that (now {r})", down(f * r))
        }
        (Some(f), _) => format!("{} times every minor_radius would give that", down(f)),
    };
    let larger = match close.scale_factor {
        Some(f) => format!("--scale {} would give that (now {mm})", up(f * mm)),
        None => "rings touch, so no --scale gives that".to_owned(),
    };
    let finer =
        close.segments.map_or(String::new(), |s| format!("\n--segments {}x{} would give that", s.around, s.across));
    let state = match (&source.locked, &source.extreme) {
        (Some(_), _) => "\nin a locked state rings touch: print the starting state",
        (None, None) => "\n--at roomiest is the state with the widest gaps",
        (None, Some(_)) => "",
    };
    let help = format!("{thinner}\n{larger}{finer}\n--warn writes the file anyway{state}");
    wrong(
        exit::USAGE,
        format!(
            "rings would fuse: {a} and {b} {how}{facets} at ({x}, {y}, {z}) mm, less than --min-clearance {clearance}; {more} too close"
        ),
        help,
    )
}

/// A distance with three decimals, and with four digits below a tenth.
fn short(x: f64) -> String {
    if x < 0.1 && x > 0.0 { format!("{}", format!("{x:.3e}").parse().unwrap_or(x)) } else { format!("{x:.3}") }
}

/// The smallest gap, in the design's unit and in the size that is written, and that between the meshes.
pub fn gaps(scene: &Scene, source: &Source, state: &State, tile: Tile) {
    let Source { design, model, .. } = source;
    if let Some((gap, _)) = topology::smallest_gap(model, state) {
        let gap = gap * model.unit;
        // Rings that touch are apart by a rounding, of either sign.
        let six = |x: f64| format!("{:.6}", (x * 1e6).round() / 1e6 + 0.0);
        let unit = design.unit.as_deref().unwrap_or("of the file's unit");
        match scene.mm == 1.0 && unit == "mm" {
            true => output::say!("smallest gap between rings: {} mm", six(gap)),
            false => output::say!("smallest gap between rings: {} {unit}, here {} mm", six(gap), six(gap * scene.mm)),
        }
    }
    let [m, n] = tile.0.map(|cells| cells as i32);
    let cells = (0..m).flat_map(|i| (0..n).map(move |j| [i, j]));
    let elements: Vec<_> = cells.flat_map(|cell| (0..model.elements.len()).map(move |e| (e, cell))).collect();
    if let Some(overlap) = source.overlap_of(state, &elements) {
        eprintln!("note: {overlap}");
    }
    match maille_mesh::smallest_clearance(scene, model, state, tile) {
        Some(0.0) => output::say!("clearance 0 mm: meshes of different elements touch or overlap"),
        Some(gap) => output::say!("clearance {} mm between the meshes of different elements", short(gap)),
        None => {}
    }
}

/// Bytes of an export above which it must be asked for.
const LARGE: u64 = 1_000_000_000;

/// Refuses files of more than [`LARGE`] in all.
pub fn large(scene: &Scene, formats: &[FormatArg], frames: usize) -> Result<()> {
    let bytes = |format: Format| format.files(scene).map(|f| f.estimated_bytes(scene)).sum::<u64>() * frames as u64;
    let total: u64 = formats.iter().map(|f| bytes(f.format())).sum();
    if total <= LARGE {
        return Ok(());
    }
    let once = match formats.iter().all(|f| f.instanced()) {
        true => String::new(),
        false => format!("3mf stores each ring once: about {}\n", size(bytes(Format::ThreeMf))),
    };
    let help = format!(
        "{once}a smaller --tile or --size, or a coarser --tolerance, takes less\n--allow-large writes it anyway"
    );
    Err(wrong(exit::USAGE, format!("this export would write about {}", size(total)), help))
}

/// Four digits, rounded so that the clearance stays.
fn down(x: f64) -> f64 {
    let unit = 10_f64.powf(x.log10().floor() - 3.0);
    let digits = (x / unit + 1e-9).floor() * unit;
    format!("{digits:.12}").parse().unwrap_or(digits)
}

fn up(x: f64) -> f64 {
    let unit = 10_f64.powf(x.log10().floor() - 3.0);
    let digits = (x / unit - 1e-9).ceil() * unit;
    format!("{digits:.12}").parse().unwrap_or(digits)
}

/// A number of bytes, for people.
pub fn size(bytes: u64) -> String {
    match bytes {
        0..1_000 => format!("{bytes} B"),
        1_000..1_000_000 => format!("{:.0} kB", bytes as f64 / 1e3),
        1_000_000..1_000_000_000 => format!("{:.1} MB", bytes as f64 / 1e6),
        _ => format!("{:.2} GB", bytes as f64 / 1e9),
    }
}

/// Rings, triangles and size of what was written.
pub fn summary(scene: &Scene) {
    let [least, largest] = scene.bounds();
    let extent = largest - least;
    output::say!(
        "{}, {} triangles (meshes within {:.3} mm of the tori); {:.1} × {:.1} × {:.1} mm",
        output::counted(scene.ring_count(), "ring"),
        scene.triangle_count(),
        scene.chordal_error(),
        extent.x,
        extent.y,
        extent.z
    );
}

/// Whether no ring or curve has a minor radius of its own.
fn common_wire(design: &maille::design::Design) -> bool {
    let own = |e: &maille::design::ElementSpec| {
        e.rings.iter().any(|ring| ring.minor_radius.is_some()) || e.curves.iter().any(|c| c.minor_radius.is_some())
    };
    !design.elements.iter().any(own)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn advice_keeps_the_clearance() {
        for x in [0.083_333_3, 0.1, 1.0, 12.3456, 9999.5] {
            assert!(down(x) <= x * (1.0 + 1e-8) && down(x) > x * 0.998);
            assert!(up(x) >= x * (1.0 - 1e-8) && up(x) < x * 1.002);
        }
        assert_eq!(down(0.1), 0.1);
    }
}
