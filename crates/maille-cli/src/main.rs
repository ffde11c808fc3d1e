//! The `maille` program: arguments, progress and exit codes. The mechanics are in the `maille` crate.

mod at;
mod characterize;
mod designs;
mod export;
mod files;
mod input;
mod inspect;
mod numbers;
mod plot;
mod progress;
mod records;
mod render;
mod replay;
mod table;

use clap::{Parser, Subcommand};
use miette::Result;
use std::process::ExitCode;

/// How far does a chainmail weave stretch before it locks?
#[derive(Parser)]
#[command(version, about, long_about = None, arg_required_else_help = true, after_help = "\
Examples:
  maille designs                          the built-in designs
  maille inspect 1.1                      rings, links and gaps of one
  maille characterize 1.1                 its limits, as a table and a polar plot in maille-out/1.1/
  maille characterize my-weave.toml --directions 0:90:5 --l2 0
  maille replay maille-out/1.3            solve the rows without a limit again

Exit codes: 0 done, 1 the input or a file is wrong, 2 the arguments are wrong, 130 interrupted.")]
struct Args {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    Characterize(characterize::Args),
    Inspect(inspect::Args),
    Designs(designs::Args),
    Replay(replay::Args),
    Export(export::Args),
    Render(render::Args),
    Plot(plot::Args),
    Table(table::Args),
}

fn main() -> ExitCode {
    // Lines of a help are commands to copy: they are not broken.
    let hook = miette::set_hook(Box::new(|_| Box::new(miette::MietteHandlerOpts::new().wrap_lines(false).build())));
    debug_assert!(hook.is_ok(), "the hook is set once");
    let done: Result<ExitCode> = match Args::parse().command {
        Command::Characterize(args) => characterize::run(&args),
        Command::Inspect(args) => inspect::run(&args).map(|()| ExitCode::SUCCESS),
        Command::Replay(args) => replay::run(&args),
        Command::Designs(args) => designs::run(&args).map(|()| ExitCode::SUCCESS),
        Command::Export(args) => export::run(&args).map(|()| ExitCode::SUCCESS),
        Command::Render(args) => render::run(&args).map(|()| ExitCode::SUCCESS),
        Command::Plot(args) => plot::run(&args).map(|()| ExitCode::SUCCESS),
        Command::Table(args) => table::run(&args).map(|()| ExitCode::SUCCESS),
    };
    done.unwrap_or_else(|report| {
        eprintln!("{report:?}");
        ExitCode::FAILURE
    })
}
