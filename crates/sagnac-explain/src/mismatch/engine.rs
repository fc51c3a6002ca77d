//! The four steps: is there a mismatch and where, what could it be, which is it and how sure, does the fit improve.

use super::assemble::{Evidence, Recorded, assemble};
use super::candidates;
use super::coarse;
use super::filtered;
use super::fitted_hypothesis::{FittedHypothesis, SpectralDataSet};
use super::heldout::Halves;
use super::jumps::{take_jumps, with_stated_jumps};
use super::named::{NamedEffect, SampleFindings, significant_delta_bic};
use super::options::{Options, Progress};
use super::outcome::Outcome;
use super::problem::{Problem, drivers};
use super::quantization_grid::QuantizationGrid;
use super::regular::{Irregular, Regular};
use super::samples;
use super::select;
use crate::claim::Claim;
use crate::effect::{Column, Detection, Domain, EFFECTS, Effect, Model, Rounding};
use crate::message::{Note, note};
use crate::series::Series;
use std::collections::BTreeMap;

/// Rounds of setting samples aside that a course bends within, of drawing what is not there, and of finding the course again.
const MAX_ROUNDS: usize = 3;

/// Rounds where a corner is set aside, of which the draws hold a good part of what tells of it: each halves about what they hold wrong.
const MAX_BEND_ROUNDS: usize = 12;

/// Explains a recording against a claim.
///
/// # Errors
/// A note of what keeps the two from being compared.
pub fn explain(
    series: Series,
    claim: &Claim,
    options: &Options,
    progress: &mut dyn FnMut(Progress),
) -> Result<Outcome, Note> {
    let length_s =
        series.time_s.last().copied().unwrap_or(0.0) - series.time_s.first().copied().unwrap_or(0.0);
    let recorded = Recorded { rows: series.time_s.len(), length_s, read_from: series.read_from.clone() };
    let mut regular = on_grid(series, claim, options)?;
    progress(Progress { doing: "explain.progress.locating", done: 0, total: 3 });
    let mut found = SampleFindings::default();
    let invalid = samples::take_invalid(&mut regular, claim, &mut found, options);
    let mut problem = uncoarsened(&regular, claim, &mut found, options);
    // The grid and what is left of the claim are all that is needed from here on, and a long record is large.
    drop(regular);
    let mut base = with_stated_jumps(&mut problem, options.alpha);
    let mut before = problem.departures(&base, problem.level.as_deref());
    before.extend(invalid);
    progress(Progress { doing: "explain.progress.trying", done: 1, total: 3 });
    // What the table does at low frequencies looks like a filter of the noise while no course says so.
    let mut moved = with_table_courses(&base, &problem.spectra, options);
    for round in 1..=MAX_BEND_ROUNDS {
        // The draws for them follow the course as it was found with them, so it is found again.
        let bent = problem.without_bends(&moved);
        if !problem.reimpute_until_stable(&moved) && !bent {
            break;
        }
        base = problem.refitted(&base);
        let again = with_table_courses(&base, &problem.spectra, options);
        let settled =
            if problem.has_round_corner() { same_shapes(&moved, &again) } else { round >= MAX_ROUNDS };
        moved = again;
        if settled {
            break;
        }
    }
    let mut held_base = Halves::new(&problem).judge(&base);
    let filtered = filtered::behind(&problem, &moved, options);
    let filtered = filtered.filter(|f| problem.impute_edges(f, f)).map(|f| problem.refitted(&f));
    if let Some(filtered) = filtered {
        base = problem.refitted(&base);
        held_base = Halves::new(&problem).judge(&base);
        moved = with_table_courses(&filtered, &problem.spectra, options);
    }
    let mut start = samples::take_outliers(&mut problem, &base, &moved, &mut found, options);
    if problem.level.is_none() {
        let moved = moved_again(&moved, &start, &problem);
        start = samples::take_level(&problem, start, &moved, &mut found, options);
    }
    let mut selection = select::select(&start, &problem, options);
    // The ends for the filters that were selected, then missing rows about the courses: each asks for the selection anew.
    let mut ends_drawn = problem.impute_edges(&selection.best, &selection.best);
    for _ in 0..=MAX_ROUNDS {
        if !std::mem::take(&mut ends_drawn) && !problem.reimpute_until_stable(&selection.best) {
            break;
        }
        base = problem.refitted(&base);
        held_base = Halves::new(&problem).judge(&base);
        start = problem.refitted(&start);
        selection = select::select(&start, &problem, options);
    }
    take_jumps(&mut problem, &start, &mut selection, &mut found, options);
    progress(Progress { doing: "explain.progress.judging", done: 2, total: 3 });
    let level = found.level.clone().or_else(|| problem.level.clone());
    let after = problem.departures(&selection.best, level.as_deref());
    Ok(assemble(Evidence {
        problem: &problem,
        claim,
        base: &base,
        held_base,
        selection: &selection,
        found,
        before: &before,
        after: &after,
        recorded,
        options,
    }))
}

