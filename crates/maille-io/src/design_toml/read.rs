//! From a TOML table to a [`Design`], collecting every problem on the way.

use super::fields::{self, CURVE, ELEMENT, FORMS, LATTICE, PARAMETER, PART, RING, TOP};
use super::index::Index;
use super::problem::DesignProblem;
use crate::nearest::nearest;
use maille::design::{
    CurveSpec, DESIGN_SCHEMA, Design, ElementSpec, LatticeSpec, Parameter, PathPart, RingSpec, Shape, Source,
};
use std::collections::BTreeMap;
use std::ops::Range;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

const SOURCES: [(&str, Source); 4] = [
    ("thesis-text", Source::ThesisText),
    ("reconstruction", Source::Reconstruction),
    ("literature", Source::Literature),
    ("own", Source::Own),
];

/// The name of a source in the file.
pub(super) fn source_name(source: Source) -> &'static str {
    SOURCES.iter().find(|(_, s)| *s == source).map_or("own", |(name, _)| name)
}

type Value<'t> = Spanned<DeValue<'t>>;

/// The design, if all its fields could be read, and what is wrong with the form of the file.
pub(super) fn design(table: &DeTable<'_>, text: &str, index: &Index) -> (Option<Design>, Vec<DesignProblem>) {
    let mut reader = Reader { text, problems: Vec::new(), formulas: BTreeMap::new(), last_line: index.last_line };
    let first = index.first_line;
    let top = At { table, path: String::new(), known: TOP, span: first..first };
    let design = reader.design(&top).and_then(|design| match design.evaluated() {
        Ok(design) => Some(design),
        Err(problems) => {
            reader.problems.extend(problems.iter().map(|p| DesignProblem::invalid(p, index)));
            None
        }
    });
    (design, reader.problems)
}

/// A table with its path and the place to point at where something is missing in it.
struct At<'a, 't> {
    table: &'a DeTable<'t>,
    path: String,
    known: &'static [&'static str],
    span: Range<usize>,
}

impl<'a, 't> At<'a, 't> {
    fn path(&self, key: &str) -> String {
        if self.path.is_empty() { key.to_owned() } else { format!("{}.{key}", self.path) }
    }

    /// The value of `key`, or of a misspelling of it: that is reported as such, and not as a missing key too.
    fn get(&self, key: &str) -> Option<(&'a Value<'t>, String)> {
        let written =
            if self.table.contains_key(key) { Some(key) } else { self.unknown().find(|k| self.meant(k) == Some(key)) };
        written.and_then(|k| self.table.get(k).map(|value| (value, self.path(k))))
    }

    fn unknown(&self) -> impl Iterator<Item = &'a str> {
        let known = self.known;
        self.table.keys().map(|k| k.get_ref().as_ref()).filter(move |k| !known.contains(k))
    }

    fn meant(&self, key: &str) -> Option<&'static str> {
        nearest(key, self.known)
    }
}

struct Reader<'s> {
    text: &'s str,
    problems: Vec<DesignProblem>,
    /// Texts that stand for numbers, by their places.
    formulas: BTreeMap<String, String>,
    last_line: usize,
}

