//! The folder of a fit: its files, its figure, and its summary.

use crate::{
    exit::{self, wrong},
    input::Input,
    map,
    output::{self, counted, say},
};
use maille::{
    Across,
    design::Design,
    fit::{Ended, FitOptions, Measure, Wanted},
    search::ExactOptions,
    survey::{MapQuestion, Method},
};
use maille_io::{
    Quantity,
    fit::{FIT, FitRecord, FitRequest, FittedTarget, open_fit, target_rows},
    numbers::distinct,
    plot::{Layout, PolarPlot, poisson_svg, polar_svg},
    record::{NamedRecord, Record},
    run::Map,
    write_design,
};
use maille_svg::svg_to_png;
use miette::{IntoDiagnostic, Result, WrapErr};
use std::{path::Path, time::Duration};

/// The record of an earlier run in the folder, where the same was asked.
pub fn earlier(folder: &Path, request: &FitRequest, overwrite: bool) -> Result<Option<FitRecord>> {
    if overwrite || !folder.join(FIT).is_file() {
        return Ok(None);
    }
    let found = open_fit(folder)?;
    if !request.continues(&found.request) {
        let problem = format!("{} holds a fit of other inputs", folder.display());
        let help = "name another folder with --out, or replace it with --overwrite";
        return Err(wrong(exit::RECORD, problem, help));
    }
    Ok(Some(found))
}

/// What is written beside fit.json.
pub struct Files<'a> {
    pub out: &'a Path,
    pub request: &'a FitRequest,
    pub record: &'a FitRecord,
    pub fitted: &'a Design,
}

/// The records of both designs in the folder.
const RECORDS: [&str; 2] = ["given", "fitted"];

impl Files<'_> {
    /// Writes the fitted design, the limits of both designs as records, and the figure; whether that was interrupted. Limits that are
    /// there are not found again.
    pub fn write(&self, threads: Option<u16>, quiet: bool) -> Result<bool> {
        output::write(&self.out.join("fitted.toml"), write_design(self.fitted).as_bytes())?;
        let Some(question) = self.question() else { return Ok(false) };
        let given = Design { allow_initial_overlap: true, ..self.request.design.clone() };
        let inputs = [Input::of(given), Input::of(self.fitted.clone())];
        let mut open = Vec::new();
        for (name, input) in RECORDS.into_iter().zip(&inputs) {
            let map = Map {
                question: question.clone(),
                quantity: Quantity::Stretch,
                out: Some(self.out.join(name)),
                overwrite: true,
                sensitivities: false,
            };
            open.push((name, map::open(&map, input)?));
        }
        let solved = map::solve(open, self.out, threads, quiet)?;
        if solved.interrupted {
            return Ok(true);
        }
        let records = RECORDS.into_iter().zip(solved.records);
        let named: Vec<NamedRecord> = records
            .map(|(name, record)| NamedRecord { name: name.to_owned(), record, sensitivities: Vec::new() })
            .collect();
        let svg = svg(self.record, &named, Layout::Beside);
        output::write(&self.out.join("fit.svg"), svg.as_bytes())?;
        let png = svg_to_png(&svg, 2.0).into_diagnostic().wrap_err("cannot draw the plot")?;
        output::write(&self.out.join("fit.png"), &png)?;
        Ok(false)
    }

    /// The limits of all directions and l2 of the targets, and every 15° between; with the width left to the sheet where only Poisson ratios are
    /// wanted; `None` where nothing along a direction is.
    fn question(&self) -> Option<MapQuestion> {
        let stretches = || {
            self.request.targets.iter().filter_map(|target| match target.measure {
                Measure::Stretch { direction_deg, l2 } => Some((direction_deg, l2)),
                Measure::PoissonRatio { .. } | Measure::Clearance => None,
            })
        };
        let ratios = || {
            self.request.targets.iter().filter_map(|target| match target.measure {
                Measure::PoissonRatio { direction_deg } => Some(direction_deg),
                Measure::Stretch { .. } | Measure::Clearance => None,
            })
        };
        let free = stretches().next().is_none() && ratios().next().is_some();
        let wanted = stretches().map(|(direction, _)| direction).chain(ratios());
        let between = (0..=180).step_by(15).filter(|_| !self.fitted.lattice.single).map(f64::from);
        let mut directions_deg = distinct(wanted.chain(between)).0;
        directions_deg.sort_by(f64::total_cmp);
        let l2 = if free { vec![0.0] } else { distinct(stretches().map(|(_, l2)| l2)).0 };
        let options: &FitOptions = &self.request.options;
        let (seed, effort, cells) = (options.seed, options.final_effort(), options.cells.clone());
        let across = Across { lateral_free: free, shear_free: false };
        let exact = ExactOptions { seed, effort, across, ..ExactOptions::default() };
        (!l2.is_empty()).then_some(MapQuestion {
            method: Method::Exact(exact),
            cells,
            directions_deg,
            l2,
            extremes: false,
        })
    }
}

/// The figure of a fit: both designs, the fitted one first, with the targets as markers; where only Poisson ratios are wanted, these.
pub fn svg(record: &FitRecord, named: &[NamedRecord], layout: Layout) -> String {
    let named = &named.iter().rev().cloned().collect::<Vec<_>>();
    let stretch = |target: &maille::fit::Target| matches!(target.measure, Measure::Stretch { .. });
    if let Some(svg) = poisson_svg(named, layout).filter(|_| !record.request.targets.iter().any(stretch)) {
        return svg;
    }
    let plot = PolarPlot::from_records(named, Quantity::Stretch).checked_by(&target_rows(record), "wanted");
    polar_svg(&plot, layout)
}

