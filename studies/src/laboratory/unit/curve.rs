//! A static dependence that is no polynomial: smooth steps, bends and a kink.

use crate::laboratory::dice::Dice;

/// A curve of a sum of logistic steps, an arcus tangens and a kink over a range.
#[derive(Debug, Clone)]
pub struct Curve {
    steps: Vec<[f64; 3]>,
    bend: [f64; 3],
    kink: [f64; 2],
}

impl Curve {
    /// Draws a curve over a range.
    pub fn draw(dice: &mut Dice, low: f64, high: f64) -> Curve {
        let width = high - low;
        let steps = (0..dice.count(1, 3))
            .map(|_| {
                [
                    dice.uniform(low, high),
                    width * dice.uniform(0.06, 0.3),
                    dice.sign() * dice.uniform(0.4, 1.0),
                ]
            })
            .collect();
        let bend = [dice.uniform(low, high), width * dice.uniform(0.1, 0.4), dice.uniform(-0.6, 0.6)];
        Curve {
            steps,
            bend,
            kink: [dice.uniform(low + 0.2 * width, high - 0.2 * width), dice.uniform(-1.5, 1.5) / width],
        }
    }

    /// Its value.
    pub fn at(&self, x: f64) -> f64 {
        let steps: f64 =
            self.steps.iter().map(|[at, width, size]| size / (1.0 + (-(x - at) / width).exp())).sum();
        let [at, width, size] = self.bend;
        steps + size * ((x - at) / width).atan() + self.kink[1] * (x - self.kink[0]).max(0.0)
    }
}

/// A course less its best straight line on another, by least squares.
pub fn without_line(course: &[f64], on: &[f64]) -> Vec<f64> {
    let n = course.len() as f64;
    let (my, mx) = (course.iter().sum::<f64>() / n, on.iter().sum::<f64>() / n);
    let sxx: f64 = on.iter().map(|x| (x - mx) * (x - mx)).sum();
    let sxy: f64 = on.iter().zip(course).map(|(x, y)| (x - mx) * (y - my)).sum();
    let slope = if sxx > 0.0 { sxy / sxx } else { 0.0 };
    course.iter().zip(on).map(|(y, x)| y - my - slope * (x - mx)).collect()
}
