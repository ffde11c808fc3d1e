//! `maille completions` and `maille man`: what a shell and `man` know of the program.

use crate::output;
use clap::Command;
use miette::{IntoDiagnostic, Result};
use std::path::PathBuf;

/// Completions for a shell, on standard output
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  maille completions bash > ~/.local/share/bash-completion/completions/maille
  maille completions zsh > ~/.zfunc/_maille
  maille completions fish > ~/.config/fish/completions/maille.fish")]
pub struct CompletionsArgs {
    /// The shell
    shell: clap_complete::Shell,
}

/// Manual pages: maille.1 and one for each command
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  maille man ~/.local/share/man/man1
  maille man man1 && man ./man1/maille-characterize.1")]
pub struct ManArgs {
    /// The folder to write to
    folder: PathBuf,
    #[command(flatten)]
    replace: output::Replace,
}

/// Prints completions of `program`.
pub fn completions(args: &CompletionsArgs, mut program: Command) -> Result<()> {
    let mut bytes = Vec::new();
    clap_complete::generate(args.shell, &mut program, "maille", &mut bytes);
    output::print(&bytes)
}

/// Writes manual pages of `program`.
pub fn man(args: &ManArgs, mut program: Command) -> Result<()> {
    program.build();
    let pages = || {
        let commands = program.get_subcommands().filter(|sub| sub.get_name() != "help");
        std::iter::once((&program, "maille".to_owned()))
            .chain(commands.map(|sub| (sub, format!("maille-{}", sub.get_name()))))
    };
    let path = |name: &str| args.folder.join(format!("{name}.1"));
    pages().try_for_each(|(_, name)| args.replace.check(&path(&name)))?;
    let page = |command: &Command, name: String| -> Result<()> {
        let mut bytes = Vec::new();
        clap_mangen::Man::new(command.clone()).title(name.to_uppercase()).render(&mut bytes).into_diagnostic()?;
        let path = path(&name);
        output::write(&path, &bytes)?;
        output::say!("{}", path.display());
        Ok(())
    };
    pages().try_for_each(|(command, name)| page(command, name))
}
