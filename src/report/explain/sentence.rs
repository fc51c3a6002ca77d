//! The verdict in sentences.

use super::print::{chance, place, title, value};
use crate::effect::find;
use crate::i18n::{EffectText, effect_text, fill};
use crate::mismatch::finding::{Explanation, Finding, MismatchVerdict};
use crate::report::number::{count, digits, duration, percent};
use crate::report::translator::Translator;

/// What one finding adds to the claim, or corrects in it, as a phrase.
pub fn phrase(finding: &Finding, explanation: &Explanation, words: Translator) -> String {
    let kind = finding.effect_id();
    let pattern = effect_text(kind, EffectText::Phrase, words.lang);
    if pattern.is_empty() {
        return title(kind, words);
    }
    let mut given: Vec<(&str, String)> =
        finding.parameters.iter().map(|(name, p)| (name.as_str(), value(name, p, words).whole)).collect();
    let named = [("column", &finding.column), ("column2", &finding.column2)];
    given.extend(named.into_iter().filter_map(|(key, name)| Some((key, name.clone()?))));
    given.extend(finding.formula.clone().map(|formula| ("formula", formula)));
    given.extend(finding.law.as_ref().map(|law| ("law", words.name("explain.law", law))));
    if let Some(name) = corrected(kind) {
        // What a claim does not state, it states to be nil.
        let claimed = explanation
            .nuisances
            .iter()
            .find(|n| n.name.rsplit('.').next() == Some(name))
            .map_or_else(|| "0".to_owned(), |n| words.quantity(&digits_of(n.claimed, words), &n.unit));
        given.push(("claimed", claimed));
    }
    let known = places(pattern).all(|name| given.iter().any(|g| g.0 == name));
    if !known {
        let title = title(kind, words);
        return words.with("explain.sentence.bare", &[("title", &title)]);
    }
    let what = fill(pattern, |name| given.iter().find(|g| g.0 == name).map(|g| g.1.clone()));
    match finding.column.as_ref().filter(|_| !places(pattern).any(|name| name == "column")) {
        Some(column) => words.with("explain.sentence.of_column", &[("what", &what), ("column", column)]),
        None => what,
    }
}

/// The parameter by which an effect corrects a value that the claim states; `None` for one that adds to the claim.
fn corrected(kind: &str) -> Option<&'static str> {
    find(kind)?.params().iter().find(|p| p.corrects_claim).map(|p| p.name)
}

/// A claimed value as it was stated, but for the dust of arithmetic.
fn digits_of(v: f64, words: Translator) -> String {
    crate::report::number::limit_digits(v, 6, words.lang)
}

/// Names in braces.
fn places(pattern: &str) -> impl Iterator<Item = &str> {
    pattern.split('{').skip(1).filter_map(|p| p.split_once('}')).map(|p| p.0)
}

/// The sentences on one finding: what it is, where it shows, what it cannot be distinguished from.
pub fn finding(finding: &Finding, explanation: &Explanation, words: Translator) -> Vec<String> {
    let shown: Vec<String> =
        finding.places.iter().map(|p| place(p, explanation.recording.length_s, words)).collect();
    let shown = shown.join(&words.t("explain.and"));
    let mut out = vec![];
    if finding.is_unnamed() {
        out.push(words.t("explain.sentence.unknown"));
        out.extend(shape(finding, words));
        if let Some(rms) = finding.parameters.get("rms_deg_h") {
            let rms = value("rms_deg_h", rms, words).whole;
            out.push(words.with("explain.sentence.size", &[("rms", &rms)]));
        }
    } else {
        let what = phrase(finding, explanation, words);
        let corrects = corrected(finding.effect_id()).is_some();
        let key = if corrects { "explain.sentence.misstates" } else { "explain.sentence.leaves_out" };
        out.push(words.with(key, &[("what", &what)]));
    }
    if !shown.is_empty() {
        out.push(words.with("explain.sentence.shows", &[("where", &shown)]));
    }
    if finding.other_causes().next().is_some() {
        let list: Vec<String> = finding.other_causes().map(|k| title(k, words)).collect();
        let list = list.join(&words.t("number.list"));
        out.push(words.with("explain.sentence.equivalents", &[("list", &list)]));
    }
    out
}

