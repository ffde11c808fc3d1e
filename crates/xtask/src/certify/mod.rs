//! `cargo xtask certify`: maps of every built-in design and of random ones, each row verified, counted by design.
//!
//! It runs the program as a user does. The records lie in a folder that is named by the program's bytes: a rerun with the
//! same program goes on where the last one stopped, another program begins anew.

mod symmetry;
mod tally;

use crate::{
    program,
    repository::{commit, today},
};
use serde_json::Value;
use std::{
    collections::BTreeMap,
    fs,
    hash::{DefaultHasher, Hasher},
    path::{Path, PathBuf},
    process::Command,
    time::Duration,
};
use tally::{Tally, quoted};

/// Where the table is written; a quick one stays beside its records.
const TABLE: &str = "validation/certified.csv";
const SCRATCH: &str = "maille-out/certify";
/// Arguments of `maille characterize` for built-in designs and for random ones.
const PULLS: [&str; 2] = ["--directions", "0:180:7.5"];
const L2: &str = "--l2=-0.25:0.25:0.125";
const RANDOM: [&str; 3] = ["--directions", "10,70,130", "--l2=-0.1,0,0.05"];
/// Random designs: seed, how many, and how many doubled ones.
const SEED: &str = "1";
const COUNTS: [&str; 2] = ["100", "30"];
/// The quick share.
const QUICK_DESIGNS: [&str; 3] = ["1.1", "3.1", "european-4-in-1"];
const QUICK_PULLS: [&str; 3] = ["--directions", "0,45,135", "--l2=-0.125,0"];
const QUICK_RANDOM: [&str; 3] = ["--directions", "70", "--l2=0"];
const QUICK_COUNTS: [&str; 2] = ["3", "2"];
/// Exit codes of the program that leave a record: all found, some not found, stopped.
const WRITTEN: [i32; 3] = [0, 5, 130];
/// Exit codes of `maille verify` that come with findings: all proved, something false, something open.
const VERIFIED: [i32; 3] = [0, 4, 5];
/// How lines of maps end that were solved and verified to the end.
const ENDS: [&str; 3] = [",proved", ",open", FALSE];
const FALSE: &str = ",false";

/// What is asked for on the command line.
#[derive(Debug, PartialEq)]
struct Options {
    quick: bool,
    /// The program; built if none is given.
    program: Option<String>,
    /// Time that one map and its verification may take, each.
    limit_s: f64,
    /// Threads of the program; all cores if none is given.
    threads: Option<String>,
}

impl Options {
    /// Reads the words after `certify`.
    fn read(words: &[&str]) -> Result<Options, String> {
        let mut out = Options { quick: false, program: None, limit_s: 1800.0, threads: None };
        let mut words = words.iter();
        while let Some(word) = words.next() {
            let mut value = || words.next().map(|value| value.to_string()).ok_or(format!("{word} lacks its value"));
            match *word {
                "--quick" => out.quick = true,
                "--program" => out.program = Some(value()?),
                "--threads" => out.threads = Some(value()?),
                "--limit-s" => {
                    let text = value()?;
                    let seconds = text.parse().ok().filter(|s: &f64| s.is_finite() && *s > 0.0);
                    out.limit_s = seconds.ok_or(format!("--limit-s {text}: give seconds, as 1800"))?;
                }
                other => return Err(format!("certify has no option `{other}`")),
            }
        }
        Ok(out)
    }
}

/// One map.
struct Task {
    /// Folder of its record.
    folder: String,
    /// Name or path, as the program takes it.
    design: String,
    name: String,
    minor_radius: f64,
    cell: &'static str,
    pulls: Vec<&'static str>,
}

/// A line of the table.
struct Line {
    tally: Tally,
    wall_s: f64,
    outcome: String,
}

struct House {
    program: PathBuf,
    version: String,
    scratch: PathBuf,
    options: Options,
}

