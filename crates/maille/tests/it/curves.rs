//! Elements with curves that are no circles: derivatives, minima, limits with closed forms, and rings written as curves.

use crate::common::{self, exact_map, map, rows, shaken};
use maille::{
    design::{CurveSpec, Design, PathPart, Shape},
    lattice::Cell,
    model::{Core, Model, curve::curve_distance_minima},
    program::{LatticeFamily, Parameter, SheetProgram},
    record::Status,
    relaxation::limit::EnergyOptions,
    search::ExactOptions,
    solver::{
        constraints::{Derivatives, Loads, Row},
        sqp::Program,
    },
    survey::{CellChoice, MapQuestion, Method},
    topology::close_pairs,
};
use maille_geometry::{Vec3, piece_distance_minima};
use nalgebra::UnitQuaternion;
use rand::{RngExt, SeedableRng, rngs::ChaCha8Rng};
use std::f64::consts::{SQRT_2, TAU};

/// A chain of two links, the second turned by 90°.
fn chain(shape: Shape, minor_radius: f64, pitch: f64) -> Design {
    let mut design = common::design("cable", minor_radius);
    let mut standing = CurveSpec::of(shape.clone());
    standing.normal = [0.0, 1.0, 0.0];
    design.lattice.a1 = [pitch, 0.0, 0.0];
    for (element, (x, curve)) in design.elements.iter_mut().zip([(0.0, CurveSpec::of(shape)), (0.5 * pitch, standing)])
    {
        element.center = [x, 0.0, 0.0];
        (element.rings, element.curves) = (Vec::new(), vec![curve]);
        for curve in &mut element.curves {
            curve.minor_radius = Some(minor_radius);
        }
    }
    design.formulas.clear();
    design.parameters.clear();
    design
}

/// A built-in design whose rings are written as curves of a form.
fn rewritten(name: &str, form: impl Fn(f64) -> Shape) -> Design {
    let mut design = common::design(name, 0.1);
    for element in &mut design.elements {
        element.curves = element
            .rings
            .drain(..)
            .map(|ring| CurveSpec {
                normal: ring.normal,
                along: [0.3, 0.5, 0.77],
                offset: ring.offset,
                minor_radius: ring.minor_radius,
                ..CurveSpec::of(form(ring.major_radius))
            })
            .collect();
    }
    design
}

/// The published (1, 4) knot as a polygon of `n` corners, on its square lattice, in millimetres.
fn polygon_knot(n: usize) -> Design {
    let mut design = rewritten("european-4-in-1", |_| Shape::Stadium { straight: 0.0, radius: 1.0 });
    let corner = |k: usize| {
        let t = TAU * k as f64 / n as f64;
        let out = 5.5 + 2.7 * (4.0 * t).cos();
        [out * t.cos(), out * t.sin(), -2.7 * (4.0 * t).sin()]
    };
    let shape = Shape::Polyline { points: (0..n).map(corner).collect(), fillet: 0.0, closed: true };
    design.elements.truncate(1);
    design.elements[0].center = [0.0; 3];
    design.elements[0].curves = vec![CurveSpec::of(shape)];
    (design.minor_radius, design.reference_radius) = (Some(1.5), 5.5);
    design.lattice.a1 = [38.5 / 3.0, 0.0, 0.0];
    design.lattice.a2 = [0.0, 38.5 / 3.0, 0.0];
    design
}

fn compiled(design: &Design) -> Model {
    Model::compile(design, Cell::PRIMITIVE).unwrap()
}

fn forms() -> Vec<Shape> {
    let knot = |p: f64, q: f64| Shape::TorusKnot { p, q, circle_radius: 1.0, a: 0.4 };
    vec![
        Shape::Stadium { straight: 1.0, radius: 0.7 },
        Shape::Square { side: 2.0, fillet: 0.0 },
        Shape::Square { side: 2.0, fillet: 0.4 },
        Shape::Hexagon { side: 1.1, fillet: 0.2 },
        Shape::Ellipse { a: 1.4, b: 0.8 },
        knot(1.0, 4.0),
        knot(2.0, 3.0),
        path_of_stadium(1.0, 0.7),
        Shape::Spline {
            points: vec![[1.4, 0.0, 0.2], [0.0, 1.0, -0.2], [-1.2, 0.1, 0.3], [0.1, -0.9, 0.0]],
            closed: true,
        },
        hook(),
        Shape::Spline {
            points: vec![[1.4, 0.0, 0.2], [0.0, 1.0, -0.2], [-1.2, 0.1, 0.3], [0.1, -0.9, 0.0]],
            closed: false,
        },
    ]
}

