//! The proven bounds against closed forms, their invariances, and states that try to break them.

use crate::common::{builtin, design};
use maille::{
    bound::{Bound, BoundKind, ChainBound, LinkBound, best_bound, crossing_pairs_length},
    design::Design,
    lattice::{Across, Direction},
    model::Model,
    state::State,
    topology,
};
use maille_geometry::{Circle, Vec3, circle_distance_minima, linking_number};
use nalgebra::{UnitVector3, Vector2};
use rand::{RngExt, SeedableRng, rngs::ChaCha8Rng};

const DESIGNS: [&str; 15] =
    ["1.1", "1.2", "1.3", "1.3-small", "2", "2-oblong", "3.1", "3.2", "3.3", "3.4", "4.1", "4.2", "4.3", "5.1", "5.2"];

fn model(name: &str, r: f64, cell: &str) -> Model {
    Model::compile(&design(name, r), cell.parse().unwrap()).unwrap()
}

fn bounds(name: &str, r: f64, cell: &str) -> (ChainBound, LinkBound) {
    let model = model(name, r, cell);
    let chain = ChainBound::new(&model);
    let link = LinkBound::new(&model, &chain);
    (chain, link)
}

fn queries() -> impl Iterator<Item = (f64, f64)> {
    (0..13).flat_map(|k| [-0.25, -0.125, 0.0, 0.125].map(|l2| (15.0 * f64::from(k), l2)))
}

#[test]
fn known_limits_attain_the_bound() {
    let known = [
        ("1.1", 0.1, 0.0, 0.0, 0.44),
        ("1.1", 0.1, 90.0, 0.0, 0.44),
        ("1.1", 0.1, 15.0, 0.0, 0.466520034632),
        ("1.1", 0.1, 45.0, 0.0, 0.774034949),
        ("1.1", 0.1, 45.0, -0.25, 0.89333040),
        ("1.1", 0.05, 0.0, 0.0, 0.52),
        ("3.1", 0.1, 30.0, 0.0, 0.55931609),
        ("1.2", 0.1, 45.0, 0.0, 0.07851750),
        ("1.2", 0.1, 0.0, 0.0, 0.04),
        ("1.2", 0.05, 0.0, 0.0, 0.12),
    ];
    for (name, r, degrees, l2, l1) in known {
        let (chain, link) = bounds(name, r, "1x1");
        let Bound::Finite { l1: bound, kind, chain: path, .. } = chain.limit(Direction::of_degrees(degrees), l2) else {
            panic!("{name} {degrees}")
        };
        assert!((bound - l1).abs() < 1e-8, "{name} r = {r}, {degrees}°, l2 = {l2}: {bound} for {l1}");
        assert_eq!(kind, BoundKind::Chain);
        let path = path.unwrap();
        let (first, last) = (path.rings[0], *path.rings.last().unwrap());
        assert_eq!((first.0, [0, 0], path.vector), (last.0, first.1, last.1));
        let proved = link.limit(Direction::of_degrees(degrees), l2);
        assert!((proved.l1 - bound).abs() < 1e-10, "{name} {degrees}° {l2}: {} for {bound}", proved.l1);
    }
    let l1 = bounds("1.1", 0.1, "1x1").0.limit(Direction::of_degrees(0.0), 0.0).l1().unwrap();
    assert!((l1 - 0.44).abs() < 1e-15, "a closed form to the last digit: {l1}");
    // Here rings that are not linked get in the way first: the limit is 0.58405762.
    let l1 = bounds("3.1", 0.1, "1x1").0.limit(Direction::of_degrees(30.0), -0.125).l1().unwrap();
    assert!((l1 - 0.58416908).abs() < 1e-8, "{l1}");
}

/// A chain's length is the sum of its edges, and its vector joins its ends: checked with the model, not with the graph.
#[test]
fn chains_are_chains_of_links() {
    for name in DESIGNS {
        let model = model(name, 0.1, "1x1");
        let chain = ChainBound::new(&model);
        assert!(chain.chains().count() >= 2, "{name}: binds in both directions");
        for path in chain.chains() {
            let mut length = 0.0;
            for pair in path.rings.windows(2) {
                let ((a, s), (b, t)) = (pair[0], pair[1]);
                let shift = [t[0] - s[0], t[1] - s[1]];
                let (ra, rb) = (&model.rings[a], &model.rings[b]);
                if ra.element == rb.element && shift == [0, 0] {
                    length += (ra.offset - rb.offset).norm();
                } else {
                    let linked = model.links.iter().any(|l| {
                        let p = l.pair;
                        (p.ring_a, p.ring_b, p.shift) == (a, b, shift)
                            || (p.ring_b, p.ring_a, p.shift.map(|x| -x)) == (a, b, shift)
                    });
                    assert!(linked, "{name}: {a} and {b} at {shift:?}");
                    length += ra.major_radius + rb.major_radius - ra.minor_radius - rb.minor_radius;
                }
            }
            assert!((length - path.length).abs() < 1e-12);
        }
    }
}

