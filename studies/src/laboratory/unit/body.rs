//! A fibre-optic gyro as a body: housing with the thermometer, mount, electronics, and a coil of layers between them.

use super::network::Network;
use crate::laboratory::dice::Dice;
use crate::laboratory::environment::span::Span;

/// How quickly heat reaches the coil.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pace {
    /// Within about a minute or two.
    Quick,
    /// Within about 5 to 30 min.
    Slow,
}

/// Temperatures of a body over a span, °C.
pub struct Warmth {
    /// Housing, where the thermometer sits.
    pub housing: Vec<f64>,
    /// Layers of the coil from the spool outwards.
    pub layers: Vec<Vec<f64>>,
    /// Board of the electronics.
    pub board: Vec<f64>,
    /// How far the mean of the coil lags behind the housing in a long ramp, s.
    pub lag_s: f64,
}

/// A body and the number of each of its parts.
pub struct Body {
    network: Network,
    housing: usize,
    board: usize,
    layers: Vec<usize>,
    power_w: f64,
}

impl Body {
    /// Draws a body of 9 to 15 layers.
    pub fn draw(dice: &mut Dice, pace: Pace) -> Body {
        let mut network = Network::default();
        let housing = network.node(dice.uniform(300.0, 700.0));
        let mount = network.node(dice.uniform(60.0, 150.0));
        let board = network.node(dice.uniform(40.0, 90.0));
        network.expose(housing, dice.uniform(1.0, 2.5));
        network.connect(housing, mount, dice.uniform(3.0, 8.0));
        network.connect(board, housing, dice.uniform(0.05, 0.2));
        let count = dice.count(9, 15);
        let each = dice.uniform(3.0, 6.0);
        let layers: Vec<usize> = (0..count).map(|_| network.node(each)).collect();
        let slowness_s = match pace {
            Pace::Quick => dice.decades(40.0, 110.0),
            Pace::Slow => dice.decades(300.0, 1800.0),
        };
        // The coil is warmed from the spool inside and through an air gap outside; the layers conduct between them.
        let total = each * count as f64;
        let inward = total / slowness_s * dice.uniform(0.5, 0.8);
        let outward = total / slowness_s * dice.uniform(0.2, 0.5);
        network.connect(mount, layers[0], inward);
        network.connect(housing, layers[count - 1], outward);
        let through = inward * count as f64 * dice.uniform(0.8, 2.0);
        layers.windows(2).for_each(|w| network.connect(w[0], w[1], through));
        Body { network, housing, board, layers, power_w: dice.uniform(1.0, 4.0) }
    }

    /// Its temperatures in air, settled at the first step unless it was cold until then.
    pub fn run(&self, span: &Span, air_deg_c: &[f64], cold_start: bool) -> Warmth {
        let mut power = vec![0.0; self.network.len()];
        power[self.board] = if cold_start { self.power_w } else { 0.0 };
        let start = vec![air_deg_c[0]; self.network.len()];
        let mut courses = self.network.run(&start, air_deg_c, &power, span.step_s);
        let layers = self.layers.iter().map(|l| std::mem::take(&mut courses[*l])).collect();
        Warmth {
            housing: std::mem::take(&mut courses[self.housing]),
            board: std::mem::take(&mut courses[self.board]),
            layers,
            lag_s: self.lag_s(),
        }
    }

    /// Lag in a ramp of 1 °C/s that lasts until every difference stands still.
    fn lag_s(&self) -> f64 {
        let ramp: Vec<f64> = (0..6000).map(|i| 10.0 * i as f64).collect();
        let start = vec![0.0; self.network.len()];
        let courses = self.network.run(&start, &ramp, &start, 10.0);
        let last = |node: usize| courses[node][5999];
        last(self.housing) - self.layers.iter().map(|l| last(*l)).sum::<f64>() / self.layers.len() as f64
    }
}

impl Warmth {
    /// Mean of the layers.
    pub fn coil(&self) -> Vec<f64> {
        let count = self.layers.len() as f64;
        (0..self.housing.len()).map(|i| self.layers.iter().map(|l| l[i]).sum::<f64>() / count).collect()
    }

    /// The effect of D. Shupe (Appl. Opt. 19 (1980) 654) of a coil wound in layers: changes of temperature count by where
    /// along the fibre they happen, inner and outer halves nearly cancel. In a long ramp of 1 °C/min it is 1.
    pub fn shupe(&self, dice: &mut Dice, span: &Span) -> Vec<f64> {
        let count = self.layers.len();
        let skew = dice.uniform(0.4, 1.2);
        let weights: Vec<f64> = (0..count)
            .map(|l| {
                let place = (l as f64 + 0.5) / count as f64 - 0.5;
                // Pairs of layers run against each other; what their winding leaves over is on one side.
                1.0 + skew * place + 0.3 * if l % 4 < 2 { 1.0 } else { -1.0 }
            })
            .collect();
        let total: f64 = weights.iter().sum();
        let mut sum = vec![0.0; self.housing.len()];
        for (layer, weight) in self.layers.iter().zip(&weights) {
            let change = span.per_minute(layer);
            sum.iter_mut().zip(change).for_each(|(s, c)| *s += weight / total * c);
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn in_a_long_ramp_the_coil_lags_and_the_shupe_term_is_one() {
        let mut dice = Dice::new(4);
        let span = Span { step_s: 1.0, length: 40_000, start_hour: 0.0 };
        for pace in [Pace::Quick, Pace::Slow] {
            let body = Body::draw(&mut dice, pace);
            let air: Vec<f64> = (0..span.length).map(|i| i as f64 / 60.0).collect();
            let warmth = body.run(&span, &air, false);
            let last = span.length - 2;
            let behind = (warmth.housing[last] - warmth.coil()[last]) * 60.0;
            assert!((behind / warmth.lag_s - 1.0).abs() < 0.02, "{behind} {}", warmth.lag_s);
            let shupe = warmth.shupe(&mut dice, &span)[last];
            assert!((shupe - 1.0).abs() < 0.02, "{shupe}");
        }
    }
}
