//! Explanations of a recording as good as the chosen effects, each with its parameters.

use super::contribution::drawn_course;
use super::estimates;
use super::finding::Finding;
use super::fitted_hypothesis::{Candidate, FittedHypothesis};
use super::problem::Problem;
use super::select::{Chosen, Selection, Slot};
use crate::claim::Stated;
use crate::effect::{Effect, Model, stateable};

/// One explanation of a recording.
#[derive(Clone)]
pub struct Alternative {
    /// The cause that it explains, by its place among the effects of the explanation, counted from 1.
    pub cause: usize,
    /// True for the effect that was chosen; false for one that the recording cannot tell from it.
    pub chosen: bool,
    /// Its effects: first the one that is in question, then those of the other causes.
    pub effects: Vec<Stated>,
}

/// The alternatives of each cause that has equivalents, the chosen one first.
pub(super) fn all(selection: &Selection, findings: &[Finding], problem: &Problem) -> Vec<Alternative> {
    let own: Vec<Stated> = selection.chosen.iter().map(|c| chosen(c, &selection.best, problem)).collect();
    let mut out = vec![];
    for (i, one) in selection.chosen.iter().enumerate() {
        let kind = own.get(i).map_or("", |s| s.effect.kind());
        let place = findings.iter().position(|f| f.effect_id() == kind);
        let (Some(place), Some(first)) = (place, own.get(i)) else { continue };
        if one.equivalents.is_empty() {
            continue;
        }
        let others = own.iter().enumerate().filter(|(j, _)| *j != i).map(|(_, s)| s.clone());
        let others: Vec<Stated> = others.collect();
        let rivals = one.equivalents.iter().map(|rival| candidate(rival, problem));
        for (n, stated) in std::iter::once(first.clone()).chain(rivals).enumerate() {
            let effects = std::iter::once(stated).chain(others.iter().cloned()).collect();
            out.push(Alternative { cause: place + 1, chosen: n == 0, effects });
        }
    }
    out
}

/// The chosen effect; of a response that is described by terms, the law that gives it its name.
fn chosen(one: &Chosen, best: &FittedHypothesis, problem: &Problem) -> Stated {
    match &one.law {
        Some(law) => candidate(law, problem),
        None => stated(one.effect, one.slot, best, problem),
    }
}

/// An effect that was fitted as the last of its hypothesis.
fn candidate(fitted: &Candidate, problem: &Problem) -> Stated {
    let hypothesis = &fitted.tried.hypothesis;
    let slot = match fitted.effect.model() {
        Model::Spectrum(_) => Slot::Spectrum(hypothesis.noise.spectra.len().saturating_sub(1)),
        _ => Slot::Mean(hypothesis.courses.len().saturating_sub(1)),
    };
    stated(fitted.effect, slot, &fitted.tried, problem)
}

fn stated(effect: &'static dyn Effect, slot: Slot, tried: &FittedHypothesis, problem: &Problem) -> Stated {
    let mut values = estimates::of(effect, slot, tried, &problem.spectra).stated;
    if let (Some(by_course), Slot::Spectrum(i)) = (effect.claimed_by_course(), slot) {
        values = by_course.values(&drawn_course(tried, i, problem));
    }
    Stated { effect, values: stateable(effect, values) }
}
