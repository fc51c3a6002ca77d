//! The findings on a unit in sentences: what its drift is made of, and what could not be compared.

use super::parts::grouped;
use super::unit::{Origin, Unit};
use crate::i18n::{Arg, Note, note};
use crate::measurand;
use crate::noise::data::NoiseType;
use crate::record::{Agreement, ComparisonRecord, WindowRecord};

/// Smallest share that is named.
const MIN_NAMED_SHARE: f64 = 0.005;

/// Probability of a misfit below which a prediction is called indicative.
const MIN_BELIEVABLE_P: f64 = 1e-3;

/// How many half-widths of a 95 % interval off a verdict may still be chance: 3.3 standard deviations, one in a
/// thousand.
const MAX_CHANCE_HALF_WIDTHS: f64 = 1.7;

/// Id of the note that a Markov process does as well as flicker.
const MARKOV_ALIKE: &str = "slow_alike.markov";

/// The window of the drift, s.
const WINDOW_S: f64 = 100.0;

/// The window of a length.
fn window(detail: &ComparisonRecord, window_s: f64) -> Option<&WindowRecord> {
    detail.windows.iter().find(|w| w.window_s == window_s)
}

/// The sentences of a unit, the most important first.
pub(super) fn sentences(unit: &Unit) -> Vec<Note> {
    let Some(detail) = &unit.detail else { return vec![] };
    let mut out = vec![];
    if let Some(w) = window(detail, 100.0) {
        out.extend(made_of(w));
        out.extend(agreement(w, "100"));
    }
    if let Some(w) = window(detail, 10.0) {
        out.extend(agreement(w, "10"));
    }
    out.extend(by_chance(detail));
    out.extend(null(detail));
    out.extend(floor(unit, detail));
    out
}

fn percent(share: f64) -> Arg {
    Arg::rounded(100.0 * share, if share > 0.995 { 3 } else { 2 })
}

fn made_of(w: &WindowRecord) -> Option<Note> {
    let kinds = grouped(&w.shares);
    let (first, rest) = kinds.split_first()?;
    let others: Vec<Arg> = rest
        .iter()
        .filter(|(_, share)| *share >= MIN_NAMED_SHARE)
        .map(|(key, share)| {
            let part = Arg::Key((*key).into());
            Arg::from(note!("compare.summary.share", part, share = percent(*share)))
        })
        .collect();
    let note =
        Note::new(if others.is_empty() { "compare.summary.made_of_one" } else { "compare.summary.made_of" })
            .with("part", Arg::Key(first.0.into()))
            .with("share", percent(first.1));
    Some(if others.is_empty() { note } else { note.with("others", Arg::Several(others, ", ".into())) })
}

fn agreement(w: &WindowRecord, window: &'static str) -> Option<Note> {
    let (ratio, interval) = (w.ratio?, w.ratio_interval?);
    // Two digits of the half-width, and not fewer than two of the value.
    let half = 0.5 * (interval.high - interval.low) / ratio;
    let figures = (1.0 - half.max(1e-6).log10().floor()).clamp(2.0, 6.0) as usize;
    let key = match w.agreement? {
        Agreement::Consistent => "compare.summary.consistent",
        Agreement::Above if window == "100" => "compare.summary.above",
        Agreement::Above => "compare.summary.above_10",
        Agreement::Below => "compare.summary.below",
    };
    Some(
        Note::new(key)
            .with("window", window)
            .with("observed", w.observed)
            .with("predicted", w.predicted?)
            .with("ratio", Arg::figures(ratio, figures))
            .with("low", Arg::figures(interval.low, figures))
            .with("high", Arg::figures(interval.high, figures)),
    )
}

/// Said when the model is no description of the record.
pub(super) fn misfit(detail: &ComparisonRecord) -> Option<Note> {
    let (misfit, p) = (detail.model.misfit?, detail.model.misfit_probability?);
    (p < MIN_BELIEVABLE_P).then(|| note!("compare.summary.misfit", misfit = Arg::rounded(misfit, 2)))
}

/// Said when a verdict is so near that it may be chance.
fn by_chance(detail: &ComparisonRecord) -> Option<Note> {
    let near = |w: &WindowRecord| {
        let (ratio, i) = (w.ratio?, w.ratio_interval?);
        let to_one = if ratio > 1.0 { (ratio / i.low).ln() } else { (i.high / ratio).ln() };
        let off = ratio.ln().abs() / to_one;
        Some(off > 1.0 && off < MAX_CHANCE_HALF_WIDTHS)
    };
    detail.windows.iter().any(|w| near(w) == Some(true)).then(|| note!("compare.more.by_chance"))
}