/// An S-hook: half circles of radius 1 about (±1, 0), and the straight piece between them. Both ends are open.
fn hook() -> Shape {
    let part = |to: [f64; 2], through: Option<f64>| PathPart {
        to: [to[0], to[1], 0.0],
        through: through.map(|x| [x, 0.0, 0.0]),
    };
    let parts = vec![part([-1.0, 1.0], Some(-2.0)), part([1.0, -1.0], None), part([1.0, 1.0], Some(2.0))];
    Shape::Path { from: Some([-1.0, -1.0, 0.0]), parts }
}

fn path_of_stadium(straight: f64, radius: f64) -> Shape {
    let part = |to: [f64; 2], through: Option<[f64; 2]>| PathPart {
        to: [to[0], to[1], 0.0],
        through: through.map(|p| [p[0], p[1], 0.0]),
    };
    let h = 0.5 * straight;
    Shape::Path {
        from: None,
        parts: vec![
            part([h, -radius], None),
            part([h, radius], Some([h + radius, 0.0])),
            part([-h, radius], None),
            part([-h, -radius], Some([-h - radius * 0.8, -radius * 0.6])),
        ],
    }
}

/// Against all pairs of pieces, and steps along the curves to both sides of each minimum.
#[test]
fn minima_are_those_of_all_pieces() {
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    let (mut found, mut corners) = (0, 0);
    for (k, one) in forms().into_iter().enumerate() {
        for (m, other) in forms().into_iter().enumerate() {
            // A coarse knot has tens of pieces, not thousands.
            let mut design = chain(one.clone(), 0.05, 40.0);
            design.elements[1].curves[0].shape = other;
            design.curve_tolerance = Some(1e-3);
            let mut model = compiled(&design);
            for _ in 0..4 {
                let mut vector = |size: f64| Vec3::from_fn(|_, _| size * rng.random_range(-1.0..1.0));
                let (at, turn) = (vector(1.5), vector(3.0));
                model.start.poses[1].position = model.start.poses[0].position + at;
                model.start.poses[1].rotation = UnitQuaternion::from_scaled_axis(turn);
                let [a, b] = [0, 1].map(|ring| model.start.core(&model, ring, [0, 0]));
                let far = 1.2;
                let minima = curve_distance_minima(&a, &b, far);
                let least_of = |x: &[maille_geometry::Piece], y: &[maille_geometry::Piece]| {
                    let pairs = x.iter().flat_map(|p| y.iter().map(move |q| *piece_distance_minima(p, q).closest()));
                    pairs.map(|m| m.distance).fold(f64::INFINITY, f64::min)
                };
                let (of_a, of_b) = (a.pieces(), b.pieces());
                assert!((minima[0].distance - least_of(&of_a, &of_b)).abs() < 1e-12, "{k} {m}");
                // A grid: every local minimum of it is near one that was found.
                let n = 200;
                let points = |core: &Core| (0..n).map(|i| core.at_angle(TAU * i as f64 / n as f64).point).collect();
                let (p, q): (Vec<Vec3>, Vec<Vec3>) = (points(&a), points(&b));
                let at = |i: usize, j: usize| (p[i % n] - q[j % n]).norm();
                for i in n..2 * n {
                    for j in n..2 * n {
                        let here = at(i, j);
                        let around = (0..9).filter(|s| *s != 4).map(|s| at(i + s / 3 - 1, j + s % 3 - 1));
                        if here < far - 0.1 && around.fold(f64::INFINITY, f64::min) > here {
                            let near = minima.iter().any(|m| {
                                (m.a.point - p[i % n]).norm() < 0.2 && (m.b.point - q[j % n]).norm() < 0.2
                                    || (m.distance <= here && here - m.distance < 1e-3)
                            });
                            assert!(near, "{k} {m}: {here} at {i} {j}");
                        }
                    }
                }
                // None is false: steps to all sides lead no nearer.
                for minimum in minima.iter().filter(|m| m.distance <= far) {
                    let step = 1e-5;
                    for (s, t) in [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0), (1.0, 1.0), (1.0, -1.0)] {
                        let there = a.at_angle(minimum.a.angle_rad + step * s).point
                            - b.at_angle(minimum.b.angle_rad + step * t).point;
                        assert!(there.norm() > minimum.distance - 1e-9, "{k} {m}: {minimum:?}");
                    }
                    found += 1;
                    corners += usize::from(!minimum.a.smooth || !minimum.b.smooth);
                }
            }
        }
    }
    assert!(found > 250 && corners > 30, "{found} {corners}");
}

