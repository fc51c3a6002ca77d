//! The parts of a model by name.

use crate::i18n::{Arg, Note, note};
use crate::measurand;
use crate::record::{ModelRecord, ShareRecord};

/// The name of a part of a model, by its id.
pub fn part_key(id: &str) -> &'static str {
    match id {
        "angle_random_walk" => "compare.part.angle_random_walk",
        "flicker" => "compare.part.flicker",
        "rate_random_walk" => "compare.part.rate_random_walk",
        "quantization" => "compare.part.quantization",
        "rate_ramp" => "compare.part.rate_ramp",
        "markov" => "compare.part.markov",
        "quasi_periodic" => "compare.part.quasi_periodic",
        _ => "compare.part.line",
    }
}

/// The name of several parts of a kind, where it has a plural.
fn plural(id: &str) -> &'static str {
    match id {
        "markov" => "compare.more.markovs",
        "quasi_periodic" => "compare.more.quasi_periodics",
        "line" => "compare.more.lines",
        other => part_key(other),
    }
}

/// Names of the kinds of parts with their shares together, the largest first.
pub(super) fn grouped(shares: &[ShareRecord]) -> Vec<(&'static str, f64)> {
    let mut kinds: Vec<(&str, usize, f64)> = vec![];
    for s in shares {
        match kinds.iter_mut().find(|k| k.0 == s.part) {
            Some(kind) => {
                kind.1 += 1;
                kind.2 += s.share;
            }
            None => kinds.push((&s.part, 1, s.share)),
        }
    }
    kinds.sort_by(|a, b| b.2.total_cmp(&a.2));
    kinds.into_iter().map(|(id, n, share)| (if n > 1 { plural(id) } else { part_key(id) }, share)).collect()
}

/// The name of one part, with its frequency where it has one.
pub fn part_name(share: &ShareRecord, model: &ModelRecord) -> Note {
    let centre = || {
        let id = measurand::QUASI_PERIODIC_FREQUENCY.id;
        Some(model.parameters.iter().find(|p| p.id == id && p.index == share.index)?.value)
    };
    let frequency = match share.part.as_str() {
        "line" => model.lines.get(share.index).map(|l| l.frequency_hz),
        "quasi_periodic" => centre(),
        _ => None,
    };
    let name = Arg::Key(part_key(&share.part).into());
    match frequency {
        Some(hz) => note!("compare.more.part_at", part = name, hz = Arg::rounded(hz, 4)),
        None => note!("compare.label", name),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::i18n::{Lang, Localize};
    use crate::record::CoherentLine;

    fn share(part: &str, index: usize, share: f64) -> ShareRecord {
        ShareRecord { part: part.into(), index, share, deviation_deg_h: 0.0 }
    }

    #[test]
    fn parts_of_a_kind_are_told_together_and_named_apart() {
        let shares = [share("angle_random_walk", 0, 0.4), share("line", 1, 0.35), share("line", 0, 0.25)];
        let kinds = grouped(&shares);
        assert_eq!(kinds[0].0, "compare.more.lines");
        assert!((kinds[0].1 - 0.6).abs() < 1e-12);
        assert_eq!(kinds[1], ("compare.part.angle_random_walk", 0.4));
        let model = ModelRecord {
            lines: [(1.0, 2.5), (2.0, 7.25)].map(CoherentLine::from).to_vec(),
            ..ModelRecord::default()
        };
        assert_eq!(part_name(&shares[1], &model).say(Lang::En), "a spectral line at 7.25 Hz");
        assert_eq!(part_name(&shares[0], &model).say(Lang::En), "angle random walk");
    }
}
