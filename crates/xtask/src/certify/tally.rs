//! What came of one map, as a line of the table: statuses, verdicts, and how well symmetric directions agree.

use super::symmetry::Sheet;
use serde_json::Value;
use std::{collections::BTreeMap, fmt::Write as _};

/// The statuses that have a column, in its order.
const STATUSES: [&str; 10] = [
    "global",
    "local",
    "threshold-reached",
    "uncertified",
    "l2-unreachable",
    "l2-not-reached",
    "unbounded",
    "not-converged",
    "infeasible-start",
    "interrupted",
];
/// Directions that differ by less are one.
const SAME_DEG: f64 = 1e-6;

/// Worst first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Verdict {
    /// Some finding does not hold.
    False,
    /// Some finding could not be shown, or a certified row is not proved.
    Open,
    /// A certified row, and all of it is proved.
    Proved,
    /// A row that claims no certificate, with nothing against it.
    Unclaimed,
}

/// The outcome of one map.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tally {
    pub statuses: BTreeMap<String, usize>,
    pub rows: usize,
    pub proved: usize,
    pub open: usize,
    pub refuted: usize,
    pub unclaimed: usize,
    /// Kind and verdict of what is open or false, how often, and the first one's words.
    pub findings: BTreeMap<String, (usize, String)>,
    /// Each false row in words; findings of whole files are among them.
    pub told: Vec<String>,
    /// Pairs of symmetric directions whose l1 both stand there, and their largest difference.
    pub symmetric_pairs: usize,
    pub symmetric_difference: f64,
    /// Pairs of which one alone has an l1.
    pub symmetric_missing: usize,
}

impl Tally {
    /// Counts a table and a verification of one record, both as the program's JSON; an error names what is missing.
    pub fn of(table: &Value, verified: &Value) -> Result<Tally, String> {
        let mut out = Tally::default();
        let rows = table["rows"].as_array().ok_or("the table has no rows")?;
        for row in rows {
            let status = row["status"].as_str().ok_or("a row has no status")?;
            if !STATUSES.contains(&status) {
                return Err(format!("there is no column for the status `{status}`"));
            }
            *out.statuses.entry(status.to_owned()).or_default() += 1;
        }
        let design = &table["records"][0]["design"];
        let sheet = Sheet::read(design).ok_or("the table's record has no design")?;
        out.compare(rows, &sheet);
        let record = &verified["records"][0];
        out.findings_of("files", record["files"].as_array().ok_or("the verification has no findings of files")?)?;
        let reports = record["rows"].as_array().ok_or("the verification has no rows")?;
        out.rows = reports.len();
        for report in reports {
            let at = format!(
                "{}°, l2 = {}, {}",
                report["direction_deg"],
                report["l2"],
                report["status"].as_str().unwrap_or_default()
            );
            let worst = out.findings_of(&at, report["findings"].as_array().ok_or("a row has no findings")?)?;
            let certified = report["certified"].as_bool().ok_or("a row does not say whether it is certified")?;
            match verdict(worst, certified, report) {
                Verdict::False => out.refuted += 1,
                Verdict::Open => out.open += 1,
                Verdict::Proved => out.proved += 1,
                Verdict::Unclaimed => out.unclaimed += 1,
            }
        }
        Ok(out)
    }

    /// Notes what is open or false among `findings`; gives the worst.
    fn findings_of(&mut self, at: &str, findings: &[Value]) -> Result<Option<Verdict>, String> {
        let mut worst: Option<Verdict> = None;
        for finding in findings {
            let text = |key: &str| finding[key].as_str().ok_or_else(|| format!("a finding has no {key}"));
            let (check, word, words) = (text("check")?, text("verdict")?, text("words")?);
            let verdict = match word {
                "false" => Verdict::False,
                "open" => Verdict::Open,
                _ => continue,
            };
            worst = Some(worst.map_or(verdict, |before| before.min(verdict)));
            let entry = self.findings.entry(format!("{check} {word}")).or_insert_with(|| (0, words.to_owned()));
            entry.0 += 1;
            if verdict == Verdict::False {
                self.told.push(format!("{at}: {check}: {words}"));
            }
        }
        Ok(worst)
    }