/// Runs all maps, and writes the table; an error if a row is false or a map failed.
pub fn run(root: &Path, words: &[&str]) -> Result<(), String> {
    let options = Options::read(words)?;
    let program = match &options.program {
        Some(program) => PathBuf::from(program),
        None => program::build(root, if options.quick { "dev" } else { "release" })?,
    };
    let program = program.canonicalize().map_err(|e| format!("{}: {e}", program.display()))?;
    let bytes = fs::read(&program).map_err(|e| format!("{} cannot be read: {e}", program.display()))?;
    let mut hasher = DefaultHasher::new();
    hasher.write(&bytes);
    let kind = if options.quick { "-quick" } else { "" };
    let hash = format!("{:016x}", hasher.finish());
    let scratch = root.join(SCRATCH).join(format!("{hash}{kind}"));
    fs::create_dir_all(&scratch).map_err(|e| format!("{} cannot be made: {e}", scratch.display()))?;
    let built = options.program.is_none().then(|| commit(root)).flatten();
    let version = format!("{} {}", version(&program)?, built.unwrap_or(hash));
    let house = House { program, version, scratch, options };
    let tasks = house.tasks(root)?;
    let table = house.scratch.join("certified.csv");
    let mut done = house.done(&table)?;
    let mut bad = Vec::new();
    for (k, task) in tasks.iter().enumerate() {
        let key = task.key();
        let count = format!("{} of {}", k + 1, tasks.len());
        if let Some(line) = done.get(&key) {
            println!("{count}  {key}  is there");
            if line.ends_with(FALSE) {
                bad.push(key);
            }
            continue;
        }
        let line = house.certify(task);
        println!("{count}  {key}  {}", line.words());
        for told in &line.tally.told {
            println!("    FALSE {}, {told}", task.name);
        }
        let fields = format!("{},{},{key},{}", today(), quoted(&house.version), line.fields());
        if !ENDS.iter().any(|end| fields.ends_with(end)) || fields.ends_with(FALSE) {
            bad.push(key.clone());
        }
        done.insert(key, fields);
        write_table(&table, &tasks, &done)?;
    }
    if !house.options.quick {
        write_table(&root.join(TABLE), &tasks, &done)?;
        println!("{TABLE}");
    }
    if bad.is_empty() {
        return Ok(());
    }
    Err(format!("{} of {} maps are false or not complete: {}", bad.len(), tasks.len(), bad.join("; ")))
}

fn columns() -> String {
    format!("date,program,design,minor_radius,cell,{},wall_s,outcome", Tally::columns())
}

impl Task {
    fn new(design: String, name: &str, minor_radius: f64, cell: &'static str, pulls: Vec<&'static str>) -> Task {
        let folder = format!("{name}-r{minor_radius}-{cell}");
        Task { folder, design, name: name.to_owned(), minor_radius, cell, pulls }
    }

    /// What names it in the table.
    fn key(&self) -> String {
        format!("{},{},{}", self.name, self.minor_radius, self.cell)
    }
}

impl Line {
    fn fields(&self) -> String {
        format!("{},{:.1},{}", self.tally.fields(), self.wall_s, quoted(&self.outcome))
    }

    fn words(&self) -> String {
        let Tally { rows, proved, open, refuted, unclaimed, symmetric_pairs, symmetric_difference, .. } = &self.tally;
        let symmetric = match symmetric_pairs {
            0 => String::new(),
            pairs => format!("; {pairs} symmetric pairs, to {symmetric_difference:.1e}"),
        };
        format!(
            "{rows} rows: {proved} proved, {open} open, {refuted} false, {unclaimed} claim nothing{symmetric}; {:.1} s, {}",
            self.wall_s, self.outcome
        )
    }
}

