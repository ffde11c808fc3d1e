//! Symmetries of designs, and the images of limits under them.

use crate::common::{builtin, design, exact_map, map, model, shaken};
use maille::{
    design::Design,
    lattice::Cell,
    model::Model,
    search::ExactOptions,
    state::State,
    survey::{CellChoice, Finished, Method, chains},
    symmetry::{Image, Orbit, between, operations, orbits},
    topology::{self, RingPair},
};
use maille_geometry::{Vec3, circle_distance_minima};
use nalgebra::{Matrix2, Quaternion, UnitQuaternion};

fn in_cell(design: &Design, cell: &str) -> Model {
    Model::compile(design, cell.parse().unwrap()).unwrap()
}

/// Two rings in general position on an oblique lattice; `turns` adds their images under a half turn of the plane.
fn oblique(turns: bool) -> Design {
    let mut out = design("1.1", 0.1);
    out.elements.truncate(if turns { 2 } else { 1 });
    out.lattice.a1 = [5.0, 0.3, 0.0];
    out.lattice.a2 = [1.1, 6.2, 0.0];
    let mut other = out.elements[0].clone();
    (out.elements[0].center, out.elements[0].rings[0].normal) = ([0.7, 0.2, 0.1], [0.3, -0.5, 0.8]);
    (other.center, other.rings[0].normal) = ([-0.4, 2.3, -0.2], [0.1, 0.9, 0.35]);
    other.name = "other".into();
    if turns {
        let [x, y, z] = out.elements[0].center;
        let [p, q, r] = out.elements[0].rings[0].normal;
        out.elements[1].center = [-x, -y - 3.0, z];
        out.elements[1].rings[0].normal = [-p, -q, r];
    } else {
        out.elements.push(other);
    }
    out
}

/// The same sheet, turned in its plane, in another basis.
fn turned(design: &Design, angle_deg: f64, basis: [[f64; 2]; 2]) -> Design {
    let (sin, cos) = angle_deg.to_radians().sin_cos();
    let turn = |[x, y, z]: [f64; 3]| [cos * x - sin * y, sin * x + cos * y, z];
    let mut out = design.clone();
    let (a1, a2) = (design.lattice.a1, design.lattice.a2);
    let vector = |[m, n]: [f64; 2]| turn([0, 1, 2].map(|k| m * a1[k] + n * a2[k]));
    (out.lattice.a1, out.lattice.a2) = (vector(basis[0]), vector(basis[1]));
    for element in &mut out.elements {
        element.center = turn(element.center);
        for ring in &mut element.rings {
            (ring.offset, ring.normal) = (turn(ring.offset), turn(ring.normal));
        }
    }
    out
}

/// Orders of the point groups, ±1 across the plane counted, as found by hand.
#[test]
fn point_groups_of_designs() {
    for (name, order) in [("1.1", 16), ("3.1", 24), ("european-4-in-1", 8), ("2-oblong", 8)] {
        assert_eq!(operations(&Model::compile(&builtin(name), Cell::PRIMITIVE).unwrap()).len(), order, "{name}");
    }
    // Circles alone are symmetric about their centres; two in general position are not.
    assert_eq!(operations(&in_cell(&oblique(false), "1x1")).len(), 1);
    let half_turn = operations(&in_cell(&oblique(true), "1x1"));
    assert_eq!(half_turn.len(), 2);
    assert_eq!((half_turn[1].direction_deg(20.0), half_turn[1].mirrors()), (20.0, false));
}

#[test]
fn orbits_are_those_of_the_point_group() {
    let square = operations(&model("1.1", 0.1));
    let hexagon = operations(&model("3.1", 0.1));
    let orbit = |representative_deg: f64, directions_deg: &[f64]| Orbit {
        representative_deg,
        directions_deg: directions_deg.to_vec(),
    };
    let asked: Vec<f64> = (0..=12).map(|k| 15.0 * f64::from(k)).collect();
    let expected = [
        orbit(0.0, &[0.0, 90.0, 180.0]),
        orbit(15.0, &[15.0, 75.0, 105.0, 165.0]),
        orbit(30.0, &[30.0, 60.0, 120.0, 150.0]),
        orbit(45.0, &[45.0, 135.0]),
    ];
    assert_eq!(orbits(&square, &asked), expected);
    let expected = [
        orbit(0.0, &[0.0, 60.0, 120.0, 180.0]),
        orbit(15.0, &[15.0, 45.0, 75.0, 105.0, 135.0, 165.0]),
        orbit(30.0, &[30.0, 90.0, 150.0]),
    ];
    assert_eq!(orbits(&hexagon, &asked), expected);
    // One of them alone is solved along the same direction, to the last bit.
    for asked in [179.9, 90.1, 0.1, 89.9, -0.1, 360.1] {
        assert_eq!(orbits(&square, &[asked])[0].representative_deg, 0.1, "{asked}");
    }
    assert_eq!(orbits(&square, &[22.123456789012345])[0].representative_deg, 22.123456789012345);
    // A larger cell keeps what keeps its lattice.
    let long = operations(&in_cell(&design("1.1", 0.1), "2x1"));
    assert_eq!(
        orbits(&long, &[0.0, 90.0, 15.0, 165.0]),
        [orbit(0.0, &[0.0]), orbit(90.0, &[90.0]), orbit(15.0, &[15.0, 165.0])]
    );
    assert_eq!(operations(&in_cell(&design("1.1", 0.1), "2x2")).len(), 16);
    assert_eq!(operations(&Model::compile_sheet(&design("1.1", 0.1), "2x2".parse().unwrap()).unwrap()).len(), 1);
}

