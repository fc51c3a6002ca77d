//! The four steps: is there a mismatch and where, what could it be, which is it and how sure, does the fit improve.

use super::candidates::{Candidate as Fitted, Tried};
use super::coarse;
use super::departures::{self, Departure};
use super::estimates;
use super::finding::{
    Candidate, Explanation, Finding, Fit, FitFigures, NuisanceValue, ParameterValue, PlaceRecord,
    RecordingFacts, Test,
};
use super::heldout::{Halves, HeldOut};
use super::hypothesis::kept;
use super::local;
use super::options::{Options, Progress};
use super::outcome::Outcome;
use super::problem::Problem;
use super::regular::{Irregular, Regular};
use super::samples::{self, Named};
use super::select::{self, Chosen, Selection, Slot};
use crate::claim::{Claim, Stated};
use crate::effect::{Domain, Effect, Model, Nuisance, Place, SpectralLook, Value};
use crate::series::Series;
use crate::text::Note;
use std::collections::BTreeMap;

/// A residual test counts as departed below this, its own scan and the number of tests counted.
const DEPARTED: f64 = 1e-4;

/// Explains a recording against a claim.
///
/// # Errors
/// A note of what keeps the two from being compared.
pub fn explain(
    series: &Series,
    claim: &Claim,
    options: &Options,
    progress: &mut dyn FnMut(Progress),
) -> Result<Outcome, Note> {
    let columns: BTreeMap<_, _> = series
        .columns
        .iter()
        .filter(|(c, _)| !options.hide.contains(c))
        .map(|(c, v)| (*c, v.clone()))
        .collect();
    let regular =
        Regular::new(&series.time_s, &series.rate_deg_h, &columns, claim.sample_rate_hz).map_err(note)?;
    progress(Progress { doing: "explain.progress.locating", done: 0, total: 3 });
    let mut found = Found::default();
    let mut problem = uncoarsened(Problem::new(regular, claim), &mut found, options.alpha);
    let rows = problem.scenes.rows;
    let base = problem.baseline();
    let before = departures::all(&problem.scenes.full, &base.fit, problem.level.as_deref(), &problem.usable);
    let held_base = Halves::new(&problem).judge(&base);
    progress(Progress { doing: "explain.progress.trying", done: 1, total: 3 });
    let mut start = take_bursts(&mut problem, &base, &mut found, options.alpha);
    if problem.level.is_none() {
        let levels = local::level(&problem, &start);
        let passing =
            levels.first().and_then(|l| samples::worth(l.gain, l.parameters, l.p_value, rows, options.alpha));
        if let Some(delta_bic) = passing {
            found.named.extend(samples::level(&levels, delta_bic, rows, &problem));
            found.level = levels.into_iter().next().map(|l| l.profile);
            start = samples::with_free_level(&start, &problem);
        }
    }
    let mut selection = select::select(&start, &problem.scenes, options.alpha, options.max_effects);
    take_telegraph(&mut problem, &start, &mut selection, &mut found, options);
    progress(Progress { doing: "explain.progress.judging", done: 2, total: 3 });
    let level = found.level.clone().or_else(|| problem.level.clone());
    let after = departures::all(&problem.scenes.full, &selection.best.fit, level.as_deref(), &problem.usable);
    Ok(assemble(&problem, claim, &base, &held_base, &selection, found, &before, &after, series, options))
}

/// The problem in averages where its output is rounded too coarsely for single samples. Rounding that the claim does
/// not state is named first: nothing finer can be judged beside it.
fn uncoarsened(problem: Problem, found: &mut Found, alpha: f64) -> Problem {
    let stated = problem.claim.quantization_lsb_arcsec;
    let lsb = if stated > 0.0 { Some(stated) } else { problem.scenes.lattice_arcsec };
    let m = lsb.map_or(1, |lsb| coarse::group(lsb, &problem.claim, problem.residual.len()));
    let Some(lsb) = lsb.filter(|_| m > 1) else { return problem };
    let mut claim = problem.claim.clone();
    if stated <= 0.0 {
        claim.quantization_lsb_arcsec = lsb;
        claim.noise.q = lsb / 12f64.sqrt();
        let with = Problem::new(problem.regular.clone(), &claim).baseline();
        let gain = with.fit.log_likelihood - problem.baseline().fit.log_likelihood;
        match samples::worth(
            gain,
            1,
            crate::estimate::chi_square_tail(2.0 * gain, 1.0),
            problem.scenes.rows,
            alpha,
        ) {
            Some(delta_bic) => found.named.extend(samples::quantization(lsb, gain, delta_bic, &problem)),
            None => return problem,
        }
    }
    claim.sample_rate_hz = problem.claim.sample_rate_hz / m as f64;
    Problem::new(coarse::averaged(&problem.regular, m), &claim)
}

