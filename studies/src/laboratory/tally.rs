//! Many scores as rows of a study.

use super::score::{Believed, Score};
use super::truth::{Family, Strength};
use crate::study::{Asked, Row};

/// Rows of the scores of one family and half.
pub fn rows(family: Family, scores: &[Score]) -> Vec<Row> {
    if family == Family::Null {
        return null_rows(scores);
    }
    let mut rows = vec![];
    for strength in Strength::ALL {
        let of: Vec<&Score> = scores.iter().filter(|s| s.strength == Some(strength)).collect();
        if !of.is_empty() {
            rows.extend(strength_rows(family, strength, &of));
        }
    }
    let both: Vec<&Score> = scores.iter().collect();
    rows.push(share("any", "no name besides what is there", Asked::AtLeast(0.95), &both, |s| s.extra == 0));
    rows.push(share("any", "no decoy named", Asked::AtLeast(0.99), &both, |s| s.decoys_named == 0));
    rows.extend(reliability(scores));
    let laws: Vec<&Score> = scores.iter().filter(|s| s.law.is_some()).collect();
    if !laws.is_empty() {
        rows.push(share("any", "law of the column", Asked::Nothing, &laws, |s| s.law == Some(true)));
    }
    let tried: Vec<&Score> = scores.iter().filter(|s| s.closes.is_some() && s.detected).collect();
    if !tried.is_empty() {
        rows.push(share("any", "loop closes", Asked::AtLeast(0.95), &tried, |s| s.closes == Some(true)));
    }
    rows
}

fn strength_rows(family: Family, strength: Strength, of: &[&Score]) -> Vec<Row> {
    let name = strength.name();
    let clear = strength == Strength::Clear;
    let when = |asked: f64| if clear { Asked::AtLeast(asked) } else { Asked::Nothing };
    let mut rows =
        vec![share(name, "detected", if clear { Asked::Nothing } else { Asked::AtLeast(0.85) }, of, |s| {
            s.detected
        })];
    let names = match (family, clear) {
        (Family::Unknown, true) => Asked::AtLeast(0.8),
        (Family::Unknown, false) => Asked::AtLeast(0.5),
        _ => when(0.85),
    };
    rows.push(share(name, "named first or as one of three equivalents", names, of, |s| s.named));
    rows.push(share(name, "named first", Asked::Nothing, of, |s| s.named_first));
    if family == Family::Unknown {
        rows.push(share(name, "called unknown by any entry", Asked::Nothing, of, |s| s.found > 0));
    }
    if family == Family::Several {
        let (found, concealed) =
            of.iter().fold((0, 0), |(f, c), s| (f + s.found as u64, c + s.concealed as u64));
        rows.push(Row::share(name, "each of the effects named", Asked::Nothing, found, concealed));
    }
    rows.push(share(name, "located", when(0.9), of, |s| s.located));
    let held: Vec<bool> = of.iter().flat_map(|s| s.intervals.iter().map(|i| i.holds)).collect();
    let hits = held.iter().filter(|h| **h).count() as u64;
    rows.push(Row::share(
        name,
        "95 % intervals hold the truth",
        Asked::Between(0.93, 0.97),
        hits,
        held.len() as u64,
    ));
    let parts: Vec<f64> = of.iter().filter_map(|s| s.explained).collect();
    let mean = parts.iter().sum::<f64>() / parts.len() as f64;
    rows.push(Row::number(name, "explained variance over the possible", when(0.9), mean, parts.len() as u64));
    // What each subject is worth, so that a family does not hide it.
    let mut subjects: Vec<&str> = of.iter().map(|s| s.subject.as_str()).collect();
    subjects.dedup();
    for subject in subjects {
        let own: Vec<&Score> = of.iter().copied().filter(|s| s.subject == subject).collect();
        rows.push(share(&format!("{name}, {subject}"), "named", Asked::Nothing, &own, |s| s.named));
    }
    rows
}

