//! Plots: what stands in them, and that they can be drawn.

#[path = "common/rows.rs"]
mod rows;

use maille::record::{ForceRow, LimitRow, Status};
use maille::relaxation::simulate::End;
use maille::search::ExactOptions;
use maille_io::record::{ForceTable, NamedRecord, SimulationRecord};
use maille_io::{
    Quantity,
    plot::{
        Cost, Curve, CurveKind, Layout, NamedSimulation, Paper, PolarPlot, cost_svg, difference_svg, force_svg,
        outlined_svg, poisson_svg, polar_svg, radius_svg, svg_to_pdf, svg_to_png,
    },
};
use rows::{design, record};
use serde_json::json;

/// Rows of one l2, one of them without a limit.
fn turn(l2: f64, missing: f64) -> Vec<LimitRow> {
    rows::turn(l2, |d| (d != missing).then_some(0.44 - 0.2 * l2))
}

#[test]
fn the_plot_says_what_it_shows() {
    let rows: Vec<_> = [turn(0.125, 30.0), turn(-0.125, 1.0), turn(0.0, 1.0)].concat();
    let plot = PolarPlot::from_rows(&design(), &rows, Quantity::Stretch, &["τ = 0.01".into()]);
    assert_eq!(plot.curves.iter().map(|c| c.l2).collect::<Vec<_>>(), [-0.125, 0.0, 0.125]);
    assert_eq!(plot.caption[0], "r = 0.1 (r/R = 0.1)  ·  energy method  ·  cell 1 × 1  ·  τ = 0.01");
    assert!(plot.caption[1].starts_with("13 directions computed, 0° to 180°."));
    assert_eq!(plot.caption[2], "Gaps: 1 of 39 searches gave no limit (1 l2-not-reached).");
    let svg = polar_svg(&plot, Layout::Beside);
    for text in [
        "1.1 · Cartesian grid of rings",
        ">330°<",
        ">1.4<",
        "Radius: 1 + l₁",
        "centre 1.0: undeformed",
        ">−0.125<",
        ">0<",
        ">0.125<",
    ] {
        assert!(svg.contains(text), "{text}");
    }
}

/// Limits that still grow with the cell are named, up to six of each l2; those that do not, or have no limit, are not.
#[test]
fn limits_that_grow_with_the_cell_are_named() {
    let grow = |row: LimitRow, grows: bool| LimitRow { grows_with_cell: Some(grows), ..row };
    let rows: Vec<_> = turn(-0.125, 30.0).into_iter().map(|row| grow(row.clone(), row.direction_deg <= 45.0)).collect();
    let rows = [rows, turn(0.0, 1.0).into_iter().map(|row| grow(row, true)).collect()].concat();
    let plot = PolarPlot::from_rows(&design(), &rows, Quantity::Stretch, &[]);
    let said = plot.caption.last().unwrap();
    assert_eq!(
        said,
        "Still grows with the cell, so that larger cells may go further: 0°, 15°, 45° at l₂ = −0.125; 0°, 15°, 30°, 45°, 60°, 75° \
         and 7 more at l₂ = 0."
    );
    let plot = PolarPlot::from_rows(&design(), &turn(0.0, 1.0), Quantity::Stretch, &[]);
    assert!(plot.caption.iter().all(|line| !line.contains("grows")));
}

#[test]
fn each_quantity_has_its_centre() {
    let rows = turn(0.0, 1.0);
    let values = |quantity| PolarPlot::from_rows(&design(), &rows, quantity, &[]).curves[0].values().next().unwrap();
    assert_eq!(values(Quantity::Stretch), 1.44);
    assert_eq!(values(Quantity::L1), 0.44);
    assert!((values(Quantity::Lambda1) - (1.44 * 1.44 - 1.0)).abs() < 1e-12);
}

#[test]
fn a_missing_limit_opens_the_curve() {
    let paths = |rows: Vec<LimitRow>| {
        let svg = polar_svg(&PolarPlot::from_rows(&design(), &rows, Quantity::L1, &[]), Layout::Beside);
        svg.lines()
            .filter(|line| line.starts_with("<path") && line.contains("fill=\"none\""))
            .map(str::to_owned)
            .collect::<Vec<_>>()
    };
    let closed = paths(turn(0.0, 1.0));
    assert_eq!(closed.len(), 1);
    assert!(closed[0].contains("Z\""));
    let open = paths(turn(0.0, 30.0));
    assert_eq!(open.len(), 2);
    assert!(open.iter().all(|path| !path.contains("Z\"")));
}