/// What was found in single samples.
#[derive(Default)]
struct Found {
    named: Vec<Named>,
    /// Deviation of the noise of each sample over that of the record.
    level: Option<Vec<f64>>,
    /// What was taken out of the residual, deg/h.
    taken: Option<Vec<f64>>,
}

impl Found {
    fn take(&mut self, course: Vec<f64>) {
        match &mut self.taken {
            Some(sum) => sum.iter_mut().zip(course).for_each(|(s, c)| *s += c),
            None => self.taken = Some(course),
        }
    }

    fn local_gain(&self) -> f64 {
        self.named.iter().map(|n| n.local_gain).sum()
    }
}

/// Sets bursts aside; the claim's fit without them.
fn take_bursts(problem: &mut Problem, base: &Tried, found: &mut Found, alpha: f64) -> Tried {
    let rows = problem.scenes.rows;
    let stated = problem.claim.effects.iter().any(|e| e.effect.kind() == "outlier_bursts");
    let Some(bursts) = local::bursts(problem, base) else { return base.clone() };
    let Some(delta_bic) = samples::worth(bursts.gain, bursts.parameters, bursts.p_value, rows, alpha) else {
        return base.clone();
    };
    let whole = problem.residual.clone();
    problem.without(&bursts.samples, base);
    if !stated {
        let removed: Vec<f64> = whole.iter().zip(&problem.residual).map(|(w, r)| w - r).collect();
        found.named.extend(samples::bursts(&bursts, delta_bic, &removed, problem));
        found.take(removed);
    }
    problem.baseline()
}

/// Takes out jumps between two levels where they explain more than anything else does.
fn take_telegraph(
    problem: &mut Problem,
    start: &Tried,
    selection: &mut Selection,
    found: &mut Found,
    options: &Options,
) {
    let rows = problem.scenes.rows;
    let stated = problem.stated_telegraph();
    if selection.chosen.is_empty() && !stated {
        return;
    }
    let Some(telegraph) = local::telegraph(problem, start) else { return };
    let worth = samples::worth(telegraph.gain, telegraph.parameters, telegraph.p_value, rows, options.alpha);
    let Some(delta_bic) = worth else { return };
    let rival = start.bic(rows) - selection.best.bic(rows);
    if delta_bic < rival && !stated {
        return;
    }
    let course: Vec<f64> = telegraph.path.iter().map(|p| telegraph.amplitude_deg_h * p).collect();
    problem.take(&course);
    let mut base = problem.baseline();
    if start.hypothesis.noise.freed[0] {
        base = samples::with_free_level(&base, problem);
    }
    let near: Vec<&'static str> = selection
        .chosen
        .iter()
        .filter(|_| selection.chosen.len() == 1 && delta_bic < rival + select::ENOUGH)
        .map(|c| c.effect.kind())
        .collect();
    if !stated && let Some(mut named) = samples::telegraph(&telegraph, delta_bic, problem) {
        named.equivalents = near;
        found.named.push(named);
        found.take(course);
    }
    *selection = select::select(&base, &problem.scenes, options.alpha, options.max_effects);
}

fn note(why: Irregular) -> Note {
    match why {
        Irregular::Short(rows) => Note::new("explain.error.short")
            .with("rows", rows as u64)
            .with("needed", super::regular::FEWEST as u64),
        Irregular::OtherRate(observed, claimed) => Note::new("explain.error.other_rate")
            .with("observed", format!("{observed:.6}"))
            .with("claimed", format!("{claimed:.6}")),
        Irregular::Sparse(rows, places) => {
            Note::new("explain.error.sparse").with("rows", rows as u64).with("places", format!("{places:.0}"))
        }
    }
}