impl House {
    /// All maps: built-in designs, then random ones, which are made anew.
    fn tasks(&self, root: &Path) -> Result<Vec<Task>, String> {
        let quick = self.options.quick;
        let listed = Command::new(&self.program).args(["designs", "--json"]).output();
        let listed = listed.map_err(|e| format!("{} did not start: {e}", self.program.display()))?;
        let listed = parsed(&String::from_utf8_lossy(&listed.stdout), "maille designs --json")?;
        let mut out = Vec::new();
        for design in listed["designs"].as_array().ok_or("`maille designs --json` lists no designs")? {
            let (name, radius, reference) = design["name"]
                .as_str()
                .zip(design["minor_radius"].as_f64())
                .zip(design["reference_radius"].as_f64())
                .map(|((name, radius), reference)| (name, radius, reference))
                .ok_or("a built-in design has no name or no radius")?;
            // A chain is pulled along itself alone.
            if design["single"] == true || quick && !QUICK_DESIGNS.contains(&name) {
                continue;
            }
            // Designs of the thesis have two radii: R/10 and R/20.
            let has_two = (radius * 10.0 - reference).abs() < 1e-9 * reference;
            let radii = if has_two && !quick { vec![radius, radius / 2.0] } else { vec![radius] };
            for radius in radii {
                for cell in if quick { &["1x1"][..] } else { &["1x1", "auto"][..] } {
                    let pulls = if quick { QUICK_PULLS.to_vec() } else { vec![PULLS[0], PULLS[1], L2] };
                    out.push(Task::new(name.to_owned(), name, radius, cell, pulls));
                }
            }
        }
        let folder = self.scratch.join("designs");
        let [count, doubled] = if quick { QUICK_COUNTS } else { COUNTS };
        println!("making {count} random designs and {doubled} doubled ones");
        let mut make = Command::new(program::example(root, "random_designs")?);
        make.args(["--seed", SEED, "--count", count, "--doubled", doubled]).arg(&folder).current_dir(root);
        program::done(&mut make, "make the random designs")?;
        let unread = |e: std::io::Error| format!("{} cannot be read: {e}", folder.display());
        let mut files = fs::read_dir(&folder)
            .map_err(unread)?
            .map(|entry| entry.map(|entry| entry.path()))
            .collect::<Result<Vec<PathBuf>, _>>()
            .map_err(unread)?;
        files.sort();
        for file in files {
            let text = fs::read_to_string(&file).map_err(|e| format!("{} cannot be read: {e}", file.display()))?;
            let radius = text.lines().find_map(|line| line.strip_prefix("minor_radius = "));
            let radius = radius.and_then(|text| text.parse().ok()).ok_or(format!("{}: no radius", file.display()))?;
            let name = file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
            let pulls = if quick { QUICK_RANDOM } else { RANDOM };
            out.push(Task::new(file.to_string_lossy().into_owned(), &name, radius, "auto", pulls.to_vec()));
        }
        Ok(out)
    }

    /// The lines that an earlier run has left, by key.
    fn done(&self, table: &Path) -> Result<BTreeMap<String, String>, String> {
        let Ok(text) = fs::read_to_string(table) else { return Ok(BTreeMap::new()) };
        let mut lines = text.lines();
        if lines.next() != Some(columns().as_str()) {
            return Err(format!("{} is of another table: remove it", table.display()));
        }
        let key = |line: &str| {
            let rest = line.split_once(',')?.1.strip_prefix(&quoted(&self.version))?.strip_prefix(',')?;
            let fields: Vec<&str> = rest.splitn(4, ',').collect();
            Some((fields.get(..3)?.join(","), line.to_owned()))
        };
        // What was not completed is tried again.
        Ok(lines.filter(|line| ENDS.iter().any(|end| line.ends_with(end))).filter_map(key).collect())
    }

    /// Solves and verifies one map. What goes wrong is said in its line.
    fn certify(&self, task: &Task) -> Line {
        let mut line = Line { tally: Tally::default(), wall_s: 0.0, outcome: String::new() };
        if let Err(problem) = self.fill(task, &mut line) {
            line.outcome = format!("failed: {problem}");
        }
        line
    }

