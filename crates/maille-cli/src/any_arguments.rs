//! Tests only: no command line makes the parser panic or hang, and what it refuses has a reason.

use crate::Args;
use clap::{CommandFactory, Parser};
use rand::{RngExt, SeedableRng, rngs::ChaCha8Rng, seq::IndexedRandom};
use std::ffi::OsString;

/// Command lines of one run; `MAILLE_COMMAND_LINES` asks for more.
const LINES: u64 = 4_000;

/// Values that are hard to read.
const VALUES: [&str; 44] = [
    "",
    " ",
    "-",
    "--",
    "0",
    "-0",
    "-1",
    "1e999",
    "nan",
    "inf",
    "-inf",
    "1e-320",
    "18446744073709551616",
    "0:180:0",
    "0:1e9:1e-9",
    "0:180:-5",
    "180:0:5",
    ":",
    "::",
    "0,,1",
    ",",
    "0:180:15",
    "1x1",
    "0x0",
    "99999x99999",
    "1,0;0,1",
    "1,2;2,4",
    "2147483647,1;1,2147483647",
    "x",
    "auto",
    "direction=30,l2=0",
    "direction=",
    "exx",
    "exx=0.1",
    "eyy=nan",
    "left",
    "right=0,0,0",
    "right=1,2",
    "flat@0,2=0,-1,0",
    "16swg",
    "5/16in",
    "1/0in",
    "1e400mm",
    "\u{feff}é",
];

#[test]
fn no_command_line_breaks_the_parser() {
    let program = Args::command();
    let commands: Vec<_> = program.get_subcommands().collect();
    let lines = std::env::var("MAILLE_COMMAND_LINES").map_or(LINES, |n| n.parse().expect("a number of lines"));
    let mut accepted = 0;
    for seed in 0..lines {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let command = commands.choose(&mut rng).expect("there are commands");
        let options: Vec<String> =
            command.get_arguments().filter_map(|a| Some(format!("--{}", a.get_long()?))).collect();
        let mut words: Vec<OsString> = vec!["maille".into(), command.get_name().into()];
        for _ in 0..rng.random_range(0..7) {
            let value = VALUES.choose(&mut rng).expect("there are values");
            let word = match (rng.random_range(0..6), options.choose(&mut rng)) {
                (0 | 1, Some(option)) => option.clone(),
                (2, Some(option)) => format!("{option}={value}"),
                (3, _) => "1.1".into(),
                _ => (*value).into(),
            };
            words.push(word.into());
        }
        #[cfg(unix)]
        if rng.random_bool(0.02) {
            // No UTF-8.
            words.push(std::os::unix::ffi::OsStringExt::from_vec(vec![b'a', 0xff, b'=', 0xfe]));
        }
        match Args::try_parse_from(&words) {
            Ok(_) => accepted += 1,
            Err(error) => assert!(!error.to_string().trim().is_empty(), "{words:?}"),
        }
    }
    // Not all are refused at once: what is behind the first option is reached.
    assert!(accepted > lines / 100, "{accepted} of {lines}");
}
