//! What a joint explanation says.

use crate::mismatch::finding::MismatchVerdict;
use crate::mismatch::joint::record::{JointExplanation, SharedEffect};
use crate::report::explain::print::{chance, difference, title};
use crate::report::number::count;
use crate::report::translator::Translator;

/// The verdict in sentences.
pub(super) fn summary(all: &JointExplanation, words: Translator) -> Vec<String> {
    let recordings = count(all.recordings.len() as u64, words.lang);
    let mut out = vec![];
    match &all.shared[..] {
        [] if all.verdict == MismatchVerdict::Consistent => {
            out.push(words.with("joint.consistent", &[("n", &recordings)]));
        }
        [] => out.push(words.with("joint.nothing_shared", &[("n", &recordings)])),
        shared => {
            let names: Vec<String> = shared.iter().map(|s| effect(s, words)).collect();
            let names = names.join(&words.t("number.list"));
            out.push(words.with("joint.shared", &[("n", &recordings), ("effects", &names)]));
            let blind =
                all.recordings.iter().filter(|r| r.alone.verdict == MismatchVerdict::Consistent).count();
            if blind > 0 {
                let blind = count(blind as u64, words.lang);
                out.push(words.with("joint.not_seen_alone", &[("k", &blind), ("n", &recordings)]));
            }
        }
    }
    if !all.unlike.is_empty() {
        let names: Vec<String> = all.unlike.iter().map(|s| effect(s, words)).collect();
        out.push(words.with("joint.unlike", &[("effects", &names.join(&words.t("number.list")))]));
    }
    let left = all.recordings.iter().filter(|r| r.together.verdict != MismatchVerdict::Consistent).count();
    if left > 0 {
        let left = count(left as u64, words.lang);
        out.push(words.with("joint.more_in_single", &[("k", &left), ("n", &recordings)]));
    } else if !all.shared.is_empty() {
        out.push(words.t("joint.all_explained"));
    }
    out
}

/// Sentences about one effect.
pub(super) fn shared(s: &SharedEffect, words: Translator) -> Vec<String> {
    let recordings = count(s.of.len() as u64, words.lang);
    let worth = words.with(
        "joint.worth",
        &[
            ("gain", &difference(s.gain, words)),
            ("bic", &difference(s.delta_bic, words)),
            ("p", &chance(s.p_value, words)),
        ],
    );
    let agree =
        words.with("joint.agreement", &[("p", &chance(s.agreement_p_value, words)), ("n", &recordings)]);
    let better = count(s.of.iter().filter(|o| o.predicted_gain > 0.0).count() as u64, words.lang);
    let gain = difference(s.predicted_gain, words);
    let predicted = words.with("joint.predicted", &[("gain", &gain), ("k", &better), ("n", &recordings)]);
    vec![worth, agree, predicted]
}

/// Title of an effect, with its column.
pub(super) fn effect(s: &SharedEffect, words: Translator) -> String {
    let name = title(s.effect.as_deref().unwrap_or(&s.kind), words);
    match &s.column {
        Some(column) => format!("{name} ({column})"),
        None => name,
    }
}
