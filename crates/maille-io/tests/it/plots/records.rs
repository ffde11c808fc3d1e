//! Plots of several records, and of their quantities.

use super::attribute;
use super::lines;
use super::three;
use super::turn;
use crate::common::rows::design;
use crate::common::rows::record;
use maille::record::LimitRow;
use maille::record::Status;
use maille_io::Quantity;
use maille_io::plot::Cost;
use maille_io::plot::Layout;
use maille_io::plot::PolarPlot;
use maille_io::plot::cost_svg;
use maille_io::plot::difference_svg;
use maille_io::plot::poisson_svg;
use maille_io::plot::polar_svg;
use maille_io::plot::radius_svg;
use maille_io::record::NamedRecord;
use maille_svg::svg_to_png;

#[test]
fn several_records_differ_in_colour_and_in_line() {
    let records = three();
    let plot = PolarPlot::from_records(&records, Quantity::Stretch);
    let (apart, labels) = &plot.records;
    assert_eq!(apart, "r, method");
    assert_eq!(labels, &["r = 0.1, exact", "r = 0.1, energy", "r = 0.05, exact"]);
    assert_eq!(plot.curves.len(), 6);
    let svg = polar_svg(&plot, Layout::Beside);
    // One curve of each record has two gaps, at 30° and 210°.
    assert_eq!(lines(&svg).len(), 9);
    let mut styles: Vec<_> =
        lines(&svg).iter().map(|line| (attribute(line, "stroke"), attribute(line, "stroke-dasharray"))).collect();
    styles.sort();
    styles.dedup();
    assert_eq!(styles.len(), 3);
    assert!(styles.windows(2).all(|w| w[0].0 != w[1].0 && w[0].1 != w[1].1), "{styles:?}");
    for text in labels.iter().map(String::as_str).chain(["−0.125", "0"]) {
        assert_eq!(svg.matches(&format!(">{text}<")).count(), 1, "{text}");
    }
    assert!(svg.contains("r = 0.1, exact: 1 of 26 searches gave no limit (1 l2-not-reached)"));
    svg_to_png(&svg, 1.0).unwrap();
}

#[test]
fn legends_name_what_differs_and_folders_at_last() {
    let heading = |records: &[NamedRecord]| PolarPlot::from_records(records, Quantity::L1).records;
    let two = |change: fn(&mut NamedRecord)| {
        let first = record("out/a", design(), turn(0.0, 1.0));
        let mut second = NamedRecord { name: "out/b".into(), ..first.clone() };
        change(&mut second);
        heading(&[first, second])
    };
    let labels = |a: &str, b: &str| vec![a.to_owned(), b.to_owned()];
    assert_eq!(two(|_| {}), ("Record".into(), labels("a", "b")));
    assert_eq!(two(|b| b.record.run.design.name = "3.1".into()), ("Design".into(), labels("1.1", "3.1")));
    assert_eq!(
        two(|b| b.record.run.parameters["options"]["tau"] = 0.02.into()),
        ("Parameters".into(), labels("τ = 0.01", "τ = 0.02"))
    );
    let cell = |b: &mut NamedRecord| b.record.rows.iter_mut().for_each(|row| row.cell = "2x1".into());
    assert_eq!(two(cell), ("Cell".into(), labels("cell 1 × 1", "cell 2 × 1")));
}

#[test]
fn differences_are_largest_less_smallest_limit() {
    let records = &three()[..1];
    // l1 runs from 0.465 − 0 down to 0.465 − 0.125 at l2 = −0.125, and is 0.44 everywhere at 0.
    let places = |spread: Quantity| {
        let svg = difference_svg(records, spread, Layout::Beside);
        let d = attribute(lines(&svg)[0], "d").to_owned();
        let y = d[1..].split('L').map(|p| p.split(' ').nth(1).unwrap().parse::<f64>().unwrap()).collect::<Vec<_>>();
        (522.0 - y[0], 522.0 - y[1], svg)
    };
    // Axes from 0 to 0.15 and to 0.4, over 400 units.
    let (high, low, svg) = places(Quantity::L1);
    assert!((high / 400.0 * 0.15 - 0.125).abs() < 1e-4 && low == 0.0, "{high} {low}");
    assert!(svg.contains("Largest less smallest l₁ of all directions"));
    assert!(svg.contains(">some directions have no limit<"));
    let (high, low, svg) = places(Quantity::Lambda1);
    let wanted = 1.465f64.powi(2) - 1.34f64.powi(2);
    assert!((high / 400.0 * 0.4 - wanted).abs() < 1e-3 && low == 0.0, "{high} {low} {wanted}");
    assert!(svg.contains("λ₁ − 1") && svg.contains("larger eigenvalue"));
}

