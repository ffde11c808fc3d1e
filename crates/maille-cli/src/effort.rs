//! How long a search goes on: the options that commands share.

use crate::numbers::read;
use maille::question::{Effort, Question};

/// Effort, starts and seed of a search.
#[derive(clap::Args, Clone, Copy)]
pub struct SearchArgs {
    /// How long to search where no proven bound is attained: low, normal, thorough, or a time for each cell, such as 30s. The search stops when
    /// the chance that another start finds more is estimated at 10, 2 or 0.5 %
    #[arg(long, default_value_t, value_parser = read::<Effort>)]
    pub effort: Effort,
    /// A number of starts, instead of an effort
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..=10_000), conflicts_with = "effort")]
    starts: Option<u32>,
    /// Seed of the random starts
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
}

impl SearchArgs {
    /// Those that are used where no option names them.
    pub const USUAL: SearchArgs = SearchArgs { effort: Effort::Normal, starts: None, seed: 1 };

    /// The number of starts, where one is asked for.
    pub fn starts(&self) -> Option<usize> {
        self.starts.map(|starts| starts as usize)
    }

    /// The same question, searched so.
    pub fn of(&self, question: Question) -> Question {
        Question { effort: self.effort, starts: self.starts(), seed: self.seed, ..question }
    }
}