/// How often names are right to which answers give a probability between two bounds, against the mean of the probabilities.
fn reliability(scores: &[Score]) -> Vec<Row> {
    const BOUNDS: [f64; 6] = [0.0, 0.1, 0.4, 0.7, 0.95, 1.0 + 1e-9];
    let all: Vec<&Believed> = scores.iter().flat_map(|s| &s.names).collect();
    let one = |bounds: &[f64]| {
        let inside: Vec<&&Believed> =
            all.iter().filter(|b| (bounds[0]..bounds[1]).contains(&b.probability)).collect();
        let of = inside.len() as u64;
        let mean = inside.iter().map(|b| b.probability).sum::<f64>() / of.max(1) as f64;
        let right = inside.iter().filter(|b| b.right).count() as u64;
        let claim = format!("names of probability {mean:.2} on average are right");
        (of > 0).then(|| Row::share("reliability", &claim, Asked::Nothing, right, of))
    };
    BOUNDS.windows(2).filter_map(one).collect()
}

fn null_rows(scores: &[Score]) -> Vec<Row> {
    let of: Vec<&Score> = scores.iter().collect();
    let named = |s: &Score| s.decoys_named > 0;
    vec![
        share("claim that is right", "false alarm", Asked::AtMost(0.013), &of, |s| s.detected),
        share("claim that is right", "decoy named", Asked::AtMost(0.01), &of, named),
    ]
}

fn share(quantity: &str, claim: &str, asked: Asked, of: &[&Score], hit: impl Fn(&Score) -> bool) -> Row {
    let hits = of.iter().filter(|s| hit(s)).count() as u64;
    Row::share(quantity, claim, asked, hits, of.len() as u64)
}

/// A table of rows as plain text.
pub fn table(title: &str, rows: &[Row]) -> String {
    let mut text = format!("{title}\n");
    for row in rows {
        let measured = row.measured.map_or_else(|| "-".to_owned(), |m| format!("{m:.3}"));
        let interval = row.interval.map_or_else(String::new, |[l, h]| format!("{l:.3} to {h:.3}"));
        text += &format!(
            "  {:<34} {:<44} {measured:>7}  {interval:<15} of {:<5} asked {:<14} {}\n",
            row.quantity,
            row.claim,
            row.of,
            row.asked.to_string(),
            row.verdict.name()
        );
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::laboratory::truth::Half;
    use crate::study::Verdict;

    fn score(family: Family, strength: Option<Strength>, right: bool) -> Score {
        Score {
            case: "one".into(),
            subject: "line".into(),
            family,
            half: Half::Development,
            strength,
            detected: right,
            first: String::new(),
            named_first: right,
            named: right,
            found: usize::from(right),
            concealed: 1,
            located: right,
            extra: usize::from(!right),
            decoys_named: 0,
            law: None,
            intervals: vec![],
            names: vec![Believed { probability: 0.8, right }],
            explained: Some(f64::from(right)),
            closes: Some(right),
        }
    }

    #[test]
    fn shares_are_of_the_cases_of_their_strength() {
        let clear = |right| score(Family::Event, Some(Strength::Clear), right);
        let rows = rows(Family::Event, &[clear(true), clear(true), clear(true), clear(false)]);
        let of = |claim: &str| rows.iter().find(|r| r.claim.starts_with(claim)).unwrap();
        assert_eq!((of("named first or").measured, of("named first or").of), (Some(0.75), 4));
        assert_eq!(of("explained").measured, Some(0.75));
        assert_eq!(of("no name besides").measured, Some(0.75));
        // A loop can close only where something was found.
        assert_eq!((of("names of probability 0.80").measured, of("names of").of), (Some(0.75), 4));
        assert_eq!((of("loop").measured, of("loop").of), (Some(1.0), 3));
        assert!(rows.iter().all(|r| !r.quantity.starts_with("middling")), "{rows:?}");
    }

    #[test]
    fn of_a_right_claim_every_detection_is_a_false_alarm() {
        let many: Vec<Score> = (0..100).map(|i| score(Family::Null, None, i < 10)).collect();
        let rows = rows(Family::Null, &many);
        assert_eq!((rows[0].measured, rows[0].verdict), (Some(0.1), Verdict::Misses));
    }
}