/// Gradients and Hessians of the gaps of shaken sheets by differences, corners and joints included.
#[test]
fn derivatives_are_those_of_the_gaps() {
    let (mut checked, mut held) = (0, 0);
    for (k, shape) in forms().into_iter().enumerate() {
        let mut design = rewritten("1.1", |_| shape.clone());
        design.elements[0].curves.clear();
        design.elements[0].rings = common::design("1.1", 0.1).elements[0].rings.clone();
        (design.allow_initial_overlap, design.minor_radius) = (true, Some(0.05));
        design.curve_tolerance = Some(1e-3);
        let model = compiled(&design);
        let along = |axis: Vec3| [model.start.a1, model.start.a2].map(|a| axis * a.dot(&axis));
        let parameters = vec![Parameter { rate: along(Vec3::x()), weight: 1.0, ..Parameter::default() }];
        let pull = LatticeFamily { base: [model.start.a1, model.start.a2], parameters, metric: None, roll: None };
        let program = SheetProgram::new(&model, &pull);
        let x = program.posed(shaken(&model, 0.1, 7 + k as u64), vec![0.03]);
        let n = program.objective().len();
        let load = |row: Row| maille::solver::constraints::Multiplier {
            key: row.key,
            angle: row.angle,
            angle_a: row.angle_a,
            minimum: row.minimum,
            value: 1.0,
        };
        let loads = Loads::new(&program.rows(&x, 0.5, Derivatives::First).into_iter().map(load).collect::<Vec<_>>());
        let near = |a: f64, b: f64| {
            let turn = (a - b).rem_euclid(TAU);
            turn.min(TAU - turn) < 0.02
        };
        for row in program.rows(&x, 0.5, Derivatives::Second(&loads)).iter().filter(|row| row.minimum) {
            let h = 2e-5;
            let gap = |step: &[f64]| {
                let there = program.rows(&program.moved(&x, step), 1.0, Derivatives::First);
                let same = there.iter().filter(|other| {
                    other.key == row.key && near(other.angle, row.angle) && near(other.angle_a, row.angle_a)
                });
                let found: Vec<f64> = same.filter(|other| other.minimum).map(|other| other.gap).collect();
                // Where another is as near there is no telling which it is.
                (found.len() == 1).then(|| found[0])
            };
            for (c, &column) in row.columns.iter().enumerate().filter(|(_, c)| **c < n) {
                let along = |t: f64| (0..n).map(|i| if i == column { t } else { 0.0 }).collect::<Vec<f64>>();
                let ([Some(up), Some(down)], Some(_)) = ([h, -h].map(|t| gap(&along(t))), gap(&along(0.0))) else {
                    continue;
                };
                let slope = (up - down) / (2.0 * h);
                assert!((slope - row.gradient[c]).abs() < 1e-6, "{shape:?}: {slope} {}", row.gradient[c]);
                let [Some(up), Some(down)] = [1e-3, -1e-3].map(|t| gap(&along(t))) else { continue };
                let (second, bend) = (row.hessian[c * row.columns.len() + c], (up - 2.0 * row.gap + down) / 1e-6);
                // Where a contact passes a joint within the step the second derivative jumps.
                if (bend - second).abs() < 2e-2 * second.abs().max(1.0) {
                    held += 1;
                }
                checked += 1;
            }
        }
    }
    assert!(checked > 300 && held * 10 > checked * 9, "{held} of {checked}");
}

