//! A design that is opened, and what a server of it knows.

use crate::{
    api::{Listed, Palette, Shown, Start},
    error::ViewError,
    records::{self, Opened, Recorded, USUAL},
    refusal::Refusal,
    rolled, sheet, simulated,
    work::Work,
};
use maille_io::{builtin_designs, read_design, weave::Weave};
use maille_render::{FORCE, KINDS, LOADS, UNLOADED};
use std::{path::PathBuf, sync::Arc};

/// What a server knows.
#[derive(Debug)]
pub struct App {
    pub(crate) start: Start,
    pub(crate) work: Arc<Work>,
    /// Where new files go.
    pub(crate) folder: PathBuf,
    /// Folders whose records may be opened, relative to that one.
    roots: Vec<String>,
}

impl App {
    /// Opens a design; solves run on `threads`, new files go to `folder`. Records in `named`, a folder that the user named,
    /// can be opened, too.
    pub fn new(
        opened: &Opened,
        threads: Option<usize>,
        folder: PathBuf,
        named: Option<&str>,
    ) -> Result<Self, ViewError> {
        let roots = named.into_iter().chain([USUAL]).map(str::to_owned).collect();
        Ok(App { start: start(opened, false)?, work: Arc::new(Work::new(threads)?), folder, roots })
    }

    /// What the page starts with, with the records that are there now.
    pub(crate) fn start(&self) -> Start {
        Start { records: self.records(), ..self.start.clone() }
    }

    fn records(&self) -> Vec<Listed> {
        records::list(&self.folder, &self.roots)
    }

    /// Opens a record that is listed.
    pub(crate) fn open(&self, name: &str) -> Result<Shown, Refusal> {
        let none = || Refusal::wrong(format!("there is no record {name}"), "load the page again, for those there are");
        if self.records().iter().all(|listed| listed.name != name) {
            return Err(none());
        }
        let damaged = |e: maille_io::record::RecordError| Refusal::wrong(e.to_string(), "compute it again");
        shown(&Opened::folder(name, &self.folder.join(name)).map_err(damaged)?.ok_or_else(none)?)
    }

    /// Solves that run or wait.
    pub fn live(&self) -> usize {
        self.work.live()
    }
}

/// What the page starts with.
pub(crate) fn start(opened: &Opened, bundle: bool) -> Result<Start, ViewError> {
    let list = |entry: &maille_io::Builtin| {
        let title = read_design(entry.name, entry.toml).map_or(String::new(), |design| design.title);
        Listed { name: entry.name.to_owned(), title }
    };
    let color = |srgb: &u32| format!("#{srgb:06x}");
    Ok(Start {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        designs: if bundle { Vec::new() } else { builtin_designs().iter().map(list).collect() },
        weaves: Weave::ALL.iter().map(|weave| weave.name().to_owned()).collect(),
        records: Vec::new(),
        opened: shown(opened)?,
        palette: Palette {
            kinds: KINDS.iter().map(color).collect(),
            loads: LOADS.iter().map(color).collect(),
            unloaded: color(&UNLOADED),
            force: color(&FORCE),
        },
        bundle,
    })
}

fn shown(opened: &Opened) -> Result<Shown, Refusal> {
    let (mut map, mut simulation) = (None, None);
    match &opened.record {
        Some((name, Recorded::Limits(record))) => map = Some(sheet::shown_map(name.clone(), record)?),
        Some((name, Recorded::Simulation(files))) => simulation = Some(simulated::shown(name.clone(), files)?),
        Some((name, Recorded::Rolls(rolls))) => simulation = Some(rolled::shown(name.clone(), &rolls.0, &rolls.1)?),
        None => {}
    }
    Ok(Shown {
        name: opened.name.clone(),
        file: opened.file.as_ref().map(|file| file.display().to_string()),
        text: opened.text.clone(),
        parameters: opened.parameters.clone(),
        map,
        simulation,
    })
}
