//! The keys of each table, and what to say about a key that is not there.

use crate::nearest::nearest;

/// Keys of the top of the file.
pub(super) const TOP: &[&str] = &[
    "schema",
    "name",
    "title",
    "source",
    "unit",
    "minor_radius",
    "reference_radius",
    "curve_tolerance",
    "allow_initial_overlap",
    "parameters",
    "lattice",
    "elements",
];
/// Keys of `[lattice]`.
pub(super) const LATTICE: &[&str] = &["a1", "a2"];
/// Keys of `[[elements]]`.
pub(super) const ELEMENT: &[&str] = &["name", "center", "rings", "curves"];
/// Keys of a ring.
pub(super) const RING: &[&str] = &["major_radius", "normal", "offset", "minor_radius"];
/// Keys of a curve: one of its forms, and where it sits.
pub(super) const CURVE: &[&str] = &[
    "stadium",
    "square",
    "hexagon",
    "polyline",
    "path",
    "spline",
    "ellipse",
    "torus_knot",
    "frame",
    "normal",
    "along",
    "offset",
    "minor_radius",
];
/// Forms of curves with their keys.
pub(super) const FORMS: [(&str, &[&str]); 9] = [
    ("stadium", &["straight", "radius"]),
    ("square", &["side", "fillet"]),
    ("hexagon", &["side", "fillet"]),
    ("polyline", &["points", "fillet", "closed"]),
    ("path", &["from", "parts"]),
    ("spline", &["points", "closed"]),
    ("ellipse", &["a", "b"]),
    ("torus_knot", &["p", "q", "R", "a"]),
    ("frame", &["vertices", "edges"]),
];
/// Keys of a part of a path.
pub(super) const PART: &[&str] = &["to", "through"];
/// Keys of a parameter that has bounds.
pub(super) const PARAMETER: &[&str] = &["value", "min", "max"];

const TABLES: [(&[&str], &str); 7] = [
    (TOP, "at the top of the file, above the first [table]"),
    (LATTICE, "in [lattice]"),
    (ELEMENT, "in an [[elements]] table"),
    (RING, "in a ring { … }"),
    (CURVE, "in a curve { … }"),
    (PART, "in a part { to = … } of a path"),
    (PARAMETER, "in a parameter { value = …, min = …, max = … }"),
];

/// What would be right instead of the unknown `key` in the table that knows `known`.
pub(super) fn unknown_key_help(key: &str, known: &[&str]) -> String {
    if key == "closed" && known.contains(&"from") {
        return "a path that has `from`, where it starts, is open".into();
    }
    if key == "a3" && known.contains(&"a2") {
        return "a third lattice vector is that of a block; maille knows sheets, which repeat along a1 and a2, and chains".into();
    }
    if let Some(near) = nearest(key, known) {
        return format!("did you mean `{near}`?");
    }
    if let Some((_, place)) = TABLES.iter().find(|(keys, _)| keys.contains(&key)) {
        return format!("`{key}` stands {place}");
    }
    format!("known here: {}", known.join(", "))
}