/// The rows on the grid of the claim, columns that are treated as not recorded left out.
pub(super) fn on_grid(series: Series, claim: &Claim, options: &Options) -> Result<Regular, Note> {
    let columns: BTreeMap<_, _> = series
        .columns
        .iter()
        .filter(|(c, _)| !options.hide.contains(c))
        .map(|(c, v)| (*c, v.as_slice()))
        .collect();
    Regular::new(&series.time_s, &series.rate_deg_h, &columns, claim.sample_rate_hz).map_err(note)
}

/// The problem in averages where its output is rounded too coarsely for single samples. Rounding that the claim does
/// not state is named first: nothing finer can be judged beside it.
pub(super) fn uncoarsened(
    regular: &Regular,
    claim: &Claim,
    found: &mut SampleFindings,
    options: &Options,
) -> Problem {
    let problem = Problem::new(regular, claim);
    let as_effect = claim.effects.iter().filter_map(|e| e.effect.rounding()?.step_arcsec(&e.values));
    let as_effect = as_effect.fold(0.0, f64::max);
    let stated = claim.quantization_lsb_arcsec.max(as_effect);
    let quantization_grid = problem.quantization_grid.filter(|_| rounding(options).is_some());
    let lsb = if stated > 0.0 { Some(stated) } else { quantization_grid.map(|l| l.increment_arcsec) };
    let m = lsb.map_or(1, |lsb| coarse::group(lsb, &problem.claim, problem.residual.len()));
    let mut claim = claim.clone();
    let unlike = quantization_grid.filter(|l| (l.increment_arcsec - stated).abs() > 0.01 * stated);
    if let Some(quantization_grid) = unlike.filter(|_| m == 1 || stated <= 0.0) {
        claim.quantization_lsb_arcsec = quantization_grid.increment_arcsec;
        claim.noise.q = quantization_grid.increment_arcsec / 12f64.sqrt();
        let with = Problem::new(regular, &claim);
        match as_rounded(quantization_grid, &problem, &with, m > 1, options) {
            Some(named) => found.named.push(named),
            None => return problem,
        }
        if m == 1 {
            return with;
        }
    }
    if m == 1 {
        return problem;
    }
    claim.sample_rate_hz = problem.claim.sample_rate_hz / m as f64;
    let expected = |r: &Regular| drivers(r, &claim).claimed_mean();
    Problem::new(&coarse::about_the_claim(regular, m, expected), &claim)
}

/// Rounding that the claim does not state, as a finding. In a record that `needs` it known before anything else the
/// spectrum decides; elsewhere the spectrum will have its say among the other effects, and the values decide where it would
/// say too little. `with` is the problem with the rounding in the claim.
fn as_rounded(
    quantization_grid: QuantizationGrid,
    problem: &Problem,
    with: &Problem,
    needed: bool,
    options: &Options,
) -> Option<NamedEffect> {
    let rows = problem.spectra.rows;
    let gain = with.baseline().fit.log_likelihood - problem.baseline().fit.log_likelihood;
    let chance = |gain: f64| crate::estimate::chi_square_tail(2.0 * gain.max(0.0), 1.0);
    let justified = |total: f64| significant_delta_bic(total, 1, chance(total), rows, options.alpha);
    let by_spectrum = justified(gain);
    let (effect, rounding) = rounding(options)?;
    let QuantizationGrid { increment_arcsec, open_arcsec, .. } = quantization_grid;
    let dt_s = problem.grid.dt_s;
    let named = |delta_bic: f64, p_value: f64| {
        let detection = rounding.detection(increment_arcsec, open_arcsec, dt_s);
        NamedEffect::detected(effect, &Detection { gain, p_value, ..detection }, delta_bic)
    };
    if needed {
        return by_spectrum.map(|delta_bic| named(delta_bic, chance(gain)));
    }
    let by_values = gain + quantization_grid.gain(rows, 60.0 * problem.claim.noise.n * dt_s.sqrt());
    if by_spectrum.is_some() || gain <= 0.0 {
        return None;
    }
    justified(by_values).map(|delta_bic| named(delta_bic, chance(by_values)))
}

