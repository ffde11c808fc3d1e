//! Readers of files: what they take is what they write, and what they refuse has a reason.

use maille::{lattice::Cell, model::Model};
use maille_io::{
    boundary::{read_surface, surface_line, write_surface},
    read_design,
    record::{
        read_forces, read_frames, read_limits, read_run, read_simulation, read_states, write_forces, write_frames,
        write_limits, write_run, write_simulation, write_states,
    },
    study::Study,
    write_design,
};
use std::{error::Error, fmt::Debug};

/// Designs with more rings are read and not compiled: that is slow, and no matter of reading.
const MOST_RINGS: usize = 12;

/// A design file. One that is right is written and read again as it was; its model says what overlaps.
pub fn design(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    match read_design("fuzz.toml", text) {
        Ok(design) => {
            assert!(design.problems().is_empty(), "{:?}", design.problems());
            let again = read_design("again.toml", &write_design(&design));
            assert!(again.as_ref().is_ok_and(|again| *again == design), "{again:?} is not {design:?}");
            if design.elements.iter().map(|e| e.rings.len()).sum::<usize>() <= MOST_RINGS
                && let Err(problems) = Model::compile(&design, Cell::PRIMITIVE)
            {
                assert!(!problems.is_empty() && problems.iter().all(|p| !p.problem.is_empty()));
            }
        }
        Err(error) => {
            let lines = text.lines().count().max(1);
            for problem in error.problems() {
                assert!(!problem.to_string().is_empty() && !problem.help_text().is_empty());
                let place = error.line_column(problem);
                assert!(place.is_none_or(|(line, _)| line <= lines + 1), "{place:?} of {lines} lines");
            }
        }
    }
}

/// `limits.csv`.
pub fn limits(bytes: &[u8]) {
    same(bytes, read_limits, |rows| write_limits(rows).ok());
}

/// `states.jsonl`.
pub fn states(bytes: &[u8]) {
    same(bytes, read_states, |states| write_states(states).ok());
}

/// `run.json`.
pub fn run(bytes: &[u8]) {
    same(bytes, read_run, |run| Some(write_run(run)));
}

/// `simulation.json`.
pub fn simulation(bytes: &[u8]) {
    same(bytes, read_simulation, |record| Some(write_simulation(record)));
}

/// `frames.jsonl`.
pub fn frames(bytes: &[u8]) {
    same(bytes, read_frames, |frames| Some(write_frames(frames)));
}

/// `forces.csv`.
pub fn forces(bytes: &[u8]) {
    same(bytes, read_forces, |table| Some(write_forces(table)));
}

/// `boundary.jsonl`: as it is, and with the right checksum for each line, which few wounds leave.
pub fn surface(bytes: &[u8]) {
    let read = |file: &str, text: &str| {
        read_surface(file, text.as_bytes()).map(|(head, vertices)| write_surface(&head, &vertices))
    };
    same(bytes, read, |written| Some(written.clone()));
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    let object = |line: &str| line.rsplit_once(",\"sum\":").map_or(line.to_owned(), |(open, _)| format!("{open}}}"));
    let summed: String = text.lines().filter_map(|line| surface_line(&object(line))).collect();
    same(summed.as_bytes(), read, |written| Some(written.clone()));
}

/// A study of `maille sweep`.
pub fn study(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    if let Err(error) = Study::read("fuzz.toml", text) {
        assert!(!error.to_string().is_empty());
    }
}

/// What was read is read again as it was from what is written of it.
fn same<T: PartialEq + Debug, E: Error>(
    bytes: &[u8],
    read: impl Fn(&str, &str) -> Result<T, E>,
    write: impl Fn(&T) -> Option<String>,
) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    match read("fuzz", text) {
        Ok(value) => {
            // A number that no file can hold is refused when it is written.
            if let Some(written) = write(&value) {
                match read("again", &written) {
                    Ok(again) => assert!(again == value, "{again:?} is not {value:?}"),
                    Err(error) => panic!("{error}: written as {written}"),
                }
            }
        }
        Err(error) => assert!(!error.to_string().is_empty()),
    }
}
