//! The surface of all in-plane strains, vertex by vertex: the state at the end of each ray is derived anew from its texts.
//!
//! With E = (FᵀF − 1)/2 = t N along the ray N, a rate of F is F⁻ᵀ N. The files have no forces: they are sought here, as the
//! ones ≥ 0 at closed points that leave the least of the balance (Lawson and Hanson's method). What they do not balance is
//! open, and not false: another choice of points might.

use crate::{
    apart::Arc,
    balance::{Closed, Free, RESIDUAL, balance},
    curvature::{ZERO_MODE, curvature},
    curve_pair::closed_points,
    dual::{edges, walks},
    files::{RECORDS, checksum, inputs_of, say, whole},
    gaps::gaps_and_links,
    record::{Design, Pose, Row, State, Unreadable, json},
    report::{Check, Finding, Verdict},
    sheet::{self, Sheet, Vec3},
    start::{Start, start},
    strain,
    tie::Linked,
};
use nalgebra::{DMatrix, DVector, Matrix2};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeMap;

const HEAD: &str = "surface.json";
const STATES: &str = "surface.jsonl";
const TABLE: &str = "boundary.csv";
/// Strains of a state are those of its vertex within this, times the condition of the deformation.
const SAME: f64 = 1e-9;
/// A point with a smaller gap is closed, in reference radii.
const CLOSED: f64 = 1e-8;
/// A smaller force is none, per unit of pull.
const CARRIED: f64 = 1e-9;
/// Statuses of a vertex.
const STATUSES: [&str; 4] = ["global", "local", "uncertified", "l2-not-reached"];
/// Places of a ring from which its nearest points to another are sought.
const PLACES: usize = 128;
/// Distances along a ray that are one.
const ATTAINED: f64 = 1e-9;

/// The files of a surface.
#[derive(Clone, Copy, Debug)]
pub struct SurfaceTexts<'a> {
    /// `surface.json`.
    pub head: &'a str,
    /// `surface.jsonl`.
    pub states: &'a str,
    /// `boundary.csv`.
    pub table: &'a str,
    /// Files of meshes that are there, with their names.
    pub meshes: &'a [(&'a str, &'a str)],
}

#[derive(Deserialize)]
struct Head {
    input_hash: String,
    design: Design,
    /// Names of the elements of each cell, in the order of the poses.
    cells: BTreeMap<String, Vec<String>>,
    /// SHA-256 of each file.
    files: BTreeMap<String, String>,
    /// SHA-256 of the rest of the file.
    checksum: Option<String>,
}

#[derive(Deserialize)]
struct Vertex {
    direction: [f64; 3],
    status: String,
    distance: Option<f64>,
    bound: Option<f64>,
    cell: String,
    lattice: [[f64; 3]; 2],
    poses: Vec<[f64; 7]>,
}

/// What is known of one vertex.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct VertexReport {
    /// Row of `boundary.csv`, from 0.
    pub vertex: usize,
    /// (E_xx, E_yy, E_xy) of the ray, of length 1.
    pub direction: [f64; 3],
    /// Status of the vertex.
    pub status: String,
    /// Whether it claims a certificate: `global` or `local`.
    pub certified: bool,
    /// The checks; a ray without an end has none but that of its status.
    pub findings: Vec<Finding>,
}

/// A surface that was read, with what all its vertices need.
pub struct SurfaceVerifier {
    name: String,
    /// Whether the design has rings alone.
    vertices: Vec<Vertex>,
    files: Vec<Finding>,
    starts: BTreeMap<String, Result<Start, String>>,
}

