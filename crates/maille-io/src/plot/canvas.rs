//! An SVG under construction.

use std::fmt::Write;

/// Where a text stands relative to its point.
#[derive(Clone, Copy)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
}

/// How a text looks.
#[derive(Clone, Copy)]
pub(super) struct TextStyle {
    pub(super) size: f64,
    pub(super) color: &'static str,
    pub(super) bold: bool,
    pub(super) anchor: Anchor,
    /// A white edge that keeps the text readable over lines.
    pub(super) halo: bool,
}

/// How a line looks.
#[derive(Clone, Copy)]
pub(super) struct Stroke<'a> {
    pub(super) color: &'a str,
    pub(super) width: f64,
    /// Lengths of dash and gap; solid if empty.
    pub(super) dash: &'a str,
}

impl<'a> Stroke<'a> {
    pub(super) fn solid(color: &'a str, width: f64) -> Self {
        Self { color, width, dash: "" }
    }

    fn attributes(self) -> String {
        let dash = if self.dash.is_empty() { String::new() } else { format!(" stroke-dasharray=\"{}\"", self.dash) };
        format!("stroke=\"{}\" stroke-width=\"{}\"{dash}", self.color, short(self.width))
    }
}

/// The SVG, drawn from back to front in pixels with y downward.
pub(super) struct Canvas {
    out: String,
}

impl Canvas {
    /// `top` is the least y that is shown. With `unit_mm` the picture has that size in print.
    pub(super) fn new(top: f64, [width, height]: [f64; 2], unit_mm: Option<f64>, title: &str) -> Self {
        let (t, w, h) = (short(top), short(width), short(height));
        let [across, down] = [width, height].map(|length| match unit_mm {
            Some(unit) => format!("{}mm", short(length * unit)),
            None => short(length),
        });
        let mut out = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{across}\" height=\"{down}\" viewBox=\"0 {t} {w} {h}\" \
             font-family=\"DejaVu Sans, Verdana, sans-serif\" role=\"img\">\n"
        );
        let _ = writeln!(out, "<title>{}</title>", escape(title));
        let _ = writeln!(out, "<rect y=\"{t}\" width=\"{w}\" height=\"{h}\" fill=\"#ffffff\"/>");
        Self { out }
    }

    pub(super) fn finish(mut self) -> String {
        self.out.push_str("</svg>\n");
        self.out
    }

    pub(super) fn text(&mut self, at: [f64; 2], style: TextStyle, text: &str) {
        let TextStyle { size, color, bold, anchor, halo } = style;
        let anchor = match anchor {
            Anchor::Start => "",
            Anchor::Middle => " text-anchor=\"middle\"",
            Anchor::End => " text-anchor=\"end\"",
        };
        let bold = if bold { " font-weight=\"bold\"" } else { "" };
        let halo = if halo {
            " stroke=\"#ffffff\" stroke-width=\"4\" stroke-linejoin=\"round\" paint-order=\"stroke\""
        } else {
            ""
        };
        let (x, y, text) = (short(at[0]), short(at[1]), with_subscripts(&escape(text), size));
        let size = short(size);
        self.line_out(format!(
            "<text x=\"{x}\" y=\"{y}\" font-size=\"{size}\" fill=\"{color}\"{bold}{anchor}{halo}>{text}</text>"
        ));
    }

    /// Upward, with its middle at a point.
    pub(super) fn text_upward(&mut self, [x, y]: [f64; 2], size: f64, text: &str) {
        let style = TextStyle { size, color: "#222222", bold: false, anchor: Anchor::Middle, halo: false };
        self.line_out(format!("<g transform=\"translate({} {}) rotate(-90)\">", short(x), short(y)));
        self.text([0.0, 0.0], style, text);
        self.line_out("</g>".into());
    }

    pub(super) fn line(&mut self, from: [f64; 2], to: [f64; 2], stroke: Stroke<'_>) {
        let [x1, y1, x2, y2] = [from[0], from[1], to[0], to[1]].map(short);
        // Without `none` a viewer of PDF draws the area of the line, a hairline under its dashes.
        let ends = format!("x1=\"{x1}\" y1=\"{y1}\" x2=\"{x2}\" y2=\"{y2}\"");
        self.line_out(format!("<line {ends} fill=\"none\" {}/>", stroke.attributes()));
    }

    pub(super) fn circle(&mut self, center: [f64; 2], radius: f64, fill: &str, stroke: Stroke<'_>) {
        let [x, y, r] = [center[0], center[1], radius].map(short);
        self.line_out(format!("<circle cx=\"{x}\" cy=\"{y}\" r=\"{r}\" fill=\"{fill}\" {}/>", stroke.attributes()));
    }

    pub(super) fn path(&mut self, points: &[[f64; 2]], closed: bool, fill: &str, stroke: Stroke<'_>) {
        let mut d = String::new();
        for (i, p) in points.iter().enumerate() {
            let _ = write!(d, "{}{} {}", if i == 0 { "M" } else { "L" }, short(p[0]), short(p[1]));
        }
        if closed {
            d.push('Z');
        }
        let style = stroke.attributes();
        self.line_out(format!(
            "<path d=\"{d}\" fill=\"{fill}\" {style} stroke-linejoin=\"round\" stroke-linecap=\"round\"/>"
        ));
    }

    fn line_out(&mut self, line: String) {
        self.out.push_str(&line);
        self.out.push('\n');
    }
}

/// Two decimals, without trailing zeros.
fn short(x: f64) -> String {
    let text = format!("{x:.2}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".into() } else { text.into() }
}

fn escape(text: &str) -> String {
    let allowed = |c: &char| !c.is_control();
    let text: String = text.chars().map(|c| if c == '\n' || c == '\t' { ' ' } else { c }).filter(allowed).collect();
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

/// Components of the strain with their letters below the line: `E_xx`.
fn with_subscripts(text: &str, size: f64) -> String {
    let (below, small) = (short(0.22 * size), short(0.75 * size));
    let mut parts = text.split("E_");
    let mut out = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let (letters, rest) = part.split_at(part.len().min(2));
        let _ = write!(
            out,
            "E<tspan font-size=\"{small}\" dy=\"{below}\">{letters}</tspan><tspan dy=\"-{below}\">{rest}</tspan>"
        );
    }
    out
}

/// Width of a text in pixels, by the widths of the font's letters, a little too large rather than too small.
pub(super) fn text_width(text: &str, size: f64) -> f64 {
    let em = |c: char| match c {
        'i' | 'j' | 'l' | '\'' | '|' | 'I' => 0.31,
        ' ' | '.' | ',' | ':' | ';' | '·' | 'f' | 't' | 'r' | '(' | ')' | '/' | '₁' | '₂' => 0.42,
        'm' | 'M' | 'w' | 'W' | '−' | '+' | '=' | '×' | '%' | '@' | '<' | '>' => 0.9,
        c if c.is_uppercase() => 0.72,
        _ => 0.64,
    };
    text.chars().map(em).sum::<f64>() * size
}

/// Lines of at most `width` pixels, by the average width of a character.
pub(super) fn wrap(text: &str, size: f64, width: f64) -> Vec<String> {
    let most = (width / (0.56 * size)) as usize;
    let mut lines = Vec::new();
    let mut line = String::new();
    for word in text.split_whitespace() {
        if !line.is_empty() && line.chars().count() + 1 + word.chars().count() > most {
            lines.push(std::mem::take(&mut line));
        }
        if !line.is_empty() {
            line.push(' ');
        }
        line.push_str(word);
    }
    lines.push(line);
    lines
}