#[allow(clippy::too_many_arguments)]
fn assemble(
    problem: &Problem,
    claim: &Claim,
    base: &Tried,
    held_base: &HeldOut,
    selection: &Selection,
    mut found: Found,
    before: &[Departure],
    after: &[Departure],
    series: &Series,
    options: &Options,
) -> Outcome {
    let scenes = &problem.scenes;
    let local_gain = found.local_gain();
    for chosen in &selection.chosen {
        found.named.push(named(chosen, &selection.best, problem));
    }
    found.named.sort_by(|a, b| b.delta_bic.total_cmp(&a.delta_bic));
    let something = !found.named.is_empty();
    let mut findings: Vec<Finding> = found.named.iter().map(finding).collect();
    findings.extend(unknown(after, !something, options.alpha));
    findings.extend(dropped(problem));
    let verdict = if findings.iter().any(|f| f.kind == "unknown") {
        "unknown-mismatch"
    } else if findings.is_empty() {
        "consistent"
    } else {
        "mismatch"
    };
    let mut correction = estimates::correction(&selection.best, scenes);
    if let Some(taken) = &found.taken {
        let sum = correction.get_or_insert_with(|| vec![0.0; taken.len()]);
        sum.iter_mut().zip(taken).for_each(|(s, t)| *s += t);
    }
    let stated = found.named.into_iter().map(|n| Stated { effect: n.effect, values: n.estimated.stated });
    let augmented = augmented(problem, claim, &selection.best, stated.collect());
    let halves = Halves::new(problem);
    let held_best = if something { halves.judge(&selection.best) } else { *held_base };
    let family = smallest_p(&selection.first, before);
    let figures_after = FitFigures {
        log_likelihood: selection.best.fit.log_likelihood + local_gain,
        heldout_log_likelihood: held_best.log_likelihood + 0.5 * local_gain,
        heldout_rms_deg_h: held_best.rms_deg_h,
        bic: selection.best.bic(scenes.rows) - 2.0 * local_gain,
    };
    let baseline = figures(base, held_base, scenes.rows);
    let explanation = Explanation {
        format: "explain/1".to_owned(),
        case: problem.claim.case.clone(),
        verdict: verdict.to_owned(),
        effects: findings,
        fit: Fit {
            heldout_tau_s: halves.bin_s(),
            augmented: if something { figures_after } else { baseline.clone() },
            baseline,
        },
        family_p_value: family,
        family_p_value_after: if something { departures::family(after) } else { family },
        alpha: options.alpha,
        candidates: selection.first.iter().map(candidate).collect(),
        tests: tests(before, after),
        nuisances: nuisances(problem, base, &selection.best),
        recording: facts(problem, series, options),
        experiments: vec![],
    };
    let correction = correction.map(|c| {
        let on_rows = c.iter().zip(&problem.regular.present).enumerate().filter(|(_, (_, p))| **p);
        on_rows.map(|(i, (v, _))| (problem.drivers.time_s(i), *v)).collect()
    });
    Outcome { explanation, correction, augmented, figures: vec![] }
}

/// A chosen effect with its parameters and places.
fn named(chosen: &Chosen, best: &Tried, problem: &Problem) -> Named {
    let mut estimated = estimates::of(chosen.effect, chosen.slot, best, &problem.scenes);
    if chosen.effect.kind() == "unobserved_driver"
        && let Slot::Spectrum(i) = chosen.slot
    {
        estimated.stated = super::driver::knots(best, i, problem);
    }
    Named {
        effect: chosen.effect,
        estimated,
        equivalents: chosen.equivalents.iter().map(|e| e.kind()).collect(),
        places: places(chosen.effect, chosen.slot, best, chosen, problem),
        delta_bic: chosen.delta_bic,
        p_value: chosen.p_value,
        local_gain: 0.0,
    }
}

fn smallest_p(first: &[Fitted], before: &[Departure]) -> f64 {
    let named = first.iter().map(|c| c.p_value).fold(1.0, f64::min) * first.len().max(1) as f64;
    (2.0 * named.min(departures::family(before))).min(1.0)
}

fn figures(tried: &Tried, held: &HeldOut, rows: usize) -> FitFigures {
    FitFigures {
        log_likelihood: tried.fit.log_likelihood,
        heldout_log_likelihood: held.log_likelihood,
        heldout_rms_deg_h: held.rms_deg_h,
        bic: tried.bic(rows),
    }
}

fn candidate(fitted: &Fitted) -> Candidate {
    Candidate {
        kind: fitted.effect.kind().to_owned(),
        delta_bic: fitted.delta_bic,
        log_likelihood_gain: fitted.gain,
        p_value: fitted.p_value,
    }
}

fn record(place: &Place) -> PlaceRecord {
    PlaceRecord { domain: place.domain.id().to_owned(), from: place.from, to: place.to }
}

fn finding(named: &Named) -> Finding {
    Finding {
        kind: named.effect.kind().to_owned(),
        equivalents: named.equivalents.iter().map(|e| (*e).to_owned()).collect(),
        parameters: named.estimated.reported.clone(),
        places: named.places.iter().map(record).take(3).collect(),
        delta_bic: named.delta_bic,
        p_value: named.p_value,
        heldout_gain: None,
        removed_share: None,
    }
}

