//! Findings that are together one cause of no kind.
//!
//! Lines side by side are one line that is modulated; many lines are a periodic course; three changes of the spectrum are
//! a spectrum that no kind has; three jumps are a staircase; a level that leaves and
//! returns is one driver that was not recorded. Each of them, named alone, would say what is not the case.

use super::estimates::{Estimated, INSTANT};
use super::finding::ParameterValue;
use super::problem::Problem;
use super::samples::Named;
use crate::effect::{Domain, Place, Value, find};
use std::collections::BTreeMap;

/// Ratio of frequencies below which two lines are neighbours.
const NEIGHBOURS: f64 = 1.15;
/// Size of a jump.
const STEP: &str = "step_deg_h";
/// Share of a jump within which the next one takes the level back.
const BACK: f64 = 0.5;
/// The same in standard deviations of the two.
const BACK_DEVIATIONS: f64 = 3.0;
/// Findings of one family from which they are one cause, where no more were allowed.
const MANY: usize = 3;

/// Several findings that are one cause.
pub(super) struct Together {
    /// Positions of the findings.
    pub members: Vec<usize>,
    /// Where they live.
    pub places: Vec<Place>,
}

#[derive(Clone, Copy, PartialEq)]
enum Family {
    Line,
    Spectrum,
    Jump,
}

fn family(named: &Named) -> Option<Family> {
    // Rounding that the values themselves show is no part of the shape of a spectrum.
    let in_spectrum = frequency(named).is_some();
    match named.effect.kind() {
        "line" => Some(Family::Line),
        "quantization" if !in_spectrum => None,
        "excess_arw" | "excess_flicker" | "excess_rrw" | "markov_short" | "markov_long"
        | "quasi_periodic" | "bandwidth_filter" | "quantization" => Some(Family::Spectrum),
        "bias_step" | "heading_change" => Some(Family::Jump),
        _ => None,
    }
}

/// The hull of the places of some findings, one in each domain, at most three.
fn hull(named: &[Named], members: &[usize]) -> Vec<Place> {
    let mut out: Vec<Place> = vec![];
    for place in members.iter().flat_map(|i| &named[*i].places) {
        match out.iter_mut().find(|p| p.domain == place.domain) {
            Some(p) => (p.from, p.to) = (p.from.min(place.from), p.to.max(place.to)),
            None => out.push(*place),
        }
    }
    out.truncate(3);
    out
}

fn frequency(named: &Named) -> Option<f64> {
    let place = named.places.iter().find(|p| p.domain == Domain::Frequency)?;
    Some(0.5 * (place.from + place.to))
}

/// Lines in the order of their frequencies, cut where neighbours are far apart.
fn neighbours(named: &[Named], lines: &[usize]) -> Vec<Vec<usize>> {
    let mut order: Vec<(f64, usize)> =
        lines.iter().filter_map(|i| Some((frequency(&named[*i])?, *i))).collect();
    order.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut out: Vec<Vec<usize>> = vec![];
    let mut last = f64::NAN;
    for (f, i) in order {
        match out.last_mut() {
            Some(group) if f < NEIGHBOURS * last => group.push(i),
            _ => out.push(vec![i]),
        }
        last = f;
    }
    out
}

/// Positions of the only two jumps, by time, if the second takes back what the first brought.
fn reversible_step_pair(named: &[Named]) -> Option<[usize; 2]> {
    let jumps: Vec<usize> = (0..named.len()).filter(|i| family(&named[*i]) == Some(Family::Jump)).collect();
    // A gyro that was turned and turned back changed its heading twice.
    let steps = jumps.iter().all(|i| named[*i].effect.kind() == "bias_step");
    let [a, b] = jumps[..] else { return None };
    let parameter = |i: usize, name: &str| named[i].estimated.reported.get(name);
    let (first, second) = (parameter(a, STEP)?, parameter(b, STEP)?);
    let deviation = |p: &ParameterValue| (p.ci95[1] - p.ci95[0]) / 3.92;
    let left = (first.value + second.value).abs();
    let back = left < BACK * first.value.abs().max(second.value.abs())
        && left < BACK_DEVIATIONS * deviation(first).hypot(deviation(second));
    let ordered = parameter(a, INSTANT)?.value <= parameter(b, INSTANT)?.value;
    (steps && back).then_some(if ordered { [a, b] } else { [b, a] })
}

/// Two jumps, there and back, made the one thing that the format of explanations calls them: something that was not
/// recorded came and went.
pub(super) fn returned(named: &mut Vec<Named>, problem: &Problem) {
    let Some([first, second]) = reversible_step_pair(named) else { return };
    let Some(effect) = find("unobserved_driver") else { return };
    let value = |i: usize, name: &str| named[i].estimated.reported.get(name).cloned();
    let (Some(up), Some(down)) = (value(first, STEP), value(second, STEP)) else { return };
    let (Some(from), Some(to)) = (value(first, INSTANT), value(second, INSTANT)) else { return };
    let weight = |p: &ParameterValue| (p.ci95[1] - p.ci95[0]).max(1e-300).powi(-2);
    let (a, b) = (weight(&up), weight(&down));
    let height = (a * up.value - b * down.value) / (a + b);
    let half = 1.0 / (a + b).sqrt() / 2.0;
    let drivers = &problem.drivers;
    let share = ((to.value - from.value) / drivers.length_s()).clamp(0.0, 1.0);
    let root = (share * (1.0 - share)).sqrt();
    let rms = ParameterValue {
        value: height.abs() * root,
        unit: "deg/h".to_owned(),
        ci95: [(height.abs() - half).max(0.0) * root, (height.abs() + half) * root],
    };
    let edge = 1e-3 * drivers.dt_s;
    let times = [from.value - edge, from.value + edge, to.value - edge, to.value + edge];
    let list = |x: &[f64]| Value::List(x.to_vec());
    let stated = BTreeMap::from([
        ("knots_time_s".to_owned(), list(&times)),
        ("knots_deg_h".to_owned(), list(&[0.0, height, height, 0.0])),
    ]);
    let pair = [&named[first], &named[second]];
    let whole = Named {
        effect,
        estimated: Estimated { reported: BTreeMap::from([("rms_deg_h".to_owned(), rms)]), stated },
        equivalents: vec![],
        places: hull(named, &[first, second]),
        delta_bic: pair.iter().map(|n| n.delta_bic).sum(),
        p_value: pair.iter().map(|n| n.p_value).fold(1.0, f64::min),
        improvement: None,
        local_gain: pair.iter().map(|n| n.local_gain).sum(),
    };
    named[first] = whole;
    named.remove(second);
}

/// The findings that belong together, of a selection that was allowed so many effects.
pub(super) fn together(named: &[Named], allowed: usize) -> Vec<Together> {
    // Where more findings were allowed than one family took, it was not cut short: each is what it is named.
    let many = MANY.max(allowed);
    let of = |wanted: Family| -> Vec<usize> {
        (0..named.len()).filter(|i| family(&named[*i]) == Some(wanted)).collect()
    };
    let mut groups: Vec<Vec<usize>> = vec![];
    let lines = of(Family::Line);
    if lines.len() >= many {
        groups.push(lines);
    } else {
        groups.extend(neighbours(named, &lines).into_iter().filter(|g| g.len() > 1));
    }
    groups.extend([Family::Spectrum, Family::Jump].map(of).into_iter().filter(|g| g.len() >= many));
    groups.extend(reversible_step_pair(named).map(|pair| pair.to_vec()));
    groups
        .into_iter()
        .map(|members| {
            let places = hull(named, &members);
            Together { members, places }
        })
        .collect()
}