#[test]
fn below_zero_the_axis_moves_its_origin() {
    let mut rows = turn(0.0, 1.0);
    rows[3].l1 = Some(-0.15);
    let svg = polar_svg(&PolarPlot::from_rows(&design(), &rows, Quantity::L1, &[]), Layout::Beside);
    assert!(svg.contains("dotted circle 0.0: undeformed") && svg.contains("centre −0.2"));
}

#[test]
fn plots_without_limits_and_with_odd_texts_are_drawn() {
    let mut design = design();
    design.title = "R&D <sheet>\u{1}".into();
    let none: Vec<_> =
        turn(0.0, 1.0).into_iter().map(|row| LimitRow { l1: None, status: Status::Unbounded, ..row }).collect();
    for rows in [&[][..], &none] {
        let svg = polar_svg(&PolarPlot::from_rows(&design, rows, Quantity::Stretch, &[]), Layout::Beside);
        assert!(svg.contains("R&amp;D &lt;sheet&gt;"));
        svg_to_png(&svg, 1.0).unwrap();
    }
}

#[test]
fn a_bound_is_dashed_and_has_no_markers() {
    let mut plot = PolarPlot::from_rows(&design(), &[], Quantity::L1, &[]);
    let points: Vec<_> = (0..180).map(|d| (f64::from(d), Some(0.5), Status::Local)).collect();
    plot.curves.push(Curve::new(0, 0.0, CurveKind::Bound, &points));
    let svg = polar_svg(&plot, Layout::Beside);
    assert!(svg.contains("stroke-dasharray=\"5 4\"") && !svg.contains("fill=\"#222222\" stroke=\"#222222\""));
}

#[test]
fn the_picture_has_the_size_asked_for_and_is_not_blank() {
    let svg = polar_svg(&PolarPlot::from_rows(&design(), &turn(0.0, 1.0), Quantity::Stretch, &[]), Layout::Beside);
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
fn a_palette_saves_bytes_and_keeps_the_picture() {
    let svg = "<svg xmlns='http://www.w3.org/2000/svg' width='200' height='100'><rect width='200' height='100' fill='#fff'/>\
        <circle cx='60' cy='50' r='40' fill='#c04010'/><circle cx='110' cy='50' r='40' fill='#2060c0' fill-opacity='0.5'/></svg>";
    let full = svg_to_png(svg, 1.0).unwrap();
    let small = maille_io::plot::with_palette(&full).unwrap();
    assert!(4 * small.len() < 3 * full.len(), "{} of {} bytes", small.len(), full.len());
    let [full, small] = [full, small].map(|png| resvg::tiny_skia::Pixmap::decode_png(&png).unwrap());
    assert_eq!((small.width(), small.height()), (200, 100));
    assert_eq!(small.pixels()[0], full.pixels()[0], "the ground");
    for (a, b) in full.pixels().iter().zip(small.pixels()) {
        let of = |p: &resvg::tiny_skia::PremultipliedColorU8| [p.red(), p.green(), p.blue(), p.alpha()];
        let off = of(a).into_iter().zip(of(b)).map(|(a, b)| a.abs_diff(b)).max();
        assert!(off <= Some(24), "{a:?} became {b:?}");
    }
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
    for letter in "λτθ₁₂−·×°ᵀéßλ≤≥αβ²,:".chars() {
        let drawn = draw(&letter.to_string());
        assert!(drawn != nothing && drawn != unknown, "{letter}");
    }
}

/// The same limits by two methods, and those of a smaller radius.
fn three() -> Vec<NamedRecord> {
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
fn lines(svg: &str) -> Vec<&str> {
    svg.lines().filter(|line| line.starts_with("<path") && line.contains("fill=\"none\"")).collect()
}

fn attribute<'a>(line: &'a str, name: &str) -> &'a str {
    line.split(&format!(" {name}=\"")).nth(1).and_then(|rest| rest.split('"').next()).unwrap_or_default()
}

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

