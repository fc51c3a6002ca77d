//! What bins under a Hann window show of a damped process on average: what a resonance narrower than the window becomes.

use super::{Damped, Sampling};
use nalgebra::Complex;
use std::f64::consts::PI;

/// The bins of one segment length. All that no frequency enters is computed once; records have a thousand bins and a fit
/// asks for them hundreds of times.
#[derive(Debug, Clone, Copy)]
pub struct Windowed {
    gamma0: f64,
    first: Complex<f64>,
    rho: Complex<f64>,
    /// ρ^(L − 1).
    last: Complex<f64>,
    /// e^(2πi/L).
    bin: Complex<f64>,
    segment: f64,
    tau_s: f64,
    scale: f64,
}

fn turn(phase: f64) -> Complex<f64> {
    let (sin, cos) = phase.sin_cos();
    Complex::new(cos, sin)
}

impl Windowed {
    /// Two-sided density at `frequency_hz`, (deg/h)²/Hz.
    pub fn density(&self, frequency_hz: f64) -> f64 {
        let l = self.segment;
        let one = Complex::new(1.0, 0.0);
        // Autocorrelation of the window: (1 − x)(2 + cos 2πx)/3 + sin(2πx)/(2π), x = d/L.
        let theta = 2.0 * PI * frequency_hz * self.tau_s;
        let (here, round) = (turn(theta), turn(theta * l));
        let odd = 1.0 / (4.0 * PI);
        let mut sum = Complex::new(0.0, 0.0);
        for (side, round) in [(here, round), (here.conj(), round.conj())] {
            let weights =
                [(self.bin.conj(), 1.0 / 6.0, odd), (one, 2.0 / 3.0, 0.0), (self.bin, 1.0 / 6.0, -odd)];
            for (shift, even, odd) in weights {
                let u = side * shift;
                let z = self.rho * u;
                // A turn by a whole bin is none after L samples.
                let last = self.last * round * u.conj();
                let inverse = one / (one - z);
                let plain = u * (one - last) * inverse;
                let weighted = u * (one - last * l + last * z * (l - 1.0)) * inverse * inverse;
                sum += (plain - weighted / l) * even + plain * Complex::new(0.0, odd);
            }
        }
        (self.scale * (self.gamma0 + (self.first * sum).re)).max(0.0)
    }
}

impl Damped {
    /// The bins of segments of `segment` samples over `tau_s`.
    pub fn windowed(&self, segment: usize, tau_s: f64, sampling: Sampling) -> Windowed {
        let (gamma0, first, rho) = self.covariance(tau_s, sampling);
        let l = segment as f64;
        Windowed {
            gamma0,
            first,
            rho,
            last: rho.powf(l - 1.0),
            bin: turn(2.0 * PI / l),
            segment: l,
            tau_s,
            scale: self.rms_deg_h.powi(2) * tau_s,
        }
    }
}
