//! Lists of patterns as OpenSSH has them (`match.c`): separated by commas, with `*`, `?`, and `!` before what is excluded.

/// Whether a list has a text.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Listed {
    /// A pattern has it, and none excludes it.
    Yes,
    /// No pattern has it.
    No,
    /// A pattern excludes it.
    Excluded,
}

/// Whether a list of patterns has a text.
pub(super) fn matches_list(text: &str, list: &str) -> Listed {
    let mut listed = Listed::No;
    for pattern in list.split(',') {
        match pattern.strip_prefix('!') {
            Some(excluded) if matches(text.as_bytes(), excluded.as_bytes()) => return Listed::Excluded,
            None if matches(text.as_bytes(), pattern.as_bytes()) => listed = Listed::Yes,
            _ => {}
        }
    }
    listed
}

/// Whether a pattern has a text; in a time that grows with the product of their lengths at most.
fn matches(text: &[u8], pattern: &[u8]) -> bool {
    let (mut t, mut p) = (0, 0);
    // Where the last `*` stands, and what it has taken so far.
    let mut star: Option<(usize, usize)> = None;
    while t < text.len() {
        match pattern.get(p) {
            Some(b'*') => {
                star = Some((p, t));
                p += 1;
            }
            Some(c) if *c == b'?' || text.get(t) == Some(c) => {
                t += 1;
                p += 1;
            }
            _ => match star {
                Some((at, taken)) => {
                    star = Some((at, taken + 1));
                    (p, t) = (at + 1, taken + 1);
                }
                None => return false,
            },
        }
    }
    pattern.get(p..).is_none_or(|rest| rest.iter().all(|c| *c == b'*'))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patterns_match_as_those_of_openssh() {
        for (text, list, expected) in [
            ("anna", "anna", Listed::Yes),
            ("anna", "ANNA", Listed::No),
            ("anna", "a*a", Listed::Yes),
            ("anna", "a??a", Listed::Yes),
            ("anna", "a?a", Listed::No),
            ("anna", "*", Listed::Yes),
            ("anna", "*n*n*", Listed::Yes),
            ("anna", "bob,an*", Listed::Yes),
            ("anna", "*,!anna", Listed::Excluded),
            ("anna", "!bob", Listed::No),
            ("anna", "", Listed::No),
            ("", "*", Listed::Yes),
        ] {
            assert_eq!(matches_list(text, list), expected, "{text} in {list}");
        }
        let long = "a".repeat(2000);
        assert_eq!(matches_list(&long, &format!("{}b", "a*".repeat(500))), Listed::No);
    }
}