#[test]
fn link_bound_is_never_above_the_chain_bound() {
    for name in DESIGNS {
        for r in [0.05, 0.1] {
            let (chain, link) = bounds(name, r, "1x1");
            for (degrees, l2) in queries() {
                let proved = link.limit(Direction::of_degrees(degrees), l2);
                match chain.limit(Direction::of_degrees(degrees), l2) {
                    Bound::Finite { l1, .. } => {
                        assert!(proved.l1 <= l1 + 1e-9, "{name} {r} {degrees} {l2}: {} above {l1}", proved.l1);
                        assert!(proved.l1 >= proved.primal_l1 - 1e-7, "{name} {r} {degrees} {l2}: {proved:?}");
                        let gap = proved.l1 - proved.primal_l1;
                        assert!(proved.l2_unreachable() || gap < 1e-7, "{name} {r} {degrees} {l2}: {gap:e}");
                    }
                    Bound::L2Unreachable { chain: path, .. } => {
                        assert!(path.is_some() && l2 > chain.most_l2(Direction::of_degrees(degrees)));
                        assert!(proved.l2_unreachable(), "{name} {r} {degrees} {l2}: {proved:?}");
                    }
                    Bound::Unbounded => panic!("{name} {degrees}"),
                }
            }
        }
    }
}

/// Where the program over all links proves more than chains do, at r = 0.1.
#[test]
fn link_bound_improves_branched_and_doubled_weaves() {
    for name in DESIGNS {
        let (chain, link) = bounds(name, 0.1, "1x1");
        let better = queries()
            .filter(|&(degrees, l2)| {
                matches!(
                    best_bound(&chain, Some(&link), Direction::of_degrees(degrees), l2).kind(),
                    Some(BoundKind::Link)
                )
            })
            .count();
        match name {
            "3.4" | "4.3" => assert!((1..queries().count()).contains(&better), "{name}: {better}"),
            "5.1" | "5.2" => assert_eq!(better, queries().count(), "{name}"),
            _ => assert_eq!(better, 0, "{name}"),
        }
    }
    // Four rings of a doubled weave cross: 2 L for 2 (1 + 1 - 2r) along the threads, at any r/R up to 1/7.
    for r in [0.1, 0.05, 0.02] {
        let (chain, link) = bounds("5.1", r, "1x1");
        let Bound::Finite { l1, .. } = best_bound(&chain, Some(&link), Direction::of_degrees(0.0), 0.0) else {
            panic!()
        };
        assert!((l1 - (2.0 * crossing_pairs_length(1.0, r).unwrap() / 2.7 - 1.0)).abs() < 1e-10, "{l1}");
        assert!(
            (chain.limit(Direction::of_degrees(0.0), 0.0).l1().unwrap() - ((4.0 - 4.0 * r) / 2.7 - 1.0)).abs() < 1e-14
        );
    }
}

fn same(a: &Bound, b: &Bound, tolerance: f64) -> bool {
    match (a, b) {
        (Bound::Finite { l1: x, .. }, Bound::Finite { l1: y, .. }) => (x - y).abs() <= tolerance,
        _ => std::mem::discriminant(a) == std::mem::discriminant(b),
    }
}