/// The name of the design and the figure of a fit's folder; `None` where it holds no fit.
pub fn svg_of(folder: &Path, layout: Layout) -> Result<Option<(String, String)>> {
    if !folder.join(FIT).is_file() {
        return Ok(None);
    }
    let record = open_fit(folder)?;
    let read = |name: &&str| {
        let path = folder.join(name);
        let record =
            Record::read(&path).wrap_err_with(|| format!("the fit in {} is not finished", folder.display()))?;
        Ok(NamedRecord { name: (*name).to_owned(), record, sensitivities: Vec::new() })
    };
    let named = RECORDS.iter().map(read).collect::<Result<Vec<_>>>()?;
    let svg = svg(&record, &named, layout);
    Ok(Some((record.request.design.name, svg)))
}

/// Prints the summary.
pub fn print(record: &FitRecord, out: &Path, time: Duration) {
    let FitRecord { request, outcome, .. } = record;
    let ended = match outcome.ended {
        Ended::Reached => "every target is reached",
        Ended::Missed => "some targets are not reached",
        Ended::Interrupted => "interrupted",
    };
    let (starts, designs) = (counted(outcome.starts, "start"), counted(outcome.designs, "design"));
    say!("{}: {ended}; {starts}, {designs}, {:.1} s", request.design.name, time.as_secs_f64());
    if request.shape {
        say!("  the shape is reached at {:.6} times the wanted limits", outcome.factor);
    }
    let width = request.free.iter().map(|free| free.name.len()).max().unwrap_or(0).max(20);
    say!("  {:<width$} {:>12} {:>12}", "number", "before", "after");
    for (free, value) in request.free.iter().zip(&outcome.numbers) {
        let end = match *value {
            x if x == free.min => "  its least",
            x if x == free.max => "  its largest",
            _ => "",
        };
        say!("  {:<width$} {:>12.6} {value:>12.6}{end}", free.name, free.value);
    }
    if !outcome.targets.is_empty() {
        say!("  {:<22} {:>18} {:>10} {:>10} {:>10}", "target", "wanted", "before", "after", "miss");
    }
    for (target, found) in request.targets.iter().zip(&outcome.targets) {
        print_target(request, outcome.factor, target, found);
    }
    print_missed(request, &outcome.targets);
    if outcome.ended != Ended::Interrupted {
        let files = ["fitted.toml", FIT, "fit.png"].map(|name| out.join(name).display().to_string());
        say!("  {}", files.join(", "));
        say!("  {} and {} hold the limits of both designs", out.join("given").display(), out.join("fitted").display());
    }
}

/// What is measured, in words.
fn name(measure: Measure) -> String {
    match measure {
        Measure::Stretch { direction_deg, l2: 0.0 } => format!("{direction_deg}\u{b0}"),
        Measure::Stretch { direction_deg, l2 } => format!("{direction_deg}\u{b0}, l2 = {l2}"),
        Measure::PoissonRatio { direction_deg } => format!("Poisson, {direction_deg}\u{b0}"),
        Measure::Clearance => "widest gap".into(),
    }
}

fn print_target(request: &FitRequest, factor: f64, target: &maille::fit::Target, found: &FittedTarget) {
    let name = name(target.measure);
    let (by, scale) = match target.measure {
        Measure::Stretch { .. } => (factor, 1.0),
        Measure::PoissonRatio { .. } => (1.0, 1.0),
        Measure::Clearance => (1.0, request.design.reference_radius),
    };
    let word = match target.wanted {
        Wanted::Value(_) => "",
        Wanted::AtLeast(_) => "at least ",
        Wanted::AtMost(_) => "at most ",
    };
    let wanted = format!("{word}{:.6}", target.wanted.value() * by * scale);
    let number = |x: Option<f64>| x.map_or("none".to_owned(), |x| format!("{:.6}", x * scale));
    let miss = if found.miss.abs() <= request.options.tolerance {
        "-".to_owned()
    } else {
        format!("{:+.2e}", found.miss * scale)
    };
    say!("  {name:<22} {wanted:>18} {:>10} {:>10} {miss:>10}", number(found.before), number(found.after));
}

/// What is said of targets that are not reached, the worst ones.
const TOLD: usize = 5;

/// Why targets are not reached: what is proved, and what holds the sheet.
fn print_missed(request: &FitRequest, targets: &[FittedTarget]) {
    let missed = |found: &FittedTarget| found.miss.abs() > request.options.tolerance;
    let mut all: Vec<_> = request.targets.iter().zip(targets).filter(|(_, found)| missed(found)).collect();
    all.sort_by(|a, b| b.1.miss.abs().total_cmp(&a.1.miss.abs()));
    for (target, found) in all.iter().take(TOLD) {
        let name = name(target.measure);
        let proof = match (found.forbidden, found.family_bound) {
            (true, Some(bound)) => format!("proved out of reach: no design between these bounds exceeds {bound:.6}"),
            _ => "not reached; that no design between these bounds does better is not proved".into(),
        };
        say!("  {name}: {proof}; held by {}", found.held_by.join(", "));
    }
    if all.len() > TOLD {
        say!("  and {} more", counted(all.len() - TOLD, "target"));
    }
}
