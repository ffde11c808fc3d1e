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
mod input;
mod inspect;
mod interrupt;
mod limit;
mod map;
mod new;
mod numbers;
mod output;
mod plot;
mod progress;
mod prove;
mod records;
mod remedy;
mod render;
mod replay;
mod reproduce;
mod schema;
mod simulate;
mod source;
mod summary;
mod sweep;
mod table;
mod units;
mod verify;
mod verify_proof;
mod verify_surface;
mod view;
mod watch;

use clap::{CommandFactory, Parser, Subcommand};
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
  maille verify maille-out/1.3            derive each state of a record anew
  maille prove 2 --direction 0            no state of the cell goes further: a proof
  maille sweep radius.toml                many designs, radii and spacings
  maille reproduce --quick                chapter 6 of the thesis, computed anew
  maille limit 1.1 --maximize exx --free eyy,exy    one strain as large as can be
  maille boundary european-4-in-1         all in-plane strains, as a surface
  maille tightest european-4-in-1         the thickest wire
  maille simulate 1.1 --fix left --pull right=5,0,0    a finite sheet
  maille new shirt --weave european-4-in-1 --wire 16swg --id 5/16in
  maille check my-weave.toml              is the file right, do rings overlap?
  maille view 1.1                         see it lock, in the browser

Exit codes:
    0  done
    1  a file cannot be read or written, or maille is at fault
    2  the arguments are wrong
    3  a design file is wrong, or there is none of that name
    4  a record is missing, damaged, of other inputs, or in use by another run; verify: something in it is false
    5  done, but some limits were not found; replay: some rows came out otherwise; verify: not all could be proved
  130  interrupted

NO_COLOR=1 takes colours away; where standard error is no terminal, progress is plain lines.")]
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
    Designs(designs::Args),
    Replay(replay::Args),
    Verify(verify::Args),
    Prove(prove::Args),
    Sweep(sweep::Args),
    Limit(limit::Args),
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

fn main() -> ExitCode {
    // Lines of a help are commands to copy: they are not broken.
    let hook = miette::set_hook(Box::new(|_| Box::new(miette::MietteHandlerOpts::new().wrap_lines(false).build())));
    debug_assert!(hook.is_ok(), "the hook is set once");
    let ended: Result<ExitCode> = match Args::parse().command {
        Command::Characterize(args) => characterize::run(&args),
        Command::Inspect(args) => inspect::run(&args),
        Command::Check(args) => check::run(&args),
        Command::New(args) => done(new::run(&args)),
        Command::Replay(args) => replay::run(&args),
        Command::Verify(args) => verify::run(&args),
        Command::Prove(args) => prove::run(&args),
        Command::Sweep(args) => sweep::run(&args),
        Command::Limit(args) => limit::run(&args),
        Command::Boundary(args) => boundary::run(&args),
        Command::Tightest(args) => extreme::tightest(&args),
        Command::Roomiest(args) => extreme::roomiest(&args),
        Command::Reproduce(args) => reproduce::run(&args),
        Command::Simulate(args) => simulate::run(&args),
        Command::Designs(args) => done(designs::run(&args)),
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
