//! Errors as people read them: what is wrong, why, its place in the text, what would be right.
//!
//! The drawing is that of miette's own graphical handler, with whole lines: those of a help are commands to copy.
//! That one can fold lines by the rules of all of Unicode, and its libraries are thirty more to compile. An error here has no code, no link and at most one place.

use miette::{Diagnostic, LabeledSpan, ReportHandler, SourceCode, SourceSpan};
use std::{error::Error, fmt};
use unicode_width::{UnicodeWidthChar, UnicodeWidthStr};

/// How errors are drawn.
#[derive(Clone, Copy, Debug)]
pub struct Drawing {
    /// Lines of Unicode; else of ASCII.
    pub unicode: bool,
    /// Whether a terminal's colours are used.
    pub colours: bool,
}

/// What lines are made of.
struct Strokes {
    cross: &'static str,
    horizontal: &'static str,
    vertical: &'static str,
    dots: &'static str,
    up: &'static str,
    right: &'static str,
    top: &'static str,
    bottom: &'static str,
    branch: &'static str,
    under: &'static str,
    label: &'static str,
}

const UNICODE: Strokes = Strokes {
    cross: "×",
    horizontal: "─",
    vertical: "│",
    dots: "·",
    up: "▲",
    right: "▶",
    top: "╭",
    bottom: "╰",
    branch: "├",
    under: "─",
    label: "┬",
};

const ASCII: Strokes = Strokes {
    cross: "x",
    horizontal: "-",
    vertical: "|",
    dots: ":",
    up: "^",
    right: ">",
    top: ",",
    bottom: "`",
    branch: "|",
    under: "^",
    label: "|",
};

// Styles of a terminal, as the parameters of "select graphic rendition".
const ERROR: &str = "31";
const HELP: &str = "36";
const LINK: &str = "36;1;4";
const NUMBER: &str = "2";
const PLACE: &str = "35;1";

/// Columns from one tab stop to the next.
const TAB: usize = 4;
/// Of a line with more columns than this, so many are shown, of them so many before the place.
const WINDOW: usize = 200;
const BEFORE: usize = 60;

impl ReportHandler for Drawing {
    fn debug(&self, error: &dyn Diagnostic, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if f.alternate() { fmt::Debug::fmt(error, f) } else { f.write_str(&self.draw(error)) }
    }
}

impl Drawing {
    /// The lines that say what is wrong.
    pub fn draw(&self, error: &dyn Diagnostic) -> String {
        let mut out = String::new();
        self.add(&mut out, error, error.source_code());
        out
    }

    fn add(&self, out: &mut String, error: &dyn Diagnostic, text: Option<&dyn SourceCode>) {
        let s = self.strokes();
        let [cross, vertical] = [s.cross, s.vertical].map(|stroke| format!("  {} ", self.styled(ERROR, stroke)));
        out.push_str(&indented(&error.to_string(), &cross, &vertical));
        let mut next = error.source();
        while let Some(cause) = next {
            next = cause.source();
            out.push_str(&self.cause(cause, next.is_none()));
        }
        for place in error.labels().into_iter().flatten() {
            out.push_str(&text.and_then(|text| self.snippet(text, &place)).unwrap_or_default());
        }
        if let Some(help) = error.help() {
            out.push_str(&indented(&help.to_string(), &self.styled(HELP, "  help: "), "        "));
        }
        for related in error.related().into_iter().flatten() {
            out.push_str("\nError: \n");
            self.add(out, related, related.source_code().or(text));
        }
    }

