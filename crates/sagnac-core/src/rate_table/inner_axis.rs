//! The inner axis of a two-axis table while the outer one turns, and between: what its own rate says of angle and output.

use super::blocks::{Block, Blocks};

/// Least rate of the inner axis that is a turn, deg/h.
const MIN_TURN_RATE_DEG_H: f64 = 360.0;
/// Share of the largest rate above which an axis turns.
const TURNING_RATE_SHARE: f64 = 0.1;
/// Least time of turning, s.
const LEAST_S: f64 = 1.0;

/// What the inner axis shows.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct InnerAxis {
    /// Its angle over the integral of its rate, while it turns; `None` where it does not, or either was not recorded.
    pub angle_per_rate: Option<f64>,
    /// Output over its rate while it turns and the outer axis rests, of every gyro channel, with its standard uncertainty.
    pub output_per_rate: Vec<Option<(f64, f64)>>,
    /// Largest rate, deg/h.
    pub largest: f64,
    /// Mean rate during the step of the outer axis in which it is largest beside that, and the rate of the step, deg/h.
    pub during_step: Option<(f64, f64)>,
}

impl InnerAxis {
    /// Looks at a recording.
    pub fn of(blocks: &Blocks) -> InnerAxis {
        let largest_of = |rate: fn(&Block) -> f64| {
            blocks.list.iter().map(|b| rate(b).abs()).filter(|r| r.is_finite()).fold(0.0, f64::max)
        };
        let largest = if blocks.has_rate { largest_of(|b| b.table_rate) } else { 0.0 };
        let outer = if blocks.has_outer { largest_of(|b| b.outer_rate) } else { 0.0 };
        let mut out =
            InnerAxis { largest, output_per_rate: vec![None; blocks.gyros.len()], ..InnerAxis::default() };
        if blocks.has_rate && blocks.has_outer {
            out.during_step = during_step(blocks, outer);
        }
        if largest < MIN_TURN_RATE_DEG_H {
            return out;
        }
        let turns = |b: &Block| b.table_rate.abs() > TURNING_RATE_SHARE * largest;
        let turning = || blocks.list.iter().filter(|b| turns(b));
        let lasts_s = turning().map(|b| f64::from(b.samples)).sum::<f64>() * blocks.interval_s;
        if lasts_s < LEAST_S {
            return out;
        }
        if blocks.has_angle {
            let pairs = blocks.list.windows(2).filter(|w| w[1].continues && turns(&w[0]) && turns(&w[1]));
            // 1 deg/h is 1 arcsec/s.
            let moved = |w: &[Block]| {
                let time_s = (w[1].first_index - w[0].first_index) as f64 * blocks.interval_s;
                (0.5 * (w[0].table_rate + w[1].table_rate) * time_s, w[1].angle_first - w[0].angle_first)
            };
            out.angle_per_rate = slope(pairs.map(moved)).map(|(factor, _)| factor);
        }
        let alone = || {
            turning()
                .filter(|b| !blocks.has_outer || b.outer_rate.abs() <= 1e-3 * outer.max(MIN_TURN_RATE_DEG_H))
        };
        for (gyro, found) in out.output_per_rate.iter_mut().enumerate() {
            let output = |b: &Block| (b.table_rate, b.gyro.get(gyro).copied().unwrap_or(f64::NAN));
            *found = slope(alone().map(output));
        }
        out
    }
}

/// The line through the origin with its standard uncertainty, by what it leaves; `None` of fewer than three points.
fn slope(points: impl Iterator<Item = (f64, f64)>) -> Option<(f64, f64)> {
    let points: Vec<(f64, f64)> = points.filter(|(x, y)| x.is_finite() && y.is_finite()).collect();
    let square = points.iter().map(|(x, _)| x * x).sum::<f64>();
    if points.len() < 3 || square <= 0.0 {
        return None;
    }
    let factor = points.iter().map(|(x, y)| x * y).sum::<f64>() / square;
    let left = points.iter().map(|(x, y)| (y - factor * x).powi(2)).sum::<f64>();
    Some((factor, (left / (points.len() - 1) as f64 / square).sqrt()))
}

/// The stretch of the outer axis during which the inner one turns most, in mean.
fn during_step(blocks: &Blocks, outer: f64) -> Option<(f64, f64)> {
    if outer < MIN_TURN_RATE_DEG_H {
        return None;
    }
    let turns = |b: &Block| b.outer_rate.abs() > 0.5 * outer && b.table_rate.is_finite();
    let stretches = blocks.list.chunk_by(|a, b| turns(a) == turns(b)).filter(|s| turns(&s[0]));
    let mean = |s: &[Block]| {
        let n = s.len() as f64;
        let of = |rate: fn(&Block) -> f64| s.iter().map(rate).sum::<f64>() / n;
        (of(|b| b.table_rate), of(|b| b.outer_rate))
    };
    let ratio = |(inner, outer): &(f64, f64)| (inner / outer).abs();
    stretches.map(mean).max_by(|a, b| ratio(a).total_cmp(&ratio(b)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Blocks of a tenth of a second: turns of the inner axis at 10 deg/s, then a step of the outer one.
    fn blocks(angle_sign: f64, output: f64, creep_deg_s: f64) -> Blocks {
        let mut angle = 0.0;
        let list = (0..200)
            .map(|i| {
                let (inner, outer) = if i < 90 { (10.0, 0.0) } else { (creep_deg_s, 30.0) };
                let first = angle;
                angle += angle_sign * inner * 3600.0 * 0.1;
                Block {
                    first_index: i * 10,
                    first_row: i * 10 + 1,
                    samples: 10,
                    continues: i > 0,
                    gyro: vec![output * inner * 3600.0],
                    table_rate: inner * 3600.0,
                    outer_rate: outer * 3600.0,
                    temperature: f64::NAN,
                    beside: vec![],
                    angle_first: first,
                    angle_last: first + 0.9 * (angle - first),
                }
            })
            .collect();
        Blocks {
            list,
            interval_s: 0.01,
            gyros: vec!["rate".to_owned()],
            has_angle: true,
            has_rate: true,
            has_temperature: false,
            has_outer: true,
        }
    }

    #[test]
    fn turns_between_steps_tell_sign_and_scale_of_angle_and_output() {
        let good = InnerAxis::of(&blocks(1.0, 1.0, 0.0));
        assert!((good.angle_per_rate.unwrap() - 1.0).abs() < 1e-9, "{good:?}");
        assert!((good.output_per_rate[0].unwrap().0 - 1.0).abs() < 1e-9);
        assert!(good.during_step.unwrap().0.abs() < 1e-9);
        let bad = InnerAxis::of(&blocks(-1.0, 1.0 / 3600.0, 0.5));
        assert!((bad.angle_per_rate.unwrap() + 1.0).abs() < 1e-9);
        assert!((bad.output_per_rate[0].unwrap().0 * 3600.0 - 1.0).abs() < 1e-9);
        assert!((bad.during_step.unwrap().0 - 1800.0).abs() < 1e-6);
    }

    #[test]
    fn an_axis_that_rests_shows_nothing() {
        let mut still = blocks(1.0, 1.0, 0.0);
        still.list.iter_mut().for_each(|b| b.table_rate = 0.0);
        let found = InnerAxis::of(&still);
        assert_eq!((found.angle_per_rate, found.output_per_rate), (None, vec![None]));
    }
}