/// Rings as stadia with sides of nearly no length are all that the general way sees; their limits are the rings'.
#[test]
fn limits_of_rings_written_as_curves_are_those_of_the_rings() {
    let (directions, l2) = ([20.0], [-0.1, 0.1]);
    for name in ["1.1", "1.2", "2", "3.1"] {
        let of = |design: &Design| {
            let model = compiled(design);
            let round = model.is_round();
            (map(&[model], &directions, &l2, &ExactOptions::default()), round)
        };
        let (rings, round) = of(&common::design(name, 0.1));
        assert!(round);
        let (curves, round) = of(&rewritten(name, |radius| Shape::Stadium { straight: 1e-10, radius }));
        assert!(!round);
        for (ring, curve) in rings.iter().zip(&curves) {
            let what = format!("{name} at {}°, l2 = {}", ring.row.direction_deg, ring.row.l2);
            assert_eq!(ring.row.status, curve.row.status, "{what}");
            match (ring.row.l1, curve.row.l1) {
                (Some(a), Some(b)) => assert!((a - b).abs() < 1e-8, "{what}: {a} {b}"),
                (a, b) => assert_eq!(a.is_some(), b.is_some(), "{what}"),
            }
        }
    }
}

/// Four arcs of one circle, an ellipse with equal axes, and a torus knot with a = 0 are rings.
#[test]
fn circles_in_other_words_are_rings() {
    type Form = fn(f64) -> Shape;
    let forms: [Form; 4] = [
        |radius| Shape::Square { side: 2.0 * radius, fillet: radius },
        |radius| Shape::Ellipse { a: radius, b: radius },
        |radius| Shape::TorusKnot { p: 1.0, q: 1.0, circle_radius: radius, a: 0.0 },
        |radius| Shape::Stadium { straight: 0.0, radius },
    ];
    for (form, name) in forms.iter().flat_map(|form| ["1.1", "1.2", "2", "3.1"].map(|name| (form, name))) {
        let (ring, other) = (common::model(name, 0.1), compiled(&rewritten(name, form)));
        assert!(other.is_round());
        // To the last digit: a search among many local limits may end elsewhere if one differs.
        for (a, b) in ring.rings.iter().zip(&other.rings) {
            assert_eq!((a.major_radius, a.minor_radius), (b.major_radius, b.minor_radius));
            assert_eq!((a.offset, a.normal), (b.offset, b.normal));
        }
    }
}

fn limit(design: &Design, direction_deg: f64) -> (f64, Status) {
    let found = map(&[compiled(design)], &[direction_deg], &[0.0], &ExactOptions::default());
    (found[0].row.l1.unwrap(), found[0].row.status)
}

/// Round end in round end: the pitch of two links is 2 (L + 2R − 2r). See docs/theory/curves.md.
#[test]
fn a_chain_of_stadia_has_its_closed_form() {
    for (straight, radius, r) in [(2.0, 1.0, 0.2), (0.5, 1.0, 0.1), (3.0, 0.6, 0.05)] {
        let pitch = 2.0 * (straight + 2.0 * radius - 2.0 * r);
        let (l1, status) = limit(&chain(Shape::Stadium { straight, radius }, r, 0.8 * pitch), 0.0);
        assert!((0.8 * pitch * (1.0 + l1) - pitch).abs() < 1e-10, "{l1}");
        assert_eq!(status, Status::Global);
    }
}

/// Corner in corner: 2 (√2 S − 2√3 r) with sharp corners of side S, where each side touches two of the other square; with corners of
/// radius ϱ where they are round enough, 2 (√2 (S − 2ϱ) + 2ϱ − 2r). See docs/theory/curves.md.
#[test]
fn a_chain_of_squares_has_its_closed_form() {
    for (fillet, r) in [(0.0, 0.1), (0.0, 0.05), (0.12, 0.1), (0.25, 0.1), (0.5, 0.1), (0.7, 0.2)] {
        let side = 2.0;
        let sharp = 2.0 * (SQRT_2 * side - 2.0 * 3.0_f64.sqrt() * r);
        let round = 2.0 * (SQRT_2 * (side - 2.0 * fillet) + 2.0 * fillet - 2.0 * r);
        let pitch = sharp.min(round);
        let (l1, status) = limit(&chain(Shape::Square { side, fillet }, r, 0.7 * pitch), 0.0);
        assert!((0.7 * pitch * (1.0 + l1) - pitch).abs() < 1e-10, "{fillet}: {} {pitch}", 0.7 * pitch * (1.0 + l1));
        assert_eq!(status == Status::Global, round < sharp, "{fillet}");
    }
}

