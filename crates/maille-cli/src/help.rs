//! `maille --help`: the commands in groups, which clap does not have.

use clap::{ArgMatches, Command};
use std::fmt::Write;

/// The commands, with what each does.
const GROUPS: [(&str, &[(&str, &str)]); 6] = [
    (
        "Designs",
        &[
            ("designs", "list the built-in designs"),
            ("new", "write a design file for a named weave"),
            ("weaves", "list which wires and inner diameters suit which named weave"),
            ("check", "check design files, without solving"),
            ("inspect", "show rings, links, gaps, wire and proven bounds of a design"),
        ],
    ),
    (
        "Limits",
        &[
            ("characterize", "compute how far a sheet stretches in each direction"),
            ("limit", "compute the largest or smallest value of one strain"),
            ("roll", "compute how tightly a sheet can be rolled"),
            ("sensitivity", "compute how a limit changes with the numbers of its design"),
            ("fit", "find a design for wanted limits"),
            ("boundary", "compute the surface of all in-plane strains"),
            ("tightest", "compute the thickest wire"),
            ("roomiest", "compute the state with the widest gaps"),
            ("sweep", "compute the limits of many designs, radii and spacings"),
            ("prove", "prove that no state of one cell stretches further"),
        ],
    ),
    (
        "Results",
        &[
            ("table", "show rows of records, or write them as CSV, JSON or Parquet"),
            ("plot", "draw records in one figure"),
            ("verify", "check a record or a proof, with separate code"),
            ("replay", "solve rows of a record again, and compare"),
        ],
    ),
    (
        "Sheets",
        &[
            ("simulate", "move a finite sheet: hold edges, pull, add weight"),
            ("render", "draw a picture or a film"),
            ("export", "write a mesh, to print or to show"),
            ("view", "open a sheet and its limits in the browser"),
        ],
    ),
    ("Chapter 6 of the thesis", &[("reproduce", "compute it again, as one page")]),
    (
        "Setup",
        &[
            ("schema", "print the JSON Schema of design files, for editors"),
            ("completions", "print completions for a shell"),
            ("man", "write manual pages"),
            ("help", "show this, or the help of a command"),
        ],
    ),
];

/// Heading of the options of the energy method.
pub const ENERGY: &str = "Energy method (lengths in units of the reference radius R)";

/// The groups as text.
fn groups() -> String {
    let mut out = String::new();
    for (heading, commands) in GROUPS {
        let _ = writeln!(out, "{heading}:");
        for (name, what) in commands {
            let _ = writeln!(out, "  {name:<14}{what}");
        }
        out.push('\n');
    }
    out
}

/// The arguments of the program. The help of `characterize` shows the options of the energy method only where this method is named.
pub fn matches(program: Command) -> ArgMatches {
    let program = program.help_template(format!(
        "{{about}}\n\n{{usage-heading}} {{usage}}\n\n{}Options:\n{{options}}{{after-help}}",
        groups()
    ));
    let names: Vec<String> = program.get_subcommands().map(|command| command.get_name().to_owned()).collect();
    let clearer = |command| with_short_lines(with_negative_numbers(command));
    let program = names.iter().fold(program, |program, name| program.mut_subcommand(name, clearer));
    let energy = std::env::args().any(|word| word == "energy" || word == "--method=energy");
    let hide = |arg: clap::Arg| if arg.get_help_heading() == Some(ENERGY) { arg.hide(true) } else { arg };
    match energy {
        true => program,
        false => program.mut_subcommand("characterize", |command| command.mut_args(hide)),
    }
    .get_matches()
}

/// The command with options that take negative numbers, so that those that must not be negative can say so.
fn with_negative_numbers(command: Command) -> Command {
    command.mut_args(|arg| match arg.get_long().is_some() && arg.get_action().takes_values() {
        true => arg.allow_negative_numbers(true),
        false => arg,
    })
}

/// The command with its examples on lines that a terminal of 80 letters does not break.
fn with_short_lines(command: Command) -> Command {
    match command.get_after_help().map(|help| short_lines(&help.to_string())) {
        Some(help) => command.after_help(help),
        None => command,
    }
}

/// Where an example and its comment are too long for a line, the comment gets one of its own. A paragraph becomes one line, which is
/// broken at the terminal's width.
fn short_lines(help: &str) -> String {
    let short = |line: &str| match line.strip_prefix("  maille ").and_then(|rest| rest.split_once("  ")) {
        Some((command, comment)) if line.chars().count() > 80 => {
            format!("  maille {command}\n      {}", comment.trim_start())
        }
        _ => line.to_owned(),
    };
    let in_paragraph = |line: &str| line.starts_with(|c: char| !c.is_whitespace());
    let mut lines: Vec<String> = Vec::new();
    for line in help.lines() {
        match lines.last_mut().filter(|last| in_paragraph(last) && in_paragraph(line) && !last.ends_with(':')) {
            Some(last) => *last += &format!(" {line}"),
            None => lines.push(short(line)),
        }
    }
    lines.join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Args;
    use clap::CommandFactory;

    #[test]
    fn every_command_is_in_one_group() {
        let mut program = Args::command();
        program.build();
        let mut known: Vec<&str> = program.get_subcommands().map(Command::get_name).collect();
        let mut grouped: Vec<&str> =
            GROUPS.iter().flat_map(|(_, commands)| commands.iter().map(|(name, _)| *name)).collect();
        known.sort_unstable();
        grouped.sort_unstable();
        assert_eq!(known, grouped);
        assert!(groups().lines().all(|line| line.len() <= 80), "{}", groups());
    }

    #[test]
    fn a_long_example_has_its_comment_on_the_next_line() {
        let short = "  maille view 1.1   in the browser";
        assert_eq!(short_lines(short), short);
        let command = format!("  maille plot {}", "record ".repeat(9).trim());
        let long = format!("Examples:\n{command}     all of them in one");
        assert_eq!(short_lines(&long), format!("Examples:\n{command}\n      all of them in one"));
        assert_eq!(short_lines("One\ntwo.\n\nThree:\n  a\nfour"), "One two.\n\nThree:\n  a\nfour");
        let alone = "  maille plot ".to_owned() + &"record ".repeat(12);
        assert_eq!(short_lines(&alone), alone);
    }
}
