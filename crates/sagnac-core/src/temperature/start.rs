//! When the unit was switched on: what a recording shows of it, or what the procedure declares.
//!
//! A warm-up time counts from there. Decays whose beginning is cut off are decays still, only smaller, so that the transient
//! itself never tells where it began.

use super::test::StartAsked;
use super::track::Means;

/// Share of its later value from which a supply counts as on.
const ON_SHARE: f64 = 0.5;
/// Times the tolerance that a thermometer must rise to show that it would have shown a warm start.
const MIN_RISE: f64 = 3.0;
/// Time over which the first temperature is read, s.
const FIRST_S: f64 = 30.0;
/// Lengths of the recording beyond which its first stamp is that of a clock with a zero of its own.
const MAX_START_RATIO: f64 = 10.0;

/// The start as far as it is known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Start {
    /// The recording shows it, so many seconds after its first sample.
    Shown(f64),
    /// The procedure declares that the first sample is the start.
    Declared,
    /// Nothing shows it.
    NotShown(Missing),
}

/// Why a start is not shown.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Missing {
    /// The procedure names no evidence and declares nothing.
    NotAsked,
    /// The channel that is to show it holds nothing.
    NoValues,
    /// The supply was on from the first sample.
    OnAtFirst,
    /// The thermometer stood at a temperature, degC, that is not that of the cold unit, degC.
    WarmAtFirst(f64, f64),
    /// The thermometer did not move, so that it would not have told a warm start.
    NoRise,
    /// The first stamp, s, is later than switching on.
    Late(f64),
}

/// Looks for the start. `channel` is the position of the channel that is to show it, `first_stamp_s` the first stamp where
/// there are stamps.
pub fn start(asked: &StartAsked, means: &Means, channel: Option<usize>, first_stamp_s: Option<f64>) -> Start {
    let length_s = means.len() as f64 * means.block_s;
    let slack_s = 2.0 * means.block_s + 1.0;
    let values = channel.and_then(|c| means.values.get(c)).map_or(&[][..], Vec::as_slice);
    let missing = match asked {
        StartAsked::Nothing => Missing::NotAsked,
        StartAsked::Declared => match first_stamp_s {
            Some(at) if at > slack_s && at < MAX_START_RATIO * length_s => Missing::Late(at),
            _ => return Start::Declared,
        },
        StartAsked::Stamp { power_on_s } => match first_stamp_s.map(|at| at - power_on_s) {
            Some(late) if late > slack_s => Missing::Late(late),
            Some(late) if -late < length_s => return Start::Shown((-late).max(0.0)),
            _ => Missing::NoValues,
        },
        StartAsked::Supply { .. } => match switched_on(values) {
            Some(0) => Missing::OnAtFirst,
            Some(at) => return Start::Shown(means.first_s + at as f64 * means.block_s),
            None => Missing::NoValues,
        },
        StartAsked::Temperature { cold_deg_c, tolerance_deg_c, .. } => {
            let blocks = ((FIRST_S / means.block_s) as usize).max(1);
            match mean(values.iter().take(blocks)) {
                None => Missing::NoValues,
                Some(first) if (first - cold_deg_c).abs() > *tolerance_deg_c => {
                    Missing::WarmAtFirst(first, *cold_deg_c)
                }
                Some(first) => {
                    let last = mean(values.iter().rev().take(values.len().div_ceil(10)));
                    if last.is_some_and(|l| (l - first).abs() > MIN_RISE * tolerance_deg_c) {
                        return Start::Shown(0.0);
                    }
                    Missing::NoRise
                }
            }
        }
    };
    Start::NotShown(missing)
}

fn mean<'a>(values: impl Iterator<Item = &'a f64>) -> Option<f64> {
    let (sum, n) = values.filter(|v| v.is_finite()).fold((0.0, 0usize), |(s, n), v| (s + v, n + 1));
    (n > 0).then(|| sum / n as f64)
}

/// The block in which a supply comes on for good: the last one below half of its later value, and one.
fn switched_on(supply: &[f64]) -> Option<usize> {
    let later = mean(supply.iter().skip(supply.len() / 2))?;
    let off = |v: &f64| v.is_finite() && v.abs() < ON_SHARE * later.abs();
    (later != 0.0).then(|| supply.iter().rposition(off).map_or(0, |i| i + 1))
}

impl Means {
    /// The start counted from a later time, s from the start of the recording, which becomes the zero of times.
    pub fn since(&self, from_s: f64) -> Means {
        let skip = ((from_s - self.first_s) / self.block_s).round().max(0.0) as usize;
        let values = self.values.iter().map(|v| v.get(skip..).unwrap_or_default().to_vec()).collect();
        let first_s = (self.first_s + skip as f64 * self.block_s - from_s).max(0.0);
        Means { first_s, values, ..*self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn means(values: Vec<f64>) -> Means {
        Means { block_s: 1.0, samples: 1, first_s: 0.0, values: vec![values] }
    }

    #[test]
    fn a_supply_shows_the_start_only_where_it_comes_on() {
        let supply = StartAsked::Supply { channel: "v".into() };
        let on = |off: usize| means((0..4000).map(|i| if i < off { 0.01 } else { 5.0 }).collect());
        assert_eq!(start(&supply, &on(120), Some(0), None), Start::Shown(120.0));
        assert_eq!(start(&supply, &on(0), Some(0), None), Start::NotShown(Missing::OnAtFirst));
        assert_eq!(start(&supply, &on(0), None, None), Start::NotShown(Missing::NoValues));
        let later = on(120).since(120.0);
        assert_eq!((later.len(), later.first_s, later.values[0][0]), (3880, 0.0, 5.0));
    }

    #[test]
    fn a_thermometer_shows_it_where_it_is_cold_first_and_rises() {
        let asked = StartAsked::Temperature { channel: "t".into(), cold_deg_c: 20.0, tolerance_deg_c: 0.5 };
        let rising = |from: f64| {
            means((0..4000).map(|i| 20.0 + 8.0 * (1.0 - (-(f64::from(i) + from) / 600.0).exp())).collect())
        };
        assert_eq!(start(&asked, &rising(0.0), Some(0), None), Start::Shown(0.0));
        let cut = start(&asked, &rising(900.0), Some(0), None);
        assert!(matches!(cut, Start::NotShown(Missing::WarmAtFirst(..))), "{cut:?}");
        let still = means(vec![20.1; 4000]);
        assert_eq!(start(&asked, &still, Some(0), None), Start::NotShown(Missing::NoRise));
    }

    #[test]
    fn a_declared_start_must_not_contradict_the_stamps() {
        let m = means(vec![0.0; 14_400]);
        let declared = |at: f64| start(&StartAsked::Declared, &m, None, Some(at));
        assert_eq!(declared(0.0), Start::Declared);
        assert_eq!(declared(3985.0), Start::NotShown(Missing::Late(3985.0)));
        // Stamps of the day, of the week, of an era count from elsewhere.
        assert_eq!(declared(1.7e9), Start::Declared);
        let stamp = |at: f64| start(&StartAsked::Stamp { power_on_s: 500.0 }, &m, None, Some(at));
        assert_eq!(stamp(500.0), Start::Shown(0.0));
        assert_eq!(stamp(440.0), Start::Shown(60.0));
        assert_eq!(stamp(900.0), Start::NotShown(Missing::Late(400.0)));
        assert_eq!(start(&StartAsked::Nothing, &m, None, None), Start::NotShown(Missing::NotAsked));
    }
}
