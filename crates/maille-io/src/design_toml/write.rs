//! From a [`Design`] to a file that reads back the same.

use super::read::source_name;
use maille::design::{CurveSpec, Design, Parameter, RingSpec, Shape};
use std::{collections::BTreeMap, fmt::Write};

/// The design as a file: every number reads back bit for bit. Formulas are written where they give the number at their place.
pub fn write_design(design: &Design) -> String {
    let design = &design.clone().settled();
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
    let at = Numbers(&design.formulas);
    if let Some(r) = design.minor_radius {
        line(format!("minor_radius = {}", at.number("minor_radius", r)));
    }
    line(format!("reference_radius = {}", at.number("reference_radius", design.reference_radius)));
    if let Some(tolerance) = design.curve_tolerance {
        line(format!("curve_tolerance = {}", at.number("curve_tolerance", tolerance)));
    }
    if design.allow_initial_overlap {
        line("allow_initial_overlap = true".into());
    }
    if design.elements.is_empty() {
        line("elements = []".into());
    }
    if !design.parameters.is_empty() {
        line("\n[parameters]".into());
        design.parameters.iter().for_each(|p| line(format!("{} = {}", p.name, parameter(p))));
    }
    let (a1, a2) = (design.lattice.a1, design.lattice.a2);
    line(format!("\n[lattice]\na1 = {}", at.vector("lattice.a1", a1)));
    if !design.lattice.single {
        line(format!("a2 = {}", at.vector("lattice.a2", a2)));
    }
    for (i, element) in design.elements.iter().enumerate() {
        let path = format!("elements[{i}]");
        let center = at.vector(&format!("{path}.center"), element.center);
        line(format!("\n[[elements]]\nname = {}\ncenter = {center}", string(&element.name)));
        let ring = |(k, ring): (usize, &RingSpec)| at.ring(&format!("{path}.rings[{k}]"), ring);
        match element.rings.as_slice() {
            [] if !element.curves.is_empty() => {}
            [] => line("rings = []".into()),
            [one] => line(format!("rings = [{}]", ring((0, one)))),
            several => {
                let rings: String = several.iter().enumerate().map(|r| format!("    {},\n", ring(r))).collect();
                line(format!("rings = [\n{rings}]"));
            }
        }
        let curve = |(k, curve): (usize, &CurveSpec)| at.curve(&format!("{path}.curves[{k}]"), curve);
        match element.curves.as_slice() {
            [] => {}
            [one] => line(format!("curves = [{}]", curve((0, one)))),
            several => {
                let curves: String = several.iter().enumerate().map(|c| format!("    {},\n", curve(c))).collect();
                line(format!("curves = [\n{curves}]"));
            }
        }
    }
    out
}

/// Numbers, or the formulas at their places.
struct Numbers<'a>(&'a BTreeMap<String, String>);

impl Numbers<'_> {
    fn number(&self, path: &str, x: f64) -> String {
        self.0.get(path).map_or_else(|| number(x), |formula| string(formula))
    }

    fn vector(&self, path: &str, v: [f64; 3]) -> String {
        let [x, y, z] = [0, 1, 2].map(|k| self.number(&format!("{path}[{k}]"), v[k]));
        format!("[{x}, {y}, {z}]")
    }

    fn ring(&self, path: &str, ring: &RingSpec) -> String {
        let major_radius = self.number(&format!("{path}.major_radius"), ring.major_radius);
        let normal = self.vector(&format!("{path}.normal"), ring.normal);
        let mut out = format!("{{ major_radius = {major_radius}, normal = {normal}");
        let offset = format!("{path}.offset");
        if ring.offset != [0.0; 3] || self.0.keys().any(|place| place.starts_with(&offset)) {
            out += &format!(", offset = {}", self.vector(&offset, ring.offset));
        }
        if let Some(r) = ring.minor_radius {
            out += &format!(", minor_radius = {}", self.number(&format!("{path}.minor_radius"), r));
        }
        out + " }"
    }
}

impl Numbers<'_> {
    fn curve(&self, path: &str, curve: &CurveSpec) -> String {
        let form = format!("{path}.{}", curve.shape.name());
        let mut numbers: Vec<String> = Vec::new();
        let point = |(name, p): (String, [f64; 3])| (self.vector(&format!("{form}.{name}"), p), name);
        let points: Vec<(String, String)> = curve.shape.points().into_iter().map(point).collect();
        let listed = |key: &str| {
            let all: Vec<&str> = points.iter().map(|(vector, _)| vector.as_str()).collect();
            format!("{key} = [{}]", all.join(", "))
        };
        match &curve.shape {
            Shape::Polyline { closed, .. } | Shape::Spline { closed, .. } => {
                numbers.push(listed("points"));
                numbers.extend((!closed).then(|| "closed = false".to_owned()));
            }
            Shape::Frame { edges, .. } => {
                numbers.push(listed("vertices"));
                let edges: Vec<String> = edges.iter().map(|[a, b]| format!("[{a}, {b}]")).collect();
                numbers.push(format!("edges = [{}]", edges.join(", ")));
            }
            Shape::Path { parts, .. } => {
                let known = |name: &str, key: &str| {
                    points.iter().find(|(_, known)| known == name).map(|(vector, _)| format!("{key} = {vector}"))
                };
                numbers.extend(known("from", "from"));
                let written = |k: usize| {
                    let of = |key: &str| known(&format!("parts[{k}].{key}"), key);
                    format!("{{ {} }}", [of("to"), of("through")].into_iter().flatten().collect::<Vec<_>>().join(", "))
                };
                let parts: Vec<String> = (0..parts.len()).map(written).collect();
                numbers.push(format!("parts = [{}]", parts.join(", ")));
            }
            _ => {}
        }
        for (name, x) in curve.shape.numbers() {
            let place = format!("{form}.{name}");
            if name != "fillet" || x != 0.0 || self.0.contains_key(&place) {
                numbers.push(format!("{name} = {}", self.number(&place, x)));
            }
        }
        let mut out = format!("{{ {} = {{ {} }}", curve.shape.name(), numbers.join(", "));
        let vectors = [
            ("normal", curve.normal, CurveSpec::Z),
            ("along", curve.along, CurveSpec::X),
            ("offset", curve.offset, [0.0; 3]),
        ];
        for (name, v, unwritten) in vectors {
            let place = format!("{path}.{name}");
            if v != unwritten || self.0.keys().any(|known| known.starts_with(&place)) {
                out += &format!(", {name} = {}", self.vector(&place, v));
            }
        }
        if let Some(r) = curve.minor_radius {
            out += &format!(", minor_radius = {}", self.number(&format!("{path}.minor_radius"), r));
        }
        out + " }"
    }
}

fn parameter(parameter: &Parameter) -> String {
    let value = parameter.formula.as_ref().map_or_else(|| number(parameter.value), |formula| string(formula));
    let bound = |name: &str, x: Option<f64>| x.map_or(String::new(), |x| format!(", {name} = {}", number(x)));
    match bound("min", parameter.min) + &bound("max", parameter.max) {
        none if none.is_empty() => value,
        bounds => format!("{{ value = {value}{bounds} }}"),
    }
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