/// The bounds are far out: the axis is that of the limits, and the bounds are cut at its end.
#[test]
fn bounds_do_not_set_the_axis() {
    let far = |bound: f64| {
        let row = |row: LimitRow| LimitRow { bound_l1: Some(bound), bound_gap: Some(bound - 0.44), ..row };
        let rows: Vec<_> = turn(0.0, 1.0).into_iter().map(row).collect();
        polar_svg(&PolarPlot::from_rows(&design(), &rows, Quantity::L1, &[]), Layout::Beside)
    };
    let (near, far) = (far(0.45), far(3.0));
    for svg in [&near, &far] {
        assert!(svg.contains(">0.5<") && !svg.contains(">1.0<") && !svg.contains(">3.0<"));
    }
    let dashed = |svg: &str| lines(svg).iter().filter(|line| line.contains("dasharray=\"5 4\"")).count();
    assert_eq!((dashed(&near), dashed(&far)), (1, 0));
    assert!(near.contains(">proven bound<") && far.contains(">proven bound, cut off at 0.5<"));
}

/// A limit that is not proved has a hollow marker; a direction without a limit has a mark that tells why.
#[test]
fn markers_tell_what_is_proved() {
    let mut rows = turn(0.0, 30.0);
    rows.iter_mut().for_each(|row| row.status = Status::Global);
    let draw = |rows: &[LimitRow]| polar_svg(&PolarPlot::from_rows(&design(), rows, Quantity::L1, &[]), Layout::Beside);
    let hollow = |svg: &str| svg.matches("fill=\"#ffffff\" stroke=\"#222222\"").count();
    rows[2].status = Status::L2NotReached;
    let svg = draw(&rows);
    assert!(hollow(&svg) == 0 && !svg.contains("not proved") && svg.contains(">no limit found<"));
    rows[5].status = Status::Local;
    rows[2].status = Status::L2Unreachable;
    let svg = draw(&rows);
    assert_eq!(hollow(&svg), 2, "at 75° and 255°");
    assert!(svg.contains(">proved<") && svg.contains(">not proved (local)<") && svg.contains(">no limit (proved)<"));
}

/// A figure of a printed column: its width in millimetres, letters of the size asked for, neither title nor notes.
#[test]
fn paper_has_the_size_of_a_column() {
    let records = three();
    for (width_mm, font_pt) in [(89.0, 7.0), (183.0, 7.0), (120.0, 9.0)] {
        let layout = Layout::Paper(Paper { width_mm, font_pt });
        for svg in [
            polar_svg(&PolarPlot::from_records(&records, Quantity::L1), layout),
            difference_svg(&records, Quantity::L1, layout),
            cost_svg(&records, Cost::Steps, layout),
        ] {
            assert_eq!(attribute(&svg, "width"), format!("{width_mm}mm"));
            assert!(!svg.contains("font-weight=\"bold\">1.1") && !svg.contains("Gaps:"));
            let view: Vec<f64> = attribute(&svg, "viewBox").split(' ').map(|x| x.parse().unwrap()).collect();
            let unit_pt = width_mm / view[2] * 72.0 / 25.4;
            assert!((13.0 * unit_pt - font_pt).abs() < 0.01, "{unit_pt}");
            for text in svg.lines().filter(|line| line.starts_with("<text")) {
                let (x, y, size) = (number(text, "x"), number(text, "y"), number(text, "font-size"));
                let letters = text.split_once('>').unwrap().1.trim_end_matches("</text>").chars().count() as f64;
                let share = if text.contains("middle") { 0.5 } else { 1.0 };
                assert!(y < view[3] && x + share * 0.53 * size * letters < view[2], "{text}");
            }
            let outlined = outlined_svg(&svg).unwrap();
            assert!(!outlined.contains("<text") && outlined.contains("<title>1.1 · Cartesian grid of rings</title>"));
            assert_eq!(attribute(&outlined, "width"), format!("{width_mm}mm"));
            let size = |svg: &str| {
                let pixmap = resvg::tiny_skia::Pixmap::decode_png(&svg_to_png(svg, 1.0).unwrap()).unwrap();
                let dark = pixmap.pixels().iter().filter(|p| p.red() < 128).count();
                (pixmap.width(), pixmap.height(), dark)
            };
            let ((w, h, dark), (ow, oh, outlines)) = (size(&svg), size(&outlined));
            assert!(w == ow && h == oh && dark.abs_diff(outlines) * 50 < dark, "{dark} {outlines}");
        }
    }
}

