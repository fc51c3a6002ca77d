//! Hysteresis of many small loops: a coil whose turns stick and slip each at its own difference of temperature.

use crate::laboratory::dice::Dice;

/// Play elements of distributed widths and weights (M. Brokate and J. Sprekels, Hysteresis and Phase Transitions, 1996).
#[derive(Debug, Clone)]
pub struct Hysteresis {
    /// Half width and weight of each.
    elements: Vec<[f64; 2]>,
}

impl Hysteresis {
    /// Draws 60 to 100 elements, their half widths spread over decades about a typical one.
    pub fn draw(dice: &mut Dice, typical: f64) -> Hysteresis {
        let count = dice.count(60, 100);
        let elements = (0..count)
            .map(|_| [typical * (0.7 * dice.normal()).exp(), dice.uniform(0.2, 1.0) / count as f64]);
        Hysteresis { elements: elements.collect() }
    }

    /// Its course under a driver, from a state that an earlier life left: each element anywhere within its play.
    pub fn run(&self, dice: &mut Dice, driver: &[f64]) -> Vec<f64> {
        let mut sum = vec![0.0; driver.len()];
        for [half, weight] in &self.elements {
            let mut state = driver[0] + half * dice.uniform(-1.0, 1.0);
            for (s, x) in sum.iter_mut().zip(driver) {
                state = state.clamp(x - half, x + half);
                *s += weight * state;
            }
        }
        sum
    }
}

/// Largest difference of a course between rising and falling driver at the same value, over 30 bins.
pub fn loop_width(driver: &[f64], course: &[f64]) -> f64 {
    let (low, high) = driver.iter().fold((f64::MAX, f64::MIN), |(l, h), x| (l.min(*x), h.max(*x)));
    let mut up = [[0.0f64; 2]; 30];
    let mut down = [[0.0f64; 2]; 30];
    let stride = (driver.len() / 2000).max(1);
    for i in (stride..driver.len()).step_by(stride) {
        let bin = ((driver[i] - low) / (high - low).max(1e-12) * 29.999) as usize;
        let change = driver[i] - driver[i - stride];
        if change.abs() > 0.002 * (high - low) {
            let of = if change > 0.0 { &mut up } else { &mut down };
            of[bin][0] += course[i];
            of[bin][1] += 1.0;
        }
    }
    let both = up.iter().zip(&down).filter(|(u, d)| u[1] > 0.0 && d[1] > 0.0);
    both.map(|(u, d)| (u[0] / u[1] - d[0] / d[1]).abs()).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cycle_opens_a_loop_that_does_not_depend_on_its_pace() {
        let hysteresis = Hysteresis::draw(&mut Dice::new(5), 4.0);
        let cycle = |n: usize| -> Vec<f64> {
            (0..4 * n).map(|i| 20.0 * (std::f64::consts::TAU * i as f64 / n as f64).sin()).collect()
        };
        let width = |n: usize| {
            let driver = cycle(n);
            let course = hysteresis.run(&mut Dice::new(6), &driver);
            // The first cycle depends on the earlier life.
            loop_width(&driver[n..], &course[n..])
        };
        let (fast, slow) = (width(1000), width(8000));
        assert!(fast > 1.0 && (fast / slow - 1.0).abs() < 0.1, "{fast} {slow}");
    }
}