/// What a cause without a name looks like, how often it shows and how large it is.
fn shape(finding: &Finding, words: Translator) -> Vec<String> {
    let Some(shape) = &finding.shape else { return vec![] };
    let mut out = vec![words.name("explain.shape", &shape.form)];
    if let (Some(events), Some(each_s)) = (shape.count, shape.each_s) {
        let (events, each) = (count(events as u64, words.lang), duration(each_s, words.lang));
        out.push(words.with("explain.shape.count", &[("count", &events), ("each", &each)]));
    }
    if let Some(rms) = shape.rms_deg_h {
        out.push(words.with("explain.shape.rms", &[("rms", &digits(rms, 2, words.lang))]));
    }
    out
}

/// The remainder when everything found has been added.
fn rest(all: &Explanation, words: Translator) -> Vec<String> {
    if let Some(rest) = &all.rest {
        let shown: Vec<String> =
            rest.places.iter().map(|p| place(p, all.recording.length_s, words)).collect();
        let given = [
            ("share", percent(rest.share, words.lang)),
            ("p", chance(rest.p_value, words)),
            ("where", shown.join(&words.t("explain.and"))),
        ];
        let given: Vec<(&str, &str)> = given.iter().map(|(key, text)| (*key, text.as_str())).collect();
        return vec![words.with("explain.sentence.rest_small", &given)];
    }
    let named: Vec<&Finding> = all.effects.iter().filter(|f| !f.is_unnamed()).collect();
    let after = all.family_p_value_after;
    let p = chance(after, words);
    let share = match named.as_slice() {
        [] => return vec![],
        [only] => only.removed_share.filter(|s| s.is_finite() && *s > 0.0).map(|s| percent(s, words.lang)),
        _ => None,
    };
    let unnamed = all.effects.len() > named.len();
    if let (Some(share), true) = (&share, after >= all.alpha && !unnamed) {
        return vec![words.with("explain.sentence.removes_all", &[("share", share), ("p", &p)])];
    }
    let mut out = vec![];
    out.extend(share.map(|s| words.with("explain.sentence.removes", &[("share", &s)])));
    let key = if unnamed && after < all.alpha {
        "explain.sentence.rest_unexplained"
    } else if unnamed {
        "explain.sentence.rest_unnamed"
    } else if after < all.alpha {
        "explain.sentence.rest_faint"
    } else if named.len() > 1 {
        "explain.sentence.rest_ordinary_of_several"
    } else {
        "explain.sentence.rest_ordinary"
    };
    out.push(words.with(key, &[("p", &p)]));
    out
}

/// The verdict, a sentence after the other.
pub fn verdict(explanation: &Explanation, words: Translator) -> Vec<String> {
    let p = chance(explanation.family_p_value, words);
    if explanation.effects.is_empty() {
        let r = &explanation.recording;
        let alpha = digits(explanation.alpha, 1, words.lang);
        let (rows, length) = (count(r.rows as u64, words.lang), duration(r.duration_s(), words.lang));
        let given = [("rows", rows.as_str()), ("length", &length), ("p", &p), ("alpha", &alpha)];
        let key = match explanation.verdict == MismatchVerdict::Consistent {
            true => "explain.sentence.consistent",
            false => "explain.sentence.unlocated",
        };
        return vec![words.with(key, &given)];
    }
    let several = explanation.effects.len() > 1;
    let mut out = vec![];
    for (i, f) in explanation.effects.iter().enumerate() {
        let text = finding(f, explanation, words).join(" ");
        out.push(if several { format!("{}) {text}", i + 1) } else { text });
    }
    out.extend(rest(explanation, words));
    out
}
