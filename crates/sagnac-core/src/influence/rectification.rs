//! Rectified bias by frequency: the output of the intervals against the mean-square acceleration in every band at once.

use super::comparison::{Beside, Comparison, Drive, Regressed, States, compare};
use super::cut::span_s;
use super::excitation::{Column, Excitation, judge};
use super::intervals::{Interval, Intervals};
use super::setup::ComparisonTest;
use super::shaken::Shaken;
use crate::noise::in_band::Band;
use crate::numeric::reml::Combination;
use crate::rate_table::blocks::Blocks;

/// Share of the largest rms within which vibrations in all bands are the same.
const SAME_VIBRATION_SHARE: f64 = 0.1;

/// Name of what lies beyond all bands.
const ELSEWHERE: &str = "elsewhere";

/// One band of one channel.
#[derive(Debug, Clone, PartialEq)]
pub struct InBand {
    /// The band.
    pub band: Band,
    /// What was excited.
    pub shown: Excitation,
    /// Largest rms acceleration in it, g.
    pub largest_rms_g: f64,
    /// Change of the bias per mean square of the acceleration, deg/h/g²; `None` where the band does not stand in the regression.
    pub per_square: Option<Combination>,
    /// Change of the temperature of the unit per mean square, degC/g²; `None` without a temperature.
    pub degrees: Option<f64>,
}

/// The bands of one channel.
#[derive(Debug, Clone)]
pub struct Rectification {
    /// The regression; `None` where no band was excited by itself.
    pub regression: Option<Comparison>,
    /// The bands.
    pub bands: Vec<InBand>,
}

/// Evaluates a channel.
pub fn evaluate(
    blocks: &Blocks,
    found: &Intervals,
    test: &ComparisonTest,
    beside: &Beside,
    gyro: usize,
    shaken: &Shaken,
) -> Rectification {
    let columns = columns(found, shaken);
    let spans: Vec<(f64, f64)> = found.list.iter().map(|i| span(blocks, i)).collect();
    let lengths: Vec<f64> = spans.iter().map(|(from, to)| to - from).collect();
    let middles: Vec<f64> = spans.iter().map(|(from, to)| 0.5 * (from + to)).collect();
    let count = middles.len().max(1) as f64;
    let middle = middles.iter().sum::<f64>() / count;
    let times: Vec<f64> = middles.iter().map(|t| t - middle).collect();
    let told = columns.iter().all(|c| c.drive.iter().all(|d| d.is_finite()));
    let excited = told.then(|| judge(&columns, &lengths, &times, found.alternations() >= 1));
    let regression = excited.as_ref().filter(|e| !e.regressed.is_empty()).and_then(|excited| {
        let (by_band, regressed) = regressed(found, &columns, &excited.regressed);
        compare(blocks, &by_band, test, beside, gyro, &regressed)
    });
    let of = |(at, band): (usize, &Band)| {
        let place = excited.as_ref().and_then(|e| e.regressed.iter().position(|r| *r == at));
        let term = |place: usize| regression.as_ref()?.bias.terms.get(place);
        let warmed = |place: usize| regression.as_ref()?.temperature.as_ref()?.per_drive.get(place).copied();
        let shown = match &excited {
            _ if !shaken.resolves(band) => Excitation::Unresolved,
            Some(excited) => excited.shown.get(at).copied().unwrap_or(Excitation::None),
            None => Excitation::Unresolved,
        };
        let largest = columns.get(at).map_or(0.0, |c| c.drive.iter().copied().fold(0.0, f64::max));
        InBand {
            band: *band,
            shown,
            largest_rms_g: largest.sqrt(),
            per_square: place.and_then(term).map(|t| t.per_unit),
            degrees: place.and_then(warmed),
        }
    };
    let bands = shaken.bands.iter().enumerate().map(of).collect();
    Rectification { regression, bands }
}

fn span(blocks: &Blocks, interval: &Interval) -> (f64, f64) {
    let list = blocks.list.get(interval.blocks.0..interval.blocks.1).unwrap_or_default();
    match (list.first(), list.last()) {
        (Some(first), Some(last)) => (span_s(blocks, first).0, span_s(blocks, last).1),
        _ => (0.0, 0.0),
    }
}

