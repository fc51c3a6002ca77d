//! The size of each kind of effect that would have been noticed with a probability of 95 %: what "consistent",
//! or "nothing else", is worth.
//!
//! | file | what it has |
//! |---|---|
//! | `gate` | what an effect must pass, and how far beyond it an effect must be to pass nearly always |
//! | `solve` | the size at which a quantity reaches a value |
//! | `null_model` | the hypothesis before which an effect would have to show, and the gain expected of a course |
//! | `draws` | spectra drawn from an expected one |
//! | `places` | the typical and the worst place of a searched effect |
//! | `course`, `spectrum`, `level`, `values` | effects on the mean, on the spectrum, on the level of the noise; rounding |

mod course;
mod draws;
mod gate;
mod level;
mod null_model;
mod places;
mod solve;
mod spectrum;
mod values;

#[cfg(test)]
mod tests;

use super::effective_tests;
use super::noticeable_record::{Basis, NotComputed, NoticeableSize, WhyNot};
use super::options::Options;
use super::problem::Problem;
use super::select::Selection;
use crate::effect::{Detector, Domain, EFFECTS, Effect, Model, Resolution};
use crate::numeric::parallel;
use gate::Gate;
use null_model::NullModel;
use spectrum::Expected;
use std::collections::BTreeMap;

/// Sizes of every kind that the recording can show, those that follow a recorded column first, and the kinds for which
/// there is none.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Noticeable {
    /// Sizes.
    pub sizes: Vec<NoticeableSize>,
    /// Kinds without one, and why.
    pub not_computed: Vec<NotComputed>,
}

/// The null hypothesis that each kind is compared with, at both resolutions.
struct NullModels<'a> {
    problem: &'a Problem,
    gate: Gate,
    averaged: NullModel<'a>,
    full: NullModel<'a>,
    expected: Expected<'a>,
}

/// Under what was selected; `found` are the kinds that are in it.
pub(super) fn sizes(
    problem: &Problem,
    selection: &Selection,
    found: &[&'static str],
    options: &Options,
) -> Noticeable {
    let (best, spectra) = (&selection.best, &problem.spectra);
    let usable = problem.usable.iter().filter(|u| **u).count();
    let share = usable as f64 / problem.usable.len().max(1) as f64;
    let full = NullModel::new(best, spectra, Resolution::FullRate, share);
    let null_models = NullModels {
        problem,
        gate: Gate { family: effective_tests::of_record(&spectra.full.drivers), alpha: options.alpha },
        averaged: NullModel::new(best, spectra, Resolution::Averaged, share),
        expected: Expected::new(best, spectra, &full),
        full,
    };
    let asked = |e: &&&'static dyn Effect| {
        e.in_format() && options.allows(e.kind()) && !found.contains(&e.kind()) && shown(**e, problem)
    };
    let effects: Vec<&&'static dyn Effect> = EFFECTS.iter().filter(asked).collect();
    let told: Vec<_> = parallel::map_items(&effects, |e| (**e, of(**e, &null_models)));
    let mut out = Noticeable::default();
    let mut ranked = vec![];
    for (effect, sizes) in told {
        match sizes {
            Ok(sizes) => ranked.extend(sizes.into_iter().map(|s| (rank(effect, &s), s))),
            Err(reason) => out.not_computed.push(NotComputed { kind: effect.kind().to_owned(), reason }),
        }
    }
    ranked.sort_by_key(|(rank, _)| *rank);
    out.sizes = ranked.into_iter().map(|(_, size)| size).collect();
    out
}

/// True where the recording has the columns that an effect needs.
fn shown(effect: &dyn Effect, problem: &Problem) -> bool {
    let drivers = &problem.drivers;
    let driven = effect.domain() != Domain::Driver || !drivers.others.is_empty();
    let there = effect.needs().iter().all(|c| drivers.column(*c).is_some());
    driven && there && !matches!(effect.model(), Model::Mean(m) if !m.applies(drivers))
}

fn of(effect: &'static dyn Effect, null_models: &NullModels<'_>) -> Result<Vec<NoticeableSize>, WhyNot> {
    let gate = &null_models.gate;
    match effect.model() {
        Model::Mean(model) => {
            let averaged = model.resolution() == Resolution::Averaged;
            let null_model = if averaged { &null_models.averaged } else { &null_models.full };
            course::sizes(effect, model, null_model, gate)
        }
        Model::Spectrum(model) => {
            let by_spectrum = spectrum::size(effect, model, &null_models.expected, gate)?;
            let by_values = effect
                .rounding()
                .and_then(|_| values::size(effect, null_models.problem, &null_models.expected, &by_spectrum));
            Ok(vec![by_values.unwrap_or(by_spectrum)])
        }
        Model::Samples(_) => match effect.detector() {
            Some(Detector::Level(detector)) => {
                level::size(effect, detector, null_models.problem.spectra.rows, gate).map(|size| vec![size])
            }
            Some(Detector::Missing(_)) => missing(effect).map(|size| vec![size]),
            _ => Err(WhyNot::SingleSamples),
        },
    }
}

/// A single row that is missing inside the record is reported.
fn missing(effect: &'static dyn Effect) -> Result<NoticeableSize, WhyNot> {
    let parameter = effect.params().first().ok_or(WhyNot::NoSingleSize)?;
    Ok(NoticeableSize {
        kind: effect.kind().to_owned(),
        column: None,
        parameter: parameter.name.to_owned(),
        unit: parameter.unit.to_owned(),
        size: 1.0,
        claimed: None,
        below: false,
        rms_deg_h: None,
        at: BTreeMap::new(),
        worst: None,
        basis: Basis::Timestamps,
    })
}

/// Order of reports: effects that follow a recorded column first, then courses in time, then the noise.
fn rank(effect: &dyn Effect, size: &NoticeableSize) -> u8 {
    match size.basis {
        Basis::Course if size.column.is_some() || !effect.needs().is_empty() => 0,
        Basis::Course => 1,
        Basis::Spectrum | Basis::Values => 2,
        Basis::Level | Basis::Timestamps => 3,
    }
}
