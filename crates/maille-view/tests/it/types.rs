//! `web/src/types.ts` is written from the Rust types, as serde reads them. `MAILLE_BLESS=1` writes it anew.

use maille::{
    design::{CurveSpec, Parameter, Shape},
    record::StateRecord,
};
use maille_io::{builtin, read_design};
use maille_view::api::{
    Activity, Edit, Export, Judged, Measure, New, OpenRecord, Refused, Ring, Save, Solve, SolveEvent, Start, Subject,
    Text,
};
use serde_reflection::{ContainerFormat, Format, Named, Registry, Tracer, TracerConfig, VariantFormat};
use std::{collections::BTreeMap, fmt::Write, fs, path::Path};

/// Every type that crosses the wire, with those that they are made of.
fn registry() -> Registry {
    let mut tracer = Tracer::new(TracerConfig::default());
    macro_rules! trace {
        ($($type:ty),*) => {
            $(tracer.trace_simple_type::<$type>().unwrap();)*
        };
    }
    trace!(maille::record::Status, maille::design::Source, maille::relaxation::simulate::End, Shape);
    trace!(
        Start,
        OpenRecord, Measure, Subject, Judged, Solve, SolveEvent, Export, Edit, New, Save, Text, Activity, Refused
    );
    tracer.registry().unwrap()
}

fn name(format: &Format) -> String {
    match format {
        Format::TypeName(name) => name.clone(),
        Format::Bool => "boolean".into(),
        Format::Str | Format::Char => "string".into(),
        Format::Option(inner) => format!("{} | null", name(inner)),
        Format::Seq(inner) => match **inner {
            Format::Option(_) => format!("({})[]", name(inner)),
            _ => format!("{}[]", name(inner)),
        },
        Format::Map { value, .. } => format!("Record<string, {}>", name(value)),
        Format::Tuple(all) => format!("[{}]", all.iter().map(name).collect::<Vec<_>>().join(", ")),
        Format::TupleArray { content, size } => format!("[{}]", vec![name(content); *size].join(", ")),
        Format::I8
        | Format::I16
        | Format::I32
        | Format::I64
        | Format::U8
        | Format::U16
        | Format::U32
        | Format::U64
        | Format::F32
        | Format::F64 => "number".into(),
        other => panic!("{other:?} has no place in JSON here"),
    }
}

/// Fields of a struct, or of a variant, as `name: type`.
fn fields(of: &str, fields: &[Named<Format>], absent: &BTreeMap<String, Vec<String>>) -> Vec<String> {
    let may_be_absent = |field: &str| absent.get(of).is_some_and(|names| names.iter().any(|name| name == field));
    let line = |field: &Named<Format>| {
        let mark = if may_be_absent(&field.name) { "?" } else { "" };
        format!("{}{mark}: {}", field.name, name(&field.value))
    };
    fields.iter().map(line).collect()
}

/// Fields that are left out where they are empty: those that a bare value does not write.
fn absent(registry: &Registry) -> BTreeMap<String, Vec<String>> {
    let mut design = read_design("1.1", builtin("1.1").unwrap()).unwrap();
    (design.minor_radius, design.unit) = (None, None);
    let parameter = Parameter { name: "wire".into(), value: 1.0, formula: None, min: None, max: None };
    let (offset, normal) = ([0.0; 3], [0.0, 0.0, 1.0]);
    let ring = Ring { element: 0, offset, normal, major_radius: 1.0, minor_radius: 0.1, curve: None, open: false };
    let bare = [
        ("StateRecord", serde_json::to_value(StateRecord::default()).unwrap()),
        ("RingSpec", serde_json::to_value(&design.elements[0].rings[0]).unwrap()),
        ("ElementSpec", serde_json::to_value(&design.elements[0]).unwrap()),
        ("CurveSpec", serde_json::to_value(CurveSpec::of(Shape::Square { side: 1.0, fillet: 0.0 })).unwrap()),
        ("Ring", serde_json::to_value(&ring).unwrap()),
        ("Design", serde_json::to_value(&design).unwrap()),
        ("LatticeSpec", serde_json::to_value(&design.lattice).unwrap()),
        ("Parameter", serde_json::to_value(&parameter).unwrap()),
    ];
    let of = |(name, value): (&str, serde_json::Value)| {
        let Some(ContainerFormat::Struct(fields)) = registry.get(name) else { panic!("{name} is no struct") };
        (name.to_owned(), missing(fields, &value))
    };
    let points = vec![[0.0; 3]];
    let shapes = [
        Shape::Polyline { points: points.clone(), fillet: 0.0, closed: true },
        Shape::Spline { points, closed: true },
        Shape::Path { from: None, parts: Vec::new() },
    ];
    let Some(ContainerFormat::Enum(variants)) = registry.get("Shape") else { panic!("Shape is no enum") };
    let of_shape = |shape: &Shape| {
        let variant = variants.values().find(|variant| variant.name == shape.name()).unwrap();
        let VariantFormat::Struct(fields) = &variant.value else { panic!("{} has no fields", variant.name) };
        let value = serde_json::to_value(shape).unwrap();
        (variant.name.clone(), missing(fields, &value[shape.name()]))
    };
    bare.into_iter().map(of).chain(shapes.iter().map(of_shape)).collect()
}

fn missing(fields: &[Named<Format>], value: &serde_json::Value) -> Vec<String> {
    fields.iter().map(|f| f.name.clone()).filter(|field| value.get(field).is_none()).collect()
}

fn typescript(registry: &Registry) -> String {
    let absent = absent(registry);
    let mut out = String::from(
        "// Written from the Rust types by `MAILLE_BLESS=1 cargo test -p maille-view --test it types::`.\n",
    );
    for (of, format) in registry {
        out.push('\n');
        match format {
            ContainerFormat::Struct(all) => {
                let lines: String = fields(of, all, &absent).iter().map(|field| format!("  {field};\n")).collect();
                write!(out, "export interface {of} {{\n{lines}}}\n").unwrap();
            }
            ContainerFormat::Enum(variants) => {
                let one = |variant: &Named<VariantFormat>| match &variant.value {
                    VariantFormat::Unit => format!("\"{}\"", variant.name),
                    VariantFormat::NewType(inner) => format!("{{ \"{}\": {} }}", variant.name, name(inner)),
                    VariantFormat::Struct(all) => {
                        format!("{{ \"{}\": {{ {} }} }}", variant.name, fields(&variant.name, all, &absent).join("; "))
                    }
                    other => panic!("{of}: {other:?}"),
                };
                let all: Vec<String> = variants.values().map(|v| format!("\n  | {}", one(v))).collect();
                writeln!(out, "export type {of} ={};", all.concat()).unwrap();
            }
            other => panic!("{of}: {other:?}"),
        }
    }
    out
}

#[test]
fn the_page_has_the_types_of_the_records() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("web/src/types.ts");
    let found = typescript(&registry());
    assert!(found.contains("export interface LimitRow") && found.contains("chain?: ChainRecord | null;"), "{found}");
    if std::env::var_os("MAILLE_BLESS").is_some() {
        fs::write(&path, &found).unwrap();
    }
    let known = fs::read_to_string(&path).unwrap_or_default();
    assert!(known == found, "{} is old; run again with MAILLE_BLESS=1", path.display());
}