/// Mean squares in every band and beyond all, less those without vibration: noise of the accelerometer is no vibration.
fn columns(found: &Intervals, shaken: &Shaken) -> Vec<Column> {
    let off: Vec<bool> = found.list.iter().map(|i| found.is_off(i)).collect();
    let column = |band: Option<Band>, squares: &[f64]| {
        let quiet: Vec<f64> = squares.iter().zip(&off).filter(|(_, off)| **off).map(|(s, _)| *s).collect();
        let floor = quiet.iter().sum::<f64>() / quiet.len().max(1) as f64;
        let drive = squares.iter().zip(&off).map(|(s, off)| if *off { 0.0 } else { s - floor });
        Column { band, drive: drive.collect() }
    };
    let in_bands = shaken.bands.iter().zip(&shaken.in_bands).map(|(b, s)| column(Some(*b), s));
    in_bands.chain([column(None, &shaken.elsewhere)]).collect()
}

/// The intervals with the rms of every band as their levels, and the regression on the columns that are told apart.
fn regressed(found: &Intervals, columns: &[Column], taken: &[usize]) -> (Intervals, Regressed) {
    let name = |c: &Column| c.band.map_or_else(|| ELSEWHERE.to_owned(), |b| b.name());
    let levels = |k: usize| -> Vec<f64> { columns.iter().map(|c| c.drive[k].max(0.0).sqrt()).collect() };
    let own = |(k, interval): (usize, &Interval)| Interval { levels: levels(k), ..interval.clone() };
    let by_band = Intervals {
        list: found.list.iter().enumerate().map(own).collect(),
        axes: columns.iter().map(name).collect(),
        reference: 0.0,
        tolerance: 0.0,
        ..found.clone()
    };
    let states = states(found, &by_band);
    let drive = |at: &usize| {
        let intervals = columns[*at].drive.clone();
        let size = intervals.iter().fold(0.0, |m: f64, d| m.max(d.abs()));
        let of_state = |state: usize| {
            let own: Vec<f64> = intervals
                .iter()
                .zip(&states.of)
                .filter(|(_, of)| **of == Some(state))
                .map(|(d, _)| *d)
                .collect();
            own.iter().sum::<f64>() / own.len().max(1) as f64
        };
        let levels = (0..states.list.len()).map(of_state).collect();
        Drive { axis: name(&columns[*at]), degree: 2, told_apart: true, levels, intervals, size }
    };
    let drives = taken.iter().map(drive).collect();
    (by_band, Regressed { states, drives })
}