fn places(
    effect: &'static dyn Effect,
    slot: Slot,
    best: &Tried,
    chosen: &Chosen,
    problem: &Problem,
) -> Vec<Place> {
    match (effect.model(), slot) {
        (Model::Course(course), Slot::Course(i)) => {
            let scene = problem.scenes.of(course.pace());
            let inside = &best.hypothesis.courses[i];
            course.places(&inside.shape, &inside.coefficients, &scene.drivers)
        }
        (Model::Spectrum(spectrum), Slot::Spectrum(i)) => {
            let scene = &problem.scenes.full;
            let observed = scene.observed(&best.fit.mean.residual);
            let look = SpectralLook {
                bins: &scene.bins,
                observed: &observed,
                expected: &chosen.without.fit.densities,
                lattice_arcsec: problem.scenes.lattice_arcsec,
            };
            spectrum.places(&best.hypothesis.noise.spectra[i].fitted, &look)
        }
        _ => vec![],
    }
}

/// What departs from the hypothesis and has no name.
fn unknown(after: &[Departure], nothing_found: bool, alpha: f64) -> Option<Finding> {
    let tests = after.len().max(1) as f64;
    let bound = if nothing_found { (0.3 * alpha).min(1e-3) } else { DEPARTED };
    let mut departed: Vec<&Departure> = after.iter().filter(|d| d.p_value * tests < bound).collect();
    departed.sort_by(|a, b| a.p_value.total_cmp(&b.p_value));
    let worst = departed.first()?;
    let mut places: Vec<PlaceRecord> = vec![];
    for d in &departed {
        let place = record(&d.place);
        if !places.iter().any(|p| p.domain == place.domain) {
            places.push(place);
        }
    }
    places.truncate(3);
    let p_value = (worst.p_value * tests).min(1.0);
    Some(Finding {
        kind: "unknown".to_owned(),
        equivalents: vec![],
        parameters: BTreeMap::new(),
        places,
        delta_bic: -2.0 * p_value.max(1e-300).ln(),
        p_value,
        heldout_gain: None,
        removed_share: None,
    })
}

/// Rows missing on the grid that the claim states.
fn dropped(problem: &Problem) -> Option<Finding> {
    let missing = problem.regular.missing();
    if missing == 0 || problem.claim.effects.iter().any(|e| e.effect.kind() == "dropped_samples") {
        return None;
    }
    let (first, last) = (problem.regular.gaps.first()?, problem.regular.gaps.last()?);
    let at = |i: usize| problem.drivers.time_s(i);
    let place = PlaceRecord {
        domain: Domain::Timestamps.id().to_owned(),
        from: at(first.0.saturating_sub(1)),
        to: at(last.0 + last.1),
    };
    let count = missing as f64;
    let value = ParameterValue { value: count, unit: String::new(), ci95: [count, count] };
    Some(Finding {
        kind: "dropped_samples".to_owned(),
        equivalents: vec![],
        parameters: BTreeMap::from([("missing_rows".to_owned(), value)]),
        places: vec![place],
        delta_bic: count * (problem.scenes.rows as f64).ln(),
        p_value: 1e-300,
        heldout_gain: None,
        removed_share: None,
    })
}

fn tests(before: &[Departure], after: &[Departure]) -> Vec<Test> {
    let (many, left) = (before.len().max(1) as f64, after.len().max(1) as f64);
    let one = |(i, b): (usize, &Departure)| {
        let a = after.get(i).filter(|a| a.test == b.test);
        Test {
            id: b.test.to_owned(),
            domain: b.place.domain.id().to_owned(),
            from: b.place.from,
            to: b.place.to,
            p_before: (b.p_value * many).min(1.0),
            p_after: a.map_or(1.0, |a| (a.p_value * left).min(1.0)),
        }
    };
    before.iter().enumerate().map(one).collect()
}

/// The value of a nuisance column in a fit; 0 where its prior was given up.
fn nuisance_value(problem: &Problem, tried: &Tried, nuisance: Nuisance) -> f64 {
    let kept = kept(&problem.scenes.full, &tried.hypothesis.courses);
    let at = kept.iter().position(|n| n.nuisance == nuisance);
    at.and_then(|i| tried.fit.mean.coefficients.get(i)).copied().unwrap_or(0.0)
}

