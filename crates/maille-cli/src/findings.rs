//! What `maille verify` found, in words, and the texts that it reads.

use crate::{
    exit::{self, wrong},
    output,
    remedy::DAMAGED,
};
use maille_verify::{Check, Finding, Unreadable, Verdict};
use miette::{IntoDiagnostic, Report, Result, WrapErr};
use std::{fs, io::ErrorKind, path::Path};

/// A file of a folder, if it is there.
pub fn text(folder: &Path, name: &str) -> Result<Option<String>> {
    let path = folder.join(name);
    match fs::read_to_string(&path) {
        Ok(text) => Ok(Some(text)),
        Err(e) if e.kind() == ErrorKind::NotFound => Ok(None),
        Err(e) if e.kind() == ErrorKind::InvalidData => {
            Err(wrong(exit::RECORD, format!("{} is not a text file", path.display()), DAMAGED))
        }
        Err(e) => Err(e).into_diagnostic().wrap_err_with(|| format!("cannot read {}", path.display())),
    }
}

/// A file that cannot be read as what it should be.
pub fn unreadable(folder: &Path, e: &Unreadable) -> Report {
    wrong(exit::RECORD, format!("{}:{}: {}", folder.join(e.file).display(), e.line, e.problem), DAMAGED)
}

/// The exit code by the worst verdict, and by how many of the certified ones are proved.
pub fn code(worst: Option<Verdict>, proved: usize, certified: usize) -> u8 {
    match worst {
        Some(Verdict::False) => exit::RECORD,
        Some(Verdict::Open) => exit::INCOMPLETE,
        _ if proved < certified => exit::INCOMPLETE,
        _ => exit::DONE,
    }
}

/// The outcome with this exit code, in a word.
pub fn outcome(code: u8) -> &'static str {
    match code {
        exit::DONE => "proved",
        exit::RECORD => "false",
        _ => "open",
    }
}

/// A line for each check of all rows.
pub fn say_checks<'a>(rows: impl Iterator<Item = &'a [Finding]> + Clone) {
    for check in Check::ALL.into_iter().filter(|check| *check != Check::Files) {
        let of = |findings: &'a [Finding]| findings.iter().find(|finding| finding.check == check);
        let findings: Vec<&Finding> = rows.clone().filter_map(of).collect();
        if findings.is_empty() {
            continue;
        }
        let verdicts = [(Verdict::Proved, "proved"), (Verdict::Open, "could not be shown"), (Verdict::False, "false")];
        let count = |verdict: Verdict| findings.iter().filter(|f| f.verdict == verdict).count();
        let words = verdicts.iter().map(|(verdict, word)| (count(*verdict), word)).filter(|(n, _)| *n > 0);
        let words: Vec<String> = words.map(|(n, word)| format!("{n} {word}")).collect();
        output::say!("  {:<12} {}{}", check.name(), words.join(", "), extreme(check, &findings));
    }
}

/// A finding in words.
pub fn marked(finding: &Finding) -> String {
    let mark = match finding.verdict {
        Verdict::Proved | Verdict::Consistent => "",
        Verdict::Open => "could not be shown: ",
        Verdict::False => "FALSE: ",
    };
    format!("{mark}{}", finding.words)
}

/// The figure of all proved rows that is nearest to its tolerance.
fn extreme(check: Check, findings: &[&Finding]) -> String {
    let figures = findings.iter().filter(|f| f.verdict == Verdict::Proved).filter_map(|f| f.figure);
    match check {
        Check::Deformation => format!("; largest difference {:.1e}", figures.fold(0.0, f64::max)),
        Check::Overlap => {
            let least = figures.fold(f64::INFINITY, f64::min);
            if least.is_finite() { format!("; smallest gap {least:.1e} R") } else { String::new() }
        }
        Check::Balance => format!("; largest residual {:.1e}", figures.fold(0.0, f64::max)),
        _ => String::new(),
    }
}