/// Neither the basis nor the frame matters; the orbits turn with the sheet.
#[test]
fn symmetries_are_invariant() {
    for name in ["1.1", "3.1", "4.3", "2-oblong"] {
        let base = design(name, 0.05);
        let order = operations(&in_cell(&base, "1x1")).len();
        assert!(order >= 4, "{name}: {order}");
        for (angle_deg, basis) in [
            (0.0, [[1.0, 0.0], [3.0, 1.0]]),
            (0.0, [[0.0, 1.0], [1.0, 0.0]]),
            (17.0, [[1.0, 0.0], [0.0, 1.0]]),
            (-41.3, [[2.0, 1.0], [5.0, 3.0]]),
        ] {
            let there = operations(&in_cell(&turned(&base, angle_deg, basis), "1x1"));
            assert_eq!(there.len(), order, "{name} {angle_deg} {basis:?}");
            let of = |all: &[maille::symmetry::Operation], direction_deg: f64| {
                let mut out: Vec<f64> = all.iter().map(|o| o.direction_deg(direction_deg)).collect();
                out.sort_by(f64::total_cmp);
                out
            };
            let here = of(&operations(&in_cell(&base, "1x1")), 12.0);
            let turned = of(&there, 12.0 + angle_deg);
            let apart = |a: f64, b: f64| (a - b).rem_euclid(180.0).min((b - a).rem_euclid(180.0));
            for a in here {
                assert!(turned.iter().any(|b| apart(a + angle_deg, *b) < 1e-9), "{name} {angle_deg}: {a} {turned:?}");
            }
        }
        for cell in ["0,1;1,0", "1,0;1,1"] {
            assert_eq!(operations(&in_cell(&base, cell)).len(), order, "{name} in {cell}");
        }
    }
}

/// The images of any state, in any cell, keep the distances of all pairs of rings and its deformation.
#[test]
fn images_of_random_states_keep_all_distances() {
    for (name, cell) in [
        ("1.1", "2x1"),
        ("3.1", "2x1"),
        ("4.3", "1x1"),
        ("2-oblong", "1,1;-1,1"),
        ("european-4-in-1", "2x2"),
        ("5.1", "1x1"),
    ] {
        let design = builtin(name);
        let from = in_cell(&design, cell);
        let state = shaken(&from, 0.2, 5);
        let state =
            State { a1: Vec3::new(state.a1.x, state.a1.y, 0.0), a2: Vec3::new(state.a2.x, state.a2.y, 0.0), ..state };
        let all = operations(&in_cell(&design, "1x1"));
        assert!(all.len() >= 4, "{name}");
        for operation in &all {
            let to = in_cell(&design, &operation.cell(from.cell).unwrap().to_string());
            let built = from.in_cell(to.cell);
            assert_eq!(
                (format!("{:?}", built.start.a1), built.links.len()),
                (format!("{:?}", to.start.a1), to.links.len())
            );
            assert_eq!(
                built.elements.iter().map(|e| (&e.name, e.rings.clone())).collect::<Vec<_>>(),
                to.elements.iter().map(|e| (&e.name, e.rings.clone())).collect::<Vec<_>>()
            );
            let image = Image::new(operation, &from, &to).unwrap();
            let mapped = image.state(&state);
            let m = operation.matrix.fixed_view::<2, 2>(0, 0).into_owned();
            let f = m * state.deformation_gradient(&from) * m.transpose();
            assert!((mapped.deformation_gradient(&to) - f).amax() < 1e-9, "{name}: {m}");
            let mut pairs = topology::close_pairs(&from, &state, 0.5);
            assert_eq!(pairs.len(), topology::close_pairs(&to, &mapped, 0.5).len(), "{name}");
            pairs.truncate(60);
            for pair in pairs {
                let minima = |model: &Model, state: &State, pair: &RingPair| {
                    let circles =
                        (state.circle(model, pair.ring_a, [0, 0]), state.circle(model, pair.ring_b, pair.shift));
                    (circle_distance_minima(&circles.0, &circles.1).closest().distance, circles)
                };
                let (before, (a, b)) = minima(&from, &state, &pair);
                let points = [a.point(0.3), b.point(1.1)];
                let (there, [p, q]) = image.contact(&pair, points, &mapped);
                let (after, (a, b)) = minima(&to, &mapped, &there);
                assert!((before - after).abs() < 1e-9, "{name}: {before} {after}");
                // The points lie on the circles that the pair names.
                let off = |x: Vec3, c: &maille_geometry::Circle| {
                    let (x, n) = (x - c.center, c.normal.into_inner());
                    x.dot(&n).abs() + (x.norm() - c.radius).abs()
                };
                assert!(off(p, &a) + off(q, &b) < 1e-9, "{name}: {} {}", off(p, &a), off(q, &b));
                assert!(((points[1] - points[0]).norm() - (q - p).norm()).abs() < 1e-9, "{name}");
            }
        }
    }
}