fn nuisances(problem: &Problem, base: &Tried, best: &Tried) -> Vec<NuisanceValue> {
    let (claim, u) = (&problem.claim, &problem.claim.uncertainty);
    let mut out = vec![];
    let names = [("N_deg_rt_h", "deg/√h"), ("B_deg_h", "deg/h"), ("K_deg_h_rt_h", "deg/h/√h")];
    let claimed = base.hypothesis.noise.claimed;
    for (i, (name, unit)) in names.into_iter().enumerate() {
        let deviation = base.hypothesis.noise.deviation[i];
        if claimed[i] > 0.0 && deviation > 0.0 {
            out.push(NuisanceValue {
                name: name.to_owned(),
                unit: unit.to_owned(),
                claimed: claimed[i],
                uncertainty: deviation * claimed[i],
                baseline: base.hypothesis.noise.base[i],
                augmented: best.hypothesis.noise.base[i],
            });
        }
    }
    if let Some(t) = claim.mean.temperature
        && u.temperature_coefficient_deg_h_per_degc > 0.0
    {
        let value = |tried| {
            t.coefficient_deg_h_per_degc + nuisance_value(problem, tried, Nuisance::TemperatureCoefficient)
        };
        out.push(NuisanceValue {
            name: "coefficient_deg_h_per_degC".to_owned(),
            unit: "deg/h/°C".to_owned(),
            claimed: t.coefficient_deg_h_per_degc,
            uncertainty: u.temperature_coefficient_deg_h_per_degc,
            baseline: value(base),
            augmented: value(best),
        });
    }
    if let Some(ppm) = claim.mean.scale_factor_ppm
        && u.scale_factor_ppm > 0.0
    {
        let value = |tried| ppm + nuisance_value(problem, tried, Nuisance::ScaleFactor);
        out.push(NuisanceValue {
            name: "error_ppm".to_owned(),
            unit: "ppm".to_owned(),
            claimed: ppm,
            uncertainty: u.scale_factor_ppm,
            baseline: value(base),
            augmented: value(best),
        });
    }
    out
}

/// The claim with its nuisances as fitted and the effects stated. A coefficient that an effect sets free stays as
/// claimed: the effect states it.
fn augmented(problem: &Problem, given: &Claim, best: &Tried, mut stated: Vec<Stated>) -> Claim {
    let mut claim = Claim {
        sample_rate_hz: given.sample_rate_hz,
        quantization_lsb_arcsec: given.quantization_lsb_arcsec,
        ..problem.claim.clone()
    };
    claim.noise.q = given.noise.q;
    let noise = &best.hypothesis.noise;
    for (i, slot) in [&mut claim.noise.n, &mut claim.noise.b, &mut claim.noise.k].into_iter().enumerate() {
        if !noise.freed[i] {
            *slot = noise.base[i];
        }
    }
    let observed = &problem.residual;
    let coefficient = nuisance_value(problem, best, Nuisance::TemperatureCoefficient);
    if let Some(t) = &mut claim.mean.temperature {
        t.coefficient_deg_h_per_degc += coefficient;
    }
    if let Some(ppm) = &mut claim.mean.scale_factor_ppm {
        *ppm += nuisance_value(problem, best, Nuisance::ScaleFactor);
    }
    // The bias is what is left of the mean.
    let correction = estimates::correction(best, &problem.scenes);
    let n = observed.len().max(1) as f64;
    let added = correction.map_or(0.0, |c| c.iter().sum::<f64>() / n);
    claim.mean.bias_deg_h = observed.iter().sum::<f64>() / n - added;
    claim.effects.append(&mut stated);
    if problem.regular.missing() > 0
        && !claim.effects.iter().any(|e| e.effect.kind() == "dropped_samples")
        && let Some(effect) = crate::effect::find("dropped_samples")
    {
        let missing = Value::Number(problem.regular.missing() as f64);
        claim.effects.push(Stated { effect, values: BTreeMap::from([("missing_rows".to_owned(), missing)]) });
    }
    claim
}

fn facts(problem: &Problem, series: &Series, options: &Options) -> RecordingFacts {
    let length = series.time_s.last().copied().unwrap_or(0.0) - series.time_s.first().copied().unwrap_or(0.0);
    RecordingFacts {
        rows: series.time_s.len(),
        missing: problem.regular.missing(),
        sample_interval_s: problem.regular.dt_s,
        length_s: length,
        columns: problem.regular.columns.keys().map(|c| c.name().to_owned()).collect(),
        hidden: options.hide.iter().map(|c| c.name().to_owned()).collect(),
    }
}
