//! The mesh of the tube round a curve of segments and arcs: closed, oriented outward, within a chordal tolerance. Of a frame each strut
//! is meshed by itself, with round ends, as an open curve has them.
//!
//! Sections of the wire stand across the curve, so near to each other that their chords stay within the tolerance; straight pieces
//! need none between their ends. From section to section the frame turns only with the tangent; what it is turned by after one
//! round of a closed curve is spread over the whole length. Round a corner the section turns about it, so that the outside is a part of a ball; inside
//! the bend its two straight tubes run into each other.

use super::{
    error::MeshError,
    torus::{Fineness, MOST, Segments, TorusMesh, polygon, sagitta},
};
use maille::{design::CurveKind, model::Curve};
use maille_geometry::{Piece, Vec3};
use nalgebra::{Rotation3, Unit};
use std::f64::consts::TAU;

/// A place of a section: the point, the tangent, and how far along the curve.
struct Section {
    point: Vec3,
    tangent: Vec3,
    along: f64,
}

/// Vertices of neighbouring sections that are nearer are one, in minor radii.
const SHARED: f64 = 1e-9;
/// Most sections of one curve.
const MOST_SECTIONS: usize = 64 * MOST;

/// The mesh of the tube of radius `minor_radius` round `curve`, both in units of `unit`; lengths of the mesh are in those of the tolerance
/// times `mm`.
pub(super) fn curve_mesh(
    curve: &Curve,
    [major_radius, minor_radius]: [f64; 2],
    fineness: Fineness,
    unit: f64,
    mm: f64,
) -> Result<TorusMesh, MeshError> {
    let small = minor_radius * unit;
    let radii = curve.pieces.iter().filter_map(radius);
    let widest = radii.fold(0.0, f64::max) * unit + small;
    // The wire may take half of the tolerance, and the curve the other half.
    let (share, across) = match fineness {
        Fineness::Tolerance(tolerance) => (0.5 * tolerance, polygon(small, 0.5 * tolerance)),
        Fineness::Segments(around, across) => {
            let share = sagitta(widest, around);
            (share, across.unwrap_or_else(|| polygon(small, share).max(6)))
        }
    };
    if across > MOST {
        return Err(MeshError::TooFine { segments: across, most: MOST });
    }
    if across < 3 {
        return Err(MeshError::TooCoarse);
    }
    let [near, thin] = [share / unit, small / unit];
    let steps = polygon(small, share).div_ceil(4);
    let (rows, sections_of_rod) = match curve.kind {
        CurveKind::Closed => (tube(&curve.pieces, thin, near), None),
        CurveKind::Open => {
            let own: Vec<Piece> = curve.own_pieces().copied().collect();
            let rows = rod(&own, thin, near, steps);
            let sections = rows.len();
            (rows, Some(sections))
        }
        CurveKind::Frame => {
            let rods = curve.own_pieces().flat_map(|strut| rod(&[*strut], thin, near, steps));
            (rods.collect::<Vec<_>>(), Some(2 * (steps + 1)))
        }
    };
    if rows.len() > MOST_SECTIONS {
        return Err(MeshError::TooFine { segments: rows.len(), most: MOST_SECTIONS });
    }
    let (mut vertices, mut normals) = (Vec::new(), Vec::new());
    for Row { point, across: [u, v], along } in &rows {
        for j in 0..across {
            let (sin, cos) = (TAU * j as f64 / across as f64).sin_cos();
            let normal = u * cos + v * sin + along;
            let vertex = (point + normal * minor_radius) * (unit * mm);
            // Sections at a corner turn about vertices that they share, to the last digit.
            let before = vertices.len().checked_sub(across).map(|k| vertices[k]);
            let shared = before.filter(|before: &Vec3| (before - vertex).norm() < SHARED * small * mm);
            vertices.push(shared.unwrap_or(vertex));
            normals.push(normal);
        }
    }
    let segments = Segments { around: rows.len(), across };
    let [major_radius, minor_radius] = [major_radius, minor_radius].map(|r| r * unit * mm);
    let chords = Some(share * mm);
    Ok(TorusMesh { major_radius, minor_radius, segments, chords, sections_of_rod, vertices, normals })
}