impl SurfaceVerifier {
    /// Reads the files and checks that they fit together.
    pub fn new(texts: &SurfaceTexts<'_>) -> Result<Self, Unreadable> {
        let head: Head = json(HEAD, 0, texts.head)?;
        let lines = texts.states.lines().enumerate();
        let known: Vec<Vertex> = lines.map(|(k, line)| json(STATES, k + 1, line)).collect::<Result<_, _>>()?;
        let sums = [(STATES, texts.states), (TABLE, texts.table)];
        let mut files: Vec<Finding> = sums.map(|(name, text)| checksum(HEAD, &head.files, name, text)).into();
        let (vertices, fits) = in_order(known, texts.table)?;
        files.push(fits);
        let value: Value = json(HEAD, 0, texts.head)?;
        let decide = ["effort", "starts", "seed", "cells"];
        let parameters: Value = decide.map(|name| (name, value["parameters"][name].clone())).into_iter().collect();
        files.push(inputs_of(HEAD, RECORDS, &value["design"], &parameters, &head.input_hash));
        files.extend(head.checksum.as_ref().map(|written| whole(HEAD, value, written)));
        // Meshes of older versions have no checksum.
        let known = texts.meshes.iter().filter(|(name, _)| head.files.contains_key(*name));
        files.extend(known.map(|(name, text)| checksum(HEAD, &head.files, name, text)));
        let start_of = |(cell, names): (&String, &Vec<String>)| {
            let names: Vec<&str> = names.iter().map(String::as_str).collect();
            let parsed = sheet::cell(cell).ok_or_else(|| format!("\"{cell}\" is no cell"));
            (cell.clone(), parsed.and_then(|cell| start(&head.design, &cell, &names)))
        };
        let starts = head.cells.iter().map(start_of).collect();
        Ok(SurfaceVerifier { name: head.design.name.clone(), vertices, files, starts })
    }

    /// What is known of the files.
    pub fn files(&self) -> &[Finding] {
        &self.files
    }

    /// Name of the design.
    pub fn design(&self) -> &str {
        &self.name
    }

    /// Vertices of the surface.
    pub fn len(&self) -> usize {
        self.vertices.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.vertices.is_empty()
    }

    /// Verifies vertex `k`, counted from 0.
    pub fn vertex(&self, k: usize) -> VertexReport {
        let vertex = &self.vertices[k];
        let certified = matches!(vertex.status.as_str(), "global" | "local");
        let mut findings = vec![status(vertex, certified)];
        if let Some(distance) = vertex.distance {
            match self.starts.get(&vertex.cell) {
                Some(Ok(start)) => findings.extend(of_state(vertex, distance, start, certified)),
                Some(Err(words)) => findings.push(say(Verdict::False, words.clone())),
                None => findings.push(say(Verdict::False, format!("{HEAD} has no cell {}", vertex.cell))),
            }
        }
        VertexReport { vertex: k, direction: vertex.direction, status: vertex.status.clone(), certified, findings }
    }
}

/// The vertices in the order of the table, and whether its figures are those of the states, bit for bit.
fn in_order(known: Vec<Vertex>, table: &str) -> Result<(Vec<Vertex>, Finding), Unreadable> {
    let key = |direction: &[f64; 3]| direction.map(f64::to_bits);
    let mut by_ray: BTreeMap<[u64; 3], Vertex> = known.into_iter().map(|v| (key(&v.direction), v)).collect();
    let mut reader = csv::Reader::from_reader(table.as_bytes());
    let wrong = |line: usize, problem: String| Unreadable { file: TABLE, line, problem };
    let mut out = Vec::new();
    let mut differs = None;
    for (k, row) in reader.deserialize::<BTreeMap<String, String>>().enumerate() {
        let row = row.map_err(|e| wrong(k + 2, e.to_string()))?;
        let number = |name: &str| row.get(name).and_then(|text| text.parse::<f64>().ok());
        let ray = ["direction_xx", "direction_yy", "direction_xy"].map(number);
        let [Some(x), Some(y), Some(z)] = ray else { return Err(wrong(k + 2, "a ray without a direction".into())) };
        let Some(vertex) = by_ray.remove(&key(&[x, y, z])) else {
            return Err(wrong(k + 2, format!("{STATES} has no such ray")));
        };
        let point = |i: usize| vertex.distance.map(|distance| vertex.direction[i] * distance);
        let figures = [
            ("distance", vertex.distance),
            ("exx", point(0)),
            ("eyy", point(1)),
            ("exy", point(2)),
            ("bound", vertex.bound),
        ];
        let other = figures.iter().find(|(name, written)| number(name) != *written).map(|(name, _)| *name);
        let text = |name: &str| row.get(name).map(String::as_str);
        let other = other.or((text("status") != Some(&vertex.status)).then_some("status"));
        let other = other.or((text("cell") != Some(&vertex.cell)).then_some("cell"));
        differs = differs.or(other.map(|name| format!("{TABLE}:{}: {name} is not that of {STATES}", k + 2)));
        out.push(vertex);
    }
    let differs = differs.or(by_ray.keys().next().map(|_| format!("{STATES} has rays that {TABLE} lacks")));
    let finding = match differs {
        Some(words) => say(Verdict::False, words),
        None => say(Verdict::Proved, format!("{TABLE} has the figures of {STATES}")),
    };
    Ok((out, finding))
}

