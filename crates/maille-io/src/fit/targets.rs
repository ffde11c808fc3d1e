//! Targets of a fit from CSV: `direction_deg`, `l2`, one of `l1`, `at_least` and `at_most` or of `poisson_ratio`, `poisson_at_least` and
//! `poisson_at_most`, and `weight`; or the limits of a record.

use crate::{nearest::nearest, text_error::TextError};
use csv::{ReaderBuilder, StringRecord, Trim};
use maille::{
    fit::{Measure, Target, Wanted},
    record::Status,
};
use std::ops::Range;

const COLUMNS: [&str; 9] = [
    "direction_deg",
    "l2",
    "l1",
    "at_least",
    "at_most",
    "poisson_ratio",
    "poisson_at_least",
    "poisson_at_most",
    "weight",
];
const FORM: &str = "write a line direction_deg,l1 and below it lines such as 45,0.6; further columns are l2, at_least, at_most, poisson_ratio and weight";

/// Reads targets. A file with a column `status` is the limits.csv of a record: its limits are wanted, its other columns left aside.
///
/// # Errors
/// What is wrong, with its line: a column that is not known, a number that is none, a row that wants nothing or two things.
pub fn read_targets(name: &str, text: &str) -> Result<Vec<Target>, TextError> {
    let wrong = |at: usize, problem: String, help: &str| {
        TextError::new(name, text, line_at(text, at), problem, help.to_owned())
    };
    let mut reader =
        ReaderBuilder::new().trim(Trim::All).comment(Some(b'#')).flexible(true).from_reader(text.as_bytes());
    let header = reader.headers().map_err(|e| wrong(0, format!("is no table: {e}"), FORM))?.clone();
    let of_record = header.iter().any(|column| column == "status");
    if let Some(column) = header.iter().find(|column| !of_record && !COLUMNS.contains(column)) {
        let problem = format!("there is no column \"{column}\" in targets");
        let help = nearest(column, &COLUMNS).map_or(FORM.to_owned(), |near| format!("did you mean {near}?"));
        return Err(wrong(header_at(text), problem, &help));
    }
    if !header.iter().any(|column| column == "direction_deg") {
        return Err(wrong(header_at(text), "there is no column direction_deg".into(), FORM));
    }
    let mut out = Vec::new();
    for record in reader.records() {
        let record = record.map_err(|e| wrong(0, format!("cannot be read: {e}"), FORM))?;
        let at = record.position().map_or(0, |position| position.byte() as usize);
        let row = Row { header: &header, record: &record };
        match row.target(of_record) {
            Ok(target) => out.extend(target),
            Err((problem, help)) => return Err(wrong(skip_blank(text, at), problem, help)),
        }
    }
    if out.is_empty() {
        return Err(wrong(0, "there is no target".into(), FORM));
    }
    Ok(out)
}

/// The line of a byte.
fn line_at(text: &str, at: usize) -> Range<usize> {
    let at = at.min(text.len());
    let start = text[..at].rfind('\n').map_or(0, |k| k + 1);
    start..text[start..].find('\n').map_or(text.len(), |length| start + length)
}

/// Where the header stands: behind comments and empty lines.
fn header_at(text: &str) -> usize {
    let mut at = 0;
    for line in text.split_inclusive('\n') {
        if !line.trim().is_empty() && !line.starts_with('#') {
            break;
        }
        at += line.len();
    }
    at
}

/// A record's position is that of the comments and empty lines before it.
fn skip_blank(text: &str, at: usize) -> usize {
    at + text.get(at..).map_or(0, header_at)
}

struct Row<'a> {
    header: &'a StringRecord,
    record: &'a StringRecord,
}

type Wrong = (String, &'static str);

impl Row<'_> {
    fn text(&self, column: &str) -> Option<&str> {
        let k = self.header.iter().position(|name| name == column)?;
        self.record.get(k).filter(|text| !text.is_empty())
    }

    fn number(&self, column: &str) -> Result<Option<f64>, Wrong> {
        let Some(text) = self.text(column) else { return Ok(None) };
        match text.parse::<f64>() {
            Ok(x) if x.is_finite() => Ok(Some(x)),
            _ => Err((format!("{column}: \"{text}\" is not a number"), "give a number with a decimal point, as 0.25")),
        }
    }

    /// `None` for a row of a record that has no certified limit.
    fn target(&self, of_record: bool) -> Result<Option<Target>, Wrong> {
        if self.record.len() > self.header.len() {
            let problem = format!("{} values under {} columns", self.record.len(), self.header.len());
            return Err((problem, "separate values by commas, and write decimals with a point"));
        }
        if of_record && !self.text("status").is_some_and(is_certified) {
            return Ok(None);
        }
        let direction_deg = self.number("direction_deg")?.ok_or(("the row has no direction_deg".into(), FORM))?;
        let l2 = self.number("l2")?;
        let stretch = Measure::Stretch { direction_deg, l2: l2.unwrap_or(0.0) };
        let poisson_ratio = Measure::PoissonRatio { direction_deg };
        let mut wanted: Vec<(Measure, Wanted)> = Vec::new();
        let mut add = |column: &str, measure: Measure, of: fn(f64) -> Wanted| {
            wanted.extend(self.number(column)?.map(|value| (measure, of(value))));
            Ok(())
        };
        add("l1", stretch, Wanted::Value)?;
        if !of_record {
            add("at_least", stretch, Wanted::AtLeast)?;
            add("at_most", stretch, Wanted::AtMost)?;
            add("poisson_ratio", poisson_ratio, Wanted::Value)?;
            add("poisson_at_least", poisson_ratio, Wanted::AtLeast)?;
            add("poisson_at_most", poisson_ratio, Wanted::AtMost)?;
        }
        let [(measure, wanted)] = wanted[..] else {
            let problem = match wanted.len() {
                0 => "the row wants nothing".to_owned(),
                n => format!("the row wants {n} things of one limit"),
            };
            let help = "give one of l1, at_least, at_most, poisson_ratio, poisson_at_least and poisson_at_most; of two, write two rows";
            return Err((problem, help));
        };
        if measure == poisson_ratio && l2.is_some() {
            return Err((
                "the row gives an l2 for a Poisson ratio".into(),
                "leave l2 empty there: the width is left to the sheet",
            ));
        }
        let weight = if of_record { None } else { self.number("weight")? }.unwrap_or(1.0);
        if weight <= 0.0 {
            return Err((format!("weight: {weight} is not above 0"), "give a number above 0, or leave the row out"));
        }
        Ok(Some(Target { measure, wanted, weight }))
    }
}

