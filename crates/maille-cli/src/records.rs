//! Records named on the command line.

use crate::exit::{self, wrong};
use maille::survey::surface::Boundary;
use maille_io::{
    boundary::{SURFACE, SurfaceRecord, open_surface},
    record::{NamedRecord, RECORDS, Record},
    roll::{ROLL, ROLLS, Roll, RollRecordFile, open_rolls},
};
use miette::Result;
use std::path::{Path, PathBuf};

/// The folder that is meant: itself, the one of a file in it, or `maille-out/NAME`.
pub fn folder(named: &Path) -> PathBuf {
    let usual = Path::new("maille-out").join(named);
    if named.is_file() {
        named.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new(".")).to_owned()
    } else if !named.exists() && usual.is_dir() {
        usual
    } else {
        named.to_owned()
    }
}

/// The surface of all strains that the folder holds, if it holds one.
pub fn surface(named: &Path) -> Result<Option<(SurfaceRecord, Boundary)>> {
    let folder = folder(named);
    if folder.join(SURFACE).is_file() {
        return Ok(Some(open_surface(&folder)?));
    }
    match folder.join("boundary.jsonl").is_file() {
        true => {
            let problem = format!("{} holds a surface without {SURFACE}", folder.display());
            let help = "its run was killed, or is older than this file: the same `maille boundary` command writes it";
            Err(wrong(exit::RECORD, problem, help))
        }
        false => Ok(None),
    }
}

/// The rolls that the folder holds, if it holds any.
pub fn rolls(named: &Path) -> Result<Option<(RollRecordFile, Vec<Roll>)>> {
    let folder = folder(named);
    if folder.join(ROLL).is_file() {
        return Ok(Some(open_rolls(&folder)?));
    }
    match folder.join(ROLLS).is_file() {
        true => {
            let problem = format!("{} holds rolls without {ROLL}", folder.display());
            Err(wrong(exit::RECORD, problem, "its run was killed: the same `maille roll` command writes it"))
        }
        false => Ok(None),
    }
}

/// Whether it is the folder of a record.
pub fn holds_record(folder: &Path) -> bool {
    folder.join("run.json").is_file()
}

/// The record of a folder that was named.
pub fn read_record(folder: &Path) -> Result<Record> {
    is_record(folder)?;
    Ok(Record::read(folder)?)
}

/// Refuses a folder without a record.
pub fn is_record(folder: &Path) -> Result<()> {
    if holds_record(folder) {
        return Ok(());
    }
    let problem = match folder.exists() {
        true => format!("{} holds no record of maille", folder.display()),
        false => format!("there is no folder {}", folder.display()),
    };
    let help = match of_sweep(folder.to_owned()).first().filter(|first| first.as_path() != folder) {
        Some(first) => format!("it holds the records of a study: give one of them, such as {}", first.display()),
        None => {
            "give the folder that `maille characterize` wrote: it holds run.json, limits.csv and states.jsonl".into()
        }
    };
    Err(wrong(exit::RECORD, problem, help))
}

/// The name of a record: its folder, without a slash at the end.
pub fn name(folder: &Path) -> String {
    folder.components().collect::<PathBuf>().display().to_string()
}

/// The records of a folder that `maille sweep` writes, in the order of their names; of any other, the folder itself.
pub fn of_sweep(folder: PathBuf) -> Vec<PathBuf> {
    let inside = match holds_record(&folder) {
        true => None,
        false => std::fs::read_dir(folder.join(RECORDS)).ok(),
    };
    let mut records: Vec<PathBuf> = inside.into_iter().flatten().flatten().map(|entry| entry.path()).collect();
    records.retain(|path| holds_record(path));
    records.sort();
    if records.is_empty() { vec![folder] } else { records }
}

/// Reads records, each with its folder as a name, and all those of a sweep.
pub fn read(named: &[PathBuf]) -> Result<Vec<NamedRecord>> {
    let mut out: Vec<NamedRecord> = Vec::new();
    for folder in named.iter().flat_map(|path| of_sweep(folder(path))) {
        let name = name(&folder);
        if out.iter().any(|known| known.name == name) {
            return Err(wrong(exit::USAGE, format!("the record {name} is given twice"), "name each record once"));
        }
        let record = read_record(&folder)?;
        let sensitivities = Record::read_sensitivities(&folder)?.unwrap_or_default();
        out.push(NamedRecord { record, name, sensitivities });
    }
    Ok(out)
}
