//! Findings that are together one cause of no kind.
//!
//! Lines side by side are one line that is modulated; many lines are a periodic course; three changes of the spectrum are
//! a spectrum that no kind has; three jumps are a staircase; a level that leaves and
//! returns is one driver that was not recorded. Each of them, named alone, would say what is not the case.

use super::estimates::Estimated;
use super::finding::ParameterValue;
use super::named::NamedEffect;
use super::options::Options;
use super::problem::Problem;
use crate::effect::{Domain, Family, Knot, Place};
use crate::numeric::order::SortByNumber;
use std::collections::BTreeMap;

/// Ratio of frequencies below which two lines are neighbours.
const NEIGHBOUR_RATIO: f64 = 1.15;
/// Size of a jump.
const STEP_NAME: &str = "step_deg_h";
/// Share of a jump within which the next one takes the level back.
const RETURN_SHARE: f64 = 0.5;
/// The same in standard deviations of the two.
const BACK_DEVIATIONS: f64 = 3.0;
/// Findings of one family from which they are one cause, where no more were allowed.
const MIN_FAMILY_FINDINGS: usize = 3;

/// Several findings that are one cause.
pub(super) struct Together {
    /// Positions of the findings.
    pub members: Vec<usize>,
    /// Intervals in which they show.
    pub places: Vec<Place>,
}