    fn fill(&self, task: &Task, line: &mut Line) -> Result<(), String> {
        let record = self.scratch.join(&task.folder);
        let path = record.to_string_lossy().into_owned();
        let radius = task.minor_radius.to_string();
        let threads: Vec<&str> = self.options.threads.iter().flat_map(|n| ["--threads", n]).collect();
        let mut solve = vec!["characterize", &task.design, "--cell", task.cell, "--out", &path, "--quiet"];
        if task.design == task.name {
            solve.extend(["--minor-radius", &radius]);
        }
        solve.extend(&task.pulls);
        solve.extend(&threads);
        let (ended, _) = self.program(&solve, task, "characterize", &WRITTEN)?;
        line.wall_s += ended.wall_s;
        let ended_early = ended.stopped;
        if ended_early {
            line.outcome = format!("characterize stopped after {} s", self.options.limit_s);
        }
        let mut verify = vec!["verify", &path, "--json", "--quiet"];
        verify.extend(&threads);
        let (ended, verified) = self.program(&verify, task, "verify", &VERIFIED)?;
        line.wall_s += ended.wall_s;
        let (_, table) = self.program(&["table", &path, "--format", "json"], task, "table", &[0])?;
        line.tally = Tally::of(&parsed(&table, "maille table")?, &parsed(&verified, "maille verify")?)?;
        if !ended_early {
            line.outcome = line.tally.outcome().to_owned();
        }
        Ok(())
    }

    /// Runs the program within the time limit; its standard output. Exit codes other than `expected` are errors.
    fn program(
        &self,
        arguments: &[&str],
        task: &Task,
        kind: &str,
        expected: &[i32],
    ) -> Result<(program::Ended, String), String> {
        let file = |ending: &str| self.scratch.join(format!("{}.{kind}.{ending}", task.folder));
        let (output, errors) = (file("out"), file("err"));
        let limit = Duration::from_secs_f64(self.options.limit_s);
        let ended = program::run(Command::new(&self.program).args(arguments), &output, &errors, limit)?;
        if !ended.status.code().is_some_and(|code| expected.contains(&code)) {
            let said = fs::read_to_string(&errors).unwrap_or_default();
            let said = said.split_whitespace().collect::<Vec<_>>().join(" ");
            let why = if ended.stopped { format!("stopped after {} s", self.options.limit_s) } else { said };
            return Err(format!("{kind} ended with {}: {why}", ended.status));
        }
        let text = fs::read_to_string(&output).map_err(|e| format!("{} cannot be read: {e}", output.display()))?;
        Ok((ended, text))
    }
}

/// Writes the table: the lines that there are, in the order of the tasks.
fn write_table(path: &Path, tasks: &[Task], done: &BTreeMap<String, String>) -> Result<(), String> {
    let lines = tasks.iter().filter_map(|task| done.get(&task.key()));
    let text: String = std::iter::once(&columns()).chain(lines).map(|line| format!("{line}\n")).collect();
    let new = path.with_extension("csv.tmp");
    fs::write(&new, text).and_then(|()| fs::rename(&new, path)).map_err(|e| format!("{}: {e}", path.display()))
}

/// The version that the program says it has.
fn version(program: &Path) -> Result<String, String> {
    let said = Command::new(program).arg("--version").output();
    let said = said.map_err(|e| format!("{} did not start: {e}", program.display()))?;
    let said = String::from_utf8_lossy(&said.stdout).into_owned();
    said.split_whitespace().last().map(str::to_owned).ok_or(format!("{} has no version", program.display()))
}

fn parsed(text: &str, line: &str) -> Result<Value, String> {
    serde_json::from_str(text).map_err(|e| format!("`{line}` printed no JSON: {e}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_are_read() {
        let options = Options::read(&["--quick", "--limit-s", "20", "--program", "p", "--threads", "2"]).unwrap();
        let expected = Options { quick: true, program: Some("p".into()), limit_s: 20.0, threads: Some("2".into()) };
        assert_eq!(options, expected);
        for wrong in [&["--limit-s", "-1"][..], &["--limit-s"], &["--slow"]] {
            assert!(Options::read(wrong).is_err(), "{wrong:?}");
        }
    }
}