/// A recorded state as poses of the model of its row.
fn state_of(found: &Finished, design: &Design) -> (Model, State) {
    let model = in_cell(design, &found.row.cell);
    let vector = |v: [f64; 3]| Vec3::from(v) / model.unit;
    let poses = found.state.poses.iter().zip(&model.elements).map(|(pose, element)| {
        assert_eq!(pose.element, element.name);
        let [w, i, j, k] = pose.rotation;
        let rotation = UnitQuaternion::from_quaternion(Quaternion::new(w, i, j, k));
        maille::state::Pose { position: vector(pose.position), rotation }
    });
    let state = State { poses: poses.collect(), a1: vector(found.state.a1), a2: vector(found.state.a2), roll: None };
    (model, state)
}

/// Rows of images agree, and their states have no overlap, the links of the design, the F of the pull, and contacts that touch.
#[test]
fn images_of_limits_are_limits() {
    let cases = [
        ("1.1", -0.25, true),
        ("3.1", -0.125, true),
        ("2-oblong", 0.0, false),
        ("5.1", 0.0, false),
        ("european-4-in-1", -0.15, true),
    ];
    for (name, l2, auto) in cases {
        let design = builtin(name);
        let method = Method::Exact(ExactOptions { starts: Some(2), ..ExactOptions::default() });
        let cell = if auto { CellChoice::Auto } else { CellChoice::from(Cell::PRIMITIVE) };
        let models: Vec<Model> = cell
            .cells(&method, design.elements.len())
            .into_iter()
            .map(|c| Model::compile(&design, c).unwrap())
            .collect();
        let Method::Exact(options) = &method else { unreachable!() };
        let directions = [20.0, 160.0, 70.0, 110.0, 80.0, 40.0, 140.0, 100.0];
        let found = map(&models, &directions, &[l2], options);
        let chains = chains(&models[0], &exact_map(options, &directions, &[l2]));
        assert!(chains.len() < directions.len(), "{name}: {chains:?}");
        for chain in &chains {
            let of = |degrees: f64| found.iter().find(|f| f.row.direction_deg == degrees).unwrap();
            let first = of(chain.directions_deg[0]);
            for &degrees in &chain.directions_deg {
                let found = of(degrees);
                let what = format!("{name} {degrees}°: {:?} {:?} {:?}", found.row.status, found.row.l1, found.row.cell);
                let solved = (degrees != chain.representative_deg).then_some(chain.representative_deg);
                assert_eq!(found.row.image_of_deg, solved, "{what}");
                assert_eq!(found.row.status, first.row.status, "{what}");
                let (Some(l1), Some(other)) = (found.row.l1, first.row.l1) else { continue };
                assert!((l1 - other).abs() < 1e-12, "{what} {other}");
                let (model, state) = state_of(found, &design);
                let gap = topology::smallest_gap(&model, &state).unwrap().0;
                assert!(gap > -1e-9, "{what}: {gap}");
                assert!(topology::links_kept(&model, &state), "{what}");
                let (sin, cos) = degrees.to_radians().sin_cos();
                let frame = Matrix2::new(cos, -sin, sin, cos);
                let f = frame.transpose() * state.deformation_gradient(&model) * frame;
                assert!((f - Matrix2::new(1.0 + l1, 0.0, 0.0, 1.0 + l2)).amax() < 1e-9, "{what}: {f}");
                assert!(!found.state.contacts.is_empty(), "{what}");
                for contact in &found.state.contacts {
                    let (a, b) = (Vec3::from(contact.point_a), Vec3::from(contact.point_b));
                    let pair = RingPair { ring_a: contact.ring_a, ring_b: contact.ring_b, shift: contact.shift };
                    let circles =
                        [state.circle(&model, pair.ring_a, [0, 0]), state.circle(&model, pair.ring_b, pair.shift)];
                    for (x, circle) in [a, b].into_iter().zip(&circles) {
                        let x = x / model.unit - circle.center;
                        assert!(x.dot(&circle.normal).abs() + (x.norm() - circle.radius).abs() < 1e-9, "{what}");
                    }
                    assert!(((b - a).normalize() - Vec3::from(contact.normal)).norm() < 1e-12, "{what}");
                }
                // The chain joins a ring to its image, by links and rigid edges of the first cell.
                if let Some(chain) = &found.state.chain {
                    let (first, last) = (chain.rings[0], *chain.rings.last().unwrap());
                    assert_eq!((first.0, first.1, last.1), (last.0, [0, 0], chain.vector), "{what}");
                    for pair in chain.rings.windows(2) {
                        let ((a, s), (b, t)) = (pair[0], pair[1]);
                        let shift = [t[0] - s[0], t[1] - s[1]];
                        let linked = models[0].links.iter().any(|link| {
                            let RingPair { ring_a, ring_b, shift: own } = link.pair;
                            (ring_a, ring_b, own) == (a, b, shift) || (ring_b, ring_a, own.map(|x| -x)) == (a, b, shift)
                        });
                        let rigid = models[0].rings[a].element == models[0].rings[b].element && shift == [0, 0];
                        assert!(linked || rigid, "{what}: {a} {b} {shift:?}");
                    }
                }
            }
        }
    }
}

