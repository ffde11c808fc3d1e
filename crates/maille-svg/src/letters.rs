//! Texts of an SVG as outlines of letters that come with the program: pictures need no font, and are the same everywhere.

use roxmltree::{Document, Error, Node};
use std::{collections::HashMap, fmt::Write, ops::Range, sync::OnceLock};

/// Characters with their outlines; `fonts/README.md` says how they were made.
const REGULAR: &str = include_str!("../fonts/regular.tsv");
const BOLD: &str = include_str!("../fonts/bold.tsv");
/// Units of the outlines in the size of a letter.
const UNITS: f64 = 2048.0;
/// Size of a text that names none.
const SIZE: f64 = 16.0;
/// Attributes of a text that say which letters stand where; all others say how they are painted.
const PLACING: [&str; 7] = ["x", "y", "dy", "font-size", "font-weight", "font-family", "text-anchor"];

/// A character of a font.
struct Letter {
    advance: f64,
    /// Path with M, L, Q, Z and absolute coordinates, y downward.
    outline: &'static str,
    /// What is added to the advance before another character.
    kerning: HashMap<char, f64>,
}

type Font = HashMap<char, Letter>;

fn font(bold: bool) -> &'static Font {
    static FONTS: [OnceLock<Font>; 2] = [const { OnceLock::new() }; 2];
    let (font, table) = if bold { (&FONTS[1], BOLD) } else { (&FONTS[0], REGULAR) };
    font.get_or_init(|| table.lines().filter_map(letter).collect())
}

/// A line of a table: code, advance, outline, kerning.
fn letter(line: &'static str) -> Option<(char, Letter)> {
    let character = |code: &str| u32::from_str_radix(code, 16).ok().and_then(char::from_u32);
    let mut fields = line.split('\t');
    let code = character(fields.next()?)?;
    let (advance, outline) = (fields.next()?.parse().ok()?, fields.next()?);
    let pairs = fields.next()?.split(' ').filter_map(|pair| pair.split_once(':'));
    let kerning = pairs.filter_map(|(after, by)| Some((character(after)?, by.parse().ok()?))).collect();
    Some((code, Letter { advance, outline, kerning }))
}

/// The SVG with each text as paths. A character that the fonts have not is an empty box.
pub(crate) fn outlined(svg: &str) -> Result<String, Error> {
    let document = Document::parse(svg)?;
    let mut out = String::with_capacity(svg.len());
    let mut done = 0;
    for text in document.descendants().filter(|node| node.has_tag_name((SVG, "text"))) {
        let Range { start, end } = text.range();
        out.push_str(&svg[done..start]);
        write_text(&mut out, text);
        done = end;
    }
    out.push_str(&svg[done..]);
    Ok(out)
}

/// The namespace of SVG.
const SVG: &str = "http://www.w3.org/2000/svg";

fn write_text(out: &mut String, text: Node<'_, '_>) {
    let attribute = |name| text.ancestors().find_map(|node| node.attribute(name));
    let number = |name| text.attribute(name).and_then(|value| value.parse().ok()).unwrap_or(0.0);
    let bold = attribute("font-weight") == Some("bold");
    let size = attribute("font-size").and_then(|value| value.parse().ok()).unwrap_or(SIZE);
    let (paths, width) = spans(text, font(bold), size, [number("x"), number("y")]);
    let before = match attribute("text-anchor") {
        Some("middle") => 0.5 * width,
        Some("end") => width,
        _ => 0.0,
    };
    out.push_str("<g");
    for attribute in text.attributes().filter(|attribute| !PLACING.contains(&attribute.name())) {
        let value = attribute.value().replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;");
        let _ = write!(out, " {}=\"{value}\"", attribute.name());
    }
    let _ = write!(out, " transform=\"translate({:.3} 0)\">", -before);
    for path in paths.iter().filter(|path| !path.is_empty()) {
        let _ = write!(out, "<path d=\"{path}\"/>");
    }
    out.push_str("</g>");
}

