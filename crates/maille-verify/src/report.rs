//! What came of a verification, as data.

use serde::Serialize;

/// What is asked of a record and of each of its rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Check {
    /// The files are whole, unedited, and fit together.
    Files,
    /// The row has what its status says, and nothing else.
    Status,
    /// The lattice of the state gives the numbers of the row.
    Deformation,
    /// Rings of different elements keep their distance.
    Overlap,
    /// Linking numbers are those of the design.
    Links,
    /// Contact forces are pushes, of closed contacts, and balance the pull.
    Balance,
    /// No small motion raises l1, to second order.
    Curvature,
    /// The least curvature on waves through the sheet is the one of the row.
    Waves,
    /// The row is not above its bound, and attains it where it says so.
    Bound,
}

impl Check {
    /// All of them, in the order in which they are told.
    pub const ALL: [Check; 9] = [
        Check::Files,
        Check::Status,
        Check::Deformation,
        Check::Overlap,
        Check::Links,
        Check::Balance,
        Check::Curvature,
        Check::Waves,
        Check::Bound,
    ];

    /// Its name, as in JSON.
    pub fn name(self) -> &'static str {
        match self {
            Check::Files => "files",
            Check::Status => "status",
            Check::Deformation => "deformation",
            Check::Overlap => "overlap",
            Check::Links => "links",
            Check::Balance => "balance",
            Check::Curvature => "curvature",
            Check::Waves => "waves",
            Check::Bound => "bound",
        }
    }
}

/// What a check came to, best first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// Derived anew, and it holds.
    Proved,
    /// Of a file without a checksum: nothing contradicts it. No row is proved by this.
    Consistent,
    /// It may hold; it could not be shown.
    Open,
    /// It does not hold.
    False,
}

/// A check with its outcome.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Finding {
    /// What was asked.
    pub check: Check,
    /// What came of it.
    pub verdict: Verdict,
    /// The figure that decided, in the unit that `words` name.
    pub figure: Option<f64>,
    /// One sentence.
    pub words: String,
}

impl Finding {
    pub(crate) fn new(check: Check, verdict: Verdict, figure: Option<f64>, words: impl Into<String>) -> Self {
        Finding { check, verdict, figure, words: words.into() }
    }
}

/// What is known of one row.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RowReport {
    /// Direction of the row.
    pub direction_deg: f64,
    /// l2 of the row.
    pub l2: f64,
    /// Status of the row.
    pub status: String,
    /// Whether the row claims a certificate: `global` or `local`.
    pub certified: bool,
    /// The checks; a row without a limit has none to pass.
    pub findings: Vec<Finding>,
}

impl RowReport {
    /// The worst verdict; none where nothing was claimed.
    pub fn verdict(&self) -> Option<Verdict> {
        self.findings.iter().map(|f| f.verdict).max()
    }

    /// Whether all that a certified row claims was derived anew.
    pub fn proved(&self) -> bool {
        let derived =
            [Check::Status, Check::Deformation, Check::Overlap, Check::Links, Check::Balance, Check::Curvature];
        derived.iter().all(|check| self.finding(*check).is_some())
            && self.findings.iter().all(|finding| finding.verdict == Verdict::Proved)
    }

    /// The finding of a check.
    pub fn finding(&self, check: Check) -> Option<&Finding> {
        self.findings.iter().find(|f| f.check == check)
    }
}
