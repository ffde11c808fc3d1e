//! `forces.csv`: what holds a simulated sheet in each of its frames.

use super::{
    csv::{csv_lines, csv_number, csv_text},
    error::RecordError,
    plan::SheetPlan,
};
use ::csv::StringRecord;
use maille::{
    error::InvalidInput,
    model::Model,
    record::ForceRow,
    relaxation::simulate::{Setup, Simulation, force::force_row},
};

/// The columns before those of the places; `docs/record.md` has what they mean.
pub const FORCE_COLUMNS: [&str; 10] =
    ["frame", "share", "stretch", "mean_force", "f_xx", "f_xy", "f_yx", "f_yy", "energy", "floor_force"];

/// The column after these of a sheet that is bent.
pub const BEND_COLUMN: &str = "bend_force";

/// The columns of a place, with its name for `PLACE`: the force that it exerts on the sheet.
pub const PLACE_COLUMNS: [&str; 3] = ["force_PLACE_x", "force_PLACE_y", "force_PLACE_z"];

/// The table: a row for each frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ForceTable {
    /// Names of the places that are fixed, then of those that are pulled.
    pub places: Vec<String>,
    /// Whether the sheet is bent.
    pub bent: bool,
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
        let places = grips.into_iter().map(|grip| grip.name).collect();
        Ok(ForceTable { places, bent: plan.bend.is_some(), rows })
    }

    /// Names of the columns.
    pub fn columns(&self) -> Vec<String> {
        let of_places =
            self.places.iter().flat_map(|place| PLACE_COLUMNS.map(|column| column.replacen("PLACE", place, 1)));
        let bend = self.bent.then(|| BEND_COLUMN.to_owned());
        FORCE_COLUMNS.iter().map(|column| (*column).to_owned()).chain(bend).chain(of_places).collect()
    }
}

/// The table as text; numbers with the fewest digits that read back bit for bit, nothing where there is none.
pub fn write_forces(table: &ForceTable) -> String {
    let names: Vec<String> = table.columns().iter().map(|name| csv_text(name)).collect();
    let mut out = names.join(",") + "\n";
    for (frame, row) in table.rows.iter().enumerate() {
        let f = row.deformation.map(|[[xx, xy], [yx, yy]]| [xx, xy, yx, yy]);
        let f = (0..4).map(|k| f.map(|f| f[k]));
        let cells = [Some(row.share), row.stretch, row.mean_force].into_iter().chain(f);
        let cells = cells.chain([Some(row.energy), row.floor_force]).chain(table.bent.then_some(row.bend_force));
        let cells = cells.chain(row.forces.iter().flatten().copied().map(Some));
        let cells: Vec<String> = std::iter::once(frame.to_string()).chain(cells.map(csv_number)).collect();
        out += &(cells.join(",") + "\n");
    }
    out
}

/// Reads the table; `file` is the name to show in errors.
pub fn read_forces(file: &str, text: &str) -> Result<ForceTable, RecordError> {
    let (header, lines) = csv_lines(file, text)?;
    let bent = header.get(FORCE_COLUMNS.len()) == Some(BEND_COLUMN);
    let mut table = ForceTable { places: places(&header, bent), bent, rows: Vec::new() };
    let columns = table.columns();
    let wrong = (0..columns.len().max(header.len())).find(|&i| header.get(i) != columns.get(i).map(String::as_str));
    if let Some(i) = wrong {
        let expected = columns.get(i).map_or("no more, or three of a place".into(), |name| format!("\"{name}\""));
        let problem = format!("column {} is \"{}\", expected {expected}", i + 1, header.get(i).unwrap_or_default());
        return Err(RecordError::malformed(file, 1, problem));
    }
    for (frame, (line, cells)) in lines.iter().enumerate() {
        let found = row(&columns, bent, cells, frame);
        table.rows.push(found.map_err(|problem| RecordError::malformed(file, *line, problem))?);
    }
    Ok(table)
}

/// The places that a header names: what is between `force_` and `_x`.
fn places(header: &StringRecord, bent: bool) -> Vec<String> {
    let of = |name: &str| name.strip_prefix("force_")?.strip_suffix("_x").map(str::to_owned);
    header.iter().skip(FORCE_COLUMNS.len() + usize::from(bent)).step_by(3).map_while(of).collect()
}

fn row(columns: &[String], bent: bool, record: &StringRecord, frame: usize) -> Result<ForceRow, String> {
    if record.len() != columns.len() {
        return Err(format!("{} columns, expected {}", record.len(), columns.len()));
    }
    if record.get(0) != Some(&frame.to_string()) {
        return Err(format!("column frame: \"{}\" is not {frame}", record.get(0).unwrap_or_default()));
    }
    let cells = columns.iter().zip(record).skip(1).map(|(name, text)| match (text, text.parse::<f64>()) {
        ("", _) => Ok(None),
        (_, Ok(x)) if x.is_finite() => Ok(Some(x)),
        _ => Err(format!("column {name}: \"{text}\" is not a finite number")),
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
        bend_force: if bent { cells[9] } else { None },
        forces: (FORCE_COLUMNS.len() - 1 + usize::from(bent)..cells.len())
            .step_by(3)
            .map(place)
            .collect::<Result<_, String>>()?,
    })
}