/// A path for each part of a text, from `at` to the right, and how far that is.
fn spans(text: Node<'_, '_>, font: &Font, size: f64, [x, y]: [f64; 2]) -> (Vec<String>, f64) {
    let (mut at, mut paths, mut before) = ([x, y], Vec::new(), None);
    let parts: Vec<Node<'_, '_>> = text.descendants().filter(Node::is_text).collect();
    let end = parts.iter().rposition(|part| part.text().is_some_and(|words| !words.trim().is_empty()));
    for (k, part) in parts.iter().enumerate() {
        let of = |name| part.ancestors().take_while(|node| *node != text).find_map(|node| node.attribute(name));
        at[1] += of("dy").and_then(|value| value.parse().ok()).unwrap_or(0.0);
        let scale = of("font-size").and_then(|value| value.parse().ok()).unwrap_or(size) / UNITS;
        let words = part.text().unwrap_or_default();
        let words = if Some(k) == end { words.trim_end() } else { words };
        let mut path = String::new();
        for character in words.chars().map(|c| if c.is_ascii_whitespace() { ' ' } else { c }) {
            // As in SVG: spaces that follow one another are one, and none is at the start.
            if character == ' ' && before.is_none_or(|before| before == ' ') {
                continue;
            }
            let Some(letter) = font.get(&character).or_else(|| font.get(&'\0')) else { continue };
            let kerned = before.and_then(|before| font.get(&before)?.kerning.get(&character)).unwrap_or(&0.0);
            at[0] += scale * kerned;
            place(&mut path, letter.outline, scale, at);
            at[0] += scale * letter.advance;
            before = Some(character);
        }
        paths.push(path);
    }
    (paths, at[0] - x)
}

/// Adds an outline, scaled and moved.
fn place(out: &mut String, outline: &str, scale: f64, at: [f64; 2]) {
    for command in outline.split_inclusive(['M', 'L', 'Q', 'Z']) {
        // The numbers of the command before, and the letter of the next one.
        let (numbers, next) = command.split_at(command.trim_end_matches(['M', 'L', 'Q', 'Z']).len());
        let numbers = numbers.split(' ').filter_map(|number| number.parse::<f64>().ok());
        for (k, number) in numbers.enumerate() {
            let _ = write!(out, "{}{:.3}", if k == 0 { "" } else { " " }, at[k % 2] + scale * number);
        }
        out.push_str(next);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn svg(text: &str) -> String {
        outlined(&format!("<svg xmlns=\"{SVG}\">{text}</svg>")).unwrap()
    }

    /// The signs of a dash and a bar are boxes: their corners tell size, place, anchor and kerning.
    #[test]
    fn letters_stand_where_they_should() {
        let dash = &font(false)[&'|'];
        assert_eq!((dash.advance, dash.outline), (690.0, "M430 -1565L430 483L260 483L260 -1565Z"));
        let start = svg("<text x=\"10\" y=\"20\" font-size=\"2048\" fill=\"#123456\">|</text>");
        let path = "M440.000 -1545.000L440.000 503.000L270.000 503.000L270.000 -1545.000Z";
        assert!(start.contains(&format!("<g fill=\"#123456\" transform=\"translate(-0.000 0)\"><path d=\"{path}\"/>")));
        let anchored = |anchor: &str| svg(&format!("<text font-size=\"1024\" text-anchor=\"{anchor}\"> |  |\n</text>"));
        let width = 345.0 + 0.5 * font(false)[&' '].advance + 345.0;
        assert!(anchored("end").contains(&format!("translate({:.3} 0)", -width)), "{}", anchored("end"));
        assert!(anchored("middle").contains(&format!("translate({:.3} 0)", -0.5 * width)));
        // A before V: 131 units nearer.
        let width = |text: &str, bold: &str| {
            let out = svg(&format!("<text text-anchor=\"end\" font-size=\"2048\" {bold}>{text}</text>"));
            out.split("translate(-").nth(1).unwrap().split(' ').next().unwrap().parse::<f64>().unwrap()
        };
        assert_eq!(width("A", "") + width("V", "") - width("AV", ""), 131.0);
        assert!(width("A", "font-weight=\"bold\"") > width("A", ""));
        assert_eq!(width("\u{4e00}", ""), font(false)[&'\0'].advance, "a box for what the font has not");
    }

    #[test]
    fn parts_of_a_text_have_their_own_size_and_height() {
        let out = svg("<text y=\"5\" font-size=\"2048\">|<tspan font-size=\"1024\" dy=\"100\">|</tspan></text>");
        let paths: Vec<&str> = out.split("<path d=\"").skip(1).map(|rest| rest.split('"').next().unwrap()).collect();
        assert_eq!(paths.len(), 2);
        assert!(paths[0].starts_with("M430.000 -1560.000L") && paths[1].starts_with("M905.000 -677.500L"), "{paths:?}");
        assert!(outlined("<nonsense").is_err());
        assert!(svg("<rect width=\"1\"/>").contains("<rect width=\"1\"/>"));
    }
}
