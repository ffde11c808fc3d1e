//! `maille fit --over`: which designs, and their ranking.

use crate::{
    exit::{self, wrong},
    output::say,
};
use maille::fit::{Ended, Norm};
use maille_io::{builtin, fit::FitRecord};
use miette::{IntoDiagnostic, Result, WrapErr};
use std::path::Path;

/// The names: folders stand for the design files in them.
pub fn designs(named: &[String]) -> Result<Vec<String>> {
    let mut out: Vec<String> = Vec::new();
    for name in named {
        let folder = Path::new(name);
        if builtin(name).is_some() || !folder.is_dir() {
            out.push(name.clone());
            continue;
        }
        let entries = std::fs::read_dir(folder).into_diagnostic().wrap_err_with(|| format!("cannot read {name}"))?;
        let files = entries.flatten().map(|entry| entry.path());
        let mut files: Vec<String> = files
            .filter(|path| path.extension().is_some_and(|ending| ending == "toml"))
            .map(|path| path.display().to_string())
            .collect();
        if files.is_empty() {
            return Err(wrong(exit::USAGE, format!("there is no design file in {name}"), "name another folder"));
        }
        files.sort();
        out.extend(files);
    }
    out.dedup();
    Ok(out)
}

/// How far a design is from its targets: the root mean square of weight × miss, or the largest of them.
fn cost(record: &FitRecord) -> f64 {
    let (targets, found) = (&record.request.targets, &record.outcome.targets);
    let misses = targets.iter().zip(found).map(|(target, found)| target.weight * found.miss.abs());
    match record.request.options.norm {
        Norm::Minimax => misses.fold(0.0, f64::max),
        Norm::LeastSquares => (misses.map(|miss| miss * miss).sum::<f64>() / targets.len() as f64).sqrt(),
    }
}

/// The nearest first; those that are not finished last.
pub fn rank(fits: &mut [(String, FitRecord)]) {
    let key = |record: &FitRecord| if record.outcome.targets.is_empty() { f64::INFINITY } else { cost(record) };
    fits.sort_by(|a, b| key(&a.1).total_cmp(&key(&b.1)));
}

/// The ranking as a table.
pub fn csv(fits: &[(String, FitRecord)]) -> String {
    let mut out = String::from("rank,design,ended,cost,worst_miss,designs\n");
    for (k, (name, record)) in fits.iter().enumerate() {
        let worst = record.outcome.targets.iter().map(|target| target.miss.abs()).fold(0.0, f64::max);
        let (ended, name) = (ended(record), format!("\"{}\"", name.replace('"', "\"\"")));
        out += &format!("{},{name},{ended},{:?},{worst:?},{}\n", k + 1, cost(record), record.outcome.designs);
    }
    out
}

/// Prints the ranking.
pub fn print(fits: &[(String, FitRecord)], out: &Path) {
    let norm = match fits.first().map(|(_, record)| record.request.options.norm) {
        Some(Norm::Minimax) => "largest miss",
        _ => "rms miss",
    };
    say!("  {:>4}  {:<32} {norm:>14} {:>12}", "rank", "design", "");
    for (k, (name, record)) in fits.iter().enumerate() {
        say!("  {:>4}  {name:<32} {:>14.3e} {:>12}", k + 1, cost(record), ended(record));
    }
    say!("  each in {}/NAME; {}", out.display(), out.join("ranking.csv").display());
}

fn ended(record: &FitRecord) -> &'static str {
    match record.outcome.ended {
        Ended::Reached => "reached",
        Ended::Missed => "missed",
        Ended::Interrupted => "interrupted",
    }
}
