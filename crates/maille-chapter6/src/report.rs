//! All files of the chapter, from records.

use crate::{
    figures::{figures, sheet_png},
    map::Map,
    page::{Sheet, page},
    plan::Chosen,
    statements::{Finding, statements},
};
use maille::{error::InvalidInput, lattice::Cell, model::Model};
use maille_io::record::NamedRecord;
use maille_render::RenderError;
use serde_json::json;

/// What keeps the report from being made.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// A design cannot be compiled, or its record read.
    #[error("{0} cannot be used: {1}")]
    Design(String, InvalidInput),
    /// A design cannot be drawn.
    #[error("cannot draw {0}")]
    Render(&'static str, #[source] RenderError),
}

/// The report.
pub struct Report {
    /// What became of each statement.
    pub findings: Vec<Finding>,
    /// The files: each with its path below the report's folder.
    pub files: Vec<(String, Vec<u8>)>,
}

/// Pixels of a sheet's picture.
const PICTURE: [u32; 2] = [480, 360];

/// The figures, the pictures of the designs, the verdicts and the page; `quick` as in [`plan`](crate::plan).
pub fn report(chosen: &[Chosen], quick: bool, records: &[NamedRecord]) -> Result<Report, ReportError> {
    let map = |named| Map::of(named).map_err(|problems| ReportError::Design(named.name.clone(), problems[0].clone()));
    let maps: Vec<Map> = records.iter().map(map).collect::<Result<_, _>>()?;
    let findings = statements(&maps);
    let figures = figures(records, &maps);
    let svg =
        |figure: &crate::figures::Figure| (format!("figures/{}.svg", figure.file), figure.svg.clone().into_bytes());
    let mut files: Vec<(String, Vec<u8>)> = figures.iter().map(svg).collect();
    let mut sheets = Vec::new();
    for Chosen { name, design, given } in chosen {
        let model = Model::compile(design, Cell::PRIMITIVE)
            .map_err(|problems| ReportError::Design(name.to_string(), problems[0].clone()))?;
        let png = sheet_png(design, &model, PICTURE).map_err(|e| ReportError::Render(name, e))?;
        files.push((format!("sheets/{name}.png"), png.clone()));
        let counts = [model.elements.len(), model.links.len()];
        sheets.push(Sheet { design, given: given.as_deref(), counts, png });
    }
    let verdicts = json!({ "statements": findings });
    files.push(("statements.json".into(), format!("{verdicts:#}\n").into_bytes()));
    let words = words(chosen, quick, &maps);
    files.push(("index.html".into(), page(&words, &findings, &sheets, &maps, &figures).into_bytes()));
    Ok(Report { findings, files })
}

/// How the records were made, and whose coordinates the designs have.
fn words(chosen: &[Chosen], quick: bool, maps: &[Map]) -> String {
    let command = if quick { "maille reproduce --quick" } else { "maille reproduce" };
    let given: Vec<&str> = chosen.iter().filter(|design| design.given.is_some()).map(|design| design.name).collect();
    let coordinates = match given.len() {
        0 => "All coordinates are ours: the thesis's pictures of its designs are lost, and its text gives no numbers."
            .into(),
        n if n == chosen.len() => "All designs were given.".into(),
        _ => format!("Given were {}; the coordinates of the others are ours.", given.join(", ")),
    };
    format!(
        "Made by {command}, version {}, from {} records with {} limits of {} designs. Limits are those of each design's \
         own cell, as in the thesis, and of the rectangular cell for 3.x. {coordinates}",
        env!("CARGO_PKG_VERSION"),
        maps.len(),
        maps.iter().map(|map| map.rows.len()).sum::<usize>(),
        chosen.len(),
    )
}
