//! Feasible states of a cell of two rings, sampled by random walks that press for a large l1, against a proved bound.
//!
//!     cargo run --release -p maille-prove --example sample -- DESIGN MINOR_RADIUS DIRECTION L2 STATES BOUND [SEED]
//!
//! Prints the number of feasible states, the largest l1 among them, and whether it is above the bound; exit code 1 if so.

#[path = "../tests/it/sampler.rs"]
mod sampler;

use maille_io::{DesignSource, builtin};
use rand::{SeedableRng, rngs::ChaCha8Rng};
use sampler::Weave;
use std::process::ExitCode;

/// Steps of one walk, and how much it likes a large l1 at its begin and at its end, per unit of l1.
const STEPS: u64 = 200_000;
const PULL: [f64; 2] = [10.0, 1e5];

fn main() -> ExitCode {
    let given: Vec<String> = std::env::args().skip(1).collect();
    let [name, radius, direction, l2, states, bound, rest @ ..] = &given[..] else {
        eprintln!("give DESIGN MINOR_RADIUS DIRECTION L2 STATES BOUND [SEED]");
        return ExitCode::from(2);
    };
    let number = |text: &String| text.parse::<f64>().expect("a number");
    let text = builtin(name).expect("a built-in design");
    let design = DesignSource::new(name.as_str(), text).read().expect("a design").with_minor_radius(number(radius));
    let weave = Weave::new(&design, number(direction), number(l2));
    let mut rng = ChaCha8Rng::seed_from_u64(rest.first().map_or(1, |seed| number(seed) as u64));
    let (wanted, bound) = (number(states) as u64, number(bound));
    let (mut feasible, mut largest, mut walks) = (0_u64, f64::NEG_INFINITY, 0);
    while feasible < wanted {
        walks += 1;
        let mut state = weave.start;
        for step in 0..STEPS {
            let part = step as f64 / STEPS as f64;
            let pull = PULL[0] * (PULL[1] / PULL[0]).powf(part);
            let (next, found) = weave.walk(&state, pull, &mut rng);
            state = next;
            if let Some(found) = found {
                feasible += 1;
                largest = largest.max(found.l1);
            }
        }
    }
    let above = largest > bound;
    println!(
        "{feasible} feasible states of {walks} walks, largest l1 {largest:.9}, bound {bound}: {}",
        if above { "ABOVE" } else { "none above" }
    );
    ExitCode::from(u8::from(above))
}
