//! Any number of inputs for one target or all: `cargo run --release -p maille-fuzz --example campaign -- 1000000 [TARGET] [SEED]`.
//!
//! Inputs are made as in the tests, from the files that are there, on all cores. A panic ends it with the seed of its input.

use maille_fuzz::{TARGETS, mutate, sound};
use rayon::prelude::*;
use std::{panic::catch_unwind, process::ExitCode, time::Instant};

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let number = |k: usize, usual: u64| arguments.get(k).map_or(Ok(usual), |text| text.parse::<u64>());
    let (Ok(inputs), Ok(first)) = (number(0, 100_000), number(2, 1)) else {
        eprintln!("campaign [INPUTS [TARGET [SEED]]]");
        return ExitCode::from(2);
    };
    let chosen = |name: &str| arguments.get(1).is_none_or(|wanted| wanted == name || wanted == "all");
    let mut failures = 0;
    for (target, run) in TARGETS.into_iter().filter(|(name, _)| chosen(name)) {
        let (sound, begun) = (sound(target), Instant::now());
        let seeds = first << 40..(first << 40) + inputs;
        let broken: Vec<u64> = seeds
            .into_par_iter()
            .filter(|seed| catch_unwind(|| run(&mutate::input(target, &sound, *seed))).is_err())
            .collect();
        println!("{target}: {inputs} inputs, {} broke it, {:.1} s", broken.len(), begun.elapsed().as_secs_f64());
        for seed in broken.iter().take(10) {
            let input = mutate::input(target, &sound, *seed);
            println!("  seed {seed}: {}", String::from_utf8_lossy(&input).escape_debug());
        }
        failures += broken.len();
    }
    ExitCode::from(u8::from(failures > 0))
}