/// Vibrations that differ: intervals are alike where they are in every band.
fn states(found: &Intervals, by_band: &Intervals) -> States {
    let largest = by_band.list.iter().flat_map(|i| &i.levels).fold(0.0, |m: f64, l| m.max(*l));
    let mut seen: Vec<&Interval> = vec![];
    let mut of = vec![];
    for (interval, stated) in by_band.list.iter().zip(&found.list) {
        if found.is_off(stated) {
            of.push(None);
            continue;
        }
        let alike = |s: &&Interval| {
            let pairs = s.levels.iter().zip(&interval.levels);
            pairs.into_iter().all(|(a, b)| (a - b).abs() <= SAME_VIBRATION_SHARE * largest)
        };
        let at = seen.iter().position(alike).unwrap_or_else(|| {
            seen.push(interval);
            seen.len() - 1
        });
        of.push(Some(at));
    }
    let strongest = |interval: &&Interval| {
        let levels = interval.levels.iter().enumerate();
        levels.fold((0, 0.0), |most, (axis, level)| if *level > most.1 { (axis, *level) } else { most })
    };
    States { list: seen.iter().map(strongest).collect(), of }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::influence::intervals;
    use crate::influence::setup::{Setting, Stated, StatedLevel};
    use crate::influence::shaken::Accelerations;
    use crate::rate_table::blocks::Collector;
    use crate::recording::{Channel, ColumnRef, Role, SampleBlock, Sink};
    use crate::units::Unit;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};
    use std::f64::consts::TAU;

    const LOW: Band = Band { from_hz: 4.0, to_hz: 8.0 };
    const HIGH: Band = Band { from_hz: 10.0, to_hz: 16.0 };
    const HZ: f64 = 40.0;
    const EACH: usize = 800;

    fn test() -> ComparisonTest {
        let stated = |k: usize, level| StatedLevel {
            stretch: Stated { phase: None, from_s: Some(20.0 * k as f64), to_s: Some(20.0 * (k + 1) as f64) },
            level,
            axis: None,
        };
        ComparisonTest {
            setting: Setting::vibration(),
            reference: 0.0,
            settling_s: 2.0,
            rate_settling_s: 0.0,
            minimum_interval_s: 10.0,
            alternations: 1,
            level_uncertainty: 0.0,
            temperature_difference_deg_c: 1.0,
            temperature_coefficient: None,
            declared: true,
            temperature: None,
            intervals: (0..9).map(|k| stated(k, if k % 2 == 1 { 2.0 } else { 0.0 })).collect(),
            by_frequency: None,
        }
    }

    /// Sines of 6 and 13 Hz of the stated rms in the four intervals with vibration, rectified by 0.1 and −0.05 deg/h/g².
    fn rectified(rms: [(f64, f64); 4], seed: u64) -> Rectification {
        let mut rng = rand_xoshiro::Xoshiro256PlusPlus::seed_from_u64(seed);
        let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
        let mut values = vec![vec![], vec![]];
        for i in 0..9 * EACH {
            let t = i as f64 / HZ;
            let (low, high) = if (i / EACH) % 2 == 1 { rms[i / EACH / 2] } else { (0.0, 0.0) };
            let sine = |rms: f64, f: f64| 2f64.sqrt() * rms * (TAU * f * t).sin();
            let (low, high) = (sine(low, 6.0), sine(high, 13.0));
            let bias = 0.1 * low * low - 0.05 * high * high;
            values[0].push(12.0 + 0.0005 * t + bias + 0.3 * normal());
            values[1].push(low + high + 0.002 * normal());
        }
        let of = |(at, (id, role)): (usize, (&str, Role))| Channel {
            id: id.into(),
            column: ColumnRef::Position(at + 1),
            role,
            unit: Unit::pure(),
            scale: 1.0,
        };
        let roles = [("rate", Role::Rate), ("acc", Role::AccelerationZ)];
        let channels: Vec<Channel> = roles.into_iter().enumerate().map(of).collect();
        let mut collector = Collector::new(&channels, 1.0 / HZ, None);
        let block =
            SampleBlock { first_index: 0, first_row: 1, time_s: 0.0, continues: false, values: &values };
        collector.push(&block);
        let blocks = collector.finish(1.0 / HZ);
        let test = test();
        let found = intervals::find(&blocks, &test, &[], &[]);
        let spans: Vec<(usize, usize)> = found
            .list
            .iter()
            .map(|i| {
                let (first, last) = (&blocks.list[i.blocks.0], &blocks.list[i.blocks.1 - 1]);
                (first.first_index as usize, last.first_index as usize + last.samples as usize)
            })
            .collect();
        let lengths: Vec<u64> = spans.iter().map(|(from, to)| (to - from) as u64).collect();
        let mut shaken = Accelerations::new(&[LOW, HIGH], 1.0 / HZ, &lengths);
        spans.iter().enumerate().for_each(|(k, (from, to))| shaken.push(k, &values[1][*from..*to], false));
        evaluate(&blocks, &found, &test, &Beside::default(), 0, &shaken.finish())
    }

    #[test]
    fn bands_in_turns_and_in_different_shares_come_back() {
        for rms in [
            [(2.0, 0.0), (0.0, 2.0), (2.0, 0.0), (0.0, 2.0)],
            [(2.0, 0.5), (0.5, 2.0), (2.0, 0.5), (0.5, 2.0)],
        ] {
            let mut outside = 0;
            for seed in 0..10 {
                let found = rectified(rms, seed);
                for (band, truth) in found.bands.iter().zip([0.1, -0.05]) {
                    assert!(matches!(band.shown, Excitation::Apart { elsewhere } if elsewhere < 0.01));
                    let k = band.per_square.unwrap();
                    assert!(k.standard < 0.03 && (band.largest_rms_g - 2.0).abs() < 0.02, "{band:?}");
                    outside += usize::from((k.value - truth).abs() > 2.1 * k.standard);
                }
            }
            assert!(outside <= 4, "{outside}");
        }
    }

    #[test]
    fn bands_in_step_have_no_value() {
        let found = rectified([(2.0, 1.0); 4], 1);
        assert_eq!(found.bands[0].shown, Excitation::InStep { with: Some(HIGH) });
        assert_eq!(found.bands[1].shown, Excitation::InStep { with: Some(LOW) });
        assert!(found.bands[1].per_square.is_none());
    }
}
