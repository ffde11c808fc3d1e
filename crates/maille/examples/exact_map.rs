//! The validation map of the exact method: the starts of chapter 6 of every thesis design × 25 directions × five l2 at both radii, 3,250
//! limits.
//!
//!     cargo run --release -p maille --example exact_map -- [--designs 1.1,2] [--radii 0.1,0.05] [--cells "1x1 2x1 1x2 2x2 3x3"] [--effort normal] [--verbose] [OUT.csv]
//!
//! Prints counts by design and status, and writes them to OUT.csv.

use maille::{
    lattice::Cell,
    model::Model,
    record::Status,
    search::ExactOptions,
    survey::{CellChoice, Finished, MapQuestion, Method, characterize},
};
use maille_io::{chapter6, read_design};
use std::{
    collections::BTreeMap,
    fmt::Write as _,
    sync::{Mutex, atomic::AtomicBool},
    time::Instant,
};

const DESIGNS: &str = "1.1,1.2,1.3,2,3.1,3.2,3.3,3.4,4.1,4.2,4.3,5.1,5.2";
const L2: [f64; 5] = [-0.25, -0.125, 0.0, 0.125, 0.25];

fn main() {
    let mut options: BTreeMap<String, String> = BTreeMap::new();
    let mut arguments = std::env::args().skip(1);
    let (mut out, mut verbose) = (None, false);
    while let Some(argument) = arguments.next() {
        match argument.strip_prefix("--") {
            Some("verbose") => verbose = true,
            Some(name) => drop(options.insert(name.into(), arguments.next().expect("a value"))),
            None => out = Some(argument),
        }
    }
    let option = |name: &str, default: &str| options.get(name).cloned().unwrap_or_else(|| default.into());
    let cells: Vec<Cell> = option("cells", "1x1").split(' ').map(|c| c.parse().expect("a cell")).collect();
    let every: f64 = option("every", "7.5").parse().expect("an angle");
    let directions: Vec<f64> = (0..).map(|k| every * f64::from(k)).take_while(|d| *d <= 180.0).collect();
    let mut table = String::from("design,minor_radius,status,rows,bound_attained\n");
    let mut totals: BTreeMap<&str, usize> = BTreeMap::new();
    let begun = Instant::now();
    for name in option("designs", DESIGNS).split(',') {
        for radius in option("radii", "0.1,0.05").split(',') {
            let radius: f64 = radius.parse().expect("a radius");
            let start = chapter6(name).expect("a design of the thesis");
            let design = read_design(start.name, start.toml).expect("valid").with_minor_radius(radius);
            let models: Vec<Model> = cells.iter().map(|c| Model::compile(&design, *c).expect("compiles")).collect();
            let rows = Mutex::new(Vec::<Finished>::new());
            let effort = option("effort", "normal").parse().expect("an effort");
            let method = Method::Exact(ExactOptions { effort, ..ExactOptions::default() });
            let map = MapQuestion::new(method, CellChoice::Auto, Some(directions.clone()), Some(L2.to_vec()), None);
            let question = map.expect("a map that can be asked");
            let started = Instant::now();
            characterize(&models, Some(radius), &question, &|_| true, &AtomicBool::new(false), &|_, _| (), &|row| {
                rows.lock().expect("no panic").push(row);
            });
            let took = started.elapsed().as_secs_f64();
            let rows = rows.into_inner().expect("no panic");
            let mut line = format!("{name:>4} r = {radius:<5}");
            for status in Status::ALL {
                let of: Vec<&Finished> = rows.iter().filter(|f| f.row.status == status).collect();
                if of.is_empty() {
                    continue;
                }
                let attained = of.iter().filter(|f| f.row.bound_gap.is_some_and(|g| g.abs() <= 1e-9)).count();
                writeln!(table, "{name},{radius},{},{},{attained}", status.name(), of.len()).expect("a string");
                write!(line, "  {} {}", status.name(), of.len()).expect("a string");
                *totals.entry(status.name()).or_default() += of.len();
            }
            let qps: u64 = rows.iter().map(|f| f.row.iterations).sum();
            let runs: u64 = rows.iter().map(|f| f.row.runs).sum();
            println!("{line}  ({took:.1} s, {qps} programs, {runs} starts)");
            for f in rows
                .iter()
                .filter(|f| verbose && !matches!(f.row.status, Status::Global | Status::Local | Status::L2Unreachable))
            {
                let r = &f.row;
                println!(
                    "      {}° l2 {} {} l1 {:?} bound {:?} gap {:?} dual {:?} mult {:?} curvature {:?} links {:?} programs {}",
                    r.direction_deg,
                    r.l2,
                    r.status.name(),
                    r.l1_uncertified,
                    r.bound_l1,
                    r.min_gap,
                    r.dual_residual,
                    r.min_multiplier,
                    r.min_curvature,
                    r.links_ok,
                    r.iterations
                );
            }
        }
    }
    println!("all: {totals:?} in {:.0} s", begun.elapsed().as_secs_f64());
    if let Some(out) = out {
        std::fs::write(&out, table).expect("writable");
    }
}
