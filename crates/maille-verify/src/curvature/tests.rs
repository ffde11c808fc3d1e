use super::*;
use crate::{apart::Arc, sheet::Body, sheet::Ring};
use rand::{RngExt, SeedableRng, rngs::ChaCha8Rng};

/// Two elements of one ring each, in a cell that is too wide for images.
fn sheet(poses: [(Vec3, Vec3, Vec3); 2]) -> Sheet {
    let ring = |(element, (_, arm, normal)): (usize, &(Vec3, Vec3, Vec3))| Ring {
        element,
        arm: *arm,
        normal: normal.normalize(),
        radius: 1.0,
        wire: 0.1,
        curve: None,
    };
    let body = |(at, _, _): &(Vec3, Vec3, Vec3)| Body { position: *at, turn: UnitQuaternion::identity() };
    Sheet {
        rings: poses.iter().enumerate().map(ring).collect(),
        bodies: poses.iter().map(body).collect(),
        lattice: [Vec3::x() * 50.0, Vec3::y() * 50.0],
        copies: vec![Vec3::zeros(); 2],
        roll: None,
    }
}

/// The angle of the least distance near `angle`, by golden section.
fn refined(arc: &Arc<'_>, angle: f64) -> f64 {
    let ratio = 0.5 * (5.0_f64.sqrt() - 1.0);
    let (mut low, mut high) = (angle - 0.2, angle + 0.2);
    for _ in 0..90 {
        let (left, right) = (high - ratio * (high - low), low + ratio * (high - low));
        if arc.at(left).distance < arc.at(right).distance { high = right } else { low = left }
    }
    0.5 * (low + high)
}

/// The least distance near `angle` after the motion.
fn least(sheet: &Sheet, angle: f64, motion: &Local) -> f64 {
    let mut moved = sheet.clone();
    for (k, body) in moved.bodies.iter_mut().enumerate() {
        let part =
            |first: usize| Vec3::new(motion[6 * k + first], motion[6 * k + first + 1], motion[6 * k + first + 2]);
        body.position += part(0);
        body.turn = UnitQuaternion::from_scaled_axis(part(3)) * body.turn;
    }
    let (one, other) = (moved.circle(0, [0, 0]), moved.circle(1, [0, 0]));
    let arc = Arc::new(&one, &other);
    // The frame of the moved circle is near that of the still one.
    arc.at(refined(&arc, angle)).distance
}

/// Second derivatives of the least distance along random motions, against second differences of the least distance itself.
#[test]
fn second_derivatives_are_those_of_the_least_distance() {
    let mut rng = ChaCha8Rng::seed_from_u64(11);
    let mut tried = 0;
    while tried < 30 {
        let mut vector = |size: f64| Vec3::from([0; 3].map(|_| size * rng.random_range(-1.0..1.0)));
        let sheet = sheet([(vector(0.2), vector(0.3), vector(1.0)), (vector(1.0), vector(0.3), vector(1.0))]);
        let (one, other) = (sheet.circle(0, [0, 0]), sheet.circle(1, [0, 0]));
        let arc = Arc::new(&one, &other);
        let Some(angle) =
            (0..63).map(|k| 0.1 * f64::from(k)).min_by(|a, b| arc.at(*a).distance.total_cmp(&arc.at(*b).distance))
        else {
            continue;
        };
        let point = Closed::next_to(&sheet, (0, 1, [0, 0]), refined(&arc, angle));
        let h = hessian(&point);
        if point.gap < 0.0 || h[(12, 12)] < 0.05 {
            continue;
        }
        let aside = h.column(12).into_owned();
        let mut motion = Local::from_fn(|_, _| rng.random_range(-1.0..1.0));
        motion[12] = 0.0;
        let schur = motion.dot(&(h * motion)) - aside.dot(&motion).powi(2) / h[(12, 12)];
        let step = 2e-4;
        let f = |x: f64| least(&sheet, point.angle, &(motion * x));
        let direct = (f(step) - 2.0 * f(0.0) + f(-step)) / (step * step);
        assert!((schur - direct).abs() < 1e-3 * (1.0 + schur.abs()), "{schur} {direct}");
        // The gradient, too.
        let slope = (f(step) - f(-step)) / (2.0 * step);
        assert!((gradient(&point, 0, 0.0).dot(&motion) - slope).abs() < 1e-4 * (1.0 + slope.abs()));
        tried += 1;
    }
}

/// A ring between two rings of a clamp, all flat on one another, glides and turns with it without a change of the gaps, wherever on
/// the circles the balanced forces are written; where their sums have a moment T, gliding along T opens them, by −(T·δe)²/N s for each side.
#[test]
fn a_ring_in_a_clamp_glides() {
    let mut sheet = sheet([(Vec3::zeros(), Vec3::zeros(), Vec3::z()), (Vec3::z() * 0.2, Vec3::zeros(), Vec3::z())]);
    sheet.rings.push(Ring { arm: Vec3::z() * 0.4, ..sheet.rings[0].clone() });
    for angles in [vec![0.3, 0.3 + std::f64::consts::PI], vec![0.0, 2.0, 4.5]] {
        let at = |pair: Pair, angle: f64| (Closed::next_to(&sheet, pair, angle), 0.5);
        let below = angles.iter().map(|angle| at((0, 1, [0, 0]), *angle));
        let above = angles.iter().map(|angle| at((1, 2, [0, 0]), *angle));
        let points: Vec<(Closed<'_>, f64)> = below.chain(above).collect();
        let found = curvature(&sheet, &points, &[], vec![[0.0; 2]; 2], 0).unwrap();
        // Eight unknowns; the height and two tilts are held.
        assert!(found.flat && found.values.len() == 5, "{found:?}");
        let moment = angles.iter().map(|angle| Vec3::new(angle.cos(), angle.sin(), 0.0) * 0.5).sum::<Vec3>();
        // δe = v − ω × 0.2 z, of a unit motion with ω twice: its square is at most 1 + 0.2²/2.
        let expected = -2.0 * moment.norm_squared() / (0.5 * angles.len() as f64 * 0.2) * 1.02;
        assert!((found.values[0] - expected).abs() < 1e-6, "{:?} {expected}", found.values);
        assert!(found.values[1..].iter().all(|v| v.abs() < 1e-6), "{:?}", found.values);
    }
}
