//! Motion of a rate table, kept as the angle it has turned at four instants in each sampling interval.

use super::dice::Dice;
use std::f64::consts::TAU;

/// Instants of the angle in each sampling interval.
const FINE: usize = 4;

/// A course of a table's axis.
#[derive(Debug, Clone)]
pub struct Motion {
    rate_hz: f64,
    /// Angle at the edges of the quarters of sampling intervals, deg; one more than quarters.
    turned_deg: Vec<f64>,
}

/// How a table moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Programme {
    /// Steps of rates to both sides, with zero between some of them.
    Steps,
    /// Swings of several periods.
    Swings,
    /// Slow scans through zero, at rates like that of the Earth.
    Crawl,
}

impl Motion {
    /// Draws a motion. The largest rate is drawn too, in deg/s.
    pub fn draw(dice: &mut Dice, programme: Programme, rows: usize, rate_hz: f64) -> Motion {
        let fine_s = 1.0 / (rate_hz * FINE as f64);
        let count = rows * FINE;
        let rates = match programme {
            Programme::Steps => steps(dice, count, fine_s),
            Programme::Swings => swings(dice, count, fine_s),
            Programme::Crawl => crawl(dice, count, fine_s),
        };
        let mut angle = 0.0;
        let mut turned_deg = vec![0.0];
        turned_deg.extend(rates.iter().map(|r| {
            angle += r * fine_s;
            angle
        }));
        Motion { rate_hz, turned_deg }
    }

    /// Number of sampling intervals.
    pub fn rows(&self) -> usize {
        (self.turned_deg.len() - 1) / FINE
    }

    /// Angle turned at a time after the beginning, in deg.
    pub fn turned_at(&self, time_s: f64) -> f64 {
        let place = (time_s * self.rate_hz * FINE as f64).clamp(0.0, (self.turned_deg.len() - 1) as f64);
        let i = (place as usize).min(self.turned_deg.len() - 2);
        self.turned_deg[i] + (place - i as f64) * (self.turned_deg[i + 1] - self.turned_deg[i])
    }

    /// Mean rate in each sampling interval, deg/s.
    pub fn rate_deg_s(&self) -> Vec<f64> {
        (0..self.rows())
            .map(|i| (self.turned_deg[FINE * (i + 1)] - self.turned_deg[FINE * i]) * self.rate_hz)
            .collect()
    }

    /// Mean rate in each sampling interval as a late clock sees it: `late_s` of the time in s, in s.
    pub fn late_rate_deg_s(&self, late_s: impl Fn(f64) -> f64) -> Vec<f64> {
        (0..self.rows())
            .map(|i| {
                let [from, to] = [i, i + 1].map(|e| e as f64 / self.rate_hz);
                (self.turned_at(to - late_s(to)) - self.turned_at(from - late_s(from))) * self.rate_hz
            })
            .collect()
    }

    /// Mean over each sampling interval of a function of the angle turned, deg, and the rate, deg/s.
    pub fn mean_of(&self, f: impl Fn(f64, f64) -> f64) -> Vec<f64> {
        let per_s = self.rate_hz * FINE as f64;
        (0..self.rows())
            .map(|i| {
                let quarter = |j: usize| {
                    let (a, b) = (self.turned_deg[FINE * i + j], self.turned_deg[FINE * i + j + 1]);
                    f(0.5 * (a + b), (b - a) * per_s)
                };
                (0..FINE).map(quarter).sum::<f64>() / FINE as f64
            })
            .collect()
    }

    /// Position in the middle of each sampling interval, 0 to 360 deg.
    pub fn angle_deg(&self) -> Vec<f64> {
        (0..self.rows()).map(|i| self.turned_deg[FINE * i + FINE / 2].rem_euclid(360.0)).collect()
    }
}

/// Rates after targets that are held, with a limited acceleration.
fn follow(targets: &[(f64, f64)], acceleration: f64, count: usize, fine_s: f64) -> Vec<f64> {
    let (mut rate, mut at, mut since) = (0.0f64, 0, 0.0);
    (0..count)
        .map(|_| {
            while since > targets[at].1 {
                since -= targets[at].1;
                at = (at + 1) % targets.len();
            }
            since += fine_s;
            let most = acceleration * fine_s;
            rate += (targets[at].0 - rate).clamp(-most, most);
            rate
        })
        .collect()
}

fn steps(dice: &mut Dice, count: usize, fine_s: f64) -> Vec<f64> {
    let largest = dice.decades(2.0, 150.0);
    let levels = dice.count(3, 6);
    let mut list: Vec<f64> = (1..=levels)
        .flat_map(|l| [1.0, -1.0].map(|s| s * largest * (l as f64 / levels as f64).powf(1.3)))
        .collect();
    list.extend([0.0, 0.0]);
    dice.shuffle(&mut list);
    let dwell = dice.uniform(25.0, 160.0);
    let targets: Vec<(f64, f64)> = list.into_iter().map(|r| (r, dwell * dice.uniform(0.8, 1.2))).collect();
    follow(&targets, largest / dice.uniform(2.0, 8.0), count, fine_s)
}

fn swings(dice: &mut Dice, count: usize, fine_s: f64) -> Vec<f64> {
    let largest = dice.decades(0.03, 5.0);
    let tones: Vec<[f64; 3]> =
        (0..3).map(|_| [dice.uniform(0.3, 1.0), dice.decades(15.0, 300.0), dice.uniform(0.0, TAU)]).collect();
    let total: f64 = tones.iter().map(|t| t[0]).sum();
    (0..count)
        .map(|i| {
            let t = i as f64 * fine_s;
            tones.iter().map(|[a, p, f]| a / total * largest * (TAU * t / p + f).sin()).sum()
        })
        .collect()
}

fn crawl(dice: &mut Dice, count: usize, fine_s: f64) -> Vec<f64> {
    let largest = dice.decades(3.0, 60.0) / 3600.0;
    let scan_s = dice.uniform(300.0, 1500.0);
    let hold = dice.uniform(0.05, 0.25);
    (0..count)
        .map(|i| {
            // A triangle whose turns are held.
            let phase = (i as f64 * fine_s / scan_s).rem_euclid(2.0);
            let triangle = if phase < 1.0 { 2.0 * phase - 1.0 } else { 3.0 - 2.0 * phase };
            largest * (triangle * (1.0 + hold)).clamp(-1.0, 1.0)
        })
        .collect()
}

/// Positions of an indexing table, deg: held, then turned within seconds.
pub fn positions(dice: &mut Dice, rows: usize, rate_hz: f64) -> Vec<f64> {
    let count = *dice.one_of(&[6usize, 8, 12, 16]);
    let mut order: Vec<f64> = (0..count).map(|p| 360.0 * p as f64 / count as f64).collect();
    if dice.chance(0.5) {
        dice.shuffle(&mut order);
    }
    let dwell_s = rows as f64 / rate_hz / (count as f64 * dice.uniform(2.0, 4.0));
    let turn_deg = 20.0 / rate_hz;
    let mut at = order[0];
    (0..rows)
        .map(|i| {
            let target = order[(i as f64 / rate_hz / dwell_s) as usize % count];
            at += (target - at).clamp(-turn_deg, turn_deg);
            at.rem_euclid(360.0)
        })
        .collect()
}
