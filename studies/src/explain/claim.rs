//! The claim as the engineer writes it, its spectrum, and what the truth departs from it within the stated uncertainty.

use super::draw::Draw;
use super::noise::{HOUR_S, quantisation_variance};
use std::f64::consts::PI;
use std::fmt::Write;

/// Rate of the Earth, deg/h.
pub const EARTH_DEG_H: f64 = 15.041067;

/// One standard deviation of what the engineer knows.
#[derive(Clone, Debug, Default)]
pub struct Uncertainty {
    /// Of N, relative.
    pub n_rel: f64,
    /// Of B, relative.
    pub b_rel: f64,
    /// Of K, relative.
    pub k_rel: f64,
    /// Of the bias, deg/h.
    pub bias_deg_h: f64,
    /// Of the temperature coefficient, deg/h per °C.
    pub coefficient: f64,
    /// Of the scale factor, ppm.
    pub scale_ppm: f64,
}

/// An effect that the claim states.
#[derive(Clone, Debug)]
pub struct Stated {
    /// Id of the kind of effect.
    pub kind: String,
    /// Its parameters by their names in the contract.
    pub parameters: Vec<(String, f64)>,
}

/// `model.toml`.
#[derive(Clone, Debug, Default)]
pub struct Claim {
    /// Name of the case.
    pub case: String,
    /// One sentence on it.
    pub description: String,
    /// Sample rate, Hz.
    pub rate_hz: f64,
    /// Columns beside time and rate.
    pub columns: Vec<&'static str>,
    /// N, deg/√h.
    pub n: f64,
    /// B, deg/h.
    pub b: f64,
    /// K, deg/h/√h.
    pub k: f64,
    /// Step of the angle, arcsec; 0 for none.
    pub lsb_arcsec: f64,
    /// Bias, deg/h.
    pub bias_deg_h: f64,
    /// Coefficient, deg/h per °C, and reference, °C.
    pub temperature: Option<(f64, f64)>,
    /// Error of the scale factor, ppm.
    pub scale_ppm: Option<f64>,
    /// Latitude and azimuth, deg.
    pub earth: Option<(f64, f64)>,
    /// What the engineer knows.
    pub uncertainty: Uncertainty,
    /// Effects that the claim states.
    pub stated: Vec<Stated>,
}

/// Departures of the true nuisances from the claim, in the units of [`Uncertainty`].
#[derive(Clone, Debug, Default)]
pub struct Departure {
    /// Of N, relative.
    pub n_rel: f64,
    /// Of B, relative.
    pub b_rel: f64,
    /// Of K, relative.
    pub k_rel: f64,
    /// Of the bias, deg/h.
    pub bias_deg_h: f64,
    /// Of the temperature coefficient, deg/h per °C.
    pub coefficient: f64,
    /// Of the scale factor, ppm.
    pub scale_ppm: f64,
}

impl Departure {
    /// Drawn from the priors, clipped at two standard deviations.
    pub fn drawn(draw: &mut Draw, u: &Uncertainty) -> Departure {
        Departure {
            n_rel: u.n_rel * draw.clipped_normal(),
            b_rel: u.b_rel * draw.clipped_normal(),
            k_rel: u.k_rel * draw.clipped_normal(),
            bias_deg_h: u.bias_deg_h * draw.clipped_normal(),
            coefficient: u.coefficient * draw.clipped_normal(),
            scale_ppm: u.scale_ppm * draw.clipped_normal(),
        }
    }
}

impl Claim {
    /// Variance of a cosine mode at `f`, the terms scaled by 1 + `rel`: what stated quantisation adds included.
    pub fn mode_variance(&self, f: f64, rel: [f64; 3]) -> f64 {
        let [white, flicker, walk] = self.parts(f);
        let s = |r: f64| (1.0 + r).powi(2);
        white * s(rel[0]) + flicker * s(rel[1]) + walk * s(rel[2]) + self.fixed(f)
    }

    /// Variances of a mode by white noise, flicker and random walk.
    pub fn parts(&self, f: f64) -> [f64; 3] {
        let w = 2.0 * PI * f;
        let white = 3600.0 * self.n * self.n;
        [white, self.b * self.b / w, self.k * self.k / (HOUR_S * w * w)].map(|s| s * self.rate_hz)
    }

    /// Variance of a mode by the stated quantisation.
    pub fn fixed(&self, f: f64) -> f64 {
        if self.lsb_arcsec > 0.0 { quantisation_variance(f, self.rate_hz, self.lsb_arcsec) } else { 0.0 }
    }

    /// Standard deviation of one sample's white noise, deg/h.
    pub fn white_sigma(&self) -> f64 {
        60.0 * self.n * self.rate_hz.sqrt()
    }

    /// The text of `model.toml`.
    pub fn toml(&self) -> String {
        let mut t = String::new();
        let columns: Vec<String> = self.columns.iter().map(|c| format!("\"{c}\"")).collect();
        let _ = writeln!(t, "[recording]\ncase = \"{}\"\ndescription = \"{}\"", self.case, self.description);
        let _ = writeln!(t, "sample_rate_hz = {:?}\ncolumns = [{}]", self.rate_hz, columns.join(", "));
        let _ = writeln!(t, "\n[noise]\nN_deg_rt_h = {:?}\nB_deg_h = {:?}", self.n, self.b);
        let _ = writeln!(t, "K_deg_h_rt_h = {:?}\nquantization_lsb_arcsec = {:?}", self.k, self.lsb_arcsec);
        let _ = writeln!(t, "\n[bias]\nvalue_deg_h = {:?}", self.bias_deg_h);
        if let Some((coefficient, reference)) = self.temperature {
            let _ = writeln!(t, "\n[temperature]\ncoefficient_deg_h_per_degC = {coefficient:?}");
            let _ = writeln!(t, "reference_degC = {reference:?}");
        }
        if let Some(ppm) = self.scale_ppm {
            let _ = writeln!(t, "\n[scale_factor]\nerror_ppm = {ppm:?}");
        }
        if let Some((latitude, azimuth)) = self.earth {
            let _ = writeln!(t, "\n[earth]\nlatitude_deg = {latitude:?}\nazimuth_deg = {azimuth:?}");
        }
        let u = &self.uncertainty;
        let _ = writeln!(
            t,
            "\n[uncertainty]\nN_rel = {:?}\nB_rel = {:?}\nK_rel = {:?}",
            u.n_rel, u.b_rel, u.k_rel
        );
        let _ = writeln!(t, "bias_deg_h = {:?}", u.bias_deg_h);
        if self.temperature.is_some() {
            let _ = writeln!(t, "temperature_coefficient_deg_h_per_degC = {:?}", u.coefficient);
        }
        if self.scale_ppm.is_some() {
            let _ = writeln!(t, "scale_factor_ppm = {:?}", u.scale_ppm);
        }
        for effect in &self.stated {
            let _ = writeln!(t, "\n[[effect]]\nkind = \"{}\"\n[effect.parameters]", effect.kind);
            for (name, value) in &effect.parameters {
                let _ = writeln!(t, "{name} = {value:?}");
            }
        }
        t
    }
}

/// `value` rounded to `digits` significant digits, as a person writes it.
pub fn rounded(value: f64, digits: i32) -> f64 {
    if value == 0.0 {
        return 0.0;
    }
    format!("{:.*e}", (digits - 1).max(0) as usize, value).parse().unwrap_or(value)
}