/// The hull of the places of some findings, one in each domain, at most three.
fn hull(named: &[NamedEffect], members: &[usize]) -> Vec<Place> {
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

fn frequency(named: &NamedEffect) -> Option<f64> {
    let place = named.places.iter().find(|p| p.domain == Domain::Frequency)?;
    Some(0.5 * (place.from + place.to))
}

/// Lines in the order of their frequencies, cut where neighbours are far apart.
fn neighbours(named: &[NamedEffect], lines: &[usize]) -> Vec<Vec<usize>> {
    let mut order: Vec<(f64, usize)> =
        lines.iter().filter_map(|i| Some((frequency(&named[*i])?, *i))).collect();
    order.sort_ascending_by(|a| a.0);
    let mut out: Vec<Vec<usize>> = vec![];
    let mut last = f64::NAN;
    for (f, i) in order {
        match out.last_mut() {
            Some(group) if f < NEIGHBOUR_RATIO * last => group.push(i),
            _ => out.push(vec![i]),
        }
        last = f;
    }
    out
}

/// Positions of the only two jumps, by time, if the second takes back what the first brought.
fn reversible_step_pair(named: &[NamedEffect]) -> Option<[usize; 2]> {
    let jumps: Vec<usize> =
        (0..named.len()).filter(|i| named[*i].effect.family() == Some(Family::Jump)).collect();
    // A gyro that was turned and turned back changed its heading twice.
    let steps = jumps.iter().all(|i| named[*i].effect.reversed_pair().is_some());
    let [a, b] = jumps[..] else { return None };
    let parameter = |i: usize, name: &str| named[i].estimated.reported.get(name);
    let (first, second) = (parameter(a, STEP_NAME)?, parameter(b, STEP_NAME)?);
    let deviation = |p: &ParameterValue| (p.ci95[1] - p.ci95[0]) / 3.92;
    let left = (first.value + second.value).abs();
    let back = left < RETURN_SHARE * first.value.abs().max(second.value.abs())
        && left < BACK_DEVIATIONS * deviation(first).hypot(deviation(second));
    let ordered = named[a].instant()?.value <= named[b].instant()?.value;
    (steps && back).then_some(if ordered { [a, b] } else { [b, a] })
}

/// Two jumps, there and back, made the one thing that the format of explanations calls them: something that was not
/// recorded came and went.
pub(super) fn returned(named: &mut Vec<NamedEffect>, problem: &Problem, options: &Options) {
    let Some([first, second]) = reversible_step_pair(named) else { return };
    let pair = named[first].effect.reversed_pair().filter(|e| options.allows(e.kind()));
    let Some((effect, by_course)) = pair.and_then(|e| Some((e, e.claimed_by_course()?))) else { return };
    let value = |i: usize, name: &str| named[i].estimated.reported.get(name).cloned();
    let (Some(up), Some(down)) = (value(first, STEP_NAME), value(second, STEP_NAME)) else { return };
    let (Some(from), Some(to)) = (named[first].instant().cloned(), named[second].instant().cloned()) else {
        return;
    };
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
    let knot = |(at, value): (&f64, f64)| Knot { at: *at, value };
    let knots: Vec<Knot> = times.iter().zip([0.0, height, height, 0.0]).map(knot).collect();
    let stated = by_course.values(&knots);
    let pair = [&named[first], &named[second]];
    let whole = NamedEffect {
        effect,
        stated_as: effect,
        estimated: Estimated {
            reported: BTreeMap::from([("rms_deg_h".to_owned(), rms)]),
            stated,
            ..Estimated::default()
        },
        equivalents: vec![],
        names: vec![],
        places: hull(named, &[first, second]),
        delta_bic: pair.iter().map(|n| n.delta_bic).sum(),
        p_value: pair.iter().map(|n| n.p_value).fold(1.0, f64::min),
        improvement: None,
        local_gain: pair.iter().map(|n| n.local_gain).sum(),
        shape: None,
    };
    named[first] = whole;
    named.remove(second);
}

/// The findings that belong together, of a selection that was allowed so many effects.
pub(super) fn together(named: &[NamedEffect], allowed: usize) -> Vec<Together> {
    // Where more findings were allowed than one family took, it was not cut short: each is what it is named.
    let many = MIN_FAMILY_FINDINGS.max(allowed);
    let of = |wanted: Family| -> Vec<usize> {
        (0..named.len()).filter(|i| named[*i].effect.family() == Some(wanted)).collect()
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

#[cfg(test)]
mod tests {
    use super::*;

    use crate::effect::find;
    use std::collections::BTreeMap;

    /// A jump of some size at an instant.
    fn jump(kind: &str, size: f64, at: f64) -> NamedEffect {
        let value = |value: f64, half: f64| ParameterValue {
            value,
            unit: String::new(),
            ci95: [value - half, value + half],
        };
        let reported = BTreeMap::from([
            ("step_deg_h".to_owned(), value(size, 0.1)),
            ("time_s".to_owned(), value(at, 1.0)),
        ]);
        NamedEffect {
            effect: find(kind).unwrap(),
            stated_as: find(kind).unwrap(),
            estimated: Estimated { reported, ..Estimated::default() },
            equivalents: vec![],
            names: vec![],
            places: vec![Place { domain: Domain::Time, from: at - 1.0, to: at + 1.0 }],
            delta_bic: 50.0,
            p_value: 1e-9,
            improvement: None,
            local_gain: 0.0,
            shape: None,
        }
    }

    fn line(frequency_hz: f64) -> NamedEffect {
        let place = Place { domain: Domain::Frequency, from: frequency_hz, to: frequency_hz };
        NamedEffect {
            effect: find("line").unwrap(),
            stated_as: find("line").unwrap(),
            places: vec![place],
            ..jump("line", 0.0, 0.0)
        }
    }

    #[test]
    fn a_level_that_comes_back_is_a_pair_in_the_order_of_time() {
        let pair = |second: NamedEffect| reversible_step_pair(&[jump("bias_step", -0.98, 700.0), second]);
        assert_eq!(pair(jump("bias_step", 1.0, 400.0)), Some([1, 0]));
        // Not back: of the same sign, too much left, or a heading that changed.
        assert_eq!(pair(jump("bias_step", -1.0, 400.0)), None);
        assert_eq!(pair(jump("bias_step", 2.1, 400.0)), None);
        assert_eq!(pair(jump("heading_change", 1.0, 400.0)), None);
    }

    #[test]
    fn lines_side_by_side_are_one_cause_and_lines_apart_are_two() {
        let groups = |f: &[f64]| {
            let named: Vec<NamedEffect> = f.iter().map(|f| line(*f)).collect();
            together(&named, 3).into_iter().map(|t| t.members).collect::<Vec<_>>()
        };
        assert_eq!(groups(&[1.14, 1.0]), [[1, 0]]);
        assert!(groups(&[1.16, 1.0]).is_empty());
        assert_eq!(groups(&[1.0, 5.0, 20.0]), [[0, 1, 2]]);
        // Rounding beside two resonances is no third part of a spectrum that no kind has; a third resonance is.
        let of = |kinds: [&str; 3]| {
            let found = |(kind, hz): (&str, f64)| NamedEffect {
                effect: find(kind).unwrap(),
                stated_as: find(kind).unwrap(),
                ..line(hz)
            };
            let named: Vec<NamedEffect> = kinds.into_iter().zip([9.2, 20.7, 29.9]).map(found).collect();
            together(&named, 3).len()
        };
        assert_eq!(of(["quasi_periodic", "quantization", "quasi_periodic"]), 0);
        assert_eq!(of(["quasi_periodic"; 3]), 1);
        // Allowed five, three were all there were.
        let named: Vec<NamedEffect> = [1.0, 5.0, 20.0].map(line).into();
        assert!(together(&named, 5).is_empty());
    }
}
