//! The rate of minima of pairs of circles from a loop in Rust that fills the arrays of the Python package:
//! `cargo run -p maille --example pair_arrays`, beside `crates/maille-py/examples/rate.py`.

use maille_geometry::{Approaches, Circle, MAX_MINIMA, Vec3, circle_distance_approaches, point_circle_distance};
use nalgebra::UnitVector3;
use rand::{Rng, RngExt, SeedableRng, rngs::ChaCha8Rng};
use rayon::prelude::*;
use std::time::Instant;

const PAIRS: usize = 1_000_000;
const CHUNK: usize = 512;

fn circle(rng: &mut impl Rng) -> Circle {
    let mut number = || rng.random_range(-1.0..1.0);
    let normal = loop {
        let v = Vec3::new(number(), number(), number());
        if (0.01..1.0).contains(&v.norm_squared()) {
            break UnitVector3::new_normalize(v);
        }
    };
    let center = Vec3::new(number(), number(), number()) * 1.5;
    Circle::new(center, normal, 0.9 + 0.6 * number())
}

fn main() {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let pairs: Vec<(Circle, Circle)> = (0..PAIRS).map(|_| (circle(&mut rng), circle(&mut rng))).collect();
    for _ in 0..7 {
        let begun = Instant::now();
        let (mut count, mut kind) = (vec![0i64; PAIRS], vec![0u8; PAIRS]);
        let mut distance = vec![0.0; MAX_MINIMA * PAIRS];
        let (mut point_a, mut point_b) = (vec![0.0; 3 * MAX_MINIMA * PAIRS], vec![0.0; 3 * MAX_MINIMA * PAIRS]);
        let outputs = (
            pairs.par_chunks(CHUNK),
            count.par_chunks_mut(CHUNK),
            kind.par_chunks_mut(CHUNK),
            distance.par_chunks_mut(MAX_MINIMA * CHUNK),
            point_a.par_chunks_mut(3 * MAX_MINIMA * CHUNK),
            point_b.par_chunks_mut(3 * MAX_MINIMA * CHUNK),
        );
        let found = || vec![Approaches::NONE; CHUNK];
        outputs.into_par_iter().for_each_init(found, |found, (pairs, count, kind, distance, point_a, point_b)| {
            circle_distance_approaches(pairs, &[f64::INFINITY; CHUNK][..pairs.len()], &mut found[..pairs.len()]);
            for (i, ((a, b), found)) in pairs.iter().zip(&*found).enumerate() {
                count[i] = found.as_slice().len() as i64;
                kind[i] = found.kind(a, b) as u8;
                for j in 0..MAX_MINIMA {
                    let at = MAX_MINIMA * i + j;
                    let (d, p, q): (f64, [f64; 3], [f64; 3]) = match found.as_slice().get(j) {
                        Some(minimum) => {
                            let on_b = b.center + minimum.direction_b * b.radius;
                            (minimum.distance, point_circle_distance(&on_b, a).point.into(), on_b.into())
                        }
                        None => (f64::NAN, [f64::NAN; 3], [f64::NAN; 3]),
                    };
                    distance[at] = d;
                    point_a[3 * at..3 * at + 3].copy_from_slice(&p);
                    point_b[3 * at..3 * at + 3].copy_from_slice(&q);
                }
            }
        });
        let seconds = begun.elapsed().as_secs_f64();
        println!("{:.2} million pairs a second", PAIRS as f64 / seconds / 1e6);
    }
}
