//! "Did you mean …?"

/// The word that `word` was probably meant to be.
pub(crate) fn nearest<'a>(word: &str, known: &[&'a str]) -> Option<&'a str> {
    let word = word.to_lowercase();
    let distance = |k: &str| {
        let contained = word.len() >= 4 && (k.contains(&word) || word.contains(k));
        if contained { 1 } else { strsim::damerau_levenshtein(&word, k) }
    };
    let best = known.iter().copied().min_by_key(|k| distance(k))?;
    (distance(best) <= 1 + word.chars().count() / 4).then_some(best)
}