/// The vertices round a place: at point + r (u cos + v sin + along).
struct Row {
    point: Vec3,
    across: [Vec3; 2],
    along: Vec3,
}

/// Rows round a closed curve.
fn tube(pieces: &[Piece], small: f64, share: f64) -> Vec<Row> {
    let sections = sections(pieces, true, small, share);
    let frames = frames(&sections, Some(pieces.iter().map(Piece::length).sum()));
    let rows = sections.iter().zip(frames);
    rows.map(|(section, across)| Row { point: section.point, across, along: Vec3::zeros() }).collect()
}

/// Rows round an open curve with round ends, each a half ball of so many steps, from pole to pole.
fn rod(pieces: &[Piece], small: f64, share: f64, steps: usize) -> Vec<Row> {
    let sections = sections(pieces, false, small, share);
    let frames = frames(&sections, None);
    let row = |at: usize, k: usize, way: f64| {
        let (sin, cos) = (TAU / 4.0 * k as f64 / steps as f64).sin_cos();
        let Section { point, tangent, .. } = sections[at];
        Row { point, across: frames[at].map(|across| across * cos), along: tangent * (way * sin) }
    };
    let last = sections.len() - 1;
    let start = (0..=steps).rev().map(|k| row(0, k, -1.0));
    start.chain((1..last).map(|at| row(at, 0, 0.0))).chain((0..=steps).map(|k| row(last, k, 1.0))).collect()
}

fn radius(piece: &Piece) -> Option<f64> {
    if let Piece::Arc(arc) = piece { Some(arc.circle().radius) } else { None }
}

/// Places of sections whose chords are within `share` of the tube of radius `small`, counted at its outside.
fn sections(pieces: &[Piece], closed: bool, small: f64, share: f64) -> Vec<Section> {
    let mut all: Vec<Section> = Vec::new();
    let mut before: f64 = 0.0;
    for (k, piece) in pieces.iter().enumerate() {
        let steps = match piece {
            Piece::Segment(_) => 1,
            Piece::Arc(arc) => {
                let whole = polygon(arc.circle().radius + small, share) as f64;
                (arc.sweep_rad() / TAU * whole * (1.0 - 1e-12)).ceil().max(1.0) as usize
            }
        };
        let length = piece.length();
        all.extend((0..=steps).map(|step| {
            let t = step as f64 / steps as f64;
            Section { point: piece.point(t), tangent: piece.tangent(t), along: before + length * t }
        }));
        before += length;
        if closed || k + 1 < pieces.len() {
            let next = &pieces[(k + 1) % pieces.len()];
            all.extend(corner(next.point(0.0), piece.tangent(1.0), next.tangent(0.0), before, small, share));
        }
    }
    // Where pieces meet smoothly one ends and the other begins with the same section.
    all.dedup_by(|next, one| (next.point - one.point).norm() <= SAME && (next.tangent - one.tangent).norm() <= CORNER);
    // A run of length L that turns by τ strays from its chord by at most Lτ/4.
    let mut out: Vec<Section> = Vec::with_capacity(all.len());
    let first = (all[0].point, all[0].tangent);
    let (mut waiting, mut turn_rad): (Option<Section>, f64) = (None, 0.0);
    for section in all {
        let Some(held) = waiting.replace(section) else { continue };
        let Some(section) = &waiting else { continue };
        let turn = held.tangent.angle(&section.tangent);
        let from = out.last().map_or(f64::NEG_INFINITY, |last| last.along);
        let length = section.along - from + small * (turn_rad + turn);
        if out.is_empty() || 0.25 * length * (turn_rad + turn) > share {
            out.push(held);
            turn_rad = 0.0;
        }
        turn_rad += turn;
    }
    // The last section of a closed curve is the first one.
    out.extend(
        waiting
            .filter(|last| !closed || (last.point - first.0).norm() > SAME || (last.tangent - first.1).norm() > CORNER),
    );
    out
}

