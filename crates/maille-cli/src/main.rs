//! The `maille` program: arguments, progress and exit codes. The mechanics are in the `maille` crate.

#[cfg(test)]
mod any_arguments;
mod at;
mod boundary;
mod certificate;
mod characterize;
mod check;
mod completions;
mod designs;
#[cfg(test)]
mod docs;
mod effort;
mod exit;
mod export;
mod extreme;
mod figure;
mod findings;
mod fit;
mod fit_over;
mod fit_record;
mod frames;
mod help;
mod input;
mod inspect;
mod inspect_piece;
mod interrupt;
mod limit;
mod map;
mod new;
mod numbers;
mod output;
mod piece;
mod plot;
mod progress;
mod prove;
mod records;
mod remedy;
mod render;
mod replay;
mod reproduce;
mod roll;
mod schema;
mod sensitivity;
mod simulate;
mod source;
mod summary;
mod sweep;
mod table;
mod terminal;
mod units;
mod verify;
mod verify_proof;
mod verify_roll;
mod verify_surface;
mod view;
mod watch;
mod weaves;

use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};
use miette::Result;
use std::process::ExitCode;

/// maille computes how far a sheet of linked rings (chainmail) stretches before it locks.
///
/// Each limit has a certificate, and many have a proof that nothing stretches further.
#[derive(Parser)]
#[command(
    name = "maille",
    version,
    arg_required_else_help = true,
    after_help = "\
Examples:
  maille characterize 1.1            the limits of a built-in design
  maille characterize my-weave.toml --directions 0:90:5 --l2 0
  maille table 1.1 --where l2=0      its rows
  maille render 1.1 --at direction=45,l2=0
  maille new shirt --weave european-4-in-1 --wire 16swg --id 5/16in
  maille inspect shirt.toml
  maille sweep --example > radius.toml

`maille COMMAND --help` has all options of a command, with examples.

Exit codes:
    0  done
    1  a file cannot be read or written, or the program has an error
    2  the arguments are wrong
    3  a design file is wrong, or no design has that name
    4  a record is missing, damaged, of other inputs, or in use;
       verify: something in it is false
    5  done, but some limits were not found (0 with --allow-incomplete);
       replay: some rows differ; verify: not everything could be proved
    6  sweep: some designs could not be used
  130  interrupted by Ctrl-C or SIGTERM; the same command continues

NO_COLOR=1 turns colours off. Where standard error is not a terminal, progress
is plain lines."
)]
struct Args {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    Characterize(Box<characterize::Args>),
    Inspect(inspect::Args),
    Check(check::Args),
    New(new::Args),
    Weaves(weaves::Args),
    Designs(designs::Args),
    Replay(replay::Args),
    Verify(verify::Args),
    Prove(prove::Args),
    Sweep(sweep::Args),
    Limit(limit::Args),
    Roll(roll::Args),
    Sensitivity(sensitivity::Args),
    Fit(Box<fit::Args>),
    Boundary(boundary::Args),
    Tightest(extreme::TightestArgs),
    Roomiest(extreme::RoomiestArgs),
    Reproduce(reproduce::Args),
    Simulate(Box<simulate::Args>),
    Export(export::Args),
    Render(render::Args),
    Plot(plot::Args),
    Table(table::Args),
    View(view::Args),
    Schema(schema::Args),
    Completions(completions::CompletionsArgs),
    Man(completions::ManArgs),
}

/// Quadratic programs make and drop many short lists; see docs/decisions/0027-allocator.md.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

fn main() -> ExitCode {
    let hook = miette::set_hook(Box::new(|_| terminal::handler()));
    debug_assert!(hook.is_ok(), "the hook is set once");
    let args = Args::from_arg_matches(&help::matches(Args::command())).unwrap_or_else(|e| e.exit());
    let ended: Result<ExitCode> = match args.command {
        Command::Characterize(args) => characterize::run(&args),
        Command::Inspect(args) => inspect::run(&args),
        Command::Check(args) => check::run(&args),
        Command::New(args) => done(new::run(&args)),
        Command::Replay(args) => replay::run(&args),
        Command::Verify(args) => verify::run(&args),
        Command::Prove(args) => prove::run(&args),
        Command::Sweep(args) => sweep::run(&args),
        Command::Limit(args) => limit::run(&args),
        Command::Roll(args) => roll::run(&args),
        Command::Sensitivity(args) => sensitivity::run(&args),
        Command::Fit(args) => fit::run(&args),
        Command::Boundary(args) => boundary::run(&args),
        Command::Tightest(args) => extreme::tightest(&args),
        Command::Roomiest(args) => extreme::roomiest(&args),
        Command::Reproduce(args) => reproduce::run(&args),
        Command::Simulate(args) => simulate::run(&args),
        Command::Designs(args) => done(designs::run(&args)),
        Command::Weaves(args) => done(weaves::run(&args)),
        Command::Export(args) => done(export::run(&args)),
        Command::Render(args) => done(render::run(&args)),
        Command::Schema(args) => done(schema::run(&args)),
        Command::Completions(args) => done(completions::completions(&args, Args::command())),
        Command::Man(args) => done(completions::man(&args, Args::command())),
        Command::Plot(args) => done(plot::run(&args)),
        Command::Table(args) => done(table::run(&args)),
        Command::View(args) => done(view::run(&args)),
    };
    ended.unwrap_or_else(|report| {
        let code = remedy::code(&report);
        eprintln!("{:?}", remedy::added(report));
        ExitCode::from(code)
    })
}

fn done(result: Result<()>) -> Result<ExitCode> {
    result.map(|()| ExitCode::from(exit::DONE))
}