#[test]
fn bounds_are_the_same_for_every_cell_and_basis() {
    for name in DESIGNS {
        let primitive = bounds(name, 0.1, "1x1");
        for cell in ["2x1", "3x2", "1,0;1,1", "1,2;-1,1", "1,0;7,1"] {
            let chain = ChainBound::new(&model(name, 0.1, cell));
            for (degrees, l2) in queries() {
                let (a, b) = (
                    primitive.0.limit(Direction::of_degrees(degrees), l2),
                    chain.limit(Direction::of_degrees(degrees), l2),
                );
                assert!(same(&a, &b, 1e-12), "{name} {cell} {degrees} {l2}: {a:?} {b:?}");
            }
        }
        for cell in ["2x1", "1,0;7,1"] {
            let link = bounds(name, 0.1, cell).1;
            for (degrees, l2) in [(0.0, 0.0), (20.0, -0.125), (45.0, -0.25), (90.0, 0.0)] {
                let (a, b) = (
                    primitive.1.limit(Direction::of_degrees(degrees), l2).l1,
                    link.limit(Direction::of_degrees(degrees), l2).l1,
                );
                assert!((a - b).abs() < 1e-8, "{name} {cell} {degrees} {l2}: {a} {b}");
            }
        }
    }
}

#[test]
fn scale_changes_nothing_and_thinner_wire_allows_more() {
    for name in DESIGNS {
        let mut large = design(name, 0.1);
        let scale = |x: &mut [f64; 3]| x.iter_mut().for_each(|x| *x *= 37.0);
        large.reference_radius *= 37.0;
        large.minor_radius = Some(3.7);
        scale(&mut large.lattice.a1);
        scale(&mut large.lattice.a2);
        for element in &mut large.elements {
            scale(&mut element.center);
            for ring in &mut element.rings {
                scale(&mut ring.offset);
                ring.major_radius *= 37.0;
            }
        }
        let large = ChainBound::new(&Model::compile(&large, "1x1".parse().unwrap()).unwrap());
        let (thick, thin) = (bounds(name, 0.1, "1x1"), bounds(name, 0.05, "1x1"));
        for (degrees, l2) in queries() {
            let bound = thick.0.limit(Direction::of_degrees(degrees), l2);
            assert!(same(&bound, &large.limit(Direction::of_degrees(degrees), l2), 1e-13));
            if let Some(l1) = bound.l1() {
                assert!(thin.0.limit(Direction::of_degrees(degrees), l2).l1().unwrap() > l1);
                let proved = [&thick, &thin].map(|b| b.1.limit(Direction::of_degrees(degrees), l2).l1);
                assert!(proved[1] > proved[0], "{name} {degrees} {l2}: {proved:?}");
            }
        }
    }
}

/// The chain bound leaves 1.2, 1.3, 3.2 and 4.1 no limit ≥ 0 at l2 = 0.125, r = 0.1, in any direction.
#[test]
fn widening_is_impossible_where_the_start_is_too_wide() {
    for name in ["1.2", "1.3-small", "3.2", "4.1"] {
        let (chain, link) = bounds(name, 0.1, "1x1");
        for k in 0..25 {
            match best_bound(&chain, Some(&link), Direction::of_degrees(7.5 * f64::from(k)), 0.125) {
                Bound::Finite { l1, .. } => assert!(l1 < 0.0, "{name}"),
                Bound::L2Unreachable { chain, .. } => assert!(chain.is_some()),
                Bound::Unbounded => panic!("{name}"),
            }
        }
    }
}

/// A weave that is linked along one direction only: bound along it, unbounded across it, finite in between.
#[test]
fn threads_bind_along_themselves_only() {
    let mut threads = design("1.1", 0.1);
    threads.elements.retain(|e| e.rings[0].normal != [1.0, 0.0, 0.0]);
    assert_eq!(threads.elements.len(), 2);
    let model = Model::compile(&threads, "1x1".parse().unwrap()).unwrap();
    let chain = ChainBound::new(&model);
    let link = LinkBound::new(&model, &chain);
    assert_eq!(chain.chains().count(), 1);
    assert!(same(
        &chain.limit(Direction::of_degrees(0.0), 3.0),
        &Bound::Finite { l1: 0.44, kind: BoundKind::Chain, chain: None, dual: Vec::new() },
        1e-15
    ));
    assert_eq!(chain.limit(Direction::of_degrees(90.0), 0.0), Bound::Unbounded);
    assert!(matches!(chain.limit(Direction::of_degrees(90.0), 0.45), Bound::L2Unreachable { .. }));
    assert_eq!(link.limit(Direction::of_degrees(90.0), 0.0).l1, f64::INFINITY);
    assert!(
        (chain.limit(Direction::of_degrees(30.0), 0.0).l1().unwrap() - link.limit(Direction::of_degrees(30.0), 0.0).l1)
            .abs()
            < 1e-9
    );
}