/// Tangents that differ by more make a corner.
const CORNER: f64 = 1e-7;
/// Sections that are nearer are one, in reference radii.
const SAME: f64 = 1e-9;

/// Sections between the tangents at a corner, both left out.
fn corner(point: Vec3, before: Vec3, after: Vec3, along: f64, small: f64, share: f64) -> Vec<Section> {
    let turn_rad = before.angle(&after);
    if before.cross(&after).norm() < CORNER {
        return Vec::new();
    }
    let axis = Unit::new_normalize(before.cross(&after));
    let steps = (turn_rad / (TAU / polygon(small, share) as f64)).ceil().max(1.0) as usize;
    let tangent = |k: usize| Rotation3::from_axis_angle(&axis, turn_rad * k as f64 / steps as f64) * before;
    (1..steps).map(|k| Section { point, tangent: tangent(k), along }).collect()
}

/// For each section two unit vectors u, v across the tangent, u × v against it: so faces look outward. A closed curve has a length.
fn frames(sections: &[Section], length: Option<f64>) -> Vec<[Vec3; 2]> {
    // The shortest turn from one tangent to the next, of a vector across the first. An angle by its cosine fails where they nearly are one.
    let carried = |u: Vec3, from: &Vec3, to: &Vec3| {
        let turned = u - (from + to) * (u.dot(to) / (1.0 + from.dot(to)));
        (turned - to * to.dot(&turned)).normalize()
    };
    let first = &sections[0];
    let least = first.tangent.iamin();
    let mut u = vec![first.tangent.cross(&Vec3::ith(least, 1.0)).normalize()];
    for pair in sections.windows(2) {
        u.push(carried(u[u.len() - 1], &pair[0].tangent, &pair[1].tangent));
    }
    let last = &sections[sections.len() - 1];
    let round = carried(u[u.len() - 1], &last.tangent, &first.tangent);
    let missed_rad: f64 = round.dot(&first.tangent.cross(&u[0])).atan2(round.dot(&u[0]));
    let turned = |(section, u): (&Section, &Vec3)| {
        let back_rad = length.map_or(0.0, |length| -missed_rad * section.along / length);
        let u = Rotation3::from_axis_angle(&Unit::new_normalize(section.tangent), back_rad) * u;
        [u, u.cross(&section.tangent)]
    };
    sections.iter().zip(&u).map(turned).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Scene;
    use maille::{Cell, model::Model};
    use maille_io::{Tile, read_design};
    use std::{
        collections::{BTreeSet, HashMap},
        f64::consts::PI,
    };

    fn curve(form: &str) -> Curve {
        let text = format!(
            "name = \"a\"\nminor_radius = 0.1\nreference_radius = 1.0\n[lattice]\na1 = [9.0, 0.0, 0.0]\na2 = [0.0, 9.0, 0.0]\n\
             [[elements]]\nname = \"e\"\ncenter = [0.0, 0.0, 0.0]\ncurves = [{{ {form} }}]\n"
        );
        let model = Model::compile(&read_design("a", &text).unwrap(), Cell::PRIMITIVE).unwrap();
        model.rings[0].curve.as_deref().unwrap().clone()
    }

    const OPEN: &str = "path = { from = [-1.0, -1.0, 0.0], parts = [{ to = [-1.0, 1.0, 0.0], through = [-2.0, 0.0, 0.0] }, { to = [1.0, -1.0, 0.0] }] }";
    const FORMS: [&str; 6] = [
        "stadium = { straight = 2.0, radius = 0.5 }",
        "square = { side = 1.6 }",
        "hexagon = { side = 1.0, fillet = 0.3 }",
        "ellipse = { a = 1.4, b = 0.8 }",
        "torus_knot = { p = 1, q = 4, R = 1.0, a = 0.4 }",
        OPEN,
    ];

    /// Closed, outward, within what it says of the tube, and not farther outside than it says.
    #[test]
    fn meshes_are_closed_and_near_their_tubes() {
        for form in FORMS {
            let curve = curve(form);
            for fineness in [Fineness::Tolerance(0.02), Fineness::Tolerance(0.004), Fineness::Segments(40, None)] {
                let mesh = curve_mesh(&curve, [1.0, 0.1], fineness, 1.0, 1.0).unwrap();
                let mut edges: HashMap<(usize, usize), usize> = HashMap::new();
                for [a, b, c] in mesh.triangles() {
                    [(a, b), (b, c), (c, a)].into_iter().for_each(|edge| *edges.entry(edge).or_default() += 1);
                }
                let twice = |(&(a, b), &count): (&(usize, usize), &usize)| count == 1 && edges.contains_key(&(b, a));
                assert!(edges.iter().all(twice), "{form}");
                // A torus has no more corners and faces than edges; what has two poles has two more.
                let used: BTreeSet<usize> = mesh.triangles().flatten().collect();
                let more = if form == OPEN { 2 } else { 0 };
                assert_eq!(used.len() + mesh.triangle_count(), edges.len() / 2 + more, "{form}");
                // By Pappus a section sweeps its area times the length; round a corner it turns about its middle, and sweeps nothing.
                let v = &mesh.vertices;
                let volume: f64 = mesh.triangles().map(|[a, b, c]| v[a].dot(&v[b].cross(&v[c])) / 6.0).sum();
                let balls = if form == OPEN { 1.0 } else { 0.0 };
                let tube = PI * 0.01 * (curve.own_length() + balls * 4.0 / 3.0 * 0.1);
                let skin = 2.0 * PI * 0.1 * (curve.own_length() + balls * 2.0 * 0.1);
                assert!((volume - tube).abs() < skin * mesh.chordal_error(), "{form}: {volume} of {tube}");
                let away = |p: &Vec3| {
                    let points = curve.pieces.iter().map(|piece| (piece.point(piece.nearest(p)) - p).norm());
                    points.fold(f64::INFINITY, f64::min) - 0.1
                };
                // Inside a sharp bend the two straight tubes run into each other.
                let sharp = form.starts_with("square") || form == OPEN;
                for corners in mesh.triangles() {
                    let [a, b, c] = corners.map(|k| v[k]);
                    for p in [a, (a + b) * 0.5, (b + c) * 0.5, (c + a) * 0.5, (a + b + c) / 3.0] {
                        let away = away(&p);
                        assert!(away < mesh.protrusion() + 1e-9, "{form}: {away} outside");
                        assert!(sharp || away > -mesh.chordal_error() - 1e-9, "{form}: {away} inside");
                    }
                }
            }
        }
    }

    /// As fine as the arcs of a smooth curve, and finer: no face without an area, none that is not finite. At a sharp corner sections turn about
    /// a vertex that they share.
    #[test]
    fn fine_meshes_have_no_empty_faces() {
        for form in FORMS {
            let curve = curve(form);
            for tolerance in [3e-3, 1e-3, 3e-4, 1e-4, 3e-5] {
                let mesh = curve_mesh(&curve, [1.0, 0.1], Fineness::Tolerance(tolerance), 1.0, 1.0).unwrap();
                let v = &mesh.vertices;
                for [a, b, c] in mesh.triangles() {
                    let area = 0.5 * (v[b] - v[a]).cross(&(v[c] - v[a])).norm();
                    let is_shared = v[a] == v[b] || v[b] == v[c] || v[c] == v[a];
                    assert!(
                        area > 1e-9 || (form.starts_with("square") || form == OPEN) && is_shared,
                        "{form} {tolerance}"
                    );
                }
            }
        }
    }

    /// Each strut of a frame is closed by half balls, and meshed once.
    #[test]
    fn struts_are_closed_and_near_their_capsules() {
        let curve = curve(
            "frame = { vertices = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.2], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.2]], \
             edges = [[0, 1], [1, 2], [2, 3], [3, 0], [0, 2]] }",
        );
        let struts: Vec<&Piece> = curve.own_pieces().collect();
        assert!(struts.len() > 1);
        for fineness in [Fineness::Tolerance(0.02), Fineness::Tolerance(0.002), Fineness::Segments(40, None)] {
            let mesh = curve_mesh(&curve, [1.0, 0.1], fineness, 1.0, 1.0).unwrap();
            let mut edges: HashMap<(usize, usize), usize> = HashMap::new();
            for [a, b, c] in mesh.triangles() {
                [(a, b), (b, c), (c, a)].into_iter().for_each(|edge| *edges.entry(edge).or_default() += 1);
            }
            assert!(edges.iter().all(|(&(a, b), &count)| count == 1 && edges.contains_key(&(b, a))));
            assert_eq!((mesh.triangles().count(), mesh.quads().count()), (mesh.triangle_count(), mesh.quad_count()));
            let v = &mesh.vertices;
            let volume: f64 = mesh.triangles().map(|[a, b, c]| v[a].dot(&v[b].cross(&v[c])) / 6.0).sum();
            let (mut capsules, mut skin) = (0.0, 0.0);
            for strut in &struts {
                capsules += PI * 0.01 * strut.length() + 4.0 / 3.0 * PI * 0.001;
                skin += 2.0 * PI * 0.1 * strut.length() + 4.0 * PI * 0.01;
            }
            let missing = capsules - volume;
            assert!(missing > 0.0 && missing < skin * mesh.chordal_error(), "{volume} of {capsules}");
            for (vertex, normal) in v.iter().zip(&mesh.normals) {
                let away = struts.iter().map(|strut| (strut.point(strut.nearest(vertex)) - vertex).norm());
                assert!(away.fold(f64::INFINITY, f64::min) < 0.1 + 1e-12 && (normal.norm() - 1.0).abs() < 1e-12);
            }
        }
    }

    /// A knot that lies about a circle in the plane is as high as its turns about it, and the wire.
    #[test]
    fn the_box_of_a_scene_holds_curves() {
        let text = format!(
            "name = \"a\"\nminor_radius = 0.1\nreference_radius = 1.0\n[lattice]\na1 = [9.0, 0.0, 0.0]\na2 = [0.0, 9.0, 0.0]\n\
             [[elements]]\nname = \"e\"\ncenter = [0.0, 0.0, 0.0]\ncurves = [{{ {} }}]\n",
            FORMS[4]
        );
        let model = Model::compile(&read_design("a", &text).unwrap(), Cell::PRIMITIVE).unwrap();
        let scene = Scene::new(&model, &model.start, Tile([1, 1]), Fineness::Tolerance(0.002), 1.0).unwrap();
        assert!(scene.shapes[0].vertices.iter().flatten().all(|x| x.is_finite()));
        let [least, largest] = scene.bounds();
        // Across, its outermost points are those of the circles of radius 1.4 at the ends of the axes.
        for (axis, half) in [(0, 1.5), (1, 1.5), (2, 0.5)] {
            assert!((largest[axis] - half).abs() < 0.004 && (least[axis] + half).abs() < 0.004, "{least} {largest}");
        }
    }

    #[test]
    fn what_makes_no_tube_is_refused() {
        let curve = curve(FORMS[0]);
        let of = |fineness| curve_mesh(&curve, [1.0, 0.1], fineness, 1.0, 1.0).map(|mesh| mesh.segments);
        assert!(matches!(of(Fineness::Tolerance(1e-9)), Err(MeshError::TooFine { .. })));
        assert!(matches!(of(Fineness::Segments(40, Some(2))), Err(MeshError::TooCoarse)));
    }
}