#[test]
fn steps_and_times_have_a_curve_for_each_record_and_l2() {
    let records = three();
    for (svg, unit) in [
        (cost_svg(&records, Cost::Steps, Layout::Beside), "Iterations, logarithmic"),
        (cost_svg(&records, Cost::WallTime, Layout::Beside), "in seconds, logarithmic"),
    ] {
        assert_eq!(lines(&svg).len(), 6);
        assert!(svg.contains(unit) && svg.contains(">180°<") && svg.contains(">r = 0.05, exact<"));
        svg_to_png(&svg, 1.0).unwrap();
    }
    assert!(cost_svg(&records, Cost::WallTime, Layout::Beside).contains("r = 0.1, energy 26.000 s"));
    let one = cost_svg(&records[..1], Cost::Steps, Layout::Beside);
    assert_eq!(lines(&one).len(), 2);
    assert!(one.contains(">Iterations<") && one.contains("quadratic programs") && !one.contains("Newton"));
}

/// Ten records: what they share is said once, and nothing that the legend says is said again.
#[test]
fn notes_say_each_thing_once() {
    let of_radius = |k: usize| {
        let radius = 0.01 * (k + 1) as f64;
        let rows = turn(0.0, if k < 2 { 30.0 } else { 1.0 });
        let rows = rows.into_iter().map(|row| LimitRow { minor_radius: Some(radius), ..row }).collect();
        record(&format!("out/{k}"), design(), rows)
    };
    let records: Vec<_> = (0..10).map(of_radius).collect();
    let plot = PolarPlot::from_records(&records, Quantity::L1);
    assert_eq!(plot.records.1[4], "r = 0.05");
    assert!(plot.caption.len() <= 3, "{:?}", plot.caption);
    let all = plot.caption.join("\n");
    assert_eq!(all.matches("energy method").count(), 1);
    assert!(!all.contains("r/R") && !all.contains("r = 0.05"), "{all}");
    assert!(
        all.contains("Gaps: r = 0.01: 1 of 13 searches gave no limit (1 l2-not-reached); r = 0.02: 1 of 13"),
        "{all}"
    );
}

/// Limits against the radius: the points of a curve are in the order of the radius, whatever that of the records.
#[test]
fn limits_are_drawn_against_the_radius() {
    let of_radius = |radius: f64, bound: f64| {
        let change = |row: LimitRow| LimitRow {
            minor_radius: Some(radius),
            l1: row.l1.map(|l1| l1 - radius),
            bound_l1: Some(bound - radius),
            bound_gap: Some(bound - 0.44),
            status: if radius > 0.1 { Status::Local } else { Status::Global },
            ..row
        };
        let keep = |row: &LimitRow| row.direction_deg == 0.0 || row.direction_deg == 45.0;
        let rows = turn(0.0, if radius == 0.2 { 45.0 } else { 1.0 }).into_iter().filter(keep).map(change).collect();
        record(&format!("out/{radius}"), design(), rows)
    };
    let records = [0.2, 0.05, 0.15].map(|radius| of_radius(radius, 0.445));
    let svg = radius_svg(&records, Quantity::L1, Layout::Beside).unwrap();
    for words in
        [">0°<", ">45°<", "Minor radius / reference radius", ">proven bound<", ">not proved (local)<", ">no limit<"]
    {
        assert!(svg.contains(words), "{words} is not in {svg}");
    }
    // Two bounds, then the limits: 0° with three radii, 45° with two.
    let points = |line: &&str| attribute(line, "d").matches(['M', 'L']).count();
    assert_eq!(lines(&svg).iter().map(points).collect::<Vec<_>>(), [3, 3, 3, 2]);
    let x: Vec<f64> =
        attribute(lines(&svg)[2], "d").split(['M', 'L', ' ']).filter_map(|x| x.parse().ok()).step_by(2).collect();
    assert!(x[0] < x[1] && x[1] < x[2], "{x:?}");
    let far = [0.2, 0.05, 0.15].map(|radius| of_radius(radius, 0.9));
    let far = radius_svg(&far, Quantity::L1, Layout::Beside).unwrap();
    assert!(lines(&far).len() == 2 && far.contains(">proven bound, cut off at the edge<"), "{far}");
    assert!(radius_svg(&records[..1], Quantity::L1, Layout::Beside).is_none());
    // What a study varies beside the radius tells curves apart.
    let mut spaced = records.to_vec();
    spaced.extend([0.05, 0.15].map(|radius| {
        let mut of = of_radius(radius, 0.445);
        of.record.run.design = of.record.run.design.spaced(0.95);
        of
    }));
    let svg = radius_svg(&spaced, Quantity::L1, Layout::Beside).unwrap();
    assert!(svg.contains(">0°, as written<") && svg.contains(">0°, spacing 0.95<"), "{svg}");
    svg_to_png(&svg, 1.0).unwrap();
}

