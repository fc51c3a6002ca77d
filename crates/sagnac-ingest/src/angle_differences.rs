//! Angles that add up from the beginning, turned into rates: the difference of neighbouring samples over the interval.

use super::plan::Plan;
use sagnac_core::recording::Role;

/// A full turn, arcsec.
const TURN: f64 = 360.0 * 3600.0;

/// One accumulated angle.
struct Angle {
    slot: usize,
    /// Declared angle after which it starts again, arcsec.
    period: Option<f64>,
    last: f64,
}

/// An angle started again.
pub(super) struct AngleRollover {
    /// Row among those given.
    pub row: usize,
    pub slot: usize,
    /// Angle after which it started again, arcsec.
    pub period: f64,
}

/// The accumulated angles of a recording.
pub(super) struct Angles {
    list: Vec<Angle>,
    interval_s: f64,
}

impl Angles {
    pub fn new(plan: &Plan<'_>) -> Angles {
        let slots = plan.channels.iter().enumerate().filter(|(_, c)| c.role == Role::AccumulatedAngle);
        let list = slots
            .map(|(slot, _)| Angle {
                slot,
                period: plan.angle_periods.get(slot).copied().flatten().filter(|p| *p > 0.0),
                last: f64::NAN,
            })
            .collect();
        Angles { list, interval_s: plan.increment_s }
    }

    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// Rows with rates in place of angles, without the first row where a stretch begins; and the roll-overs.
    pub fn differences(&mut self, values: &[Vec<f64>], begins: bool) -> (Vec<Vec<f64>>, Vec<AngleRollover>) {
        let skipped = usize::from(begins);
        let mut out: Vec<Vec<f64>> =
            values.iter().map(|v| v.get(skipped..).unwrap_or_default().to_vec()).collect();
        let mut wraps = Vec::new();
        for angle in &mut self.list {
            let Some(own) = values.get(angle.slot) else { continue };
            if begins {
                angle.last = own.first().copied().unwrap_or(f64::NAN);
            }
            let Some(rates) = out.get_mut(angle.slot) else { continue };
            for (i, value) in rates.iter_mut().enumerate() {
                let mut step = *value - angle.last;
                if let Some(period) = wrap(angle, *value, step) {
                    step -= period * (step / period).round();
                    wraps.push(AngleRollover { row: i + skipped, slot: angle.slot, period });
                }
                angle.last = *value;
                *value = step / self.interval_s;
            }
        }
        (out, wraps)
    }
}

/// The period by which an angle started again in this step. Without a declared one, a step of more than half a turn
/// between angles within one turn is a roll-over at the full turn.
fn wrap(angle: &Angle, value: f64, step: f64) -> Option<f64> {
    match angle.period {
        Some(period) => (step.abs() > 0.5 * period).then_some(period),
        None => {
            let within = |v: f64| v.abs() <= 1.000_001 * TURN;
            (step.abs() > 0.5 * TURN && within(value) && within(angle.last)).then_some(TURN)
        }
    }
}
