//! Names that a user may have meant.

/// The candidate that is spelt most nearly like `word`, when one is near enough to be meant.
pub fn nearest<'a>(word: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    if word.len() > 100 {
        return None;
    }
    let plain = |s: &str| s.to_lowercase().replace(['-', ' '], "_");
    let wanted = plain(word);
    candidates
        .into_iter()
        .map(|c| (strsim::damerau_levenshtein(&wanted, &plain(c)), c))
        .filter(|(distance, c)| *distance <= 1 + c.chars().count().min(wanted.chars().count()) / 4)
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, c)| c)
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
}
