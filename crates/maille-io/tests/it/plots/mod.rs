//! Plots: what stands in them, and that they can be drawn.

mod force;
mod page;
mod polar;
mod records;

use crate::common::rows::{self, design, record};
use maille::record::LimitRow;
use maille::search::ExactOptions;
use maille_io::record::NamedRecord;
use serde_json::json;

/// Rows of one l2, one of them without a limit.
pub(crate) fn turn(l2: f64, missing: f64) -> Vec<LimitRow> {
    rows::turn(l2, |d| (d != missing).then_some(0.44 - 0.2 * l2))
}

/// The same limits by two methods, and those of a smaller radius.
pub(crate) fn three() -> Vec<NamedRecord> {
    let by = |method: &str, r: f64, iterations: u64| {
        let mut rows = [turn(-0.125, 30.0), turn(0.0, 1.0)].concat();
        for row in &mut rows {
            (row.method, row.minor_radius) = (method.into(), Some(r));
            (row.iterations, row.wall_s) = (iterations, 0.001 * iterations as f64);
            row.l1 = row.l1.map(|l1| l1 + row.l2 * row.direction_deg / 180.0);
            row.lambda1 = row.l1.map(|l1| (1.0 + l1).powi(2));
        }
        let mut named = record(&format!("out/{method}-{r}"), design(), rows);
        if method == "exact" {
            let parameters = &mut named.record.run.parameters;
            (parameters["method"], parameters["options"]) = (method.into(), json!(ExactOptions::default()));
        }
        named
    };
    vec![by("exact", 0.1, 7), by("energy", 0.1, 1000), by("exact", 0.05, 9)]
}

/// Lines of curves: paths without a fill.
pub(crate) fn lines(svg: &str) -> Vec<&str> {
    svg.lines().filter(|line| line.starts_with("<path") && line.contains("fill=\"none\"")).collect()
}

pub(crate) fn attribute<'a>(line: &'a str, name: &str) -> &'a str {
    line.split(&format!(" {name}=\"")).nth(1).and_then(|rest| rest.split('"').next()).unwrap_or_default()
}

/// Value of an attribute of an SVG element.
pub(crate) fn number(element: &str, name: &str) -> f64 {
    let (_, rest) = element.split_once(&format!(" {name}=\"")).unwrap();
    rest.split_once('"').unwrap().0.parse().unwrap()
}