fn status(vertex: &Vertex, certified: bool) -> Finding {
    let of = |verdict, words: &str| Finding::new(Check::Status, verdict, None, words);
    match (vertex.distance, vertex.bound) {
        (None, _) if certified => of(Verdict::False, "a certified ray has no distance"),
        (Some(far), Some(bound)) if far > bound + ATTAINED => of(Verdict::False, "the state lies beyond its bound"),
        (Some(far), bound) if vertex.status == "global" && bound.is_none_or(|bound| bound - far > ATTAINED) => {
            of(Verdict::False, "a global vertex does not attain its bound")
        }
        _ if !STATUSES.contains(&vertex.status.as_str()) => of(Verdict::Open, "nothing is derived of this status"),
        _ => of(Verdict::Proved, "the vertex has what its status says"),
    }
}

/// All that is derived of the state at the end of a ray.
fn of_state(vertex: &Vertex, distance: f64, start: &Start, certified: bool) -> Vec<Finding> {
    let pose = |&[x, y, z, w, i, j, k]: &[f64; 7]| Pose {
        element: String::new(),
        position: [x, y, z],
        rotation: [w, i, j, k],
    };
    let [a1, a2] = vertex.lattice;
    let state = State { a1, a2, poses: vertex.poses.iter().map(pose).collect(), ..State::default() };
    if state.poses.len() != start.sheet.bodies.len() {
        return vec![say(
            Verdict::False,
            format!("{} poses of {} elements", state.poses.len(), start.sheet.bodies.len()),
        )];
    }
    // Lengths of a vertex are in R already.
    let here = match start.sheet.at(&state, 1.0) {
        Ok(here) => here,
        Err(words) => return vec![say(Verdict::False, words)],
    };
    let [xx, yy, xy] = vertex.direction;
    let ray = Matrix2::new(xx, xy, xy, yy);
    let Some(f) = strain::gradient(here.lattice, start.sheet.lattice) else {
        return vec![say(Verdict::False, "the lattice vectors are parallel")];
    };
    let off = ((f.transpose() * f - Matrix2::identity()) * 0.5 - ray * distance).amax();
    let fits = off <= SAME * f.norm_squared().max(1.0);
    let words = match fits {
        true => format!("the lattice has the vertex's strain, to {off:.1e}"),
        false => format!("the strain of the lattice is off the vertex by {off:.3e}"),
    };
    let verdict = if fits { Verdict::Proved } else { Verdict::False };
    let mut out = vec![Finding::new(Check::Deformation, verdict, Some(off), words)];
    let row = Row { status: vertex.status.clone(), links_ok: Some(true), ..Row::default() };
    out.extend(gaps_and_links(&row, &here, start, 0.0, 1.0));
    if certified {
        out.extend(forces(&here, start, &f, &ray));
    }
    out.extend(vertex.bound.map(|written| bound(written, distance, start, &ray)));
    out
}

