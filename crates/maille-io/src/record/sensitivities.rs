//! `sensitivities.csv`: derivatives of the limits of a record, see `docs/record.md`.

use super::{
    csv::{csv_lines, csv_number, csv_text},
    error::RecordError,
};

/// Columns of the table.
pub const SENSITIVITY_COLUMNS: [&str; 5] = ["direction_deg", "l2", "number", "derivative", "derivative_back"];

/// The derivatives of one limit by one number of the design.
#[derive(Clone, Debug, PartialEq)]
pub struct SensitivityRow {
    /// Direction of the limit's row.
    pub direction_deg: f64,
    /// l2 of the limit's row.
    pub l2: f64,
    /// `minor_radius`, `spacing`, or `parameters.` and the name of a parameter of the file.
    pub number: String,
    /// dl1 by the number for a step forward; `None` where no state is left, or it was not found.
    pub derivative: Option<f64>,
    /// The same for a step back: l1 falls by this times the step.
    pub derivative_back: Option<f64>,
}

/// The table as text; numbers with the fewest digits that read back bit for bit.
pub fn write_sensitivities(rows: &[SensitivityRow]) -> String {
    let mut out = SENSITIVITY_COLUMNS.join(",") + "\n";
    for row in rows {
        let [direction, l2] = [row.direction_deg, row.l2].map(|x| csv_number(Some(x)));
        let [forward, back] = [row.derivative, row.derivative_back].map(csv_number);
        out += &format!("{direction},{l2},{},{forward},{back}\n", csv_text(&row.number));
    }
    out
}

/// Reads the table; `file` is the name to show in errors.
pub fn read_sensitivities(file: &str, text: &str) -> Result<Vec<SensitivityRow>, RecordError> {
    let (header, lines) = csv_lines(file, text)?;
    if header.iter().ne(SENSITIVITY_COLUMNS) {
        let problem = format!("the header is not {}", SENSITIVITY_COLUMNS.join(","));
        return Err(RecordError::malformed(file, 1, problem));
    }
    let row = |(line, cells): (usize, ::csv::StringRecord)| {
        let cell = |k: usize| cells.get(k).unwrap_or_default();
        let number = |k: usize| match cell(k).parse::<f64>() {
            _ if cell(k).is_empty() => Ok(None),
            Ok(x) if x.is_finite() => Ok(Some(x)),
            _ => {
                let problem = format!("column {}: \"{}\" is not a finite number", SENSITIVITY_COLUMNS[k], cell(k));
                Err(RecordError::malformed(file, line, problem))
            }
        };
        let there = |k: usize| {
            let empty = || RecordError::malformed(file, line, format!("column {} is empty", SENSITIVITY_COLUMNS[k]));
            number(k)?.ok_or_else(empty)
        };
        if cells.len() != SENSITIVITY_COLUMNS.len() {
            let problem = format!("{} columns, expected {}", cells.len(), SENSITIVITY_COLUMNS.len());
            return Err(RecordError::malformed(file, line, problem));
        }
        Ok(SensitivityRow {
            direction_deg: there(0)?,
            l2: there(1)?,
            number: cell(2).to_owned(),
            derivative: number(3)?,
            derivative_back: number(4)?,
        })
    };
    lines.into_iter().map(row).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_reads_back_and_a_wrong_one_is_refused() {
        let row = SensitivityRow {
            direction_deg: 30.0,
            l2: -0.05,
            number: "parameters.play".into(),
            derivative: Some(-1.0 / 3.0),
            derivative_back: None,
        };
        let text = write_sensitivities(std::slice::from_ref(&row));
        assert_eq!(read_sensitivities("s", &text).unwrap(), [row]);
        for (from, to, problem) in [
            ("number,", "name,", "s:1: the header is not"),
            ("-0.3333333333333333", "NaN", "s:2: column derivative: \"NaN\" is not a finite number"),
            ("30.0", "", "s:2: column direction_deg is empty"),
            ("play,", "play,1,", "s:2: 6 columns, expected 5"),
        ] {
            let error = read_sensitivities("s", &text.replace(from, to)).unwrap_err().to_string();
            assert!(error.starts_with(problem), "{error}");
        }
    }
}
