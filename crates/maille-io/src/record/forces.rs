//! `forces.csv`: what holds a simulated sheet in each of its frames.

use super::{
    error::{RecordError, complete},
    plan::SheetPlan,
};
use csv::{ReaderBuilder, StringRecord};
use maille::{
    error::InvalidInput,
    model::Model,
    record::ForceRow,
    relaxation::simulate::{Setup, Simulation, force::force_row},
};

/// A column of the table. Units: `1` is a plain number or a count, `β R/1000` that of `--gravity` and `--force`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ForceColumn {
    /// Its name.
    pub name: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// What it says.
    pub meaning: &'static str,
}

const fn column(name: &'static str, unit: &'static str, meaning: &'static str) -> ForceColumn {
    ForceColumn { name, unit, meaning }
}

/// The columns before those of the places.
pub const FORCE_COLUMNS: [ForceColumn; 10] = [
    column("frame", "1", "line of frames.jsonl, from 0, as in --at frame=3"),
    column("share", "1", "fraction of the pull that is done"),
    column(
        "stretch",
        "1",
        "distance between the first pulled place and the one opposite to it, along the pull, divided by that at the start",
    ),
    column(
        "mean_force",
        "β R/1000",
        "mean force along the pull on an element of the first pulled place; negative where it compresses the sheet",
    ),
    column("f_xx", "1", "F, the linear map of the plane that best fits the motion of all elements"),
    column("f_xy", "1", "its shear of lines along y towards x"),
    column("f_yx", "1", "its shear of lines along x towards y"),
    column("f_yy", "1", "its stretch of lines along y"),
    column("energy", "β R²", "energy of contacts, targets and loads, as in frames.jsonl"),
    column("floor_force", "β R/1000", "force of the floor on the sheet along z; empty without a floor"),
];

/// The columns of a place, with its name for `PLACE`: the force that it exerts on the sheet.
pub const PLACE_COLUMNS: [ForceColumn; 3] = [
    column("force_PLACE_x", "β R/1000", "force of a fixed or pulled place on the sheet, the sum over its elements"),
    column("force_PLACE_y", "β R/1000", "its y"),
    column("force_PLACE_z", "β R/1000", "its z"),
];

/// The table: a row for each frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ForceTable {
    /// Names of the places that are fixed, then of those that are pulled.
    pub places: Vec<String>,
    /// The rows.
    pub rows: Vec<ForceRow>,
}

impl ForceTable {
    /// The table of a simulation that was made by `plan`: of the states at rest, or of the last one if there is none.
    pub fn new(plan: &SheetPlan, model: &Model, setup: &Setup, end: &Simulation) -> Result<Self, InvalidInput> {
        let grips = plan.grips(model)?;
        let row = |share, energy, state| force_row(model, setup, &grips, share, energy, state);
        let rows = match &end.rests[..] {
            [] => vec![row(end.share, end.energy, &end.state)],
            rests => end.path.iter().zip(rests).map(|(frame, state)| row(frame.share, frame.energy, state)).collect(),
        };
        Ok(ForceTable { places: grips.into_iter().map(|grip| grip.name).collect(), rows })
    }

    /// Names of the columns.
    pub fn columns(&self) -> Vec<String> {
        let of_places =
            self.places.iter().flat_map(|place| PLACE_COLUMNS.map(|column| column.name.replacen("PLACE", place, 1)));
        FORCE_COLUMNS.iter().map(|column| column.name.to_owned()).chain(of_places).collect()
    }
}

