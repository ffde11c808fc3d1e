//! `cargo xtask gallery`: a picture, a plot and the numbers of every built-in design, as the program gives them.

use crate::program;
use serde_json::Value;
use std::{
    fs,
    path::{Path, PathBuf},
    process::{Command, Stdio},
    time::Instant,
};

/// Where the gallery is written, and where a quick one.
const FOLDER: &str = "docs/gallery";
const QUICK_FOLDER: &str = "maille-out/gallery";
/// Arguments of `maille characterize`; a quick one, to see whether all is well, has few directions. One cell only:
/// larger ones take minutes for each limit of the tighter weaves.
const PULLS: &str = "--directions 0:180:5 --l2=0 --cell 1x1";
const QUICK_PULLS: &str = "--directions 0:90:45 --l2=0 --cell 1x1 --starts 1";
const RENDER: &str = "--size 440x330 --palette";
const PLOT: &str = "--scale 0.75 --palette";
/// Exit code of the program where some limits were not found.
const SOME_MISSING: i32 = 5;

/// Writes the gallery anew with `program`, which is built if none is given; says for each design how long it took.
///
/// A quick one has few directions and is written aside.
pub fn write(root: &Path, quick: bool, program: Option<&str>) -> Result<(), String> {
    let program = match program {
        Some(program) => PathBuf::from(program),
        None => program::build(root, "release")?,
    };
    let (folder, pulls) = if quick { (QUICK_FOLDER, QUICK_PULLS) } else { (FOLDER, PULLS) };
    let scratch = root.join("maille-out/gallery-records");
    let house = House { program, folder: root.join(folder), scratch, pulls };
    fs::create_dir_all(&house.folder).map_err(|e| format!("{folder} cannot be made: {e}"))?;
    let mut pages = Vec::new();
    for design in program::designs(&house.program)? {
        let begun = Instant::now();
        let name = design["name"].as_str().ok_or("a design has no name")?;
        let limits = house.show(name, design["single"] == true)?;
        let inspected = house.json(&format!("inspect {name} --json"))?;
        pages.push(Page::of(&inspected, &limits).ok_or_else(|| format!("{name}: the program's JSON lacks a key"))?);
        println!("{name}  {:.1} s", begun.elapsed().as_secs_f64());
    }
    let text = document(&pages, pulls);
    let readme = house.folder.join("README.md");
    fs::write(&readme, text).map_err(|e| format!("{} cannot be written: {e}", readme.display()))?;
    println!("{folder}/README.md");
    Ok(())
}

struct House {
    program: PathBuf,
    folder: PathBuf,
    scratch: PathBuf,
    pulls: &'static str,
}

impl House {
    /// Solves, draws and plots one design; gives the summary of its limits.
    fn show(&self, name: &str, single: bool) -> Result<Value, String> {
        let record = self.scratch.join(name).to_string_lossy().into_owned();
        let file = |ending: &str| self.folder.join(format!("{name}{ending}")).to_string_lossy().into_owned();
        // A chain is pulled along itself alone.
        let pulls = if single { "--cell 1x1" } else { self.pulls };
        let solve = format!("characterize {name} {pulls} --overwrite --json");
        let limits = parsed(&self.run(&solve, &["--out", &record])?, &solve)?;
        self.run(&format!("render {name} {RENDER} --quiet --overwrite"), &["--out", &file(".png")])?;
        if !single {
            self.run(&format!("plot {PLOT} --overwrite"), &[&record, "--output", &file("-polar.png")])?;
        }
        Ok(limits)
    }

    fn json(&self, line: &str) -> Result<Value, String> {
        parsed(&self.run(line, &[])?, line)
    }

    /// Runs the program; `paths` are kept apart, for they may have blanks.
    fn run(&self, line: &str, paths: &[&str]) -> Result<Vec<u8>, String> {
        let mut command = Command::new(&self.program);
        command.args(line.split_whitespace()).args(paths).stdin(Stdio::null());
        let output = command.output().map_err(|e| format!("{} did not start: {e}", self.program.display()))?;
        let missing = line.starts_with("characterize") && output.status.code() == Some(SOME_MISSING);
        if output.status.success() || missing {
            return Ok(output.stdout);
        }
        Err(format!("`maille {line}`: {}\n{}", output.status, String::from_utf8_lossy(&output.stderr)))
    }
}

fn parsed(text: &[u8], line: &str) -> Result<Value, String> {
    serde_json::from_slice(text).map_err(|e| format!("`maille {line}` printed no JSON: {e}"))
}

/// A design's line of the table, and its section; none if a key is missing.
struct Page {
    line: String,
    section: String,
}

