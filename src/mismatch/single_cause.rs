//! Findings that are together one cause of no kind.
//!
//! Lines side by side are one line that is modulated; many lines are a periodic course; three changes of the spectrum are
//! a spectrum that no kind has; three jumps are a staircase. Each of them, named alone, would say what is not the case.

use super::samples::Named;
use crate::effect::{Domain, Place};

/// Ratio of frequencies below which two lines are neighbours.
const NEIGHBOURS: f64 = 1.15;
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

fn family(kind: &str) -> Option<Family> {
    match kind {
        "line" => Some(Family::Line),
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

/// The findings that belong together, of a selection that was allowed so many effects.
pub(super) fn together(named: &[Named], allowed: usize) -> Vec<Together> {
    // Where more findings were allowed than one family took, it was not cut short: each is what it is named.
    let many = MANY.max(allowed);
    let of = |wanted: Family| -> Vec<usize> {
        (0..named.len()).filter(|i| family(named[*i].effect.kind()) == Some(wanted)).collect()
    };
    let mut groups: Vec<Vec<usize>> = vec![];
    let lines = of(Family::Line);
    if lines.len() >= many {
        groups.push(lines);
    } else {
        groups.extend(neighbours(named, &lines).into_iter().filter(|g| g.len() > 1));
    }
    groups.extend([Family::Spectrum, Family::Jump].map(of).into_iter().filter(|g| g.len() >= many));
    groups
        .into_iter()
        .map(|members| {
            let places = hull(named, &members);
            Together { members, places }
        })
        .collect()
}
