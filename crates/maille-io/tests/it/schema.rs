//! The JSON Schema of design files against the reader: what the reader takes the schema takes, and what it refuses the
//! schema refuses too, but for what no schema can say.

use maille_io::{DESIGN_JSON_SCHEMA, builtin_designs, read_design};
use serde_json::{Map, Value};
use std::{fs, path::Path};

struct Validator {
    schemas: boon::Schemas,
    design: boon::SchemaIndex,
}

/// What compiles is a valid schema.
fn validator() -> Validator {
    let (mut schemas, mut compiler) = (boon::Schemas::new(), boon::Compiler::new());
    let name = "https://maille/design.json"; // looked up nowhere
    compiler.add_resource(name, serde_json::from_str(DESIGN_JSON_SCHEMA).unwrap()).unwrap();
    let design = compiler.compile(name, &mut schemas).unwrap();
    Validator { schemas, design }
}

impl Validator {
    fn errors(&self, instance: &Value) -> Option<String> {
        self.schemas.validate(instance, self.design).err().map(|e| e.to_string())
    }

    fn is_valid(&self, instance: &Value) -> bool {
        self.errors(instance).is_none()
    }
}

/// TOML as JSON; NaN and infinity, which JSON has not, become strings.
fn json(value: &toml::Value) -> Value {
    match value {
        toml::Value::Float(x) if !x.is_finite() => Value::String(x.to_string()),
        toml::Value::Array(list) => list.iter().map(json).collect(),
        toml::Value::Table(table) => {
            Value::Object(table.iter().map(|(k, v)| (k.clone(), json(v))).collect::<Map<_, _>>())
        }
        other => serde_json::to_value(other).unwrap(),
    }
}

fn parsed(text: &str) -> Option<Value> {
    Some(json(&toml::Value::Table(text.parse::<toml::Table>().ok()?)))
}

#[test]
fn every_builtin_design_fits_the_schema() {
    let validator = validator();
    for design in builtin_designs() {
        let instance = parsed(design.toml).unwrap();
        assert_eq!(validator.errors(&instance), None, "{}", design.name);
    }
}

#[test]
fn examples_with_curves_fit_the_schema() {
    let (validator, mut count) = (validator(), 0);
    for entry in fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/curves")).unwrap() {
        let path = entry.unwrap().path();
        fits_and_reads_back(&validator, &fs::read_to_string(&path).unwrap());
        count += 1;
    }
    assert_eq!(count, 2);
}

/// What is written reads back the same.
fn fits_and_reads_back(validator: &Validator, text: &str) {
    assert!(validator.is_valid(&parsed(text).unwrap()), "{text}");
    let design = maille_io::read_design("example", text).unwrap();
    let written = maille_io::write_design(&design);
    assert!(validator.is_valid(&parsed(&written).unwrap()), "{written}");
    assert_eq!(maille_io::read_design("written", &written).unwrap(), design);
}

#[test]
fn open_curves_fit_the_schema() {
    let of = |form: &str| {
        format!(
            "name = \"a\"\nminor_radius = 0.1\nreference_radius = 1.0\n[lattice]\na1 = [9.0, 0.0, 0.0]\na2 = [0.0, 9.0, 0.0]\n\
             [[elements]]\nname = \"e\"\ncenter = [0.0, 0.0, 0.0]\ncurves = [{{ {form} }}]\n"
        )
    };
    let (validator, points) = (validator(), "[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]");
    fits_and_reads_back(&validator, &of(&format!("polyline = {{ points = [{points}], closed = false }}")));
    fits_and_reads_back(
        &validator,
        &of(&format!("spline = {{ points = [{points}, [1.0, 2.0, 0.0]], closed = false }}")),
    );
    fits_and_reads_back(&validator, &of("path = { from = [0.0, 0.0, 0.0], parts = [{ to = [1.0, 0.0, 0.0] }] }"));
    for closed in
        [format!("polyline = {{ points = [{points}] }}"), "path = { parts = [{ to = [1.0, 0.0, 0.0] }] }".into()]
    {
        assert!(!validator.is_valid(&parsed(&of(&closed)).unwrap()), "{closed}");
    }
}

/// What a schema cannot say: relations between two fields, and what formulas mean.
const BEYOND: [&str; 29] = [
    "curve-along-normal.toml",
    "curve-fillet-below-wire.toml",
    "curve-fillet-too-large.toml",
    "curve-frame-apart.toml",
    "curve-frame-no-vertex.toml",
    "curve-frame-through-itself.toml",
    "curve-hairpin.toml",
    "curve-knot-common-divisor.toml",
    "curve-knot-half-turn.toml",
    "curve-path-arc-on-line.toml",
    "curve-point-twice.toml",
    "curve-spike.toml",
    "curve-spline-point-twice.toml",
    "curve-through-itself.toml",
    "curve-too-fine.toml",
    "minor-radius-too-large.toml",
    "parallel-lattice.toml",
    "parameter-arguments.toml",
    "parameter-bounds.toml",
    "parameter-cycle.toml",
    "parameter-function.toml",
    "parameter-not-finite.toml",
    "parameter-not-positive.toml",
    "parameter-out-of-bounds.toml",
    "parameter-syntax.toml",
    "parameter-unknown-name.toml",
    "reference-radius-too-large.toml",
    "ring-minor-radius-too-large.toml",
    "same-name-twice.toml",
];

#[test]
fn wrong_designs_do_not_fit_the_schema() {
    let validator = validator();
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/errors");
    let (mut fit, mut refused) = (Vec::new(), 0);
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|e| e != "toml") {
            continue;
        }
        let text = fs::read_to_string(&path).unwrap();
        // Files that are no TOML are the parser's to refuse.
        let Some(instance) = parsed(&text) else { continue };
        match validator.is_valid(&instance) {
            true => fit.push(path.file_name().unwrap().to_str().unwrap().to_owned()),
            false => refused += 1,
        }
    }
    fit.sort();
    assert_eq!(fit, BEYOND);
    assert!(refused >= 35, "{refused}");
}

#[test]
fn what_the_schema_leaves_out_the_reader_leaves_out() {
    let least = "name = 'x'\nreference_radius = 1\nlattice = { a1 = [3, 0, 0], a2 = [0, 3, 0] }\nelements = \
                 [{ name = 'a', center = [0, 0, 0], rings = [{ major_radius = 1, normal = [0, 0, 1], minor_radius = 0.1 }] }]\n";
    assert!(read_design("least", least).is_ok() && validator().is_valid(&parsed(least).unwrap()));
    for key in ["name", "reference_radius", "lattice", "elements"] {
        let without: String = least.lines().filter(|l| !l.starts_with(key)).map(|l| format!("{l}\n")).collect();
        assert!(read_design(key, &without).is_err() && !validator().is_valid(&parsed(&without).unwrap()), "{key}");
    }
}