/// Beside the direction across a chain the chain still bounds l1; across it, but for the rounding of the direction, it does not.
#[test]
fn a_chain_binds_next_to_the_direction_across_it() {
    let mut threads = design("1.1", 0.1);
    threads.elements.retain(|e| e.rings[0].normal != [1.0, 0.0, 0.0]);
    let chain = |threads: &Design| ChainBound::new(&Model::compile(threads, "1x1".parse().unwrap()).unwrap());
    for off_deg in [1e-3, 1e-6, 1e-8, -1e-8, 1e-10] {
        let l1 = chain(&threads).limit(Direction::of_degrees(90.0 + off_deg), 0.0).l1().unwrap();
        // v = 2.5 and d = 3.6; what 90° + off is in binary.
        let off_rad = ((90.0 + off_deg) - 90.0_f64).to_radians().abs();
        let used = 2.5 * off_rad.cos();
        let exact = (3.6_f64.powi(2) - used * used).sqrt() / (2.5 * off_rad.sin()) - 1.0;
        assert!((l1 / exact - 1.0).abs() < 1e-3, "{off_deg}: {l1} for {exact}");
    }
    // The same threads turned, pulled across: in decimals of a degree and of a lattice vector.
    for k in 0..480 {
        let degrees = 0.75 * f64::from(k);
        let (sin, cos) = degrees.to_radians().sin_cos();
        let turned = |[x, y, z]: [f64; 3]| [cos * x - sin * y, sin * x + cos * y, z];
        let mut design = threads.clone();
        (design.lattice.a1, design.lattice.a2) = (turned(design.lattice.a1), turned(design.lattice.a2));
        for element in &mut design.elements {
            element.center = turned(element.center);
            element.rings.iter_mut().for_each(|ring| ring.normal = turned(ring.normal));
        }
        assert_eq!(chain(&design).limit(Direction::of_degrees(degrees + 90.0), 0.0), Bound::Unbounded, "{degrees}");
    }
}

/// Weaves whose rings are pulled in several directions: more than the links prove, and not below the limits found.
#[test]
fn normals_lower_the_bound_of_woven_sheets() {
    let cases = [
        ("european-4-in-1", 0.0, 0.0, 0.0620502, 0.087),
        ("european-4-in-1", 90.0, 0.0, 0.1316982, 0.245),
        ("european-4-in-1", 30.0, 0.1, -0.0112107, 0.042),
        ("2", 90.0, 0.0, 0.1951130, 0.24),
        ("kings-mail", 90.0, 0.0, 0.4101681, 0.95),
    ];
    for (name, direction_deg, l2, limit, most) in cases {
        let design = builtin(name);
        let model = Model::compile(&design, "1x1".parse().unwrap()).unwrap();
        let chain = ChainBound::new(&model);
        let link = LinkBound::new(&model, &chain);
        let direction = Direction::of_degrees(direction_deg);
        let found = link.limit_by_normals(direction, l2, Across::HELD).l1;
        assert!(limit <= found && found <= most, "{name} {direction_deg}° {l2}: {found}");
        assert!(found < best_bound(&chain, Some(&link), direction, l2).l1().unwrap(), "{name} {direction_deg}°");
    }
    // Straight chains attain theirs; the descent may stay a little above.
    for name in ["1.1", "3.1"] {
        let (chain, link) = bounds(name, 0.1, "1x1");
        let direction = Direction::of_degrees(0.0);
        let (attained, found) =
            (chain.limit(direction, 0.0).l1().unwrap(), link.limit_by_normals(direction, 0.0, Across::HELD).l1);
        assert!((attained - 1e-12..attained + 1e-3).contains(&found), "{name}: {found} of {attained}");
    }
}