/// Share of angle random walk in σ100 as predicted; `None` without a prediction.
fn white_share(detail: &ComparisonRecord) -> Option<f64> {
    let shares = &window(detail, WINDOW_S).filter(|w| w.predicted.is_some())?.shares;
    Some(shares.iter().find(|s| s.part == NoiseType::AngleRandomWalk.id()).map_or(0.0, |s| s.share))
}

fn null(detail: &ComparisonRecord) -> Option<Note> {
    let m = detail.minimum.as_ref()?;
    let ([low, median, high], ratio) = (m.null_ratio?, m.ratio?);
    let white = white_share(detail);
    let key = if ratio < low {
        "compare.summary.null_below"
    } else if ratio > high {
        "compare.summary.null_above"
    } else if white.is_none_or(|white| white >= 0.5) {
        "compare.summary.null_inside"
    } else {
        "compare.more.null_inside_of_other_noise"
    };
    Some(
        Note::new(key)
            .with("length", time(detail.length_s))
            .with("tau", time(m.largest_tau_s))
            .with("low", Arg::rounded(low, 2))
            .with("median", Arg::rounded(median, 2))
            .with("high", Arg::rounded(high, 2))
            .with("ratio", Arg::figures(ratio, 3))
            .with("share", percent(white.unwrap_or(1.0))),
    )
}

fn floor(unit: &Unit, detail: &ComparisonRecord) -> Option<Note> {
    let f = detail.floor.as_ref()?;
    let notes = unit.quantity(measurand::BIAS_INSTABILITY.id).map_or(&[][..], |q| &q.notes);
    let markov = notes.iter().any(|n| n.id == MARKOV_ALIKE);
    let key = match (f.is_limit, f.identifiable_h) {
        (false, Some(_)) if markov => "compare.summary.floor_or_markov",
        (false, Some(h)) if h * 3600.0 <= detail.length_s => "compare.summary.floor_shown",
        (true, Some(h)) if h * 3600.0 <= detail.length_s => "compare.summary.floor_limit_here",
        (false, Some(_)) => "compare.summary.floor_early",
        (true, Some(_)) => "compare.summary.floor_limit",
        (_, None) => "compare.summary.floor_never",
    };
    let b = if f.is_limit { rounded_up(f.b_deg_h) } else { f.b_deg_h };
    let note = Note::new(key)
        .with("b", Arg::rounded(b, 3))
        .with("crossover", time(f.crossover_s))
        .with("longest_h", crate::noise::identifiable::MAX_HOURS);
    Some(match f.identifiable_h {
        Some(h) => note.with("needed", time(h * 3600.0)),
        None => note,
    })
}

/// An upper limit to three digits, never below itself.
fn rounded_up(limit: f64) -> f64 {
    let place = 10f64.powf(limit.abs().log10().floor() - 2.0);
    let up = (limit / place * (1.0 - 1e-12)).ceil() * place;
    if up.is_finite() { up } else { limit }
}

/// A time in the unit that reads well.
fn time(seconds: f64) -> Note {
    let (key, value) = match seconds {
        s if s < 120.0 => ("compare.time.s", s),
        s if s < 7200.0 => ("compare.time.min", s / 60.0),
        s => ("compare.time.h", s / 3600.0),
    };
    Note::new(key).with("value", Arg::rounded(value, 2))
}

/// What could not be compared.
pub(super) fn missing(unit: &Unit) -> Vec<Note> {
    let mut out = vec![];
    let drift = unit.quantity(measurand::RUSSIAN_DRIFT_100S.id);
    if drift.and_then(|d| d.value) == Some(0.0) {
        return vec![note!("compare.missing.constant")];
    }
    match (&unit.detail, drift.and_then(|d| d.value), unit.origin) {
        (Some(detail), _, _) => {
            for w in detail.windows.iter().filter(|w| w.predicted.is_none()) {
                out.push(note!("compare.missing.beyond", window = w.window_s));
            }
            if detail.octaves.is_none() {
                out.push(note!("compare.missing.octaves"));
            }
            if detail.minimum.as_ref().is_none_or(|m| m.null_ratio.is_none()) {
                out.push(note!("compare.missing.null"));
            }
        }
        (None, None, _) if unit.length_s.is_some_and(|t| t >= 2.0 * WINDOW_S) => {
            out.push(note!("compare.missing.windows"));
        }
        (None, None, _) => out.push(note!("compare.missing.short")),
        (None, Some(_), Origin::Result) => out.push(note!("compare.missing.detail")),
        (None, Some(_), Origin::Recording) => out.push(note!("compare.missing.model")),
    }
    if unit.detail.is_some()
        && unit.quantity(measurand::RUSSIAN_ARW_10S.id).is_some_and(|q| q.value.is_none())
    {
        out.push(note!("compare.missing.ten"));
    }
    if drift.is_none() {
        out.push(note!("compare.missing.drift"));
    }
    out
}