    /// Compares each row with the rows of the same l2 along the images of its direction.
    fn compare(&mut self, rows: &[Value], sheet: &Sheet) {
        let number = |row: &Value, key: &str| row[key].as_f64();
        let rows: Vec<&Value> = rows.iter().filter(|row| row["status"] != "interrupted").collect();
        for (k, row) in rows.iter().enumerate() {
            let Some(direction_deg) = number(row, "direction_deg") else { continue };
            let images = sheet.images(direction_deg);
            for other in &rows[..k] {
                let Some(theirs) = number(other, "direction_deg") else { continue };
                let symmetric = images.iter().any(|image| apart_deg(*image, theirs) < SAME_DEG);
                if !symmetric || number(row, "l2") != number(other, "l2") {
                    continue;
                }
                match (number(row, "l1"), number(other, "l1")) {
                    (Some(mine), Some(its)) => {
                        self.symmetric_pairs += 1;
                        self.symmetric_difference = self.symmetric_difference.max((mine - its).abs());
                    }
                    (None, None) => {}
                    _ => self.symmetric_missing += 1,
                }
            }
        }
    }

    /// The worst of all findings, in a word.
    pub fn outcome(&self) -> &'static str {
        match () {
            () if !self.told.is_empty() => "false",
            () if !self.findings.is_empty() || self.open > 0 => "open",
            () => "proved",
        }
    }

    /// Names of the columns.
    pub fn columns() -> String {
        let mut out = String::from("rows");
        for status in STATUSES {
            let _ = write!(out, ",{}", status.replace('-', "_"));
        }
        out + ",proved,open,false,unclaimed,symmetric_pairs,symmetric_difference,symmetric_missing,findings"
    }

    /// Its fields, in the order of [`Tally::columns`].
    pub fn fields(&self) -> String {
        let mut out = self.rows.to_string();
        for status in STATUSES {
            let _ = write!(out, ",{}", self.statuses.get(status).copied().unwrap_or(0));
        }
        let _ = write!(out, ",{},{},{},{}", self.proved, self.open, self.refuted, self.unclaimed);
        let difference =
            if self.symmetric_pairs > 0 { format!("{:.1e}", self.symmetric_difference) } else { String::new() };
        let _ = write!(out, ",{},{difference},{}", self.symmetric_pairs, self.symmetric_missing);
        let findings: Vec<String> =
            self.findings.iter().map(|(of, (count, words))| format!("{of}: {count} ({words})")).collect();
        out + "," + &quoted(&findings.join("; "))
    }
}

/// A row is proved as `maille verify` counts it: certified, and all four derived checks hold.
fn verdict(worst: Option<Verdict>, certified: bool, report: &Value) -> Verdict {
    let holds = |check: &str| {
        let findings = report["findings"].as_array().into_iter().flatten();
        findings.filter(|f| f["check"] == check).any(|f| f["verdict"] == "proved")
    };
    match worst {
        Some(worst) => worst,
        None if !certified => Verdict::Unclaimed,
        None if ["deformation", "overlap", "links", "balance"].into_iter().all(holds) => Verdict::Proved,
        None => Verdict::Open,
    }
}

/// Angle between two lines.
fn apart_deg(a: f64, b: f64) -> f64 {
    let turn = (a - b).rem_euclid(180.0);
    turn.min(180.0 - turn)
}

