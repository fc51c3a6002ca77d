//! A damped-cosine process as an exact series of box averages: a complex Ornstein-Uhlenbeck process that turns.

use super::normal;
use crate::noise::composite::Damped;
use nalgebra::Complex;
use rand_xoshiro::Xoshiro256PlusPlus;

/// A running quasi-periodic disturbance.
#[derive(Debug, Clone)]
pub(super) struct Rotating {
    state: Complex<f64>,
    turn: Complex<f64>,
    average: Complex<f64>,
    /// Standard deviation of each part of the innovation of the state.
    innovation: f64,
    /// The innovation of the average is `shared` times that of the state, and a rest.
    shared: Complex<f64>,
    rest: f64,
    rng: Xoshiro256PlusPlus,
}

impl Rotating {
    pub(super) fn new(process: &Damped, tau0_s: f64, mut rng: Xoshiro256PlusPlus) -> Rotating {
        let one = Complex::new(1.0, 0.0);
        let c = process.rate();
        let a = c.re;
        let turn = (-c * tau0_s).exp();
        // z' = −c z + w with E|w|² = q: the real part then has variance rms².
        let q = 4.0 * a * process.rms_deg_h.powi(2);
        let decayed = -(-2.0 * a * tau0_s).exp_m1() / (2.0 * a);
        let state_power = q * decayed;
        let average_power = if (c * tau0_s).norm() < 1e-3 {
            q * tau0_s / 3.0
        } else {
            q / (tau0_s * tau0_s * c.norm_sqr()) * (tau0_s - 2.0 * ((one - turn) / c).re + decayed)
        };
        let cross = q / tau0_s / c * ((one - turn.conj()) / c.conj() - decayed);
        let shared = cross / state_power;
        let rest = (average_power - cross.norm_sqr() / state_power).max(0.0);
        let mut pair = |sigma: f64| Complex::new(sigma * normal(&mut rng), sigma * normal(&mut rng));
        let state = pair(process.rms_deg_h);
        Rotating {
            state,
            turn,
            average: (one - turn) / (c * tau0_s),
            innovation: (0.5 * state_power).sqrt(),
            shared,
            rest: (0.5 * rest).sqrt(),
            rng,
        }
    }

    pub(super) fn next(&mut self) -> f64 {
        let e = Complex::new(normal(&mut self.rng), normal(&mut self.rng)) * self.innovation;
        let mean = self.average * self.state + self.shared * e;
        self.state = self.turn * self.state + e;
        mean.re + self.rest * normal(&mut self.rng)
    }
}
