//! A design that is opened, and what a server of it knows.

use crate::{
    api::{Listed, Palette, Shown, ShownMap, Start},
    error::ViewError,
    sheet,
    work::Work,
};
use maille_io::{
    builtin_designs, read_design,
    record::Record,
    render::{FORCE, KINDS, LOADS, UNLOADED},
    weave::Weave,
};
use std::{path::PathBuf, sync::Arc};

/// A design to open.
#[derive(Clone, Debug)]
pub struct Opened {
    /// The name that errors show: a built-in name or a path.
    pub name: String,
    /// The design file, if it is one that may be written again.
    pub file: Option<PathBuf>,
    /// Its text.
    pub text: String,
    /// A record of it, with its name.
    pub record: Option<(String, Record)>,
}

/// What a server knows.
#[derive(Debug)]
pub struct App {
    pub(crate) start: Start,
    pub(crate) work: Arc<Work>,
    /// Where new files go.
    pub(crate) folder: PathBuf,
}

impl App {
    /// Opens a design; solves run on `threads`, new files go to `folder`.
    pub fn new(opened: &Opened, threads: Option<usize>, folder: PathBuf) -> Result<Self, ViewError> {
        Ok(App { start: start(opened, false)?, work: Arc::new(Work::new(threads)?), folder })
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
    let map = |(name, record): &(String, Record)| sheet::shown_map(name.clone(), record);
    let map: Option<ShownMap> = opened.record.as_ref().map(map).transpose()?;
    Ok(Start {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        designs: if bundle { Vec::new() } else { builtin_designs().iter().map(list).collect() },
        weaves: Weave::ALL.iter().map(|weave| weave.name().to_owned()).collect(),
        opened: Shown {
            name: opened.name.clone(),
            file: opened.file.as_ref().map(|file| file.display().to_string()),
            text: opened.text.clone(),
            map,
        },
        palette: Palette {
            kinds: KINDS.iter().map(color).collect(),
            loads: LOADS.iter().map(color).collect(),
            unloaded: color(&UNLOADED),
            force: color(&FORCE),
        },
        bundle,
    })
}