    fn cause(&self, cause: &(dyn Error + 'static), last: bool) -> String {
        let s = self.strokes();
        let (corner, below) = if last { (s.bottom, " ") } else { (s.branch, s.vertical) };
        let first = self.styled(ERROR, &format!("  {corner}{}{} ", s.horizontal, s.right));
        indented(&cause.to_string(), &first, &self.styled(ERROR, &format!("  {below}   ")))
    }

    /// The lines around a place, with marks below or beside it; none where the text has no such place.
    fn snippet(&self, text: &dyn SourceCode, place: &LabeledSpan) -> Option<String> {
        let span = place.inner();
        let around = text.read_span(span, 1, 1).ok()?;
        let data = String::from_utf8_lossy(around.data());
        let mut start = around.span().offset();
        let lines: Vec<Line<'_>> = data
            .split_inclusive('\n')
            .zip(around.line() + 1..)
            .map(|(line, number)| {
                let at = start;
                start += line.len();
                let text = line.strip_suffix('\n').map_or(line, |text| text.strip_suffix('\r').unwrap_or(text));
                Line { number, start: at, end: start, text }
            })
            .collect();
        let (s, mark) = (self.strokes(), |stroke: &str| self.styled(PLACE, stroke));
        let gutter = lines.iter().any(|line| line.has(span) && !line.holds(span));
        let digits = lines.last().map_or(1, |line| line.number.to_string().len());
        let label = place.label().map(mark);
        let blank = format!(" {:digits$} {} ", "", s.dots);

        let at = text.read_span(span, 0, 0).ok()?;
        let named = at.name().map(|name| format!("{name}:")).unwrap_or_default();
        let named = self.styled(LINK, &format!("{named}{}:{}", at.line() + 1, at.column() + 1));
        let mut out = format!("{:digits$}  {}{}[{named}]\n", "", s.top, s.horizontal);
        for line in &lines {
            let number = self.styled(NUMBER, &format!("{:digits$}", line.number));
            let beside = match line.has(span) {
                _ if !gutter => String::new(),
                false => "    ".into(),
                true if line.start <= span.offset() => [s.top, s.horizontal, s.right].map(mark).concat() + " ",
                true if line.ends(span) => {
                    let corner = if label.is_some() { s.branch } else { s.bottom };
                    [corner, s.horizontal, s.right].map(mark).concat() + " "
                }
                true => mark(s.vertical) + "   ",
            };
            let first = if line.holds(span) { line.column(span.offset()) } else { 0 };
            let (shown, hidden) = line.shown(first, if self.unicode { "…" } else { "..." });
            out.push_str(&format!(" {number} {} {beside}{shown}\n", s.vertical));
            if !line.has(span) {
                continue;
            }
            if line.holds(span) {
                let end = if span.is_empty() { 0 } else { line.column(span.offset() + span.len()) };
                let first = first - hidden;
                let end = end.saturating_sub(hidden).min(shown.width()).max(first + 1);
                let middle = (first + end) / 2;
                let point = if span.is_empty() { s.up } else { label.as_ref().map_or(s.under, |_| s.label) };
                let under = |count: usize| s.under.repeat(count);
                let marks = format!("{:first$}{}{point}{}", "", under(middle - first), under(end - middle - 1));
                out.push_str(&format!("{blank}{}\n", mark(&marks)));
                if let Some(label) = &label {
                    let label = mark(&format!("{}{} {label}", s.bottom, s.horizontal.repeat(2)));
                    out.push_str(&format!("{blank}{:middle$}{label}\n", ""));
                }
            } else if let (Some(label), true) = (&label, line.ends(span) && line.start > span.offset()) {
                let along = [s.bottom, &s.horizontal.repeat(3), s.horizontal].map(mark).concat();
                out.push_str(&format!("{blank}{along} {label}\n"));
            }
        }
        out.push_str(&format!("{:digits$}  {}{}\n", "", s.bottom, s.horizontal.repeat(4)));
        Some(out)
    }

    fn strokes(&self) -> &'static Strokes {
        if self.unicode { &UNICODE } else { &ASCII }
    }

    fn styled(&self, style: &str, text: &str) -> String {
        if self.colours { format!("\x1b[{style}m{text}\x1b[0m") } else { text.to_owned() }
    }
}

/// A text with `first` before its first line, and `rest` before the others.
fn indented(text: &str, first: &str, rest: &str) -> String {
    let indent = |(k, line): (usize, &str)| {
        let before = if k == 0 { first } else { rest };
        let before = if line.trim().is_empty() { before.trim_end() } else { before };
        format!("{before}{line}")
    };
    let lines: Vec<String> = text.split_terminator('\n').enumerate().map(indent).collect();
    lines.join("\n") + if text.ends_with('\n') { "\n\n" } else { "\n" }
}

/// A line of a text: its bytes, the end of the line included, and what is shown of it.
struct Line<'a> {
    number: usize,
    start: usize,
    end: usize,
    text: &'a str,
}

impl Line<'_> {
    /// Whether the place begins in this line, ends in it, or goes on through it.
    fn has(&self, span: &SourceSpan) -> bool {
        span.offset() < self.end && span.offset() + span.len().max(1) > self.start
    }

    /// Whether the whole place lies in this line.
    fn holds(&self, span: &SourceSpan) -> bool {
        self.start <= span.offset() && self.ends(span)
    }

    fn ends(&self, span: &SourceSpan) -> bool {
        span.offset() + span.len() <= self.end
    }

    /// Column of a byte of the text; the end of the line is one column.
    fn column(&self, at: usize) -> usize {
        let at = at - self.start;
        let before = self.text.char_indices().take_while(|(k, _)| *k < at).map(|(_, c)| c);
        widths(before).map(|(_, width)| width).sum::<usize>() + usize::from(at > self.text.len())
    }

    /// The line with spaces for its tabs, of a long one what is around the column `place`; and how many columns are not shown before it.
    fn shown(&self, place: usize, cut: &str) -> (String, usize) {
        let tab = |(c, width)| if c == '\t' { " ".repeat(width) } else { String::from(c) };
        let all = widths(self.text.chars());
        if self.text.len() <= WINDOW || all.clone().map(|(_, width)| width).sum::<usize>() <= WINDOW {
            return (all.map(tab).collect(), 0);
        }
        let mut column = 0;
        let from = place.saturating_sub(BEFORE);
        let (mut out, mut hidden, mut more) = (String::new(), 0, false);
        for (c, width) in all {
            match column {
                at if at < from => hidden = at + width,
                at if at < from + WINDOW => out.push_str(&tab((c, width))),
                _ => more = true,
            }
            column += width;
        }
        if hidden > 0 {
            (out, hidden) = (format!("{cut} {out}"), hidden.saturating_sub(cut.width() + 1));
        }
        (if more { format!("{out} {cut}") } else { out }, hidden)
    }
}

/// Characters with the columns that each takes.
fn widths(text: impl Iterator<Item = char> + Clone) -> impl Iterator<Item = (char, usize)> + Clone {
    text.scan(0, |column, c| {
        let width = if c == '\t' { TAB - *column % TAB } else { c.width().unwrap_or(0) };
        *column += width;
        Some((c, width))
    })
}