/// What a PDF says, without the compression of its page.
fn pdf_page(pdf: &[u8]) -> String {
    let find = |what: &[u8]| pdf.windows(what.len()).position(|window| window == what).unwrap();
    let (begin, end) = (find(b"\nstream") + 8, find(b"\nendstream"));
    let mut page = String::new();
    std::io::Read::read_to_string(&mut flate2::read::ZlibDecoder::new(&pdf[begin..end]), &mut page).unwrap();
    page
}

#[test]
fn a_pdf_has_lines_areas_and_outlines() {
    let svg = "<svg xmlns='http://www.w3.org/2000/svg' width='254mm' height='127mm' viewBox='0 0 1000 500'>\n<title>a &amp; b</title>\n\
        <path d='M10 20L30 40' stroke='#ff0000' stroke-width='3' stroke-dasharray='5 4' fill='none'/>\
        <rect x='100' y='100' width='50' height='60' fill='#00ff0040'/></svg>";
    let pdf = svg_to_pdf(svg).unwrap();
    let text = String::from_utf8_lossy(&pdf).into_owned();
    assert!(text.starts_with("%PDF-1.") && text.contains("/MediaBox [0 0 720 360]") && text.contains("(a & b)"));
    assert!(text.contains("/ca 0.2509"), "the opacity of the area: {text}");
    let page = pdf_page(&pdf);
    for words in ["1 0 0 RG", "10 20 m", "30 40 l", "[5 4] 0 d", "0 1 0 rg", "100 100 m", "150 160 l"] {
        assert!(page.contains(words), "{words} is not in {page}");
    }
    let letters = |text: &str| {
        let svg =
            format!("<svg xmlns='http://www.w3.org/2000/svg' width='90' height='90'><text y='40'>{text}</text></svg>");
        let pdf = svg_to_pdf(&svg).unwrap();
        assert!(!String::from_utf8_lossy(&pdf).contains("/Font"));
        pdf_page(&pdf).matches(" m\n").count()
    };
    // Outlines of l, o (two) and i (two).
    assert_eq!((letters("l"), letters("lo"), letters("loi")), (1, 3, 5));
    let picture = "<svg xmlns='http://www.w3.org/2000/svg' width='9' height='9'><g opacity='0.5'><rect width='5' height='5'/>\
        <rect width='3' height='3'/></g></svg>";
    assert!(svg_to_pdf(picture).is_err());
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
        [">0°<", ">45°<", "Minor radius by reference radius", ">proven bound<", ">not proved (local)<", ">no limit<"]
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
}

/// Value of an attribute of an SVG element.
fn number(element: &str, name: &str) -> f64 {
    let (_, rest) = element.split_once(&format!(" {name}=\"")).unwrap();
    rest.split_once('"').unwrap().0.parse().unwrap()
}

