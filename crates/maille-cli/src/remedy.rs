//! How errors end the program, and what to do about those of the library, in the words of the command line.

use crate::exit::{DESIGN, FAILED, RECORD, USAGE, Wrong};
use maille_io::{DesignError, TextError, record::RecordError};
use maille_mesh::MeshError;
use maille_render::RenderError;
use miette::{Diagnostic, Report};
use std::{error::Error, fmt};

/// For a file of a record that cannot be what was written.
pub const DAMAGED: &str = "the file is damaged or was edited: restore it, or compute the record again with --overwrite";

/// The report with what to do next, where the library does not say it.
pub fn added(report: Report) -> Report {
    match remedy(&report) {
        Some((_, Some(help))) => Report::new(Helped { report, help }),
        _ => report,
    }
}

/// The exit code of what went wrong.
pub fn code(report: &Report) -> u8 {
    let of_design = report.downcast_ref::<DesignError>().map(|_| DESIGN);
    let of_text = report.downcast_ref::<TextError>().map(|_| USAGE);
    let own = report.downcast_ref::<Wrong>().map(|wrong| wrong.code);
    own.or(of_design).or(of_text).or(remedy(report).map(|(code, _)| code)).unwrap_or(FAILED)
}

/// The exit code of an error of the library, and what to do next.
fn remedy(report: &Report) -> Option<(u8, Option<&'static str>)> {
    let record = report.downcast_ref().map(of_record);
    record.or_else(|| report.downcast_ref().map(of_mesh)).or_else(|| report.downcast_ref().map(of_picture))
}

fn of_record(error: &RecordError) -> (u8, Option<&'static str>) {
    let help = match error {
        RecordError::Io { action, .. } => return (if *action == "read" { RECORD } else { FAILED }, None),
        RecordError::NotFinite { .. } => return (RECORD, None),
        RecordError::Malformed { .. } => DAMAGED,
        RecordError::Edited { .. } => "restore the file, or compute it again; a record with --overwrite",
        RecordError::OtherInputs { .. } => "name another folder with --out, or replace this record with --overwrite",
        RecordError::NotARecord { .. } => "name a new or empty folder with --out; files of others are never replaced",
        RecordError::InUse { .. } => "wait until it has ended, or name another folder with --out",
    };
    (RECORD, Some(help))
}

fn of_mesh(error: &MeshError) -> (u8, Option<&'static str>) {
    let help = match error {
        MeshError::Write(_) => return (FAILED, None),
        MeshError::OtherElements { .. } => {
            return (RECORD, Some("the record's files do not belong together: compute it again with --overwrite"));
        }
        MeshError::TooFine { .. } => "take a coarser --tolerance; it counts in the design file's unit of length",
        MeshError::TooCoarse => "give --segments 48, or 48x16 for 48 around the ring and 16 across the wire",
        MeshError::TooManyRings { .. } => "take a smaller --tile",
        MeshError::TooManyTriangles { .. } => {
            "take 3mf or glb, which store each ring once, a smaller --tile, or a coarser --tolerance"
        }
    };
    (USAGE, Some(help))
}

fn of_picture(error: &RenderError) -> (u8, Option<&'static str>) {
    let forces = matches!(error, RenderError::NoForces);
    (USAGE, forces.then_some("limits of the exact method come with forces: maille characterize … --method exact"))
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