/// A field of a CSV file.
pub fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn row(direction_deg: f64, l2: f64, status: &str, l1: Option<f64>) -> Value {
        json!({ "direction_deg": direction_deg, "l2": l2, "status": status, "l1": l1 })
    }

    /// A rectangular sheet of flat rings: mirror lines along x and y.
    fn table(rows: Vec<Value>) -> Value {
        let element =
            json!({ "center": [0.0, 0.0, 0.0], "rings": [{ "major_radius": 1.0, "normal": [0.0, 0.0, 1.0] }] });
        let lattice = json!({ "a1": [2.5, 0.0, 0.0], "a2": [0.0, 3.0, 0.0] });
        let design = json!({ "reference_radius": 1.0, "minor_radius": 0.1, "lattice": lattice, "elements": [element] });
        json!({ "records": [{ "design": design }], "rows": rows })
    }

    fn report(status: &str, verdicts: [&str; 4]) -> Value {
        let checks = ["deformation", "overlap", "links", "balance"].into_iter().zip(verdicts);
        let findings: Vec<Value> = checks
            .map(|(check, verdict)| json!({ "check": check, "verdict": verdict, "words": format!("{check}, so") }))
            .collect();
        let certified = ["global", "local"].contains(&status);
        json!({ "direction_deg": 0.0, "l2": 0.0, "status": status, "certified": certified, "findings": findings })
    }

    #[test]
    fn rows_are_counted_by_their_worst_finding() {
        let all = ["proved"; 4];
        let reports = [
            report("global", all),
            report("local", ["proved", "proved", "proved", "false"]),
            report("local", ["proved", "open", "proved", "proved"]),
            report("local", ["proved", "proved", "proved", "consistent"]),
            report("uncertified", ["proved", "proved", "proved", "consistent"]),
            report("uncertified", ["false", "open", "proved", "consistent"]),
        ];
        let verified = json!({ "records": [{ "files": [], "rows": reports }] });
        let rows = vec![row(0.0, 0.0, "global", Some(0.5)), row(10.0, 0.0, "local", None)];
        let tally = Tally::of(&table(rows.clone()), &verified).unwrap();
        assert_eq!((tally.rows, tally.proved, tally.open, tally.refuted, tally.unclaimed), (6, 1, 2, 2, 1));
        assert_eq!(
            tally.told,
            [
                "0.0°, l2 = 0.0, local: balance: balance, so",
                "0.0°, l2 = 0.0, uncertified: deformation: deformation, so"
            ]
        );
        let columns = Tally::columns();
        let names: Vec<&str> = columns.split(',').collect();
        let fields = tally.fields();
        let values: Vec<&str> = fields.splitn(names.len(), ',').collect();
        let value = |name: &str| values[names.iter().position(|n| *n == name).unwrap()];
        assert_eq!(
            [value("rows"), value("global"), value("local"), value("false"), value("symmetric_difference")],
            ["6", "1", "1", "2", ""]
        );
        assert!(value("findings").starts_with("\"balance false: 1 (balance, so); deformation false: 1 "), "{fields}");
        // A false file refutes the record though no row is false.
        let damaged = json!([{ "check": "files", "verdict": "false", "words": "edited" }]);
        let of_files = json!({ "records": [{ "files": damaged, "rows": [] }] });
        let outcome = |record: &Value| Tally::of(&table(rows.clone()), record).unwrap().outcome();
        assert_eq!([outcome(&verified), outcome(&of_files)], ["false", "false"]);
        let sound = json!({ "records": [{ "files": [], "rows": [report("global", all)] }] });
        let doubtful = json!({ "records": [{ "files": [], "rows": [report("local", ["proved", "proved", "proved", "consistent"])] }] });
        assert_eq!([outcome(&sound), outcome(&doubtful)], ["proved", "open"]);
        assert!(Tally::of(&table(vec![row(0.0, 0.0, "new", None)]), &verified).is_err());
        assert!(Tally::of(&json!({}), &verified).is_err());
    }

    #[test]
    fn symmetric_directions_are_compared() {
        let verified = json!({ "records": [{ "files": [], "rows": [] }] });
        let rows = vec![
            row(30.0, 0.0, "local", Some(0.25)),
            row(150.0, 0.0, "local", Some(0.75)),
            row(150.0, 0.1, "local", Some(9.0)),
            row(60.0, 0.0, "local", Some(7.0)),
            row(0.0, 0.0, "local", Some(1.0)),
            row(180.0, 0.0, "l2-not-reached", None),
            row(150.0, 0.0, "interrupted", None),
        ];
        let tally = Tally::of(&table(rows), &verified).unwrap();
        assert_eq!((tally.symmetric_pairs, tally.symmetric_missing), (1, 1));
        assert!((tally.symmetric_difference - 0.5).abs() < 1e-12);
    }
}