/// A direction alone, one of a map, and its image give the same row.
#[test]
fn an_image_alone_is_that_of_a_map() {
    let models = [model("3.1", 0.1), in_cell(&design("3.1", 0.1), "2x1")];
    let options = ExactOptions { starts: Some(2), ..ExactOptions::default() };
    let alone = map(&models, &[105.0], &[-0.25, 0.0], &options);
    let all = map(&models, &[15.0, 45.0, 105.0], &[-0.25, 0.0], &options);
    for found in alone {
        let other = all.iter().find(|f| (f.row.direction_deg, f.row.l2) == (105.0, found.row.l2)).unwrap();
        assert_eq!(found.row.image_of_deg, Some(15.0));
        assert_eq!((found.row.l1, found.row.status), (other.row.l1, other.row.status));
        assert_eq!(found.state, other.state);
    }
}

/// 172.5° of design 2 is an image of 7.5°: both have one limit, and it is no lower than what either found when it was solved by itself
/// (0.580927 and 0.617304).
#[test]
fn a_limit_is_that_of_all_directions_of_its_orbit() {
    let found = map(&[model("2-oblong", 0.1)], &[7.5, 172.5], &[-0.25], &ExactOptions::default());
    let l1 = [0, 1].map(|k: usize| found[k].row.l1.unwrap());
    assert!(l1[0] > 0.617303 && (l1[0] - l1[1]).abs() < 1e-12, "{l1:?}");
}

/// A compression of 1.1 in a square cell is that of the other axis; and what is free is free to both sides on a mirror.
#[test]
fn compression_and_a_free_shear_are_symmetric() {
    let square = [in_cell(&design("1.1", 0.1), "2x2")];
    let options = ExactOptions { starts: Some(1), compression: true, ..ExactOptions::default() };
    let found = map(&square, &[0.0, 90.0], &[0.0], &options);
    assert_eq!(found[1].row.image_of_deg, Some(0.0));
    let l1 = [0, 1].map(|k: usize| found[k].row.l1.unwrap());
    assert!(l1[0] < -0.5 && (l1[0] - l1[1]).abs() < 1e-12, "{l1:?}");
    let across = maille::lattice::Across { lateral_free: true, shear_free: true };
    let options = ExactOptions { starts: Some(1), across, ..ExactOptions::default() };
    let found = map(&[model("1.1", 0.1)], &[0.0, 20.0, 160.0], &[0.0], &options);
    let shear = |k: usize| (found[k].row.shear_min.unwrap(), found[k].row.shear_max.unwrap());
    assert_eq!(shear(0).0, -shear(0).1);
    assert_eq!(shear(1), (-shear(2).1, -shear(2).0));
    let all = operations(&model("1.1", 0.1));
    assert_eq!(between(&all, 20.0, 160.0).filter(|o| !o.mirrors()).count(), 0);
}
