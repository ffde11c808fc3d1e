//! Inputs made from sound ones.

use rand::rngs::ChaCha8Rng as Rng;
use rand::{RngExt, SeedableRng, seq::IndexedRandom};

/// Longest input.
pub const MOST: usize = 16 * 1024;

/// Words that files of maille are made of, and numbers that are hard to read.
const WORDS: [&str; 36] = [
    "0",
    "-0",
    "1",
    "-1",
    "1e308",
    "1e-308",
    "5e-324",
    "1e999",
    "nan",
    "inf",
    "-inf",
    "null",
    "true",
    "\"\"",
    "[]",
    "{}",
    "[[",
    "]]",
    "\n",
    ",",
    "=",
    "#",
    "'",
    "\\u0000",
    "é",
    "9007199254740993",
    "18446744073709551616",
    "0.1",
    "[elements]",
    "[[elements]]",
    "rings = []",
    "minor_radius = 0.1",
    "\"global\"",
    "\"l1\":",
    "\r\n",
    "\u{feff}",
];

/// The input of a target that a seed determines; `sound` are the target's files.
pub fn input(target: &str, sound: &[Vec<u8>], seed: u64) -> Vec<u8> {
    let mut rng = Rng::seed_from_u64(seed);
    match target {
        "circles" => floats(&mut rng, 14),
        "pieces" => {
            let mut out = floats(&mut rng, 9);
            let other = floats(&mut rng, 9);
            out.insert(0, rng.random());
            out.push(rng.random());
            out.extend(other);
            out
        }
        _ => {
            let mut any = || sound.choose(&mut rng).expect("there are sound inputs").as_slice();
            let (input, other) = (any(), any());
            text(&mut rng, input, other)
        }
    }
}

/// A sound input with one to eight wounds: bytes changed, words put in, pieces removed, doubled, or taken from `other`.
fn text(rng: &mut Rng, sound: &[u8], other: &[u8]) -> Vec<u8> {
    let mut out = sound.to_vec();
    for _ in 0..rng.random_range(1..=8) {
        let at = rng.random_range(0..=out.len());
        let end = (at + rng.random_range(1..=24)).min(out.len());
        match rng.random_range(0..7) {
            0 if at < out.len() => out[at] = rng.random(),
            1 if at < out.len() => out[at] ^= 1 << rng.random_range(0..8),
            2 => drop(out.drain(at..end)),
            3 => {
                let piece = out[at..end].to_vec();
                out.splice(at..at, piece);
            }
            4 => {
                let from = rng.random_range(0..=other.len());
                let piece = &other[from..(from + rng.random_range(1..=40)).min(other.len())];
                out.splice(at..end, piece.iter().copied());
            }
            5 => out.truncate(at.max(1)),
            _ => {
                let word = WORDS.choose(rng).expect("there are words");
                out.splice(at..end, word.bytes());
            }
        }
    }
    out.truncate(MOST);
    out
}

/// So many floats: any bits, hard ones, or those of an ordinary pair.
fn floats(rng: &mut Rng, count: usize) -> Vec<u8> {
    const HARD: [f64; 16] = [
        0.0,
        -0.0,
        1.0,
        -1.0,
        f64::INFINITY,
        f64::NEG_INFINITY,
        f64::NAN,
        f64::MIN_POSITIVE,
        5e-324,
        f64::MAX,
        f64::MIN,
        f64::EPSILON,
        1e-9,
        1e9,
        1e154,
        1e-154,
    ];
    let kind = rng.random_range(0..4);
    let one = |rng: &mut Rng| match kind {
        0 => f64::from_bits(rng.random()),
        1 => *HARD.choose(rng).expect("there are some"),
        2 if rng.random_bool(0.2) => *HARD.choose(rng).expect("there are some"),
        // Ties are frequent on a coarse grid.
        3 => f64::from(rng.random_range(-4..=4)) * 0.5,
        _ => rng.random_range(-2.0..2.0),
    };
    (0..count).flat_map(|_| one(rng).to_le_bytes()).collect()
}
