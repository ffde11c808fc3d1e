//! Cases of a statement, counted: for it, against it, and ties; and the verdict that they come to.

use serde::Serialize;

/// What became of a statement.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// No record speaks of it.
    NotMeasured,
    /// No case contradicts it.
    Holds,
    /// Some cases do.
    HoldsWithExceptions,
    /// More than a quarter of the cases do.
    Fails,
}

impl Verdict {
    /// In words.
    pub fn words(self) -> &'static str {
        match self {
            Verdict::NotMeasured => "not measured",
            Verdict::Holds => "holds",
            Verdict::HoldsWithExceptions => "holds with exceptions",
            Verdict::Fails => "fails",
        }
    }
}

/// A statement beside what was measured.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Finding {
    /// Number of the statement.
    pub number: u32,
    /// What the thesis says.
    pub statement: &'static str,
    /// What became of it.
    pub verdict: Verdict,
    /// Its parts, each with its cases.
    pub parts: Vec<Part>,
    /// What was measured.
    pub evidence: Vec<String>,
    /// The cases that contradict it.
    pub exceptions: Vec<String>,
}

/// How the cases of one part of a statement came out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Part {
    /// What a case shows.
    pub what: &'static str,
    /// Cases that show it.
    pub shown: usize,
    /// Cases that show neither it nor the contrary.
    pub ties: usize,
    /// Cases that show the contrary.
    pub against: usize,
}

/// Exceptions up to this part of the cases leave a statement standing.
const MOST_EXCEPTIONS: f64 = 0.25;
/// The same where the thesis says "usually".
const MOST_OF_USUAL: f64 = 0.5;

/// How verdicts come about, for readers of the page.
pub(crate) const RULE: &str = "Each statement is broken into cases. It holds if every case shows it, holds with exceptions if at \
    least three quarters do (more than half, where the thesis says \u{201c}usually\u{201d}), and fails otherwise. A tie, what stays the \
    same, counts neither way and is counted apart. Parts are judged apart, and the worst counts.";

/// Cases of one part of a statement.
#[derive(Default)]
pub(crate) struct Cases {
    /// What a case shows.
    pub(crate) what: &'static str,
    pub(crate) shown: usize,
    pub(crate) ties: usize,
    pub(crate) exceptions: Vec<String>,
    /// It is enough that some cases show it.
    pub(crate) some: bool,
    /// The thesis says "usually".
    pub(crate) usual: bool,
}

impl Cases {
    pub(crate) fn of(what: &'static str) -> Self {
        Cases { what, ..Cases::default() }
    }

    pub(crate) fn add(&mut self, holds: bool, what: impl FnOnce() -> String) {
        if holds {
            self.shown += 1;
        } else {
            self.exceptions.push(what());
        }
    }

    /// It holds where `more` is above 0; within `tie` of 0 it is a tie.
    pub(crate) fn compare(&mut self, more: f64, tie: f64, what: impl FnOnce() -> String) {
        if more.abs() <= tie { self.ties += 1 } else { self.add(more > 0.0, what) }
    }

    pub(crate) fn count(&self) -> usize {
        self.shown + self.exceptions.len()
    }

    pub(crate) fn verdict(&self) -> Verdict {
        let count = self.count();
        match self.exceptions.len() {
            _ if count == 0 => Verdict::NotMeasured,
            0 => Verdict::Holds,
            n if self.some && n < count => Verdict::HoldsWithExceptions,
            n if self.usual && (n as f64) < MOST_OF_USUAL * count as f64 => Verdict::HoldsWithExceptions,
            n if n as f64 <= MOST_EXCEPTIONS * count as f64 => Verdict::HoldsWithExceptions,
            _ => Verdict::Fails,
        }
    }

    /// `61 of 64 cases`, with the ties.
    pub(crate) fn score(&self) -> String {
        let ties = match self.ties {
            0 => String::new(),
            1 => " (and 1 tie)".into(),
            n => format!(" (and {n} ties)"),
        };
        format!("{} of {} cases{ties}", self.shown, self.count())
    }

    fn part(&self) -> Part {
        Part { what: self.what, shown: self.shown, ties: self.ties, against: self.exceptions.len() }
    }
}

impl Finding {
    /// Names a case that keeps the statement from holding as it stands, whatever the other cases say.
    pub(crate) fn except(mut self, what: String) -> Self {
        if self.verdict != Verdict::NotMeasured {
            self.verdict = self.verdict.max(Verdict::HoldsWithExceptions);
        }
        self.exceptions.push(what);
        self
    }
}

pub(crate) fn finding(number: u32, statement: &'static str, evidence: Vec<String>, parts: Vec<Cases>) -> Finding {
    Finding {
        number,
        statement,
        verdict: parts.iter().map(Cases::verdict).max().unwrap_or(Verdict::NotMeasured),
        parts: parts.iter().filter(|part| part.count() + part.ties > 0).map(Cases::part).collect(),
        evidence,
        exceptions: parts.into_iter().flat_map(|part| part.exceptions).collect(),
    }
}
