//! `cargo xtask atlas`: every built-in weave with many wires and spacings, as one table.

use crate::{
    program::{self, done},
    wheel::Environment,
};
use serde_json::Value;
use std::{
    fs,
    path::{Path, PathBuf},
    process::Command,
};

/// Where the table is written, and where a quick one.
pub const TABLE: &str = "site/atlas.parquet";
const QUICK_TABLE: &str = "maille-out/atlas-quick.parquet";
/// What each design is asked.
const QUESTION: &str = "directions = \"0:180:15\"\nl2 = [0]\nkeep_links = true\ncell = \"1x1\"\neffort = \"low\"\n";
/// Wires, as factors of the design's minor radius, and spacings, as factors of the distances between its elements:
/// first, last, and how many. The file's own are among them.
const WIRES: (f64, f64, usize) = (0.4, 1.3, 31);
const SPACINGS: (f64, f64, usize) = (0.86, 1.04, 19);
const QUICK_WIRES: (f64, f64, usize) = (0.8, 1.0, 2);
const QUICK_SPACINGS: (f64, f64, usize) = (0.95, 1.0, 2);
/// Columns of the table.
const COLUMNS: &str = "design,minor_radius,spacing,direction_deg,l2,status,l1,bound_l1,min_gap,max_overlap";
/// Exit code of the program where some limits were not found, or some designs cannot be.
const SOME_MISSING: &[i32] = &[5, 6];

/// Computes what is not there yet, and writes the table. A run that was stopped goes on.
pub fn write(root: &Path, quick: bool, program: Option<&str>) -> Result<(), String> {
    let program = match program {
        Some(program) => PathBuf::from(program),
        None => program::build(root, "release")?,
    };
    let run = |arguments: &[&str]| {
        let mut command = Command::new(&program);
        command.args(arguments).current_dir(root);
        command
    };
    let listed = program::designs(&program)?;
    let (name, table, wires, spacings) = match quick {
        true => ("atlas-quick", QUICK_TABLE, QUICK_WIRES, QUICK_SPACINGS),
        false => ("atlas", TABLE, WIRES, SPACINGS),
    };
    let study = study(&listed, &series(wires), &series(spacings)).ok_or("`maille designs --json` lacks a key")?;
    let file = root.join("maille-out").join(format!("{name}.toml"));
    fs::create_dir_all(root.join("maille-out")).map_err(|e| format!("maille-out cannot be made: {e}"))?;
    fs::write(&file, study).map_err(|e| format!("{} cannot be written: {e}", file.display()))?;
    let file = format!("maille-out/{name}.toml");
    let status = run(&["sweep", &file]).status().map_err(|e| format!("the program did not start: {e}"))?;
    if !status.success() && !status.code().is_some_and(|code| SOME_MISSING.contains(&code)) {
        return Err(format!("`maille sweep {file}` ended with {status}"));
    }
    let folder = format!("maille-out/{name}");
    let whole = format!("{folder}/whole.parquet");
    done(&mut run(&["table", &folder, "--columns", COLUMNS, "-o", &whole, "--overwrite"]), "write the table")?;
    let python = Environment::new(root, false)?;
    let mut command = python.python();
    command.arg("site/lighter.py").args([&*whole, table]).current_dir(root);
    python.run(&mut command, "write a lighter table")?;
    println!("   {table}");
    Ok(())
}

/// The values from first to last, both among them.
fn series((first, last, count): (f64, f64, usize)) -> Vec<f64> {
    // Rounded, so that the file's own value is exactly one of them.
    let value = |k: usize| first + (last - first) * k as f64 / (count - 1) as f64;
    (0..count).map(|k| (value(k) * 1e6).round() / 1e6).collect()
}

/// A study of all sheets of rings that are built in. Chains have one direction only; elements of curves take seconds a
/// limit.
fn study(designs: &[Value], wires: &[f64], spacings: &[f64]) -> Option<String> {
    let mut out = format!("# Made by `cargo xtask atlas`.\n{QUESTION}");
    for design in designs {
        if design["single"].as_bool()? || design["curves"].as_u64()? > 0 {
            continue;
        }
        let (name, radius) = (design["name"].as_str()?, design["minor_radius"].as_f64()?);
        let radii: Vec<f64> = wires.iter().map(|factor| (factor * radius * 1e9).round() / 1e9).collect();
        out += &format!("\n[[designs]]\ndesign = {name:?}\nminor_radius = {radii:?}\nspacing = {spacings:?}\n");
    }
    Some(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_study_has_all_sheets_of_rings_with_the_own_wire_and_spacing() {
        let designs = [
            serde_json::json!({ "name": "a", "single": false, "curves": 0, "minor_radius": 1.15 }),
            serde_json::json!({ "name": "b", "single": true, "curves": 0, "minor_radius": 1.0 }),
            serde_json::json!({ "name": "c", "single": false, "curves": 2, "minor_radius": 1.0 }),
        ];
        let text = study(&designs, &[0.5, 1.0], &series(QUICK_SPACINGS)).unwrap();
        let expected = "\n[[designs]]\ndesign = \"a\"\nminor_radius = [0.575, 1.15]\nspacing = [0.95, 1.0]\n";
        assert_eq!(text.split_once(QUESTION).unwrap().1, expected);
        assert!(series(WIRES).contains(&1.0) && series(SPACINGS).contains(&1.0));
        assert!(study(&[serde_json::json!({})], &[], &[]).is_none());
    }
}
