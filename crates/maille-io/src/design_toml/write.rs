//! From a [`Design`] to a file that reads back the same.

use super::read::source_name;
use maille::design::{Design, RingSpec};
use std::fmt::Write;

/// The design as a file: every number reads back bit for bit.
pub fn write_design(design: &Design) -> String {
    let mut out = String::new();
    let mut line = |text: String| {
        out.push_str(&text);
        out.push('\n');
    };
    line(format!("schema = {}", design.schema));
    line(format!("name = {}", string(&design.name)));
    line(format!("title = {}", string(&design.title)));
    line(format!("source = {}", string(source_name(design.source))));
    if let Some(unit) = &design.unit {
        line(format!("unit = {}", string(unit)));
    }
    if let Some(r) = design.minor_radius {
        line(format!("minor_radius = {}", number(r)));
    }
    line(format!("reference_radius = {}", number(design.reference_radius)));
    if design.allow_initial_overlap {
        line("allow_initial_overlap = true".into());
    }
    if design.elements.is_empty() {
        line("elements = []".into());
    }
    line(format!("\n[lattice]\na1 = {}\na2 = {}", vector(design.lattice.a1), vector(design.lattice.a2)));
    for element in &design.elements {
        line(format!("\n[[elements]]\nname = {}\ncenter = {}", string(&element.name), vector(element.center)));
        match element.rings.as_slice() {
            [] => line("rings = []".into()),
            [one] => line(format!("rings = [{}]", ring(one))),
            several => {
                let rings: String = several.iter().map(|r| format!("    {},\n", ring(r))).collect();
                line(format!("rings = [\n{rings}]"));
            }
        }
    }
    out
}

fn ring(ring: &RingSpec) -> String {
    let mut out = format!("{{ major_radius = {}, normal = {}", number(ring.major_radius), vector(ring.normal));
    if ring.offset != [0.0; 3] {
        out += &format!(", offset = {}", vector(ring.offset));
    }
    if let Some(r) = ring.minor_radius {
        out += &format!(", minor_radius = {}", number(r));
    }
    out + " }"
}

fn vector(v: [f64; 3]) -> String {
    format!("[{}, {}, {}]", number(v[0]), number(v[1]), number(v[2]))
}

/// Rust's shortest digits that read back the same are TOML but for NaN.
fn number(x: f64) -> String {
    if x.is_nan() { "nan".into() } else { format!("{x:?}") }
}

fn string(s: &str) -> String {
    let mut out = String::from("\"");
    for c in s.chars() {
        match c {
            '"' | '\\' => out.extend(['\\', c]),
            '\n' => out.push_str("\\n"),
            '\t' => out.push_str("\\t"),
            c if c.is_control() => write!(out, "\\u{:04X}", c as u32).expect("a String takes all"),
            c => out.push(c),
        }
    }
    out.push('"');
    out
}
