//! Steps of which the evaluated part begins while the table still changes its rate, as its angle tells.

use super::blocks::Block;

/// Part of a step at its end by which its rate is determined.
const STEP_END_SHARE: f64 = 0.25;
/// Deviations of the rate of a block from which the table was not at its rate yet.
const BEYOND_NOISE: f64 = 8.0;
/// The same, as a share of the largest rate of the test.
const OF_LARGEST: f64 = 1e-5;
/// The same, as a share of the rate of the step: a table is not steadier.
const OF_RATE: f64 = 2e-3;
/// Blocks at their rate that still may lie before one that is not.
const MAX_BLOCKS_BETWEEN: usize = 2;

/// A step whose evaluated part begins too early.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unsettled {
    /// Time from the beginning of the step after which the table was at its rate, s.
    pub needed_s: f64,
    /// Rate of the table at the end of the step, deg/h.
    pub rate: f64,
    /// Mean deviation from it over what is evaluated, deg/h.
    pub off: f64,
}

/// Looks at the blocks from `from` to `to`, of which those from `first` on are evaluated. `None` where the angle does not
/// tell, or the table was at its rate.
pub fn of_step(
    list: &[Block],
    (from, first, to): (usize, usize, usize),
    interval_s: f64,
    largest: f64,
) -> Option<Unsettled> {
    let begins = list.get(from)?.first_index;
    let time_s = |index: u64| index.saturating_sub(begins) as f64 * interval_s;
    // A degree an hour is an arc second a second.
    let rates: Vec<(f64, f64, f64)> = list
        .get(from..to)?
        .windows(2)
        .filter(|w| w[1].continues)
        .map(|w| {
            let length_s = (w[1].first_index - w[0].first_index) as f64 * interval_s;
            (time_s(w[1].first_index), length_s, (w[1].angle_first - w[0].angle_first) / length_s)
        })
        .collect();
    let last = rates.get(((1.0 - STEP_END_SHARE) * rates.len() as f64) as usize..)?;
    if last.len() < 8 || rates.iter().any(|r| !r.2.is_finite()) {
        return None;
    }
    let rate = last.iter().map(|r| r.2 * r.1).sum::<f64>() / last.iter().map(|r| r.1).sum::<f64>();
    let noise = (last.iter().map(|r| (r.2 - rate).powi(2)).sum::<f64>() / last.len() as f64).sqrt();
    let allowed = (BEYOND_NOISE * noise).max(OF_LARGEST * largest).max(OF_RATE * rate.abs());
    let (mut at, mut since) = (None, 0);
    for (i, r) in rates.iter().enumerate() {
        if (r.2 - rate).abs() > allowed {
            (at, since) = (Some(i), 0);
        } else {
            since += 1;
        }
        if since > MAX_BLOCKS_BETWEEN {
            break;
        }
    }
    let needed_s = rates.get(at?)?.0;
    let kept_from_s = time_s(list.get(first)?.first_index);
    if needed_s <= kept_from_s + 1e-9 {
        return None;
    }
    let kept: Vec<_> = rates.iter().filter(|r| r.0 > kept_from_s + 1e-9).collect();
    let off = kept.iter().map(|r| (r.2 - rate) * r.1).sum::<f64>() / kept.iter().map(|r| r.1).sum::<f64>();
    Some(Unsettled { needed_s, rate, off })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A step of 40 s at 1000 deg/h that the table reaches after `ramp_s`, in blocks of 0.1 s.
    fn step(ramp_s: f64) -> Vec<Block> {
        let angle = |t: f64| {
            let (rate, ramp) = (1000.0, ramp_s.max(1e-9));
            if t < ramp { 0.5 * rate * t * t / ramp } else { rate * (t - 0.5 * ramp) }
        };
        (0..400)
            .map(|i| Block {
                first_index: i,
                first_row: i + 1,
                samples: 1,
                continues: i > 0,
                gyro: vec![],
                table_rate: 1000.0,
                outer_rate: f64::NAN,
                temperature: f64::NAN,
                beside: vec![],
                angle_first: angle(0.1 * i as f64) + 0.1 * ((i * 7919 % 13) as f64 / 13.0 - 0.5),
                angle_last: 0.0,
            })
            .collect()
    }

    #[test]
    fn a_ramp_into_what_is_evaluated_is_seen_with_the_time_it_needs() {
        let found = of_step(&step(6.0), (0, 40, 400), 0.1, 1000.0).unwrap();
        assert!((found.needed_s - 6.0).abs() < 0.15, "{found:?}");
        // Two seconds with a mean shortfall of a sixth, of 36.
        assert!((found.off / found.rate + 2.0 / 36.0 / 6.0).abs() < 1e-3, "{found:?}");
    }

    #[test]
    fn a_ramp_that_ends_before_is_none() {
        for ramp_s in [0.0, 2.0, 3.9] {
            assert_eq!(of_step(&step(ramp_s), (0, 40, 400), 0.1, 1000.0), None, "{ramp_s}");
        }
    }
}