/// The bound of a ray. A closed walk of links with the lattice vector v and length d says xᵀ (1 + 2 t E) x ≤ 1 for x = v/d, so
/// t ≤ (1 − |x|²)/(2 xᵀ E x). And no metric 1 + 2 t E has a negative eigenvalue.
fn bound(written: f64, distance: f64, start: &Start, ray: &Matrix2<f64>) -> Finding {
    let linked = match &start.links {
        Ok(links) => Linked { sheet: &start.sheet, links },
        Err(words) => return Finding::new(Check::Bound, Verdict::Open, None, words.clone()),
    };
    let edges = edges(linked);
    let back_and_forth = edges.iter().flat_map(|&((a, p), (b, s), one)| {
        let back = edges.iter().filter(move |((c, _), (d, t), _)| (*c, *d) == (a, b) && *t != s);
        back.map(move |&(_, (_, t), other)| {
            (start.sheet.translation([s[0] - p[0] - t[0], s[1] - p[1] - t[1]]).xy(), one + other)
        })
    });
    let along = walks(linked).into_iter().chain(back_and_forth).filter_map(|(v, length)| {
        let x = v / length;
        let rate = 2.0 * x.dot(&(ray * x));
        (rate > 0.0).then(|| (1.0 - x.norm_squared()) / rate)
    });
    let least = ray.symmetric_eigenvalues().min();
    let shrunk = if least < 0.0 { -0.5 / least } else { f64::INFINITY };
    let most = along.fold(shrunk, f64::min);
    let of = |verdict, words: String| Finding::new(Check::Bound, verdict, Some(most), words);
    if distance > most + ATTAINED {
        of(Verdict::False, format!("a chain of links ends the ray at {most:?}, the state is at {distance:?}"))
    } else if written >= most - ATTAINED {
        of(Verdict::Proved, "a chain of links proves the bound".into())
    } else {
        of(Verdict::Open, format!("the chains that are tried prove {most:?}, the bound is {written:?}"))
    }
}

/// Forces that hold the sheet at the end of the ray, and the curvature with them.
fn forces(here: &Sheet, start: &Start, f: &Matrix2<f64>, ray: &Matrix2<f64>) -> [Finding; 2] {
    let open = |check, words: String| Finding::new(check, Verdict::Open, None, words);
    let both = |words: String| [Check::Balance, Check::Curvature].map(|check| open(check, words.clone()));
    let Some(inverse) = f.transpose().try_inverse() else { return both("the deformation has no inverse".into()) };
    let rate = start.sheet.lattice.map(|a| {
        let v = inverse * ray * a.xy();
        Vec3::new(v.x, v.y, 0.0)
    });
    let free = Free(vec![rate]);
    let closed = match closed(here) {
        Ok(closed) if !closed.is_empty() => closed,
        Ok(_) => return both("no two rings touch".into()),
        Err(words) => return both(words),
    };
    let gradients: Vec<DVector<f64>> = closed.iter().map(|closed| closed.gradient(&free)).collect();
    let matrix = DMatrix::from_columns(&gradients);
    let mut pull = DVector::zeros(matrix.nrows());
    pull[matrix.nrows() - 1] = -1.0;
    let found = non_negative(&matrix, &pull);
    let loaded: Vec<(Closed<'_>, f64)> =
        closed.into_iter().zip(found.iter().copied()).filter(|(_, y)| *y > CARRIED).collect();
    let balance = balance(here, &loaded, &free);
    let residual = balance.residual.max(balance.slope).max(balance.complementarity);
    if residual.is_nan() || residual > RESIDUAL {
        return both(format!(
            "no forces at the closed points were found that balance the pull: {residual:.1e} is left"
        ));
    }
    let words = format!("forces that push at closed points balance the pull to {residual:.1e}");
    let balanced = Finding::new(Check::Balance, Verdict::Proved, Some(residual), words);
    let anchors = start.sheet.carried();
    let judged = (0..here.bodies.len()).map(|still| curvature(here, &loaded, &free.0, anchors.clone(), still));
    let mut worst = "no element could be held".to_owned();
    for found in judged {
        match found {
            Ok(found) if found.values.first().is_none_or(|least| *least >= -ZERO_MODE * found.scale()) => {
                let words = "no small motion goes further along the ray, to second order";
                return [balanced, Finding::new(Check::Curvature, Verdict::Proved, found.least(), words)];
            }
            Ok(found) => worst = format!("a motion has the curvature {:.1e}", found.values.first().unwrap_or(&0.0)),
            Err(words) => worst = words,
        }
    }
    [balanced, open(Check::Curvature, worst)]
}

/// The nearest points of all pairs of rings that touch.
fn closed(here: &Sheet) -> Result<Vec<Closed<'_>>, String> {
    let mut out = Vec::new();
    for pair in here.pairs(|a, b| here.touching(a, b) + CLOSED)? {
        if !here.is_round(pair) {
            let found = closed_points(here, pair, CLOSED);
            out.extend(found.into_iter().map(|contact| Closed::of_curves(here, pair, contact)));
            continue;
        }
        let (one, other) = (here.circle(pair.0, [0, 0]), here.circle(pair.1, pair.2));
        let arc = Arc::new(&one, &other);
        let step = std::f64::consts::TAU / PLACES as f64;
        let seen: Vec<f64> = (0..PLACES).map(|k| arc.at(step * k as f64).distance).collect();
        for k in 0..PLACES {
            let (before, after) = (seen[(k + PLACES - 1) % PLACES], seen[(k + 1) % PLACES]);
            if seen[k] > before || seen[k] > after || seen[k] - other.radius * step > here.touching(pair.0, pair.1) {
                continue;
            }
            let angle = lowest(&arc, step * (k as f64 - 1.0), step * (k as f64 + 1.0));
            let closed_here = Closed::next_to(here, pair, angle);
            if closed_here.gap.abs() <= CLOSED {
                out.push(closed_here);
            }
        }
    }
    Ok(out)
}