/// The effect that rounds the output, where it is considered.
fn rounding(options: &Options) -> Option<(&'static dyn Effect, &'static dyn Rounding)> {
    let mut all = EFFECTS.iter().filter_map(|e| Some((*e, e.rounding()?)));
    all.find(|(e, _)| options.allows(e.kind()))
}

/// The hypothesis that single samples are compared with: the claim with the courses of a moving table that it leaves out. Their corners,
/// as of a delay, look like bursts and like a changing level; a smooth course does not.
fn with_table_courses(
    base: &FittedHypothesis,
    spectra: &SpectralDataSet,
    options: &Options,
) -> FittedHypothesis {
    const MAX_COURSES: usize = 2;
    let table = [Column::TableRate, Column::TableAngle, Column::OuterRate];
    // A delay of the claimed mean needs no column of its own, but moves only with the table.
    let delays = |e: &dyn Effect| e.needs().is_empty() && e.domain() == Domain::Lag;
    let follows = |e: &dyn Effect| {
        options.allows(e.kind()) && (e.needs().iter().any(|c| table.contains(c)) || delays(e))
    };
    let drivers = &spectra.full.drivers;
    let applies = |e: &dyn Effect| {
        let there = e.needs().iter().all(|c| drivers.column(*c).is_some());
        follows(e) && there && matches!(e.model(), Model::Mean(c) if c.applies(drivers))
    };
    if !EFFECTS.iter().any(|e| applies(*e)) {
        return base.clone();
    }
    let mut out = base.clone();
    for _ in 0..MAX_COURSES {
        let candidates = candidates::among(&out, spectra, applies);
        match candidates.into_iter().next() {
            Some(leader) if select::passes(&leader, drivers, options.alpha) => out = leader.tried,
            _ => break,
        }
    }
    out
}

/// True for courses whose shapes are the same but for next to nothing.
fn same_shapes(one: &FittedHypothesis, other: &FittedHypothesis) -> bool {
    const MAX_CHANGE: f64 = 1e-7;
    let shapes = |t: &FittedHypothesis| -> Vec<f64> {
        t.hypothesis.courses.iter().flat_map(|c| c.nonlinear_parameters.clone()).collect()
    };
    let (one, other) = (shapes(one), shapes(other));
    let near = |(a, b): (&f64, &f64)| (a - b).abs() <= MAX_CHANGE * a.abs().max(b.abs());
    one.len() == other.len() && one.iter().zip(&other).all(near)
}

/// The same on a problem from which something was taken since.
fn moved_again(moved: &FittedHypothesis, start: &FittedHypothesis, problem: &Problem) -> FittedHypothesis {
    let filters = |t: &FittedHypothesis| t.hypothesis.noise.filters().count();
    if moved.hypothesis.courses.is_empty() && filters(moved) == filters(start) {
        return start.clone();
    }
    problem.refitted(moved)
}

fn note(why: Irregular) -> Note {
    match why {
        Irregular::Short(rows) => {
            note!("explain.error.short", rows = rows as u64, needed = super::regular::MIN_ROWS as u64)
        }
        Irregular::OtherRate(observed, claimed) => note!(
            "explain.error.other_rate",
            observed = format!("{observed:.6}"),
            claimed = format!("{claimed:.6}")
        ),
        Irregular::Sparse(rows, places) => {
            note!("explain.error.sparse", rows = rows as u64, places = format!("{places:.0}"))
        }
    }
}
