//! The kinematic Poisson ratio ν = −ln(1 + l2)/ln(1 + l1) at the limits with free width, against the direction of the pull.
//!
//! At a limit the width need not be unique: the ratio is then a bar between the values of the largest and the least l2, and a band
//! between neighbouring bars.

use super::chart::{Chart, Point, Series, legend_of_records};
use super::compare::{captions, differences, title};
use super::frame::{Frame, Layout};
use super::look::{self, Look};
use super::scale::Axis;
use crate::record::NamedRecord;
use maille::{answer::FreeRanges, record::LimitRow};

/// Below this l1 the ratio of the logarithms says nothing.
const LEAST_L1: f64 = 1e-4;

/// A sheet that is narrower than this share of its written width is called folded.
const FOLDED: f64 = 0.5;

/// Least and largest ratio of a row, where its width was free.
fn ratios(row: &LimitRow) -> Option<[f64; 2]> {
    let (l1, least, most) = (row.l1?, row.l2_min?, row.l2_max?);
    let free = row.lateral.as_deref() == Some("free") && l1 > LEAST_L1 && least > -1.0;
    let ends = if most - least < FreeRanges::ONE_VALUE { [0.5 * (least + most); 2] } else { [most, least] };
    free.then(|| ends.map(|l2| -l2.ln_1p() / l1.ln_1p()))
}

/// The widths of a limit.
#[derive(Clone, Copy, PartialEq)]
enum Widths {
    One,
    Range,
}

/// Those of a row with a ratio.
fn widths(row: &LimitRow) -> Option<Widths> {
    ratios(row).map(|[low, high]| if low == high { Widths::One } else { Widths::Range })
}

/// What limits the ratio is of: where the sheet is folded, no ratio of small strains.
fn folded(rows: &[LimitRow]) -> Option<String> {
    let shown: Vec<&LimitRow> = rows.iter().filter(|row| ratios(row).is_some()).collect();
    let width = |row: &LimitRow| row.l2_min.map_or(1.0, |l2| 1.0 + l2);
    let folded = shown.iter().filter(|row| width(row) < FOLDED).count();
    let narrowest = shown.iter().map(|row| width(row)).fold(1.0, f64::min);
    (folded > 0).then(|| {
        format!(
            "{folded} of {} limits are folded states, narrower than half the written width (down to {:.0} %): there the \
             ratio is of a fold, and not a Poisson ratio of small strains.",
            shown.len(),
            100.0 * narrowest
        )
    })
}

/// The plot of one record or several, as SVG; `None` where no limit has a free width.
pub fn poisson_svg(records: &[NamedRecord], layout: Layout) -> Option<String> {
    let (apart, labels) = differences(records);
    let looks = look::of_records(records.len());
    let (mut series, mut bars, mut bands) = (Vec::new(), Vec::new(), Vec::new());
    for (named, look) in records.iter().zip(&looks) {
        let mut rows: Vec<&LimitRow> = named.record.rows.iter().collect();
        rows.sort_by(|a, b| a.direction_deg.total_cmp(&b.direction_deg));
        // Between a direction with one width and one with a range nothing is known: no line joins them.
        for run in rows.chunk_by(|a, b| widths(a) == widths(b)) {
            let ends = |k: usize| {
                let point =
                    |row: &&LimitRow| Point { x: row.direction_deg, y: ratios(row).map(|r| r[k]), hollow: false };
                run.iter().map(point).collect::<Vec<_>>()
            };
            let (least, most) = (ends(0), ends(1));
            if widths(run[0]) == Some(Widths::Range) {
                let around = least.iter().chain(most.iter().rev()).copied().collect();
                bands.push((around, format!("{}40", look.color)));
                // A bar joins the two ends of a direction.
                let thin = Look { width: 1.2, dash: "", ..look.clone() };
                let bar = |(low, high): (&Point, &Point)| Series { look: thin.clone(), points: vec![*low, *high] };
                bars.extend(least.iter().zip(&most).map(bar));
                series.push(Series { look: look.clone(), points: most });
            }
            series.push(Series { look: look.clone(), points: least });
        }
    }
    let values: Vec<f64> = series.iter().flat_map(|s| &s.points).filter_map(|point| point.y).collect();
    if values.is_empty() {
        return None;
    }
    let rows: Vec<LimitRow> = records.iter().flat_map(|named| named.record.rows.clone()).collect();
    let mut caption = captions(records, &labels);
    caption.push("Bar: at this limit the width is not unique; the sheet was found at both ends.".into());
    caption.extend(folded(&rows));
    let directions: Vec<f64> = rows.iter().map(|row| row.direction_deg).collect();
    let frame = Frame {
        title: title(records),
        subtitle: "Kinematic Poisson ratio at the limit, width left to the sheet".into(),
        legend: legend_of_records(apart, &labels),
        caption,
    };
    let axes = [Axis::of_directions(&directions), Axis::linear(values.into_iter())];
    let names = ["Direction of the pull, counter-clockwise from x".into(), "ν = −ln(1 + l₂)/ln(1 + l₁)".into()];
    let chart = Chart::of_lines(frame, axes, names, series);
    Some(Chart { bands, bare: bars, gap: "no limit, or no free width", ..chart }.svg(layout))
}
