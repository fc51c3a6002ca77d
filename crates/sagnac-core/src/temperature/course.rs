//! The temperature of the coil from that of the sensor, and the regressors that follow from it.

/// Rate and temperature of a recording as block means on a grid without holes: what the model is fitted to.
#[derive(Debug, Clone, PartialEq)]
pub struct Course {
    /// Length of a block, s.
    pub block_s: f64,
    /// Start of the first block, s from the start of the recording.
    pub first_s: f64,
    /// Rate, deg/h.
    pub rate_deg_h: Vec<f64>,
    /// Temperature of the sensor, degC.
    pub temperature_deg_c: Vec<f64>,
    /// Share of blocks that hold nothing and were bridged by straight lines.
    pub bridged: f64,
}

/// The nonlinear parameters of the model: lag of the coil and play of the hysteresis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shape {
    /// Time constant of the coil behind the sensor, s.
    pub lag_s: f64,
    /// Half width of the play of the hysteresis, degC.
    pub play_deg_c: f64,
}

impl Shape {
    /// From a drawn vector of nonlinear parameters: the lag, then the play where there is one.
    pub fn of(numbers: &[f64], play_deg_c: f64) -> Shape {
        Shape {
            lag_s: numbers.first().copied().unwrap_or(0.0),
            play_deg_c: numbers.get(1).copied().unwrap_or(play_deg_c),
        }
    }
}

/// Which terms a model of the bias over temperature has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Terms {
    /// Order of the polynomial in temperature.
    pub order: usize,
    /// Sensitivity to the rate of temperature.
    pub rate: bool,
    /// Rate-independent hysteresis.
    pub hysteresis: bool,
}

/// Temperatures that the polynomial is scaled to: −1 and +1 of its argument.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Span {
    /// Lowest, degC.
    pub low: f64,
    /// Highest, degC.
    pub high: f64,
}

impl Span {
    /// Argument of the polynomial at a temperature.
    pub fn argument(&self, deg_c: f64) -> f64 {
        (2.0 * deg_c - self.low - self.high) / (self.high - self.low)
    }

    /// Temperature at an argument.
    pub fn temperature(&self, x: f64) -> f64 {
        0.5 * (self.low + self.high) + 0.5 * x * (self.high - self.low)
    }
}

impl Terms {
    /// Position of the coefficient of the rate of temperature.
    pub fn rate_at(&self) -> Option<usize> {
        self.rate.then_some(self.order)
    }

    /// Position of the coefficient of the hysteresis.
    pub fn hysteresis_at(&self) -> Option<usize> {
        self.hysteresis.then_some(self.order + usize::from(self.rate))
    }

    /// Number of coefficients.
    pub fn count(&self) -> usize {
        self.order + usize::from(self.rate) + usize::from(self.hysteresis)
    }
}

/// Legendre polynomials 1 to `order`: orthogonal over temperature with even weight.
pub fn legendre(x: f64, order: usize) -> Vec<f64> {
    let mut values = Vec::with_capacity(order);
    each_legendre(x, order, |_, v| values.push(v));
    values
}

fn each_legendre(x: f64, order: usize, mut take: impl FnMut(usize, f64)) {
    let (mut before, mut here) = (1.0, x);
    for k in 0..order {
        take(k, here);
        let n = (k + 1) as f64;
        (before, here) = (here, ((2.0 * n + 1.0) * x * here - n * before) / (n + 1.0));
    }
}

/// Derivatives of the Legendre polynomials 1 to `order`.
pub fn legendre_slopes(x: f64, order: usize) -> Vec<f64> {
    // P'ₖ₊₁ = P'ₖ₋₁ + (2k + 1) Pₖ.
    let values = legendre(x, order);
    let mut slopes: Vec<f64> = Vec::with_capacity(order);
    for k in 1..=order {
        let two_before = if k >= 3 { slopes[k - 3] } else { 0.0 };
        let one_before = if k >= 2 { values[k - 2] } else { 1.0 };
        slopes.push(two_before + (2.0 * k as f64 - 1.0) * one_before);
    }
    slopes
}

/// Temperature of the coil: a first-order lag behind the sensor, which runs straight between the middles of blocks. The
/// coil starts at the temperature of the sensor.
pub fn lagged(sensor: &[f64], block_s: f64, lag_s: f64) -> Vec<f64> {
    if lag_s < 1e-3 * block_s {
        return sensor.to_vec();
    }
    let a = (-block_s / lag_s).exp();
    let share = lag_s / block_s * (1.0 - a);
    let mut coil = sensor.first().copied().unwrap_or(0.0);
    let mut before = coil;
    sensor
        .iter()
        .map(|&now| {
            coil = a * coil + now - a * before - (now - before) * share;
            before = now;
            coil
        })
        .collect()
}

/// Rate of a temperature, degC/min: straight lines through `reach` blocks on each side.
pub fn rate_per_minute(temperature: &[f64], block_s: f64, reach: usize) -> Vec<f64> {
    let n = temperature.len();
    (0..n)
        .map(|i| {
            let m = reach.min(i).min(n - 1 - i);
            if m == 0 {
                let (a, b) = (i.saturating_sub(1), (i + 1).min(n - 1));
                return (temperature[b] - temperature[a]) / ((b - a).max(1) as f64 * block_s) * 60.0;
            }
            let (mut top, mut bottom) = (0.0, 0.0);
            for k in 1..=m {
                top += k as f64 * (temperature[i + k] - temperature[i - k]);
                bottom += 2.0 * (k * k) as f64;
            }
            top / bottom / block_s * 60.0
        })
        .collect()
}

