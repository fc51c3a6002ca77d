//! A cause without a name: what departs from the hypothesis when everything that has a name is in it.

use super::departures::Departure;
use super::finding::{Finding, PlaceRecord, ShapeRecord};
use super::options::Options;
use super::problem::Problem;
use crate::effect::{Domain, EFFECTS, Model, UNKNOWN, find};
use crate::numeric::order::SortByNumber;
use std::collections::BTreeMap;

/// A residual test counts as departed below this, its own scan and the number of tests counted.
pub(super) const DEPARTURE_PROBABILITY: f64 = 1e-4;

/// Cause of a departure of which no single event shows: short events of the whole bandwidth are groups of outlying samples,
/// each too weak to be found.
fn beside(worst: &Departure, problem: &Problem, options: &Options) -> Vec<String> {
    /// Samples of a short event, at most.
    const MAX_EVENT_SAMPLES: f64 = 24.0;
    let dt_s = problem.drivers.dt_s;
    let short = worst.shape.and_then(|s| s.each_s).is_some_and(|s| s <= MAX_EVENT_SAMPLES * dt_s);
    // The upper octave and more.
    let broad = worst.place.domain == Domain::Frequency
        && worst.place.to >= 0.45 / dt_s
        && worst.place.from <= 0.26 / dt_s;
    let events = EFFECTS.iter().filter(|e| e.is_short_events() && options.allows(e.kind()));
    events.filter(|_| short && broad).map(|e| e.kind().to_owned()).collect()
}

/// A departure from the hypothesis without a name.
pub(super) fn cause(
    after: &[Departure],
    nothing_found: bool,
    problem: &Problem,
    options: &Options,
) -> Option<Finding> {
    let alpha = options.alpha;
    let bound = if nothing_found { (0.3 * alpha).min(1e-3) } else { DEPARTURE_PROBABILITY };
    let departed = after.iter().filter(|d| d.below(bound, after.len())).collect();
    let mut cause = of_departures(departed, problem, options)?;
    let ln_p = (cause.ln_p + (after.len().max(1) as f64).ln()).min(0.0);
    (cause.finding.delta_bic, cause.finding.p_value) = (-2.0 * ln_p, ln_p.exp().max(1e-300));
    Some(cause.finding)
}

/// The departures of all tests together, where no single effect is justified: their probability is below the significance, so that the
/// recording departs from the hypothesis, most plainly where the clearest of them says.
pub(super) fn of_all_together(
    before: &[Departure],
    p_value: f64,
    problem: &Problem,
    options: &Options,
) -> Option<Finding> {
    let clearest = before.iter().min_by(|a, b| a.ln_p.total_cmp(&b.ln_p))?;
    let cause = of_departures(vec![clearest], problem, options)?;
    Some(Finding { delta_bic: -2.0 * p_value.ln(), p_value, ..cause.finding })
}

/// A cause without a name, and the logarithm of the probability of its clearest departure.
struct Unnamed {
    finding: Finding,
    ln_p: f64,
}

fn of_departures(mut departed: Vec<&Departure>, problem: &Problem, options: &Options) -> Option<Unnamed> {
    departed.sort_ascending_by(|a| a.ln_p);
    departed.sort_by_key(|d| d.narrows());
    let worst = departed.first()?;
    let mut places: Vec<PlaceRecord> = vec![];
    for place in departed.iter().flat_map(|d| [Some(d.place), d.beside]).flatten() {
        let place = PlaceRecord::of(&place);
        if !places.iter().any(|p| p.domain == place.domain) {
            places.push(place);
        }
    }
    places.truncate(3);
    let finding = Finding {
        kind: UNKNOWN.to_owned(),
        effect: None,
        column: None,
        column2: None,
        law: None,
        formula: None,
        shape: Some(shape(worst)),
        equivalents: beside(worst, problem, options),
        probabilities: BTreeMap::new(),
        parameters: BTreeMap::new(),
        places,
        delta_bic: 0.0,
        p_value: 1.0,
        heldout_gain: None,
        removed_share: None,
    };
    Some(Unnamed { finding, ln_p: worst.ln_p })
}

/// Shape of a departure, for a report.
fn shape(departure: &Departure) -> ShapeRecord {
    let shape = departure.shape.unwrap_or_default();
    ShapeRecord {
        form: departure.test.to_owned(),
        count: shape.count,
        each_s: shape.each_s,
        rms_deg_h: shape.rms_deg_h,
    }
}

/// Takes processes that stand for part of what has no name into it. A process fits the power of anything slow or of any
/// band; where what it leaves still departs in the same band, or in time, it was the nearest name and not the cause.
pub(super) fn absorb(unknown: &mut Finding, named: &mut Vec<Finding>) {
    let band = |places: &[PlaceRecord]| {
        places.iter().find(|p| p.domain == Domain::Frequency).map(|p| (p.from, p.to))
    };
    let own = band(&unknown.places);
    let same = |f: &Finding| {
        let process = find(f.effect_id())
            .is_some_and(|e| matches!(e.model(), Model::Spectrum(spectrum) if spectrum.has_course()));
        let overlaps = match (own, band(&f.places)) {
            (Some((from, to)), Some((low, high))) => from <= high && low <= to,
            _ => true,
        };
        process && overlaps
    };
    for taken in named.extract_if(.., |f| same(f)) {
        unknown.delta_bic += taken.delta_bic;
        unknown.p_value = unknown.p_value.min(taken.p_value);
        for place in taken.places {
            if unknown.places.len() < 3 && !unknown.places.iter().any(|p| p.domain == place.domain) {
                unknown.places.push(place);
            }
        }
    }
}