/// The table as text; numbers with the fewest digits that read back bit for bit, nothing where there is none.
pub fn write_forces(table: &ForceTable) -> String {
    let quoted = |name: &String| match name.contains([',', '"', '\n', '\r']) {
        true => format!("\"{}\"", name.replace('"', "\"\"")),
        false => name.clone(),
    };
    let mut out = table.columns().iter().map(quoted).collect::<Vec<_>>().join(",") + "\n";
    for (frame, row) in table.rows.iter().enumerate() {
        let f = row.deformation.map(|[[xx, xy], [yx, yy]]| [xx, xy, yx, yy]);
        let f = (0..4).map(|k| f.map(|f| f[k]));
        let cells = [Some(row.share), row.stretch, row.mean_force].into_iter().chain(f);
        let cells = cells.chain([Some(row.energy), row.floor_force]);
        let cells = cells.chain(row.forces.iter().flatten().copied().map(Some));
        let cells = cells.map(|x| x.map_or(String::new(), |x| format!("{x:?}")));
        out += &(std::iter::once(frame.to_string()).chain(cells).collect::<Vec<_>>().join(",") + "\n");
    }
    out
}

/// Reads the table; `file` is the name to show in errors.
pub fn read_forces(file: &str, text: &str) -> Result<ForceTable, RecordError> {
    complete(file, text)?;
    let mut reader = ReaderBuilder::new().has_headers(false).flexible(true).from_reader(text.as_bytes());
    let mut records = reader.records();
    let header = match records.next() {
        None => return Err(RecordError::malformed(file, 1, "the header is missing")),
        Some(header) => header.map_err(|e| RecordError::malformed(file, 1, e.to_string()))?,
    };
    let mut table = ForceTable { places: places(&header), rows: Vec::new() };
    let columns = table.columns();
    let wrong = (0..columns.len().max(header.len())).find(|&i| header.get(i) != columns.get(i).map(String::as_str));
    if let Some(i) = wrong {
        let expected = columns.get(i).map_or("no more, or three of a place".into(), |name| format!("\"{name}\""));
        let problem = format!("column {} is \"{}\", expected {expected}", i + 1, header.get(i).unwrap_or_default());
        return Err(RecordError::malformed(file, 1, problem));
    }
    for record in records {
        let record = record.map_err(|e| RecordError::malformed(file, table.rows.len() + 2, e.to_string()))?;
        let line = record.position().map_or(table.rows.len() + 2, |p| p.line() as usize);
        let found = row(&columns, &record, table.rows.len());
        table.rows.push(found.map_err(|problem| RecordError::malformed(file, line, problem))?);
    }
    Ok(table)
}

/// The places that a header names: what is between `force_` and `_x`.
fn places(header: &StringRecord) -> Vec<String> {
    let of = |name: &str| name.strip_prefix("force_")?.strip_suffix("_x").map(str::to_owned);
    header.iter().skip(FORCE_COLUMNS.len()).step_by(3).map_while(of).collect()
}

fn row(columns: &[String], record: &StringRecord, frame: usize) -> Result<ForceRow, String> {
    if record.len() != columns.len() {
        return Err(format!("{} columns, expected {}", record.len(), columns.len()));
    }
    if record.get(0) != Some(&frame.to_string()) {
        return Err(format!("column frame: \"{}\" is not {frame}", record.get(0).unwrap_or_default()));
    }
    let cells = columns.iter().zip(record).skip(1).map(|(name, text)| match (text, text.parse::<f64>()) {
        ("", _) => Ok(None),
        (_, Ok(x)) if x.is_finite() => Ok(Some(x)),
        _ => Err(format!("column {name}: \"{text}\" is no finite number")),
    });
    let cells = cells.collect::<Result<Vec<Option<f64>>, String>>()?;
    let there = |k: usize| cells[k].ok_or_else(|| format!("column {} is empty", columns[k + 1]));
    let deformation = match cells[3..7] {
        [Some(xx), Some(xy), Some(yx), Some(yy)] => Some([[xx, xy], [yx, yy]]),
        [None, None, None, None] => None,
        _ => return Err("of f_xx, f_xy, f_yx and f_yy some are empty and some are not".into()),
    };
    let place = |k: usize| Ok([there(k)?, there(k + 1)?, there(k + 2)?]);
    Ok(ForceRow {
        share: there(0)?,
        stretch: cells[1],
        mean_force: cells[2],
        deformation,
        energy: there(7)?,
        floor_force: cells[8],
        forces: (FORCE_COLUMNS.len() - 1..cells.len()).step_by(3).map(place).collect::<Result<_, String>>()?,
    })
}