/// State of a play of half width `play`: −1 after cooling, +1 after heating, between while it turns round.
pub fn play_state(temperature: &[f64], play: f64) -> Vec<f64> {
    let mut centre = temperature.first().copied().unwrap_or(0.0);
    let mut state = 0.0;
    temperature
        .iter()
        .map(|&t| {
            centre = centre.clamp(t - play, t + play);
            if play > 0.0 {
                state = (t - centre) / play;
            }
            state
        })
        .collect()
}

impl Course {
    /// Blocks on each side that the rate of temperature is read from: about a minute.
    fn reach(&self) -> usize {
        ((60.0 / self.block_s).round() as usize).clamp(1, 60)
    }

    /// Temperature of the coil.
    pub fn coil(&self, shape: &Shape) -> Vec<f64> {
        lagged(&self.temperature_deg_c, self.block_s, shape.lag_s)
    }

    /// The regressors in time: Legendre polynomials of the coil's temperature, its rate in degC/min, the state of the
    /// play.
    pub fn columns(&self, terms: &Terms, shape: &Shape, span: &Span) -> Vec<Vec<f64>> {
        let coil = self.coil(shape);
        let mut columns = vec![Vec::with_capacity(coil.len()); terms.order];
        for t in &coil {
            each_legendre(span.argument(*t), terms.order, |k, v| columns[k].push(v));
        }
        if terms.rate {
            columns.push(rate_per_minute(&coil, self.block_s, self.reach()));
        }
        if terms.hysteresis {
            columns.push(play_state(&coil, shape.play_deg_c));
        }
        columns
    }

    /// Lowest and highest temperature, degC.
    pub fn span(&self) -> Span {
        let fold = |(l, h): (f64, f64), v: &f64| (l.min(*v), h.max(*v));
        let (low, high) = self.temperature_deg_c.iter().fold((f64::INFINITY, f64::NEG_INFINITY), fold);
        Span { low, high }
    }

    /// Means over `factor` blocks; a rest that does not fill one is left out.
    pub fn merged(&self, factor: usize) -> Course {
        let mean = |v: &[f64]| -> Vec<f64> {
            v.chunks_exact(factor.max(1)).map(|c| c.iter().sum::<f64>() / c.len() as f64).collect()
        };
        Course {
            block_s: self.block_s * factor.max(1) as f64,
            rate_deg_h: mean(&self.rate_deg_h),
            temperature_deg_c: mean(&self.temperature_deg_c),
            ..*self
        }
    }

    /// Number of blocks.
    pub fn len(&self) -> usize {
        self.rate_deg_h.len()
    }

    /// True when there is none.
    pub fn is_empty(&self) -> bool {
        self.rate_deg_h.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_lag_is_that_of_the_differential_equation() {
        // A ramp of slope r that starts from rest: T − r τ (1 − e^{−t/τ}) behind the sensor.
        let (block_s, lag_s, r) = (20.0, 600.0, 0.01);
        let sensor: Vec<f64> = (0..300).map(|i| r * i as f64 * block_s).collect();
        for (i, coil) in lagged(&sensor, block_s, lag_s).iter().enumerate() {
            let t = i as f64 * block_s;
            let exact = r * (t - lag_s * (1.0 - (-t / lag_s).exp()));
            assert!((coil - exact).abs() < 1e-9, "{i}: {coil} {exact}");
        }
    }

    #[test]
    fn legendre_polynomials_and_their_slopes() {
        for x in [-1.0, -0.3, 0.0, 0.7, 1.0f64] {
            let p = legendre(x, 4);
            assert!((p[1] - 0.5 * (3.0 * x * x - 1.0)).abs() < 1e-14);
            assert!((p[3] - (35.0 * x.powi(4) - 30.0 * x * x + 3.0) / 8.0).abs() < 1e-14);
            let d = legendre_slopes(x, 4);
            assert!((d[0] - 1.0).abs() < 1e-14 && (d[1] - 3.0 * x).abs() < 1e-14);
            assert!((d[2] - 0.5 * (15.0 * x * x - 3.0)).abs() < 1e-14);
            assert!((d[3] - (140.0 * x.powi(3) - 60.0 * x) / 8.0).abs() < 1e-13);
        }
    }

    #[test]
    fn the_play_turns_round_over_its_width() {
        let up: Vec<f64> = (0..=20).map(f64::from).collect();
        let there_and_back: Vec<f64> = up.iter().chain(up.iter().rev()).copied().collect();
        let s = play_state(&there_and_back, 2.0);
        assert_eq!((s[0], s[1], s[10], s[20]), (0.0, 0.5, 1.0, 1.0));
        assert_eq!((s[23], s[25], s[41]), (0.0, -1.0, -1.0));
    }

    #[test]
    fn the_rate_of_a_straight_course_is_its_slope() {
        let t: Vec<f64> = (0..50).map(|i| 0.25 * f64::from(i)).collect();
        assert!(rate_per_minute(&t, 30.0, 3).iter().all(|r| (r - 0.5).abs() < 1e-12));
    }
}