/// A width that is not unique is a bar from end to end; a folded sheet is called one.
#[test]
fn a_free_width_is_a_bar() {
    let of = |least: f64, most: f64| {
        let free =
            |row: LimitRow| LimitRow { lateral: Some("free".into()), l2_min: Some(least), l2_max: Some(most), ..row };
        let rows = turn(0.0, 30.0).into_iter().map(free).collect();
        poisson_svg(&[record("a", design(), rows)], Layout::Beside).unwrap()
    };
    let bars = |svg: &str| {
        let vertical = |line: &&&str| {
            let d: Vec<f64> = attribute(line, "d").split(['M', 'L', ' ']).filter_map(|x| x.parse().ok()).collect();
            d.len() == 4 && d[0] == d[2]
        };
        lines(svg).iter().filter(vertical).count()
    };
    let (wide, narrow) = (of(-0.7, 0.2), of(-0.1004, -0.1));
    assert_eq!((bars(&wide), bars(&narrow)), (12, 0));
    assert!(wide.contains("12 of 12 limits are folded states") && wide.contains("30 %"));
    assert!(!narrow.contains("folded") && wide.contains(">no limit, or no free width<"));

    // One range between single widths: no line leads to its bar, and no band.
    let free = |(k, row): (usize, LimitRow)| {
        let least = if k == 6 { -0.7 } else { 0.2 };
        LimitRow { lateral: Some("free".into()), l2_min: Some(least), l2_max: Some(0.2), ..row }
    };
    let rows = turn(0.0, 15.0).into_iter().enumerate().map(free).collect();
    let mixed = poisson_svg(&[record("a", design(), rows)], Layout::Beside).unwrap();
    assert_eq!(bars(&mixed), 1);
    let x = |line: &&str| -> Vec<f64> {
        attribute(line, "d").split(['M', 'L', ' ']).filter_map(|x| x.parse().ok()).step_by(2).collect()
    };
    let all = lines(&mixed);
    let bar = all.iter().map(x).find(|x| x.len() == 2 && x[0] == x[1]).unwrap()[0];
    assert!(all.iter().map(x).filter(|x| x.contains(&bar)).all(|x| x.iter().all(|other| *other == bar)));
}

#[test]
fn every_kind_is_drawn_without_rows() {
    let empty = [record("a", design(), Vec::new()), record("b", design(), Vec::new())];
    for records in [&empty[..1], &empty[..]] {
        let polar = polar_svg(&PolarPlot::from_records(records, Quantity::L1), Layout::Beside);
        for svg in [
            polar,
            difference_svg(records, Quantity::L1, Layout::Beside),
            cost_svg(records, Cost::Steps, Layout::Beside),
            cost_svg(records, Cost::WallTime, Layout::Beside),
        ] {
            assert!(!svg.contains("NaN") && !svg.contains("inf"));
            svg_to_png(&svg, 1.0).unwrap();
        }
    }
}
