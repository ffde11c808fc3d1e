//! Made-up limits, for tests and pictures.

use maille::design::Design;
use maille::lattice::Cell;
use maille::record::{LimitRow, RECORD_SCHEMA, Status};
use maille::relaxation::limit::EnergyOptions;
use maille::survey::{MapQuestion, Method};
use maille_io::record::{Counters, NamedRecord, Record, RunRecord};

/// The built-in design 1.1.
pub fn design() -> Design {
    maille_io::read_design("1.1", maille_io::builtin("1.1").expect("built in")).expect("a valid file")
}

/// A row of the energy method; a `None` was not reached.
pub fn row(direction_deg: f64, l2: f64, l1: Option<f64>) -> LimitRow {
    LimitRow {
        design: "1.1".into(),
        minor_radius: Some(0.1),
        direction_deg,
        l2,
        method: "energy".into(),
        cell: "1x1".into(),
        status: if l1.is_some() { Status::ThresholdReached } else { Status::L2NotReached },
        l1,
        lambda1: l1.map(|l1| (1.0 + l1).powi(2)),
        ..LimitRow::default()
    }
}

/// Rows each 15°, from 0° to 180°.
pub fn turn(l2: f64, l1: impl Fn(f64) -> Option<f64>) -> Vec<LimitRow> {
    (0..=12).map(|i| 15.0 * f64::from(i)).map(|d| row(d, l2, l1(d))).collect()
}

/// A record of these rows, without states.
pub fn record(name: &str, design: Design, rows: Vec<LimitRow>) -> NamedRecord {
    let question = MapQuestion {
        method: Method::Energy(EnergyOptions { tau: 0.01, ..EnergyOptions::default() }),
        cells: Cell::PRIMITIVE.into(),
        directions_deg: rows.iter().map(|row| row.direction_deg).collect(),
        l2: rows.iter().map(|row| row.l2).collect(),
        extremes: false,
    };
    let run = RunRecord {
        schema: RECORD_SCHEMA,
        program_version: "0.1.0".into(),
        input_hash: "0".into(),
        design,
        curve_deviation: None,
        parameters: serde_json::json!(question),
        counters: Counters::of(&rows),
        files: Default::default(),
    };
    NamedRecord { name: name.into(), record: Record { run, rows, states: Vec::new() }, sensitivities: Vec::new() }
}
