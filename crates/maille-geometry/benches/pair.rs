//! Times per pair of all functions of the crate, on the same families of pairs.
//!
//! `cargo bench -p maille-geometry`. A sample is 1,000 pairs: read milliseconds as microseconds per pair, and
//! microseconds as nanoseconds per pair.

#[path = "../tests/it/common/mod.rs"]
#[expect(dead_code, reason = "it uses a part")]
mod common;

use common::{Family, Pair, circle, degenerate, direction, linked, near_degenerate, rng, symmetric, thin_gap, uniform};
use divan::{Bencher, black_box, counter::ItemsCount};
use maille_geometry::{
    Approaches, Arc, Circle, Instructions, Piece, Segment, Vec3, circle_distance_approaches_with,
    circle_distance_lower_bound, circle_distance_minima, circle_distance_minima_polynomial, linking_number,
    piece_distance_minima, point_circle_distance,
};
use rand::RngExt;
use std::f64::consts::TAU;

const PAIRS: usize = 1_000;
const FAMILIES: [&str; 8] =
    ["near", "stacked", "linked", "thin gap", "uniform", "symmetric", "near degenerate", "degenerate"];

fn main() {
    divan::main();
}

fn pairs(name: &str) -> Vec<Pair> {
    let family: Family = match name {
        "linked" => linked,
        "near" => near,
        "stacked" => stacked,
        "thin gap" => thin_gap,
        "symmetric" => symmetric,
        "near degenerate" => near_degenerate,
        "degenerate" => degenerate,
        _ => uniform,
    };
    let mut rng = rng(99);
    (0..PAIRS).map(|_| family(&mut rng)).collect()
}

/// Stacked rings, coaxial up to 1e-9 … 1e-3.
fn stacked(rng: &mut common::Rng) -> Pair {
    let by = 10f64.powf(rng.random_range(-9.0..-3.0));
    let mut other = circle([0.0, 0.0, 0.2], [0.0, 0.0, 1.0], 1.0);
    other.center += *direction(rng) * by;
    other.normal = nalgebra::UnitVector3::new_normalize(*other.normal + *direction(rng) * by);
    (circle([0.0; 3], [0.0, 0.0, 1.0], 1.0), other)
}

fn time<T>(bencher: Bencher<'_, '_>, family: &str, f: impl Fn(&Pair) -> T + Sync) {
    let pairs = pairs(family);
    bencher.counter(ItemsCount::new(PAIRS)).bench(|| {
        for pair in &pairs {
            black_box(f(black_box(pair)));
        }
    });
}

#[divan::bench(args = FAMILIES)]
fn enumeration(bencher: Bencher<'_, '_>, family: &str) {
    let pairs = pairs(family);
    bencher.counter(ItemsCount::new(PAIRS)).bench(|| {
        for (a, b) in &pairs {
            // By reference: copying the minima would take a tenth of the time of finding them.
            let minima = circle_distance_minima(black_box(a), b);
            black_box(&minima);
        }
    });
}

#[divan::bench(args = FAMILIES, sample_count = 20)]
fn polynomial(bencher: Bencher<'_, '_>, family: &str) {
    time(bencher, family, |(a, b)| circle_distance_minima_polynomial(a, b));
}

/// Many pairs at once.
#[divan::bench(args = ["near", "linked", "thin gap", "uniform"], consts = [0, 1, 2])]
fn batch<const SET: usize>(bencher: Bencher<'_, '_>, family: &str) {
    let Some(set) = Instructions::available().nth(SET) else { return };
    let pairs = pairs(family);
    let reach = vec![f64::INFINITY; PAIRS];
    let mut out = vec![Approaches::NONE; PAIRS];
    bencher.counter(ItemsCount::new(PAIRS)).bench_local(|| {
        circle_distance_approaches_with(set, black_box(&pairs), &reach, &mut out);
        black_box(&mut out);
    });
}

/// The lower bound by which distant pairs are discarded.
#[divan::bench(args = ["near", "uniform"])]
fn floor(bencher: Bencher<'_, '_>, family: &str) {
    time(bencher, family, |(a, b)| circle_distance_lower_bound(a, b));
}

#[divan::bench(args = ["linked", "uniform"])]
fn linking(bencher: Bencher<'_, '_>, family: &str) {
    time(bencher, family, |(a, b)| linking_number(a, b));
}

#[divan::bench(args = ["uniform"])]
fn point(bencher: Bencher<'_, '_>, family: &str) {
    time(bencher, family, |(a, b)| point_circle_distance(&b.center, a));
}

/// Pieces that lie about one another at random.
#[divan::bench(args = ["segment, segment", "segment, arc", "arc, arc"])]
fn pieces(bencher: Bencher<'_, '_>, kinds: &str) {
    let mut rng = rng(98);
    let mut piece = |kind: &str| {
        let at = Vec3::from_fn(|_, _| rng.random_range(-1.0..1.0));
        let other = at + *direction(&mut rng) * rng.random_range(0.5..2.0);
        let circle = Circle::new(at, direction(&mut rng), rng.random_range(0.3..1.5));
        let arc = Arc::new(circle, rng.random_range(0.0..TAU), rng.random_range(0.5..5.0)).unwrap();
        if kind == "arc" { Piece::Arc(arc) } else { Piece::Segment(Segment::new(at, other).unwrap()) }
    };
    let (a, b) = kinds.split_once(", ").unwrap();
    let pairs: Vec<(Piece, Piece)> = (0..PAIRS).map(|_| (piece(a), piece(b))).collect();
    bencher.counter(ItemsCount::new(PAIRS)).bench(|| {
        for (a, b) in &pairs {
            black_box(&piece_distance_minima(black_box(a), b));
        }
    });
}

/// Neighbouring rings of a weave: linked, with a distance of the core circles between 0.02 R and 0.4 R.
fn near(rng: &mut common::Rng) -> Pair {
    loop {
        let (a, mut b) = linked(rng);
        b.radius = if rng.random_bool(0.5) { 1.0 } else { 0.9 };
        let distance = circle_distance_minima(&a, &b).closest().distance;
        if distance > 0.02 && distance < 0.4 {
            return (a, b);
        }
    }
}