impl Reader<'_> {
    fn design(&mut self, top: &At<'_, '_>) -> Option<Design> {
        let schema = self.optional(top, "schema", Self::integer).map(|schema| schema.unwrap_or(DESIGN_SCHEMA));
        if schema.is_some_and(|s| s != DESIGN_SCHEMA) {
            // Nothing else can be judged by the rules of another version.
            let (value, path) = top.get("schema")?;
            let problem = format!("version {} is not known", &self.text[value.span()]);
            let help = format!("this program reads schema = {DESIGN_SCHEMA}");
            self.problems.push(DesignProblem::new(&path, problem, help, value.span()));
            return None;
        }
        self.known_keys(top);
        let name = self.required(top, "name", "name = \"my-weave\"").and_then(|(v, p)| self.string(v, &p));
        let title = self.optional(top, "title", Self::string);
        let source = self.optional(top, "source", Self::source);
        let unit = self.optional(top, "unit", Self::string);
        let minor_radius = self.optional(top, "minor_radius", Self::number);
        let help = "reference_radius = 1.0, the major radius that ratios such as r = R/10 refer to";
        let reference_radius = self.required(top, "reference_radius", help).and_then(|(v, p)| self.number(v, &p));
        let curve_tolerance = self.optional(top, "curve_tolerance", Self::number);
        let allow_initial_overlap = self.optional(top, "allow_initial_overlap", Self::boolean);
        let parameters = self.optional(top, "parameters", Self::parameters);
        let help = "[lattice] with a1 = [2.5, 0.0, 0.0] and a2 = [0.0, 2.5, 0.0], the translations to the next cells; a chain has a1 alone";
        let lattice = self.required(top, "lattice", help).and_then(|(v, p)| self.lattice(v, &p));
        let help = "[[elements]] with name, center and rings = [{ major_radius = 1.0, normal = [0.0, 0.0, 1.0] }]";
        let elements = self
            .required(top, "elements", help)
            .and_then(|(v, p)| self.list(v, &p, "write a table [[elements]] for each element", Self::element));
        let (elements, minor_radius) = (elements?, minor_radius?);
        let lattice = match lattice? {
            (a1, Some(a2)) => LatticeSpec { a1, a2, single: false },
            (a1, None) => LatticeSpec::single(a1, &elements, minor_radius),
        };
        Some(Design {
            schema: schema?,
            name: name?,
            title: title?.unwrap_or_default(),
            source: source?.unwrap_or_default(),
            unit: unit?,
            minor_radius,
            reference_radius: reference_radius?,
            curve_tolerance: curve_tolerance?,
            allow_initial_overlap: allow_initial_overlap?.unwrap_or_default(),
            lattice,
            elements,
            varied: BTreeMap::new(),
            parameters: parameters?.unwrap_or_default(),
            formulas: std::mem::take(&mut self.formulas),
        })
    }

    fn parameters(&mut self, value: &Value<'_>, path: &str) -> Option<Vec<Parameter>> {
        let help = "write [parameters] with radius = 1.0";
        let DeValue::Table(table) = value.get_ref() else {
            return self.wrong_type(value, path, "a table", help);
        };
        // The table is sorted by name: where the names stand has the order of the file.
        let mut entries: Vec<_> = table.iter().collect();
        entries.sort_by_key(|(key, _)| key.span().start);
        let read = entries.into_iter().map(|(key, value)| {
            let path = format!("{path}.{}", key.get_ref());
            self.parameter(key.get_ref(), value, &path)
        });
        let read: Vec<_> = read.collect();
        read.into_iter().collect()
    }

    fn parameter(&mut self, name: &str, value: &Value<'_>, path: &str) -> Option<Parameter> {
        let (of_value, min, max) = match value.get_ref() {
            DeValue::Table(_) => {
                let help = "write a number, a formula, or { value = 1.0, min = 0.5, max = 2.0 }";
                let at = self.table(value, path, PARAMETER, help)?;
                let of_value = self.required(&at, "value", "value = 1.0");
                let (min, max) =
                    (self.optional(&at, "min", Self::plain_number), self.optional(&at, "max", Self::plain_number));
                (of_value?, min?, max?)
            }
            _ => ((value, path.to_owned()), None, None),
        };
        let (value, path) = of_value;
        let number = self.number(value, &path)?;
        // Its formula stands with it, not among those of the design's numbers.
        let formula = self.formulas.remove(&path);
        Some(Parameter {
            name: name.to_owned(),
            value: if formula.is_some() { 0.0 } else { number },
            formula,
            min,
            max,
        })
    }

    fn lattice(&mut self, value: &Value<'_>, path: &str) -> Option<([f64; 3], Option<[f64; 3]>)> {
        let at = self.table(value, path, LATTICE, "write [lattice] with a1 and a2, or a1 alone for a chain")?;
        let a1 = self.required(&at, "a1", "a1 = [2.5, 0.0, 0.0]").and_then(|(v, p)| self.vector(v, &p));
        let a2 = self.optional(&at, "a2", Self::vector);
        Some((a1?, a2?))
    }

    fn element(&mut self, value: &Value<'_>, path: &str) -> Option<ElementSpec> {
        let at = self.table(value, path, ELEMENT, "write a table [[elements]] with name, center and rings")?;
        let name = self.required(&at, "name", "name = \"flat\"").and_then(|(v, p)| self.string(v, &p));
        let center = self.required(&at, "center", "center = [0.0, 0.0, 0.0]").and_then(|(v, p)| self.vector(v, &p));
        let help = "rings = [{ major_radius = 1.0, normal = [0.0, 0.0, 1.0] }]";
        let curves = self.optional(&at, "curves", |reader, v, p| {
            reader.list(v, p, "write curves = [{ stadium = { straight = 2.0, radius = 1.0 } }]", Self::curve)
        });
        let list = |reader: &mut Self, v: &Value<'_>, p: &str| {
            reader.list(v, p, "write rings = [{ major_radius = 1.0, normal = [0.0, 0.0, 1.0] }]", Self::ring)
        };
        // An element has rings, curves or both.
        let rings = match at.get("curves") {
            Some(_) => match at.get("rings") {
                Some((value, path)) => list(self, value, &path),
                None => Some(Vec::new()),
            },
            None => self.required(&at, "rings", help).and_then(|(v, p)| list(self, v, &p)),
        };
        Some(ElementSpec { name: name?, center: center?, rings: rings?, curves: curves?.unwrap_or_default() })
    }

    fn curve(&mut self, value: &Value<'_>, path: &str) -> Option<CurveSpec> {
        let at = self.table(value, path, CURVE, "write { stadium = { straight = 2.0, radius = 1.0 } }")?;
        let forms: Vec<_> =
            FORMS.iter().filter_map(|(name, keys)| at.get(name).map(|found| (*name, *keys, found))).collect();
        let shape = match &forms[..] {
            [(name, keys, (value, path))] => self.shape(name, keys, value, path),
            [] => {
                let known = FORMS.map(|(name, _)| name).join(", ");
                let help = format!("give one of {known}, as stadium = {{ straight = 2.0, radius = 1.0 }}");
                self.problems.push(DesignProblem::new(path, "the curve has no form", help, value.span()));
                None
            }
            [(first, ..), (second, ..), ..] => {
                let problem = format!("the curve has two forms, {first} and {second}");
                self.problems.push(DesignProblem::new(path, problem, "write a curve { … } for each", value.span()));
                None
            }
        };
        let normal = self.optional(&at, "normal", Self::vector);
        let along = self.optional(&at, "along", Self::vector);
        let offset = self.optional(&at, "offset", Self::vector);
        let minor_radius = self.optional(&at, "minor_radius", Self::number);
        Some(CurveSpec {
            shape: shape?,
            normal: normal?.unwrap_or(CurveSpec::Z),
            along: along?.unwrap_or(CurveSpec::X),
            offset: offset?.unwrap_or_default(),
            minor_radius: minor_radius?,
        })
    }

    fn shape(&mut self, name: &str, keys: &'static [&'static str], value: &Value<'_>, path: &str) -> Option<Shape> {
        let help = format!("write {name} = {{ {} = … }}", keys.join(" = …, "));
        let at = self.table(value, path, keys, &help)?;
        let fillet = match keys.contains(&"fillet") {
            true => self.optional(&at, "fillet", Self::number)?.unwrap_or(0.0),
            false => 0.0,
        };
        let corners = "[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]]";
        let points = |reader: &mut Self, key: &str| {
            let help = format!("{key} = {corners}");
            let (value, path) = reader.required(&at, key, &help)?;
            reader.list(value, &path, &format!("write {help}"), Self::vector)
        };
        let closed = match keys.contains(&"closed") {
            true => self.optional(&at, "closed", Self::boolean)?.unwrap_or(true),
            false => true,
        };
        match name {
            "polyline" => return points(self, "points").map(|points| Shape::Polyline { points, fillet, closed }),
            "spline" => return points(self, "points").map(|points| Shape::Spline { points, closed }),
            "path" => {
                let from = self.optional(&at, "from", Self::vector);
                let help = "parts = [{ to = [1.0, 0.0, 0.0] }, { to = [-1.0, 0.0, 0.0], through = [0.0, 1.0, 0.0] }]";
                let (value, path) = self.required(&at, "parts", help)?;
                let parts = self.list(value, &path, &format!("write {help}"), Self::part)?;
                return Some(Shape::Path { from: from?, parts });
            }
            "frame" => {
                let vertices = points(self, "vertices");
                let help = "edges = [[0, 1], [1, 2], [2, 0]], the numbers of two vertices each, from 0";
                let (value, path) = self.required(&at, "edges", help)?;
                let edges = self.list(value, &path, &format!("write {help}"), Self::edge)?;
                return Some(Shape::Frame { vertices: vertices?, edges });
            }
            _ => {}
        }
        let needed = keys.iter().filter(|key| **key != "fillet");
        let numbers: Vec<Option<f64>> = needed
            .map(|key| self.required(&at, key, &format!("{key} = 1.0")).and_then(|(v, p)| self.number(v, &p)))
            .collect();
        Some(match numbers.into_iter().collect::<Option<Vec<f64>>>()?[..] {
            [straight, radius] if name == "stadium" => Shape::Stadium { straight, radius },
            [a, b] if name == "ellipse" => Shape::Ellipse { a, b },
            [side] if name == "square" => Shape::Square { side, fillet },
            [side] if name == "hexagon" => Shape::Hexagon { side, fillet },
            [p, q, circle_radius, a] => Shape::TorusKnot { p, q, circle_radius, a },
            _ => unreachable!("a form that is not in FORMS"),
        })
    }

    fn part(&mut self, value: &Value<'_>, path: &str) -> Option<PathPart> {
        let at = self.table(value, path, PART, "write { to = [1.0, 0.0, 0.0] }")?;
        let to = self.required(&at, "to", "to = [1.0, 0.0, 0.0], where the part ends");
        let to = to.and_then(|(v, p)| self.vector(v, &p));
        let through = self.optional(&at, "through", Self::vector);
        Some(PathPart { to: to?, through: through? })
    }

    fn edge(&mut self, value: &Value<'_>, path: &str) -> Option<[u32; 2]> {
        let numbers = match value.get_ref() {
            DeValue::Array(array) => array.iter().map(whole).collect::<Option<Vec<u32>>>(),
            _ => None,
        };
        let edge = numbers.and_then(|numbers| <[u32; 2]>::try_from(numbers).ok());
        if edge.is_none() {
            let help = "write [0, 1]; vertices count from 0";
            self.problems.push(DesignProblem::new(path, "is not the numbers of two vertices", help, value.span()));
        }
        edge
    }

    fn ring(&mut self, value: &Value<'_>, path: &str) -> Option<RingSpec> {
        let at = self.table(value, path, RING, "write { major_radius = 1.0, normal = [0.0, 0.0, 1.0] }")?;
        let help = "major_radius = 1.0, the radius of the ring's core circle: (inner diameter + wire) / 2";
        let major_radius = self.required(&at, "major_radius", help).and_then(|(v, p)| self.number(v, &p));
        let help = "normal = [0.0, 0.0, 1.0] for a ring that lies in the sheet; any non-zero vector";
        let normal = self.required(&at, "normal", help).and_then(|(v, p)| self.vector(v, &p));
        let offset = self.optional(&at, "offset", Self::vector);
        let minor_radius = self.optional(&at, "minor_radius", Self::number);
        Some(RingSpec {
            major_radius: major_radius?,
            normal: normal?,
            offset: offset?.unwrap_or_default(),
            minor_radius: minor_radius?,
        })
    }

    fn known_keys(&mut self, at: &At<'_, '_>) {
        for key in at.table.keys().filter(|k| !at.known.contains(&k.get_ref().as_ref())) {
            let help = fields::unknown_key_help(key.get_ref(), at.known);
            self.problems.push(DesignProblem::new(&at.path(key.get_ref()), "unknown key", help, key.span()));
        }
    }

    fn required<'a, 't>(&mut self, at: &At<'a, 't>, key: &str, help: &str) -> Option<(&'a Value<'t>, String)> {
        let found = at.get(key);
        if found.is_none() {
            let table = at.path.is_empty() && (key == "lattice" || key == "elements");
            let last = self.last_line..self.last_line;
            let (span, place) = if table { (last, "belongs below") } else { (at.span.clone(), "belongs here") };
            self.problems.push(DesignProblem::missing(&at.path(key), &format!("add {help}"), span, place));
        }
        found
    }

    /// `None`: there, but wrong; `Some(None)`: not there.
    fn optional<T>(
        &mut self,
        at: &At<'_, '_>,
        key: &str,
        read: fn(&mut Self, &Value<'_>, &str) -> Option<T>,
    ) -> Option<Option<T>> {
        match at.get(key) {
            None => Some(None),
            Some((value, path)) => read(self, value, &path).map(Some),
        }
    }

    fn table<'a, 't>(
        &mut self,
        value: &'a Value<'t>,
        path: &str,
        known: &'static [&'static str],
        help: &str,
    ) -> Option<At<'a, 't>> {
        let DeValue::Table(table) = value.get_ref() else {
            return self.wrong_type(value, path, "a table", help);
        };
        let at = At { table, path: path.to_owned(), known, span: value.span() };
        self.known_keys(&at);
        Some(at)
    }

    /// All items, or nothing if one of them is wrong; each is read, so that all problems are found.
    fn list<T>(
        &mut self,
        value: &Value<'_>,
        path: &str,
        help: &str,
        read: fn(&mut Self, &Value<'_>, &str) -> Option<T>,
    ) -> Option<Vec<T>> {
        let DeValue::Array(array) = value.get_ref() else {
            return self.wrong_type(value, path, "an array of tables", help);
        };
        let items: Vec<_> = array.iter().enumerate().map(|(i, v)| read(self, v, &format!("{path}[{i}]"))).collect();
        items.into_iter().collect()
    }

    fn vector(&mut self, value: &Value<'_>, path: &str) -> Option<[f64; 3]> {
        let key = path.rsplit('.').next().unwrap_or(path);
        let help = format!("write {key} = [x, y, z]");
        let DeValue::Array(array) = value.get_ref() else {
            return self.wrong_type(value, path, "an array of three numbers", &help);
        };
        let numbers: Option<Vec<f64>> =
            array.iter().enumerate().map(|(i, v)| self.number(v, &format!("{path}[{i}]"))).collect();
        let numbers = numbers?;
        let three = <[f64; 3]>::try_from(numbers);
        if let Err(found) = &three {
            let problem = format!("expected three numbers, found {}", found.len());
            let help =
                self.decimal_commas(&value.span()).map_or(help, |v| format!("decimals take a point: {key} = {v}"));
            self.problems.push(DesignProblem::new(path, problem, help, value.span()));
        }
        three.ok()
    }

    /// The vector that `[15,0, 0,0, 0,0]` means.
    fn decimal_commas(&self, span: &Range<usize>) -> Option<String> {
        let items: Vec<&str> = self.text.get(span.clone())?.strip_prefix('[')?.strip_suffix(']')?.split(", ").collect();
        let commas = items.iter().any(|item| item.contains(','));
        let numbers: Vec<String> = items.iter().map(|item| item.trim().replace(',', ".")).collect();
        let three = numbers.len() == 3 && numbers.iter().all(|item| item.parse::<f64>().is_ok());
        (commas && three).then(|| format!("[{}]", numbers.join(", ")))
    }

    /// A number, or a formula: that is kept for when all parameters are known, and the number is NaN until then.
    fn number(&mut self, value: &Value<'_>, path: &str) -> Option<f64> {
        match value.get_ref() {
            DeValue::String(text) if text.trim().parse::<f64>().is_err() => {
                self.formulas.insert(path.to_owned(), text.trim().to_owned());
                Some(f64::NAN)
            }
            _ => self.plain_number(value, path),
        }
    }

    fn plain_number(&mut self, value: &Value<'_>, path: &str) -> Option<f64> {
        match value.get_ref() {
            DeValue::Float(x) => x.as_str().parse().ok(),
            DeValue::Integer(i) => i64::from_str_radix(i.as_str(), i.radix()).ok().map(|i| i as f64),
            DeValue::String(s) if s.trim().parse::<f64>().is_ok() => {
                return self.wrong_type(value, path, "a number", &format!("write {} without quotes", s.trim()));
            }
            _ => None,
        }
        .or_else(|| self.wrong_type(value, path, "a number", "write a number, as 1.0"))
    }

    fn integer(&mut self, value: &Value<'_>, path: &str) -> Option<u32> {
        whole(value)
            .or_else(|| self.wrong_type(value, path, "a version number", &format!("write schema = {DESIGN_SCHEMA}")))
    }

    fn boolean(&mut self, value: &Value<'_>, path: &str) -> Option<bool> {
        match value.get_ref() {
            DeValue::Boolean(b) => Some(*b),
            _ => self.wrong_type(value, path, "true or false", "write true or false, without quotes"),
        }
    }

    fn string(&mut self, value: &Value<'_>, path: &str) -> Option<String> {
        match value.get_ref() {
            DeValue::String(s) => Some(s.to_string()),
            _ => {
                let written = self.text[value.span()].replace('"', "'");
                let key = path.rsplit('.').next().unwrap_or(path);
                self.wrong_type(value, path, "a string", &format!("write {key} = \"{written}\""))
            }
        }
    }

    fn source(&mut self, value: &Value<'_>, path: &str) -> Option<Source> {
        let name = self.string(value, path)?;
        let found = SOURCES.iter().find(|(known, _)| *known == name).map(|(_, source)| *source);
        if found.is_none() {
            let known = SOURCES.map(|(known, _)| known);
            let mut help = format!("known: {}", known.join(", "));
            if let Some(near) = nearest(&name, &known) {
                help = format!("did you mean \"{near}\"? {help}");
            }
            let problem = format!("\"{name}\" is not a source");
            self.problems.push(DesignProblem::new(path, problem, help, value.span()));
        }
        found
    }

    fn wrong_type<T>(&mut self, value: &Value<'_>, path: &str, expected: &str, help: &str) -> Option<T> {
        let written = self.text.get(value.span()).unwrap_or_default();
        let found = match value.get_ref() {
            DeValue::Table(_) => "a table".to_owned(),
            DeValue::Array(_) => "an array".to_owned(),
            DeValue::String(_) => format!("the string {written}"),
            _ => written.to_owned(),
        };
        let problem = format!("expected {expected}, found {found}");
        self.problems.push(DesignProblem::new(path, problem, help, value.span()));
        None
    }
}

fn whole(value: &Value<'_>) -> Option<u32> {
    match value.get_ref() {
        DeValue::Integer(i) => u32::from_str_radix(i.as_str(), i.radix()).ok(),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sources_are_those_of_the_record() {
        for (name, source) in SOURCES {
            assert_eq!(serde_json::to_value(source).unwrap(), name);
            assert_eq!(source_name(source), name);
        }
    }
}
