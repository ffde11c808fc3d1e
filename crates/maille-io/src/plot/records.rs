//! Curves of several records and several l2: how each looks, and the legend that tells them apart.

use super::compare::l2_label;
use super::frame::{Entry, INK};
use super::look::{self, Look};

/// The looks of curves: by their l2 alone, or, with several records, line and colour by its record and marker by its l2.
pub(super) struct Looks {
    pub(super) l2: Vec<f64>,
    of_l2: Vec<Look>,
    /// None where there is one record.
    of_record: Vec<Look>,
}

impl Looks {
    /// Of so many records, and of these l2.
    pub(super) fn new(records: usize, l2: Vec<f64>) -> Self {
        Self { of_l2: look::of_l2(&l2), of_record: look::of_records(if records > 1 { records } else { 0 }), l2 }
    }

    /// The look of the curve of a record and the l2 of this index.
    pub(super) fn of(&self, record: usize, k: usize) -> Look {
        match self.of_record.get(record) {
            None => self.of_l2[k].clone(),
            Some(look) if self.l2.len() > 1 => look.with_l2(&self.of_l2[k]),
            Some(look) => look.clone(),
        }
    }

    /// What tells records apart, and the l2, each with its name, which is that of the whole plot if there is one. Of one
    /// record no l2 has a sample yet.
    pub(super) fn legend(
        &self,
        (apart, labels): &(String, Vec<String>),
        is: &str,
        name: impl Fn(f64) -> String,
    ) -> Vec<Entry> {
        let several = !self.of_record.is_empty();
        let mut out = Vec::new();
        if several {
            out.push(Entry::Heading(apart.clone()));
            let marker = self.l2.len() == 1;
            out.extend(self.of_record.iter().zip(labels).map(|(look, label)| Entry::sample(look, true, marker, label)));
        }
        if let ([only], true) = (&self.l2[..], several) {
            out.push(Entry::Heading(format!("l₂ {is}{}", name(*only))));
            return out;
        }
        out.push(Entry::Heading("l₂ across the pull".into()));
        if several {
            let look = |look: &Look| Look { color: INK.into(), ..look.clone() };
            let l2 = self.l2.iter().zip(&self.of_l2);
            out.extend(l2.map(|(l2, of_l2)| Entry::sample(&look(of_l2), false, true, &name(*l2))));
        }
        out
    }

    /// The same with a sample for each l2 of one record, too.
    pub(super) fn full_legend(&self, differences: &(String, Vec<String>)) -> Vec<Entry> {
        let mut out = self.legend(differences, "= ", l2_label);
        if self.of_record.is_empty() {
            let l2 = self.l2.iter().zip(&self.of_l2);
            out.extend(l2.map(|(l2, look)| Entry::sample(look, true, true, &l2_label(*l2))));
        }
        out
    }
}
