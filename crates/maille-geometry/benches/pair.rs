//! Time of one pair: the enumeration beside the polynomial, on the same pairs; and what else is asked about a pair.
//!
//! `cargo bench -p maille-geometry`. A sample is 1,000 pairs: the figures are microseconds a pair if read as milliseconds.

#[path = "../tests/common/mod.rs"]
mod common;

use common::{Family, Pair, degenerate, linked, near_degenerate, rng, symmetric, thin_gap, uniform};
use divan::{Bencher, black_box, counter::ItemsCount};
use maille_geometry::{
    circle_distance_minima, circle_distance_minima_polynomial, linking_number, point_circle_distance,
};

const PAIRS: usize = 1_000;
const FAMILIES: [&str; 6] = ["linked", "thin gap", "uniform", "symmetric", "near degenerate", "degenerate"];

fn main() {
    divan::main();
}

fn pairs(name: &str) -> Vec<Pair> {
    let family: Family = match name {
        "linked" => linked,
        "thin gap" => thin_gap,
        "symmetric" => symmetric,
        "near degenerate" => near_degenerate,
        "degenerate" => degenerate,
        _ => uniform,
    };
    let mut rng = rng(99);
    (0..PAIRS).map(|_| family(&mut rng)).collect()
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
    time(bencher, family, |(a, b)| circle_distance_minima(a, b));
}

#[divan::bench(args = FAMILIES, sample_count = 20)]
fn polynomial(bencher: Bencher<'_, '_>, family: &str) {
    time(bencher, family, |(a, b)| circle_distance_minima_polynomial(a, b));
}

#[divan::bench(args = ["linked", "uniform"])]
fn linking(bencher: Bencher<'_, '_>, family: &str) {
    time(bencher, family, |(a, b)| linking_number(a, b));
}

#[divan::bench(args = ["uniform"])]
fn point(bencher: Bencher<'_, '_>, family: &str) {
    time(bencher, family, |(a, b)| point_circle_distance(&b.center, a));
}
