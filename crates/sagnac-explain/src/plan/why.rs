//! Which contrast of a schedule tells two explanations apart.

use super::record::Contrast;
use crate::effect::Column;
use crate::numeric::order::SortNumbers;
use crate::schedule::Leg;
use std::collections::BTreeSet;

/// Rates of ramps that are one within this ratio.
const ALIKE: f64 = 1.05;

/// What of a schedule decides between explanations that follow some columns.
pub(super) fn contrast(legs: &[Leg], follows: &BTreeSet<Column>, squared: f64) -> Contrast {
    if squared <= 0.0 {
        return Contrast::Nothing;
    }
    let by_table = || rates(legs).or_else(|| headings(legs));
    let found = match () {
        () if follows.contains(&Column::TableAngle) => headings(legs),
        () if follows.contains(&Column::TableRate) => rates(legs),
        () if follows.contains(&Column::Temperature) => ramps(legs),
        () => None,
    };
    let hours = legs.last().map_or(0.0, |l| l.to_s) / 3600.0;
    found.or_else(|| if follows.is_empty() { None } else { by_table() }).unwrap_or(Contrast::Length { hours })
}

fn ramps(legs: &[Leg]) -> Option<Contrast> {
    let sizes: Vec<f64> = legs.iter().map(|l| l.ramp_degc_per_h().abs()).filter(|r| *r > 1e-9).collect();
    let slowest_degc_per_h = sizes.iter().copied().fold(f64::INFINITY, f64::min);
    let fastest_degc_per_h = sizes.iter().copied().fold(0.0, f64::max);
    let soaked = legs
        .windows(2)
        .any(|w| matches!(w, [a, b] if a.ramp_degc_per_h() != 0.0 && b.ramp_degc_per_h() == 0.0));
    match () {
        () if sizes.is_empty() => None,
        () if fastest_degc_per_h > ALIKE * slowest_degc_per_h => {
            Some(Contrast::RampRates { slowest_degc_per_h, fastest_degc_per_h })
        }
        () if soaked => Some(Contrast::RampAndSoak { rate_degc_per_h: fastest_degc_per_h }),
        () => Some(Contrast::HeatingAndCooling { rate_degc_per_h: fastest_degc_per_h }),
    }
}

fn rates(legs: &[Leg]) -> Option<Contrast> {
    let sizes = legs.iter().filter_map(|l| l.table_rate_deg_s).map(f64::abs).filter(|r| *r > 0.0);
    let (smallest_deg_s, largest_deg_s) =
        sizes.fold((f64::INFINITY, 0.0f64), |(low, high), r| (low.min(r), high.max(r)));
    if largest_deg_s <= 0.0 {
        return None;
    }
    if largest_deg_s > ALIKE * smallest_deg_s {
        return Some(Contrast::SizesOfRate { smallest_deg_s, largest_deg_s });
    }
    Some(Contrast::SignsOfRate { largest_deg_s })
}

fn headings(legs: &[Leg]) -> Option<Contrast> {
    let mut angles: Vec<f64> = legs.iter().filter_map(|l| l.table_angle_deg).collect();
    angles.sort_ascending();
    angles.dedup();
    (angles.len() > 1).then_some(Contrast::Headings { count: angles.len() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::schedule::{Schedule, Start, Step};

    fn cycle(rate: f64, soak_h: f64) -> Step {
        Step::Cycle { low_degc: 10.0, high_degc: 40.0, rate_degc_per_h: rate, soak_h, count: 1 }
    }

    #[test]
    fn ramps_decide_by_their_rates_their_soaks_or_their_direction() {
        let of = |steps: Vec<Step>| {
            let legs = Schedule { start: Start::default(), steps }.legs();
            contrast(&legs, &BTreeSet::from([Column::Temperature]), 30.0)
        };
        assert_eq!(of(vec![cycle(30.0, 0.0)]), Contrast::HeatingAndCooling { rate_degc_per_h: 30.0 });
        assert_eq!(of(vec![cycle(30.0, 1.0)]), Contrast::RampAndSoak { rate_degc_per_h: 30.0 });
        let two = Contrast::RampRates { slowest_degc_per_h: 10.0, fastest_degc_per_h: 30.0 };
        assert_eq!(of(vec![cycle(30.0, 0.0), cycle(10.0, 0.0)]), two);
        assert_eq!(of(vec![Step::Hold { duration_h: 2.0 }]), Contrast::Length { hours: 2.0 });
    }

    #[test]
    fn a_distance_of_nothing_is_decided_by_nothing() {
        let legs = Schedule { start: Start::default(), steps: vec![cycle(30.0, 0.0)] }.legs();
        assert_eq!(contrast(&legs, &BTreeSet::new(), 0.0), Contrast::Nothing);
    }
}