fn is_certified(status: &str) -> bool {
    [Status::Global, Status::Local].iter().any(|certified| certified.name() == status)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_targets() {
        let text = "# a profile\n\ndirection_deg, l2, l1, at_least, at_most, weight\n0,,0.4,,,\n45, -0.1,,0.5,,2\n\n90,,,,0.3,\n";
        let found = read_targets("t.csv", text).unwrap();
        let of = |direction_deg, l2, wanted, weight| Target {
            measure: Measure::Stretch { direction_deg, l2 },
            wanted,
            weight,
        };
        let expected = [
            of(0.0, 0.0, Wanted::Value(0.4), 1.0),
            of(45.0, -0.1, Wanted::AtLeast(0.5), 2.0),
            of(90.0, 0.0, Wanted::AtMost(0.3), 1.0),
        ];
        assert_eq!(found, expected);
    }

    #[test]
    fn poisson_ratios_are_targets() {
        let text = "direction_deg,l1,poisson_ratio,poisson_at_most\n0,,0.4,\n45,,,1\n90,0.3,,\n";
        let found = read_targets("t.csv", text).unwrap();
        let [a, b] = [0.0, 45.0].map(|direction_deg| Measure::PoissonRatio { direction_deg });
        assert_eq!([found[0].measure, found[1].measure], [a, b]);
        assert_eq!([found[0].wanted, found[1].wanted], [Wanted::Value(0.4), Wanted::AtMost(1.0)]);
        assert_eq!(found[2].measure, Measure::Stretch { direction_deg: 90.0, l2: 0.0 });
    }

    #[test]
    fn limits_of_a_record_are_targets() {
        let text =
            "direction_deg,l2,status,l1,bound_l1\n0,0,global,0.44,0.44\n15,0,uncertified,,0.5\n30,0.1,local,0.2,0.9\n";
        let found = read_targets("limits.csv", text).unwrap();
        assert_eq!(found.len(), 2);
        assert_eq!(found[1].measure, Measure::Stretch { direction_deg: 30.0, l2: 0.1 });
        assert_eq!(found[1].wanted, Wanted::Value(0.2));
    }

    #[test]
    fn what_is_wrong_is_shown_at_its_line() {
        for (text, problem, line, help) in [
            ("", "no column direction_deg", "", "direction_deg,l1"),
            ("direction_deg,l1\n", "there is no target", "direction_deg,l1", "45,0.6"),
            ("direction,l1\n0,1\n", "no column \"direction\"", "direction,l1", "did you mean direction_deg?"),
            ("l2,l1\n0,1\n", "no column direction_deg", "l2,l1", "direction_deg"),
            ("direction_deg,l1\n0,0.1\n#\n45,x\n", "l1: \"x\" is not a number", "45,x", "decimal point"),
            ("direction_deg,l1\n0,0,1\n", "3 values under 2 columns", "0,0,1", "with a point"),
            ("direction_deg,l1\n0,\n", "wants nothing", "0,", "one of l1"),
            ("direction_deg,l1,at_most\n0,1,2\n", "wants 2 things", "0,1,2", "two rows"),
            ("direction_deg,l1\n,2\n", "no direction_deg", ",2", "direction_deg"),
            ("direction_deg,l2,poisson_ratio\n0,0.1,2\n", "an l2 for a Poisson ratio", "0,0.1,2", "left to the sheet"),
            ("direction_deg,l1,weight\n0,2,-1\n", "-1 is not above 0", "0,2,-1", "leave the row out"),
        ] {
            let error = read_targets("t.csv", text).unwrap_err();
            assert!(error.to_string().contains(problem), "{text}: {error}");
            assert!(error.help_text().contains(help), "{text}: {}", error.help_text());
            assert_eq!(error.at(), line, "{text}");
        }
    }
}
