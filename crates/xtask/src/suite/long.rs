//! The last results of what takes minutes by nature, kept in the repository.

use super::{
    counts::Counts,
    step::{Ended, Outcome},
};
use crate::repository;
use std::{fs, path::Path};

/// Where they are kept.
pub const TABLE: &str = "validation/long-tests.md";
const HEAD: &str = "\
# Long tests

What takes too long for every change, with its last result; `cargo xtask test --all` runs it and writes this table.

| step | outcome | time | date | commit | cores |
| --- | --- | ---: | --- | --- | ---: |
";

/// Writes the rows of steps that ran anew; those of others stay. What goes wrong is a step that has failed.
pub fn write(root: &Path, ended: &[Ended], names: &[&str]) -> Result<(), Ended> {
    let path = root.join(TABLE);
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let commit = repository::commit(root).unwrap_or_default();
    let row = |step: &Ended| {
        let outcome = match &step.outcome {
            Outcome::Ok => "ok",
            Outcome::Failed(_) => "FAILED",
            Outcome::Skipped(_) | Outcome::Blocked(_) => return None,
        };
        let (time, date) = (step.wall_s, repository::today());
        Some(format!("| {} | {outcome} | {time:.0} s | {date} | {commit} | {cores} |", step.name))
    };
    let new: Vec<String> = ended.iter().filter(|step| names.contains(&step.name)).filter_map(row).collect();
    let old = fs::read_to_string(&path).unwrap_or_default();
    let failed = |e| Ended {
        name: TABLE,
        outcome: Outcome::Failed(format!("cannot be written: {e}")),
        wall_s: 0.0,
        counts: Counts::default(),
        log: path.clone(),
    };
    fs::write(&path, table(&old, names, &new)).map_err(failed)
}

/// The table, with the rows of `names` in their order: the new one, or else the old one.
fn table(old: &str, names: &[&str], new: &[String]) -> String {
    let of = |name: &str| {
        let begin = format!("| {name} |");
        new.iter().map(String::as_str).chain(old.lines()).find(|line| line.starts_with(&begin))
    };
    HEAD.to_owned() + &names.iter().filter_map(|name| of(name)).map(|row| format!("{row}\n")).collect::<String>()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_stays_until_its_step_has_run() {
        let first = table("", &["a", "b"], &["| b | ok | 3 s |".into()]);
        assert_eq!(first.strip_prefix(HEAD), Some("| b | ok | 3 s |\n"));
        let second = table(&first, &["a", "b"], &["| a | FAILED | 5 s |".into()]);
        assert_eq!(second.strip_prefix(HEAD), Some("| a | FAILED | 5 s |\n| b | ok | 3 s |\n"));
        let third = table(&second, &["a", "b"], &["| a | ok | 4 s |".into()]);
        assert_eq!(third.strip_prefix(HEAD), Some("| a | ok | 4 s |\n| b | ok | 3 s |\n"));
    }
}