/// Stadia as paths of two segments and two arcs; squares as frames, alone and with a strut across, whose cycles share it; and a frame whose
/// loose end is in nothing's way.
#[test]
fn paths_and_frames_lock_as_the_forms_that_they_are() {
    let (stadium, path) = (Shape::Stadium { straight: 1.0, radius: 0.7 }, path_of_stadium(1.0, 0.7));
    let limits = [stadium, path].map(|shape| limit(&chain(shape, 0.1, 3.0), 0.0));
    assert!((limits[0].0 - limits[1].0).abs() < 1e-10 && limits[0].1 == limits[1].1, "{limits:?}");
    let corners = [[1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0], [-1.0, -1.0, 0.0], [-1.0, -1.0, 0.3]];
    let sides = [[0, 1], [1, 2], [2, 3], [3, 0]];
    let frame = |corners: &[[f64; 3]], more: &[[u32; 2]]| Shape::Frame {
        vertices: corners.to_vec(),
        edges: sides.iter().chain(more).copied().collect(),
    };
    let pitch = 0.7 * 2.0 * (SQRT_2 * 2.0 - 2.0 * 3.0_f64.sqrt() * 0.1);
    let sharp = limit(&chain(Shape::Square { side: 2.0, fillet: 0.0 }, 0.1, pitch), 0.0);
    for (frame, curves) in [
        (frame(&corners[..4], &[]), 1),
        // The links pull at corners 0 and 2, which this strut does not touch.
        (frame(&corners[..4], &[[1, 3]]), 2),
        (frame(&corners, &[[3, 4]]), 2),
    ] {
        let design = chain(frame, 0.1, pitch);
        assert_eq!(compiled(&design).rings.len(), 2 * curves);
        let found = limit(&design, 0.0);
        assert!((found.0 - sharp.0).abs() < 1e-9 && found.1 == sharp.1, "{found:?} {sharp:?}");
    }
}

/// Hook in hook the cores are 4 long, and the pitch of two is 2 (4 − 2r). A ring that is cut open aside of the pull locks as the whole ring. No bound is
/// known of what is not linked, so both are local.
#[test]
fn open_curves_hold_where_closed_ones_do() {
    for r in [0.1, 0.2] {
        let (l1, status) = limit(&chain(hook(), r, 7.0), 0.0);
        assert!((7.0 * (1.0 + l1) - 2.0 * (4.0 - 2.0 * r)).abs() < 1e-10 && status == Status::Local, "{l1}");
    }
    // Not that each hook is linked to nothing: it cannot be.
    let warnings = maille::topology::warnings(&compiled(&chain(hook(), 0.1, 7.0)));
    assert!(warnings.len() == 1 && warnings[0].problem.contains("may come apart"), "{warnings:?}");
    let on_circle = |turn: f64| [(TAU * turn).cos(), (TAU * turn).sin(), 0.0];
    let arc = |to: f64, through: f64| PathPart { to: on_circle(to), through: Some(on_circle(through)) };
    let cut = Shape::Path { from: Some(on_circle(0.3)), parts: vec![arc(0.7, 0.5), arc(1.2, 0.9)] };
    let (whole, cut) = (Shape::Ellipse { a: 1.0, b: 1.0 }, cut);
    let [whole, cut] = [whole, cut].map(|shape| limit(&chain(shape, 0.15, 3.0), 0.0));
    assert!((whole.0 - cut.0).abs() < 1e-10, "{whole:?} {cut:?}");
    assert_eq!([whole.1, cut.1], [Status::Global, Status::Local]);
}