/// The angle of the least distance between two others, by golden section.
fn lowest(arc: &Arc<'_>, mut low: f64, mut high: f64) -> f64 {
    let ratio = 0.5 * (5.0_f64.sqrt() - 1.0);
    for _ in 0..40 {
        let (left, right) = (high - ratio * (high - low), low + ratio * (high - low));
        if arc.at(left).distance < arc.at(right).distance { high = right } else { low = left }
    }
    0.5 * (low + high)
}

/// The y ≥ 0 with the least |A y − b|, by Lawson and Hanson's method: columns join while they lower it, and those whose y would
/// fall below 0 leave.
fn non_negative(a: &DMatrix<f64>, b: &DVector<f64>) -> DVector<f64> {
    let n = a.ncols();
    let (mut y, mut free) = (DVector::zeros(n), vec![false; n]);
    for _ in 0..3 * n + 30 {
        let slope = a.transpose() * (b - a * &y);
        let next = (0..n).filter(|&k| !free[k] && slope[k] > 1e-12).max_by(|&i, &j| slope[i].total_cmp(&slope[j]));
        let Some(next) = next else { break };
        free[next] = true;
        loop {
            let chosen: Vec<usize> = (0..n).filter(|&k| free[k]).collect();
            let columns = a.select_columns(&chosen);
            let Ok(solved) = columns.svd(true, true).solve(b, 1e-11) else { return y };
            let falls = |&(i, &k): &(usize, &usize)| solved[i] <= 0.0 && (y[k] > 0.0 || k == next);
            let share = chosen.iter().enumerate().filter(falls).map(|(i, &k)| y[k] / (y[k] - solved[i]).max(1e-300));
            let share = share.fold(1.0, f64::min);
            for (i, &k) in chosen.iter().enumerate() {
                y[k] += share * (solved[i] - y[k]);
            }
            if share >= 1.0 {
                break;
            }
            for &k in &chosen {
                if y[k] <= 1e-14 {
                    (y[k], free[k]) = (0.0, false);
                }
            }
        }
    }
    y
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against the conditions of the least: no free column has a slope, and none of the others would lower it.
    #[test]
    fn the_least_with_non_negative_entries() {
        use rand::{RngExt, SeedableRng};
        let mut rng = rand::rngs::ChaCha8Rng::seed_from_u64(11);
        for _ in 0..200 {
            let (rows, columns) = (rng.random_range(1..9), rng.random_range(1..12));
            let a = DMatrix::from_fn(rows, columns, |_, _| rng.random_range(-1.0..1.0));
            let b = DVector::from_fn(rows, |_, _| rng.random_range(-1.0..1.0));
            let y = non_negative(&a, &b);
            let slope = a.transpose() * (&b - &a * &y);
            for k in 0..columns {
                assert!(y[k] >= 0.0 && slope[k] < 1e-8 && (slope[k] * y[k]).abs() < 1e-8, "{y} {slope}");
            }
        }
    }
}