/// The lemma on random linked pairs that do not overlap: y·(c_b − c_a) ≤ R_a |y × N_a| + R_b |y × N_b| − (r_a + r_b) |y|.
#[test]
fn normals_hold_linked_rings() {
    let mut rng = ChaCha8Rng::seed_from_u64(17);
    let mut random = |size: f64| Vec3::from_fn(|_, _| rng.random_range(-size..size));
    let (mut pairs, mut closest) = (0, f64::INFINITY);
    while pairs < 2000 {
        let radii = [0, 1].map(|_| 0.8 + 0.4 * random(1.0).x);
        let mut circle =
            |center: Vec3, radius: f64| Circle { center, normal: UnitVector3::new_normalize(random(1.0)), radius };
        let (a, b) = (circle(Vec3::zeros(), radii[0]), circle(Vec3::zeros(), radii[1]));
        let b = Circle { center: random(1.9), ..b };
        if linking_number(&a, &b) == 0 {
            continue;
        }
        pairs += 1;
        // The thickest wire that fits.
        let wires = circle_distance_minima(&a, &b).closest().distance;
        for _ in 0..50 {
            // Mostly along the line of centres, where it is sharpest.
            let y = (b.center - a.center) + random(0.5);
            let width = |circle: &Circle| circle.radius * y.cross(&circle.normal).norm();
            let slack = width(&a) + width(&b) - wires * y.norm() - y.dot(&(b.center - a.center));
            assert!(slack >= -1e-12, "{slack} for {a:?}, {b:?}, {y:?}");
            closest = closest.min(slack / y.norm());
        }
    }
    assert!(closest < 0.02, "never sharp: {closest}");
}

/// States without overlap that climb towards a limit by random moves never pass the bound.
#[test]
fn states_stay_below_the_bound() {
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    for name in DESIGNS {
        let model = model(name, 0.1, "1x1");
        let (chain, link) = bounds(name, 0.1, "1x1");
        for (degrees, l2) in [(0.0, 0.0), (37.0, -0.02)] {
            let direction = Direction::of_degrees(degrees);
            let of_links = best_bound(&chain, Some(&link), direction, l2).l1().unwrap();
            let bound = of_links.min(link.limit_by_normals(direction, l2, Across::HELD).l1);
            let stretched = |state: &State, l1: f64| {
                let gradient = Direction::of_degrees(degrees).gradient(l1, l2, 0.0);
                let map = |v: Vec3| {
                    let w: Vector2<f64> = gradient * v.xy();
                    Vec3::new(w.x, w.y, 0.0)
                };
                State { a1: map(model.start.a1), a2: map(model.start.a2), ..state.clone() }
            };
            let (mut state, mut l1) = (stretched(&model.start, 0.0), 0.0);
            let mut accepted = 0;
            for step in 0..1500 {
                let size = [0.1, 0.03, 0.01][step % 3];
                let mut random = || Vec3::from_fn(|_, _| rng.random_range(-size..size));
                let mut trial = state.clone();
                trial.poses.iter_mut().for_each(|p| *p = p.moved(&random(), &random()));
                let rise = l1 + 0.5 * random().x.abs();
                let trial = stretched(&trial, rise);
                let free = topology::smallest_gap(&model, &trial).is_none_or(|(gap, _)| gap >= 0.0);
                if free && topology::links_kept(&model, &trial) {
                    (state, l1, accepted) = (trial, rise, accepted + 1);
                }
            }
            let along = Direction::of_degrees(degrees).along();
            let measured = (state.deformation_gradient(&model) * along).norm() - 1.0;
            assert!(measured <= bound, "{name} {degrees}°: {measured} above {bound}");
            // 2 has hardly any room to begin with.
            let enough = if name == "2" { 0.2 } else { 0.5 };
            assert!(accepted > 5 && measured > enough * bound, "{name} {degrees}°: {measured} of {bound} is no trial");
        }
    }
}

/// The mean over its copies makes a solution of a larger cell one of the design's own.
#[test]
fn the_own_cell_has_the_bound_of_a_larger_one() {
    for (name, cell) in [("1.1", "2x2"), ("3.1", "2,1;0,2"), ("5.1", "1x2")] {
        let large = model(name, 0.1, cell);
        let own = large.primitive();
        let compiled = model(name, 0.1, "1x1");
        assert_eq!(own.links, compiled.links, "{name}");
        assert_eq!(own.elements.len(), compiled.elements.len());
        assert!((own.start.a1 - compiled.start.a1).norm() + (own.start.a2 - compiled.start.a2).norm() < 1e-12);
        assert!((own.reference_inverse - compiled.reference_inverse).norm() < 1e-12);
        let chain = ChainBound::new(&large);
        let [of_large, of_own] = [&large, &own].map(|m| LinkBound::new(m, &chain));
        for (direction_deg, l2) in [(0.0, 0.0), (15.0, -0.125), (40.0, 0.125)] {
            let [a, b] = [&of_large, &of_own].map(|bound| bound.limit(Direction::of_degrees(direction_deg), l2).l1);
            assert!((a - b).abs() < 1e-9 || a == b, "{name} {cell}: {a} {b}");
        }
    }
}
