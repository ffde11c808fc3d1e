//! Plots: what stands in them, and that they can be drawn.

use maille::design::Design;
use maille::record::{LimitRow, Status};
use maille_io::plot::{Curve, CurveKind, PolarPlot, Quantity, polar_svg, svg_to_png};

fn design() -> Design {
    maille_io::read_design("1.1", maille_io::builtin("1.1").unwrap()).unwrap()
}

fn row(direction_deg: f64, l2: f64, l1: Option<f64>) -> LimitRow {
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
        lambda2: None,
        stretch1: None,
        stretch2: None,
        max_overlap: None,
        min_gap: None,
        iterations: 0,
        runs: 0,
        wall_s: 0.0,
        ..LimitRow::default()
    }
}

fn turn(l2: f64, missing: f64) -> impl Iterator<Item = LimitRow> {
    let l1 = move |d: f64| (d != missing).then_some(0.44 - 0.2 * l2);
    (0..=12).map(|i| 15.0 * f64::from(i)).map(move |d| row(d, l2, l1(d)))
}

#[test]
fn the_plot_says_what_it_shows() {
    let rows: Vec<_> = turn(0.125, 30.0).chain(turn(-0.125, 1.0)).chain(turn(0.0, 1.0)).collect();
    let plot = PolarPlot::from_rows(&design(), &rows, Quantity::Stretch, &["τ = 0.01".into()]);
    let labels: Vec<_> = plot.curves.iter().map(|c| c.label.as_str()).collect();
    assert_eq!(labels, ["−0.125", "0", "0.125"]);
    assert_eq!(plot.caption[0], "r = 0.1 (r/R = 0.1)  ·  energy method  ·  cell 1 × 1  ·  τ = 0.01");
    assert!(plot.caption[1].starts_with("13 directions computed, 0° to 180°."));
    assert_eq!(plot.caption[2], "Gaps: 1 of 39 searches gave no limit (1 l2-not-reached).");
    let svg = polar_svg(&plot);
    for text in ["1.1 · Cartesian grid of rings", ">330°<", ">1.4<", "Radius: 1 + l₁", "centre 1.0: undeformed"] {
        assert!(svg.contains(text), "{text}");
    }
}

#[test]
fn each_quantity_has_its_centre() {
    let rows: Vec<_> = turn(0.0, 1.0).collect();
    let values = |quantity| PolarPlot::from_rows(&design(), &rows, quantity, &[]).curves[0].values().next().unwrap();
    assert_eq!(values(Quantity::Stretch), 1.44);
    assert_eq!(values(Quantity::L1), 0.44);
    assert!((values(Quantity::Lambda1) - (1.44 * 1.44 - 1.0)).abs() < 1e-12);
}

#[test]
fn a_missing_limit_opens_the_curve() {
    let paths = |rows: Vec<LimitRow>| {
        let svg = polar_svg(&PolarPlot::from_rows(&design(), &rows, Quantity::L1, &[]));
        svg.lines()
            .filter(|line| line.starts_with("<path") && line.contains("fill=\"none\""))
            .map(str::to_owned)
            .collect::<Vec<_>>()
    };
    let closed = paths(turn(0.0, 1.0).collect());
    assert_eq!(closed.len(), 1);
    assert!(closed[0].contains("Z\""));
    let open = paths(turn(0.0, 30.0).collect());
    assert_eq!(open.len(), 2);
    assert!(open.iter().all(|path| !path.contains("Z\"")));
}

#[test]
fn below_zero_the_axis_moves_its_origin() {
    let mut rows: Vec<_> = turn(0.0, 1.0).collect();
    rows[3].l1 = Some(-0.15);
    let svg = polar_svg(&PolarPlot::from_rows(&design(), &rows, Quantity::L1, &[]));
    assert!(svg.contains("dotted circle 0.0: undeformed") && svg.contains("centre −0.2"));
}

#[test]
fn plots_without_limits_and_with_odd_texts_are_drawn() {
    let mut design = design();
    design.title = "R&D <sheet>\u{1}".into();
    let none: Vec<_> = turn(0.0, 1.0).map(|row| LimitRow { l1: None, status: Status::Unbounded, ..row }).collect();
    for rows in [&[][..], &none] {
        let svg = polar_svg(&PolarPlot::from_rows(&design, rows, Quantity::Stretch, &[]));
        assert!(svg.contains("R&amp;D &lt;sheet&gt;"));
        svg_to_png(&svg, 1.0).unwrap();
    }
}

#[test]
fn a_bound_is_dashed_and_has_no_markers() {
    let mut plot = PolarPlot::from_rows(&design(), &[], Quantity::L1, &[]);
    let points: Vec<_> = (0..180).map(|d| (f64::from(d), Some(0.5))).collect();
    plot.curves.push(Curve::new("bound", 0.0, CurveKind::Bound, &points));
    let svg = polar_svg(&plot);
    assert!(svg.contains("stroke-dasharray=\"5 4\"") && !svg.contains("fill=\"#222222\" stroke=\"#222222\""));
}

#[test]
fn the_picture_has_the_size_asked_for_and_is_not_blank() {
    let svg = polar_svg(&PolarPlot::from_rows(&design(), &turn(0.0, 1.0).collect::<Vec<_>>(), Quantity::Stretch, &[]));
    let size = |png: &[u8]| {
        let pixmap = resvg::tiny_skia::Pixmap::decode_png(png).unwrap();
        let dark = pixmap.pixels().iter().filter(|p| p.red() < 128).count();
        assert!(dark > 1000, "{dark} dark pixels");
        pixmap.width()
    };
    assert_eq!(size(&svg_to_png(&svg, 1.0).unwrap()), 860);
    assert_eq!(size(&svg_to_png(&svg, 2.0).unwrap()), 1720);
    assert!(svg_to_png(&svg, 0.0).is_err());
    assert!(svg_to_png("<nonsense", 1.0).is_err());
}

#[test]
fn every_letter_of_the_plot_is_in_the_font() {
    // A letter that the font lacks would be drawn as nothing or as a box: compare with text that has none.
    let draw = |text: &str| {
        let svg = format!(
            "<svg xmlns='http://www.w3.org/2000/svg' width='40' height='40'><text x='5' y='30' font-size='24' font-family='DejaVu Sans'>{text}</text></svg>"
        );
        svg_to_png(&svg, 1.0).unwrap()
    };
    let (nothing, unknown) = (draw(""), draw("\u{4e2d}"));
    for letter in "λτθ₁₂−·×°ᵀéßλ≤≥".chars() {
        let drawn = draw(&letter.to_string());
        assert!(drawn != nothing && drawn != unknown, "{letter}");
    }
}
