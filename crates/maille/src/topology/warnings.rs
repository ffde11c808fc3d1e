//! What is odd about a design that can be solved: most often a slip of the pen.

use super::{binding_vectors, close_pairs, core_distance, linked_parts, neighbours};
use crate::model::Model;
use maille_design::{CurveKind, InvalidInput};

/// A ring that is linked to nothing is called far from this gap on, in reference radii.
const FAR_GAP: f64 = 2.0;
/// How far the nearest ring is looked for, in reference radii.
const FARTHEST: f64 = 1e3;
/// Elements that are named one by one.
const MOST: usize = 6;

/// What is odd, each with its field in the design; nothing of it keeps the design from being solved.
pub fn warnings(model: &Model) -> Vec<InvalidInput> {
    let counts: Vec<usize> = (0..model.elements.len()).map(|e| neighbours(model, e).len()).collect();
    let mut out = unlinked(model, &counts);
    out.extend(unequal(model, &counts));
    let more = out.len().saturating_sub(MOST);
    if more > 0 {
        out.truncate(MOST);
        let problem = format!("there are {more} more such elements");
        out.push(InvalidInput::new("elements", problem, "look at the first ones; the others may have the same cause"));
    }
    out.extend(loose(model));
    out
}

/// Elements that nothing links, and how far they are from the rest.
fn unlinked(model: &Model, counts: &[usize]) -> Vec<InvalidInput> {
    let warning = |(e, _): (usize, &usize)| {
        let gap = nearest_other(model, e).filter(|gap| *gap > FAR_GAP);
        let far = gap.map_or(String::new(), |gap| {
            format!("; the nearest ring of another element is {:.4} away", gap * model.unit)
        });
        let problem = format!("nothing is linked to \"{}\"{far}", model.elements[e].name);
        let help = "check its center, and the normals and radii of its rings";
        InvalidInput::new(format!("elements[{e}].center"), problem, help)
    };
    let alone = counts.iter().enumerate().filter(|(e, count)| **count == 0 && !is_open(model, *e));
    alone.map(warning).collect()
}

/// Whether an element is made of open curves alone, which nothing can be linked to.
fn is_open(model: &Model, element: usize) -> bool {
    let mut rings = model.elements[element].rings.clone();
    rings.all(|ring| model.rings[ring].curve.as_ref().is_some_and(|curve| curve.kind == CurveKind::Open))
}

/// Gap between an element and the nearest other one; `None` where there is none within reach.
fn nearest_other(model: &Model, element: usize) -> Option<f64> {
    let mut margin = model.largest_radius;
    while margin < FARTHEST {
        let others = close_pairs(model, &model.start, margin).into_iter().filter(|pair| {
            let [a, b] = [pair.ring_a, pair.ring_b].map(|ring| model.rings[ring].element == element);
            a != b
        });
        let gaps = others.map(|p| core_distance(model, &model.start, &p) - model.contact_distance(p.ring_a, p.ring_b));
        // What is farther than the margin may not have been listed.
        if let Some(gap) = gaps.min_by(f64::total_cmp).filter(|gap| *gap <= margin) {
            return Some(gap);
        }
        margin *= 4.0;
    }
    None
}

/// Elements with fewer neighbours than others that are their copies or mirror images.
fn unequal(model: &Model, counts: &[usize]) -> Vec<InvalidInput> {
    let mut out = Vec::new();
    for (e, count) in counts.iter().enumerate().filter(|(_, count)| **count > 0) {
        let like = (0..counts.len()).filter(|other| alike(model, e, *other));
        let most = like.map(|other| counts[other]).max().unwrap_or(*count);
        if *count < most {
            let name = &model.elements[e].name;
            let problem = format!(
                "\"{name}\" has {count} linked neighbours, another element of the same or the mirrored shape has {most}"
            );
            let help = "if that is not meant: check its center, and whether an element beside it is missing";
            out.push(InvalidInput::new(format!("elements[{e}].center"), problem, help));
        }
    }
    out
}

/// Whether two elements have the same rings, turned the same way, each perhaps mirrored in planes of the axes.
fn alike(model: &Model, a: usize, b: usize) -> bool {
    let rings = |e: usize| &model.rings[model.elements[e].rings.clone()];
    let close = |x: f64, y: f64| (x - y).abs() < 1e-6;
    rings(a).len() == rings(b).len()
        && rings(a).iter().zip(rings(b)).all(|(p, q)| {
            close(p.major_radius, q.major_radius)
                && close(p.minor_radius, q.minor_radius)
                && (p.normal.abs() - q.normal.abs()).norm() < 1e-6
                && p.is_round() == q.is_round()
                && (p.offset.abs() - q.offset.abs()).norm() < 1e-6
        })
}

/// A sheet that does not hold together.
fn loose(model: &Model) -> Option<InvalidInput> {
    let vectors = binding_vectors(model);
    let independent =
        |v: &[i32; 2], w: &[i32; 2]| i64::from(v[0]) * i64::from(w[1]) != i64::from(v[1]) * i64::from(w[0]);
    let problem = match vectors.first() {
        None if model.periodic && (0..model.elements.len()).any(|e| is_open(model, e)) => {
            "no chain of links joins the cells: what open curves hold has no bound, and may come apart".to_owned()
        }
        None if model.periodic => "no chain of links joins the cells: links bound no pull".to_owned(),
        Some(first) if !model.single && !vectors.iter().any(|v| independent(first, v)) => {
            let along = model.start.translation(*first);
            let direction_deg = along.y.atan2(along.x).to_degrees().rem_euclid(180.0);
            format!(
                "chains of links hold the sheet in one direction only, {direction_deg:.1}°: links bound no pull across it"
            )
        }
        // A finite sheet has no other cells to hold together with.
        _ => {
            // Elements without a link have been named.
            let parts = linked_parts(model).into_iter();
            let parts = parts.filter(|part| part.elements.len() > 1 || !part.vectors.is_empty()).count();
            if parts < 2 {
                return None;
            }
            format!("the sheet has {parts} parts that no link joins")
        }
    };
    let help = "check the lattice and the centers: rings that should be linked may have missed each other";
    Some(InvalidInput::new("lattice", problem, help))
}