/// On a page the legend stands below the data, without a heading, and nothing leaves the picture.
#[test]
fn a_narrow_plot_has_its_legend_below() {
    let records = three();
    let polar = |layout| polar_svg(&PolarPlot::from_records(&records, Quantity::L1), layout);
    let difference = |layout| difference_svg(&records, Quantity::L1, layout);
    let draw: [&dyn Fn(Layout) -> String; 3] = [&polar, &difference, &|layout| cost_svg(&records, Cost::Steps, layout)];
    for draw in draw {
        let (beside, below) = (draw(Layout::Beside), draw(Layout::Below));
        assert!(number(&below, "width") < number(&beside, "width"));
        assert_eq!(lines(&below).len(), lines(&beside).len());
        let label = |svg: &str| {
            let text = svg.lines().find(|line| line.contains(">r = 0.05, exact<")).unwrap();
            number(text, "y")
        };
        assert!(label(&below) > label(&beside) + 300.0);
        let (top, width, height) = (number(&below, "y"), number(&below, "width"), number(&below, "height"));
        for text in below.lines().filter(|line| line.starts_with("<text")) {
            let (x, y, size) = (number(text, "x"), number(text, "y"), number(text, "font-size"));
            assert!(y > top + 8.0 && y < top + height - 2.0, "{text}");
            let letters = text.split_once('>').unwrap().1.trim_end_matches("</text>").chars().count() as f64;
            let share = if text.contains("middle") { 0.5 } else { 1.0 };
            assert!(x + share * 0.58 * size * letters < width, "{text}");
        }
        svg_to_png(&below, 1.0).unwrap();
    }
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

/// A simulation of a sheet with a force at each stretch, and nothing in one frame.
fn simulation(name: &str, tile: &str, end: End, curve: &[(f64, f64)]) -> NamedSimulation {
    let row = |stretch, mean_force| ForceRow {
        share: 0.0,
        stretch,
        mean_force,
        deformation: None,
        energy: 0.0,
        floor_force: None,
        forces: vec![[0.0; 3]],
    };
    let rows = curve.iter().map(|&(stretch, force)| row(Some(stretch), Some(force))).chain([row(None, None)]).collect();
    let document = serde_json::json!({
        "schema": 1, "version": "0", "design": design(), "tile": tile,
        "setup": {
            "fix": ["left", "flat@0,1"], "pull": [{ "place": "right", "way": [[8.0, 0.0, 0.0]] }], "gravity": null,
            "force": [], "floor": null, "steps": 40, "max_iterations": 9, "seed": 1,
        },
        "outcome": { "end": end, "share": 0.5, "smallest_gap": null, "links_ok": true, "iterations": 1, "kicks": 0, "note": null },
    });
    let record: SimulationRecord = serde_json::from_value(document).unwrap();
    NamedSimulation { name: name.into(), record, forces: ForceTable { places: vec!["left".into()], rows } }
}

/// Free at first, then a hard stop: along the axis, then straight up; the legend says where, the caption what was done.
#[test]
fn a_force_rises_where_the_sheet_stops() {
    let stops = [(1.0, 0.0), (1.2, 1e-9), (1.4399, 1e-4), (1.44, 4.0)];
    let one = force_svg(&[simulation("a", "4x4", End::Locked, &stops)], Layout::Beside).unwrap();
    for words in [
        ">stops at 1.440<",
        "4 × 4 cells · ",
        "left and flat@0,1 held",
        "right pulled by (8, 0, 0)",
        "40 steps",
        "(βR/1000, the unit of --force)",
    ] {
        assert!(one.contains(words), "{words} is not in {one}");
    }
    let curve = one.lines().find(|line| line.starts_with("<path") && line.contains("fill=\"none\"")).unwrap();
    let numbers = attribute(curve, "d").split(['M', 'L', ' ']).filter_map(|x| x.parse().ok());
    let at: Vec<f64> = numbers.collect();
    assert_eq!(at.len(), 8);
    let (run, rise) = (at[4] - at[0], at[5] - at[7]);
    assert!(run > 300.0 && (at[1] - at[5]).abs() < 0.5 && rise > 300.0 && at[6] - at[4] < 1.0, "{at:?}");

    // Sheets of one design are told apart by their cells, and by their folders at last.
    let all = [
        simulation("a", "4x4", End::Locked, &stops),
        simulation("b", "4x4", End::Reached, &stops[..2]),
        simulation("c", "2x2", End::Interrupted, &stops[..1]),
        simulation("d", "1x1", End::Reached, &[]),
    ];
    let several = force_svg(&all, Layout::Beside).unwrap();
    for label in [
        ">1.1, 4 × 4 cells, a<",
        ">stops at 1.440<",
        ">1.1, 4 × 4 cells, b<",
        ">no stop up to 1.200<",
        ">1.1, 2 × 2 cells<",
        ">given up at 1.000<",
    ] {
        assert!(several.contains(label), "{label} is not in {several}");
    }
    svg_to_png(&several, 1.0).unwrap();
    svg_to_png(&force_svg(&all, Layout::Below).unwrap(), 1.0).unwrap();
    assert!(force_svg(&all[3..], Layout::Beside).is_none());
}
