//! Pictures, printed columns and PDF: sizes, letters, legends.

use super::attribute;
use super::lines;
use super::number;
use super::three;
use super::turn;
use crate::common::rows::design;
use maille_io::Quantity;
use maille_io::plot::Cost;
use maille_io::plot::Layout;
use maille_io::plot::Paper;
use maille_io::plot::PolarPlot;
use maille_io::plot::cost_svg;
use maille_io::plot::difference_svg;
use maille_io::plot::polar_svg;
use maille_svg::outlined_svg;
use maille_svg::svg_to_pdf;
use maille_svg::svg_to_png;

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
    let small = maille_svg::with_palette(&full).unwrap();
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

/// The area of a line is empty, but viewers draw a hairline where it is filled.
#[test]
fn no_line_of_a_pdf_is_filled() {
    let svg = polar_svg(&PolarPlot::from_records(&three(), Quantity::L1), Layout::Below);
    let page = pdf_page(&svg_to_pdf(&svg).unwrap());
    let steps: Vec<&str> = page.lines().collect();
    let line = |w: &&[&str]| w[0].ends_with(" m") && w[1].ends_with(" l");
    let lines: Vec<&[&str]> = steps.windows(3).filter(line).collect();
    assert!(lines.iter().any(|w| w[2] == "S"), "{page}");
    assert!(!lines.iter().any(|w| w[2].starts_with('f')), "{page}");
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
