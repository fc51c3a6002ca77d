//! Jumps between two levels, weighed against what else was chosen.

use super::found::Found;
use super::local;
use super::options::Options;
use super::problem::Problem;
use super::samples;
use super::select::{self, Selection, Slot};
use super::terms::SpectrumIn;
use super::tried::Tried;

/// Samples at a level below which jumps are not told from a process.
const FEWEST_AT_A_LEVEL: f64 = 6.0;

/// Jumps between two levels on one of the hypotheses that they may stand beside.
struct Jumps {
    telegraph: local::Telegraph,
    delta_bic: f64,
    /// True when nothing else explains nearly as much.
    told: bool,
    /// What the selection gains on the same hypothesis.
    rival: f64,
    /// The process that the selection has in their place.
    instead: Option<&'static str>,
}

/// The best of jumps on the claim alone, and beside what else was chosen in place of each of its processes: they have the
/// spectrum of a slow process, and with another effect in the record neither the one nor the other alone comes near a pair.
fn jumps(problem: &Problem, start: &Tried, selection: &Selection, alpha: f64) -> Option<Jumps> {
    let rows = problem.spectra.rows;
    let several = selection.chosen.len() > 1;
    let processes = selection.chosen.iter().filter(|c| several && matches!(c.slot, Slot::Spectrum(_)));
    let single = selection.chosen.iter().find(|_| !several).map(|c| c.effect.kind());
    let grounds =
        std::iter::once((start, single)).chain(processes.map(|c| (&c.without, Some(c.effect.kind()))));
    let judged = grounds.filter_map(|(tried, instead)| {
        let telegraph = local::telegraph(problem, tried)?;
        // Jumps every few samples are what a short Markov process looks like, even ones a periodic course.
        if telegraph.mean_dwell_s < FEWEST_AT_A_LEVEL * problem.drivers.dt_s || telegraph.regular {
            return None;
        }
        let (gain, parameters) = (telegraph.gain, telegraph.parameters);
        let delta_bic = samples::worth(gain, parameters, telegraph.chance, rows, alpha)?;
        let told = samples::worth(gain, parameters, telegraph.p_value, rows, alpha).is_some();
        let rival = tried.bic(rows) - selection.best.bic(rows);
        Some(Jumps { telegraph, delta_bic, told, rival, instead })
    });
    judged.max_by(|a, b| (a.delta_bic - a.rival).total_cmp(&(b.delta_bic - b.rival)))
}

/// The claim's own fit where it states jumps between two levels: they are taken out where they are found as they are
/// stated, and stand as the Markov process that has their spectrum where they cannot be told one by one.
pub(super) fn with_stated_jumps(problem: &mut Problem, alpha: f64) -> Tried {
    const AS_STATED: f64 = 2.0;
    let base = problem.baseline();
    let Some((amplitude, dwell_s)) = problem.stated_telegraph() else { return base };
    let alone = Selection { best: base.clone(), chosen: vec![], first: vec![] };
    if let Some(Jumps { telegraph, .. }) = jumps(problem, &base, &alone, alpha).filter(|j| j.told) {
        let [low, high] = telegraph.amplitude_ci95;
        if (telegraph.amplitude_deg_h - amplitude).abs() < 0.5 * AS_STATED * (high - low) {
            problem.take(&telegraph.course);
            return problem.baseline();
        }
    }
    let markov = crate::effect::find("markov_long");
    let same = markov.map(|effect| SpectrumIn {
        effect,
        fitted: vec![0.5 * dwell_s, 0.5 * amplitude],
        stated: true,
    });
    problem.baseline_with(same)
}

/// Takes out jumps between two levels where they explain more than anything else does; where they explain about as much,
/// they are an equivalent.
pub(super) fn take_telegraph(
    problem: &mut Problem,
    start: &Tried,
    selection: &mut Selection,
    found: &mut Found,
    options: &Options,
) {
    let stated = problem.claim.effects.iter().any(|e| e.effect.kind() == "random_telegraph");
    if stated || selection.chosen.is_empty() || !options.allows("random_telegraph") {
        return;
    }
    let Some(Jumps { telegraph, delta_bic, told, rival, instead }) =
        jumps(problem, start, selection, options.alpha)
    else {
        return;
    };
    if !told || delta_bic < rival {
        if delta_bic > rival - select::ENOUGH {
            let replaced = selection.chosen.iter_mut().find(|c| Some(c.effect.kind()) == instead);
            replaced.into_iter().for_each(|c| c.beside = Some("random_telegraph"));
        }
        return;
    }
    problem.take(&telegraph.course);
    let mut base = problem.baseline();
    if start.hypothesis.noise.freed[0] {
        base = samples::with_free_level(&base, problem);
    }
    if let Some(mut named) = samples::telegraph(&telegraph, delta_bic, problem) {
        named.equivalents = instead.filter(|_| delta_bic < rival + select::ENOUGH).into_iter().collect();
        found.gained_in_fit += base.fit.log_likelihood - start.fit.log_likelihood;
        found.named.push(named);
        found.take(telegraph.course);
    }
    // What was tried on the claim alone is what the jumps stood against.
    let first = std::mem::take(&mut selection.first);
    *selection = Selection { first, ..select::select(&base, &problem.spectra, options) };
}
