//! How far finite sheets of a design stretch along x with the left edge held, against the periodic cell.
//!
//!     cargo run --release -p maille --example finite_sheets -- [OUT.csv]

use maille::{
    answer::Answer,
    lattice::{Cell, Direction},
    model::Model,
    record::Status,
    relaxation::{
        limit::{EnergyMethod, EnergyOptions},
        simulate::{Setup, TAU, elements_at, simulate},
    },
};
use maille_geometry::Vec3;
use std::{fmt::Write as _, sync::atomic::AtomicBool, time::Instant};

fn main() {
    let cancel = AtomicBool::new(false);
    let mut table = String::from("design,sheet,elements,end,l1,smallest_gap,links_ok,iterations\n");
    for (name, most, sizes) in [("1.1", 0.5, &[2, 4, 6, 8][..]), ("2-oblong", 1.0, &[2, 4, 6])] {
        let text = maille_io::builtin(name).expect("a built-in design");
        let design = maille_io::read_design(name, text).expect("built-in designs are valid").with_minor_radius(0.1);
        for &n in sizes {
            let begun = Instant::now();
            let tile = Cell::new([[n, 0], [0, n]]).expect("a cell");
            let model = Model::compile_sheet(&design, tile).expect("it compiles");
            let at = |place: &str| elements_at(&model, place).expect("an edge");
            let (left, right) = (at("left"), at("right"));
            let length = model.start.poses[right[0]].position.x - model.start.poses[left[0]].position.x;
            let by = Vec3::new(most * length, 0.0, 0.0);
            let setup = Setup {
                fix: left,
                pull: right.into_iter().map(|e| (e, vec![by])).collect(),
                gravity: Vec3::zeros(),
                forces: Vec::new(),
                floor: None,
                bend: None,
                steps: 10,
                drag: None,
                options: EnergyOptions { tau: TAU, max_iterations: 2000, ..EnergyOptions::default() },
            };
            let end = simulate(&model, &setup, &cancel, &mut |_| {}).expect("the setup is right");
            let line = format!(
                "{name},{n}x{n},{},{:?},{:.4},{:.1e},{},{}",
                model.elements.len(),
                end.end,
                most * end.share,
                end.smallest_gap.unwrap_or(f64::NAN),
                end.links_ok,
                end.iterations
            );
            println!("{line}  ({:.1} s) {}", begun.elapsed().as_secs_f64(), end.note.unwrap_or_default());
            writeln!(table, "{line}").expect("a string");
        }
        let model = Model::compile(&design, Cell::PRIMITIVE).expect("it compiles");
        // The finite sheets' width is free: of the periodic limits the largest over l2 is the one to compare with.
        let method = EnergyMethod::new(&model, EnergyOptions::default(), &cancel);
        let limits = (-4..=8)
            .map(|k| (f64::from(k) * 0.025, method.limit(Direction::of_degrees(0.0), f64::from(k) * 0.025, &cancel)));
        let found: Vec<_> = limits.filter(|(_, limit)| limit.status == Status::ThresholdReached).collect();
        let of = |(l2, limit): &(f64, Answer)| (limit.gradient[(0, 0)] - 1.0, *l2, limit.iterations);
        let at_rest = found.iter().map(of).filter(|(_, l2, _)| *l2 == 0.0);
        let best = found.iter().map(of).max_by(|a, b| a.0.total_cmp(&b.0));
        for (l1, l2, iterations) in at_rest.chain(best) {
            let line =
                format!("{name},periodic l2={l2:.3},{},ThresholdReached,{l1:.4},,,{iterations}", model.elements.len());
            println!("{line}");
            writeln!(table, "{line}").expect("a string");
        }
    }
    if let Some(out) = std::env::args().nth(1) {
        std::fs::write(out, table).expect("the table can be written");
    }
}