impl Page {
    fn of(inspected: &Value, limits: &Value) -> Option<Page> {
        let text = |key: &str| inspected[key].as_str();
        let (name, title, unit) =
            (text("design")?, text("title").unwrap_or_default(), text("unit").unwrap_or_default());
        let (rings, links) = (inspected["rings"].as_u64()?, inspected["links"].as_u64()?);
        let gap = inspected["smallest_gap"]["gap"].as_f64()?;
        let wire = inspected["wire"]["length"].as_f64()?;
        let radius = inspected["reference_radius"].as_f64()?;
        let of_l2 = limits["limits"].as_array()?;
        let held = of_l2.iter().find(|entry| entry["l2"].as_f64() == Some(0.0))?;
        let limit = |entry: &Value| match (entry["l1"].as_f64(), entry["direction_deg"].as_f64()) {
            (Some(l1), Some(direction_deg)) => format!("{l1:.4} at {direction_deg}°"),
            _ => "none found".into(),
        };
        let line = format!(
            "| [{name}](#{}) | {rings} | {links} | {:.4} | {:.2} | {} | {} | {} of {} |\n",
            anchor(&format!("{name} {title}")),
            gap / radius,
            wire / radius,
            limit(&held["least"]),
            limit(&held["largest"]),
            limits["statuses"]["global"].as_u64().unwrap_or(0),
            of_l2.iter().map(|entry| entry["asked"].as_u64()).sum::<Option<u64>>()?,
        );
        let single = inspected["single"] == true;
        let wire = match inspected["wire"]["metres_per_square_metre"].as_f64().filter(|_| !single) {
            Some(metres) => format!("wire {wire:.1} {unit} per cell, {metres:.0} m per square metre"),
            None => format!("wire {wire:.2} per cell"),
        };
        let gap = format!("{gap:.4} {unit}");
        let pictures = match single {
            true => format!("![{name}, a piece of the chain]({name}.png)\n"),
            false => format!(
                "| start | limits |\n| --- | --- |\n\
                | ![{name}, a patch of the sheet]({name}.png) | ![{name}, largest stretch in each direction]({name}-polar.png) |\n"
            ),
        };
        let section = format!(
            "\n## {name} {title}\n\n\
            {rings} rings and {links} links per cell; smallest gap {}; {wire}.\n\n\
            {pictures}",
            gap.trim_end(),
        );
        Some(Page { line, section })
    }
}

fn document(pages: &[Page], pulls: &str) -> String {
    let mut out = "# Gallery\n\n\
        Every built-in design: the sheet at its start, the largest stretch in each direction, and the numbers.\n\n\
        Lengths are relative to R, the design's reference radius; a negative gap is an overlap that the file allows at\n\
        the start. l1 is the largest stretch along the pull, less 1, with\n\
        the width held (l2 = 0), and the direction where it is least and largest; of equal ones the first. *Attained* says\n\
        how many limits attain their proven bound: none of these can be larger. All are of a single cell (`--cell 1x1`);\n\
        in a larger one, those that do not attain their bound can be larger. See\n\
        [reading plots](../guide/reading-plots.md) and [certificates](../guide/certificates.md).\n\n\
        | design | rings | links | smallest gap / R | wire / R | smallest l1 | largest l1 | attained |\n\
        | --- | --- | --- | --- | --- | --- | --- | --- |\n"
    .to_owned();
    out.extend(pages.iter().map(|page| &*page.line));
    out.extend(pages.iter().map(|page| &*page.section));
    out + &format!(
        "\n---\n\n**How it is made.** `cargo xtask gallery` runs for each design\n\n<!-- with: NAME=1.1 -->\n\n    \
        maille characterize NAME {pulls}\n    \
        maille render NAME {RENDER}\n    \
        maille plot NAME {PLOT}\n    \
        maille inspect NAME --json\n"
    )
}

/// The name that a heading has in a link, as GitHub makes it.
fn anchor(heading: &str) -> String {
    let kept = heading.chars().filter(|c| c.is_alphanumeric() || " -_".contains(*c));
    kept.flat_map(char::to_lowercase).map(|c| if c == ' ' { '-' } else { c }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_has_the_numbers_of_the_program() {
        let inspected = serde_json::json!({
            "design": "4.2", "title": "Flat rings, joined", "unit": "mm", "rings": 5, "links": 8, "reference_radius": 2.0,
            "smallest_gap": { "gap": 0.5 }, "wire": { "length": 40.0, "metres_per_square_metre": 321.4 }
        });
        let entry = |l2: f64, least: Value| serde_json::json!({ "l2": l2, "least": least, "largest": { "l1": 0.77403, "direction_deg": 45.0 }, "asked": 37 });
        let least = serde_json::json!({ "l1": 0.44, "direction_deg": 0.0 });
        let limits = serde_json::json!({ "limits": [entry(-0.25, Value::Null), entry(0.0, least)], "statuses": { "global": 70 } });
        let text = document(&[Page::of(&inspected, &limits).unwrap()], PULLS);
        assert!(text.contains(
            "| [4.2](#42-flat-rings-joined) | 5 | 8 | 0.2500 | 20.00 | 0.4400 at 0° | 0.7740 at 45° | 70 of 74 |"
        ));
        assert!(text.contains("smallest gap 0.5000 mm; wire 40.0 mm per cell, 321 m per square metre."), "{text}");
        let without = serde_json::json!({ "limits": [entry(0.0, Value::Null)], "statuses": {} });
        assert!(Page::of(&inspected, &without).unwrap().line.contains("| none found | 0.7740 at 45° | 0 of 37 |"));
        assert!(Page::of(&inspected, &serde_json::json!({})).is_none());
    }
}
