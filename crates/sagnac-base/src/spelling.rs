//! Names that a user may have meant.

/// Shortest beginning of a name that is taken for the name, characters.
const MIN_PREFIX_CHARS: usize = 3;

/// The candidate that begins with `word`, or else is spelt most nearly like it, when one is near enough to be meant.
pub fn nearest<'a>(word: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    if word.len() > 100 {
        return None;
    }
    let wanted = plain(word);
    let candidates: Vec<&str> = candidates.into_iter().collect();
    if let Some(begun) = begun(&wanted, &candidates) {
        return Some(begun);
    }
    candidates
        .into_iter()
        .map(|c| (strsim::damerau_levenshtein(&wanted, &plain(c)), c))
        .filter(|(distance, c)| *distance <= 1 + c.chars().count().min(wanted.chars().count()) / 4)
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, c)| c)
}

/// A name without what people write in different ways.
fn plain(name: &str) -> String {
    name.to_lowercase().replace(['-', ' '], "_")
}

/// The candidate that begins with a word: `temp` is `temperature`. Of several, the one that all others begin with.
fn begun<'a>(wanted: &str, candidates: &[&'a str]) -> Option<&'a str> {
    if wanted.chars().count() < MIN_PREFIX_CHARS {
        return None;
    }
    let begin = || candidates.iter().copied().filter(|c| plain(c).starts_with(wanted));
    let shortest = begin().min_by_key(|c| c.len())?;
    begin().all(|c| plain(c).starts_with(&plain(shortest))).then_some(shortest)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_near_spellings_are_offered() {
        assert_eq!(nearest("warmup", ["warm_up", "site"]), Some("warm_up"));
        assert_eq!(nearest("angle-random-walk", ["angle_random_walk"]), Some("angle_random_walk"));
        assert_eq!(nearest("zebra", ["warm_up", "site"]), None);
    }

    #[test]
    fn a_beginning_is_nearer_than_a_spelling() {
        assert_eq!(nearest("temp", ["time", "temperature"]), Some("temperature"));
        assert_eq!(nearest("sample", ["sample_rate_tolerance", "sample_rate"]), Some("sample_rate"));
        // Two that go on differently: neither is offered for its beginning.
        assert_eq!(nearest("table", ["table_rate", "table_angle"]), None);
        assert_eq!(nearest("t", ["temperature"]), None);
    }
}
