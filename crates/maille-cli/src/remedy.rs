//! What to do about errors of the library, in the words of the command line.

use maille_io::{mesh::MeshError, record::RecordError, render::RenderError};
use miette::{Diagnostic, Report};
use std::{error::Error, fmt};

/// For a file of a record that cannot be what was written.
pub const DAMAGED: &str = "the file is damaged or was edited: restore it, or compute the record again with --overwrite";

/// The report with what to do next, where the library does not say it.
pub fn added(report: Report) -> Report {
    match remedy(&report) {
        Some(help) => Report::new(Helped { report, help }),
        None => report,
    }
}

fn remedy(report: &Report) -> Option<&'static str> {
    let record = report.downcast_ref().and_then(of_record);
    let mesh = report.downcast_ref().and_then(of_mesh);
    let picture = matches!(report.downcast_ref(), Some(RenderError::NoForces))
        .then_some("limits of the exact method come with forces: maille characterize … --method exact");
    record.or(mesh).or(picture)
}

fn of_record(error: &RecordError) -> Option<&'static str> {
    match error {
        RecordError::Malformed { .. } => Some(DAMAGED),
        RecordError::Edited { .. } => Some("restore the file, or compute it again; a record with --overwrite"),
        RecordError::OtherInputs { .. } => {
            Some("name another folder with --out, or replace this record with --overwrite")
        }
        RecordError::NotARecord { .. } => {
            Some("name a new or empty folder with --out; files of others are never replaced")
        }
        RecordError::InUse { .. } => Some("wait until it has ended, or name another folder with --out"),
        RecordError::Io { .. } | RecordError::NotFinite { .. } => None,
    }
}

fn of_mesh(error: &MeshError) -> Option<&'static str> {
    match error {
        MeshError::TooFine { .. } => Some("take a coarser --tolerance; it counts in the design file's unit of length"),
        MeshError::TooCoarse => Some("give --segments 48, or 48x16 for 48 around the ring and 16 across the wire"),
        MeshError::TooManyRings { .. } => Some("take a smaller --tile"),
        MeshError::TooManyTriangles { .. } => {
            Some("take 3mf or glb, which store each ring once, a smaller --tile, or a coarser --tolerance")
        }
        MeshError::OtherElements { .. } => {
            Some("the record's files do not belong together: compute it again with --overwrite")
        }
        MeshError::Write(_) => None,
    }
}

/// A report with a help of its own.
#[derive(Debug)]
struct Helped {
    report: Report,
    help: &'static str,
}

impl fmt::Display for Helped {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.report.fmt(f)
    }
}

impl Error for Helped {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        self.report.source()
    }
}

impl Diagnostic for Helped {
    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        Some(Box::new(self.help))
    }
}