/// The published knot as a polygon: an independent prototype found 0.01589 for the Green strain along x, and the gap at rest is 0.119 mm.
#[test]
fn the_knot_of_forty_segments() {
    let design = polygon_knot(40);
    let model = compiled(&design);
    let (gap, _) = maille::topology::smallest_gap(&model, &model.start).unwrap();
    assert!((gap * model.unit - 0.119).abs() < 5e-4);
    let question = MapQuestion {
        cells: CellChoice::These(vec![Cell::PRIMITIVE]),
        ..exact_map(&ExactOptions::default(), &[0.0], &[0.0])
    };
    let found = rows(&[model], &question);
    let l1 = found[0].row.l1.unwrap();
    assert_eq!(found[0].row.status, Status::Local);
    assert!((l1 + 0.5 * l1 * l1 - 0.01589).abs() < 5e-6, "{l1}");
}

/// The energy method comes within its own resolution.
#[test]
fn the_energy_method_agrees() {
    let design = chain(Shape::Stadium { straight: 2.0, radius: 1.0 }, 0.2, 6.0);
    let question = MapQuestion {
        method: Method::Energy(EnergyOptions::default()),
        cells: CellChoice::Auto,
        directions_deg: vec![0.0],
        l2: vec![0.0],
        extremes: false,
    };
    let found = rows(&[compiled(&design)], &question);
    assert!((found[0].row.l1.unwrap() - 0.2).abs() < 1e-3, "{:?}", found[0].row.l1);
}

/// Every pair of a state is linked as at the start, whatever cell it is solved in.
#[test]
fn links_of_curves_are_the_same_in_every_cell() {
    let design = rewritten("1.1", |radius| Shape::Stadium { straight: 0.3, radius });
    let (one, four) = (compiled(&design), Model::compile(&design, Cell::new([[2, 0], [0, 2]]).unwrap()).unwrap());
    assert_eq!(one.links.len() * 4, four.links.len());
    assert!(close_pairs(&four, &four.start, 0.0).len() >= four.links.len());
}

/// Sides beside each other, nearly parallel: to first order the rows say how near the curves come after any small motion.
#[test]
fn rows_of_sides_beside_each_other_foresee_the_gap() {
    let mut rng = ChaCha8Rng::seed_from_u64(11);
    for shape in [
        Shape::Stadium { straight: 1.0, radius: 0.7 },
        Shape::Square { side: 2.0, fillet: 0.0 },
        Shape::Hexagon { side: 1.1, fillet: 0.2 },
    ] {
        let mut design = chain(shape, 0.05, 40.0);
        design.elements[1].curves[0].normal = design.elements[0].curves[0].normal;
        design.reference_radius = 1.0;
        let mut model = compiled(&design);
        let flat = model.start.core(&model, 0, [0, 0]);
        let wide = flat.extent(&Vec3::y()).map(f64::abs)[0] + flat.extent(&Vec3::y())[1];
        // Side by side, one shifted along the sides and tilted by less than can be seen.
        model.start.poses[1].position = model.start.poses[0].position + Vec3::new(0.4, wide + 0.1001, 0.0);
        model.start.poses[1].rotation = UnitQuaternion::from_scaled_axis(Vec3::new(0.0, 0.0, 1e-6));
        let parameters = vec![Parameter { weight: 1.0, ..Parameter::default() }];
        let family = LatticeFamily { base: [model.start.a1, model.start.a2], parameters, metric: None, roll: None };
        let program = SheetProgram::new(&model, &family);
        let x = program.posed(model.start.clone(), vec![0.0]);
        let n = program.objective().len();
        let rows = program.rows(&x, 0.05, Derivatives::First);
        for _ in 0..40 {
            let step: Vec<f64> = (0..n).map(|_| 1e-3 * rng.random_range(-1.0..1.0)).collect();
            let after = |row: &Row| {
                let held = row.columns.iter().zip(&row.gradient).filter(|(c, _)| **c < n);
                row.gap + held.map(|(c, g)| g * step[*c]).sum::<f64>()
            };
            let foreseen = rows.iter().map(after).fold(f64::INFINITY, f64::min);
            let there = program.rows(&program.moved(&x, &step), 0.1, Derivatives::First);
            let gap = there.iter().map(|row| row.gap).fold(f64::INFINITY, f64::min);
            assert!(
                (gap - foreseen).abs() < 1e-4,
                "{:?}: {gap}, foreseen {foreseen}",
                design.elements[0].curves[0].shape
            );
        }
    }
}
