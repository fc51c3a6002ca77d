//! The claimed simulation of a recording, and `model.toml`.

use super::noise::Levels;
use std::collections::BTreeMap;
use std::fmt::Write;

/// Rate of the Earth, deg/h.
pub const EARTH_DEG_H: f64 = 15.041067;

/// Columns with a role of their own in the contract.
const KNOWN: [&str; 5] = ["temp_degC", "table_rate_deg_s", "table_angle_deg", "outer_rate_deg_s", "supply_v"];

/// Recorded columns besides time and rate, by name.
pub type Columns = BTreeMap<String, Vec<f64>>;

/// What the engineer believes.
#[derive(Debug, Clone)]
pub struct Claim {
    /// Sample rate, Hz.
    pub rate_hz: f64,
    /// Free text.
    pub description: String,
    /// Noise.
    pub levels: Levels,
    /// Relative uncertainties of N, B and K.
    pub levels_rel: [f64; 3],
    /// Bias, deg/h.
    pub bias_deg_h: f64,
    /// Its uncertainty.
    pub bias_sd_deg_h: f64,
    /// Temperature coefficient, deg/h/°C, its reference temperature and its uncertainty.
    pub temperature: Option<[f64; 3]>,
    /// Known scale factor error and its uncertainty, ppm.
    pub scale_ppm: Option<[f64; 2]>,
    /// Latitude and azimuth, deg.
    pub earth_deg: Option<[f64; 2]>,
}

impl Claim {
    /// The claimed mean, deg/h per row.
    pub fn mean(&self, columns: &Columns, rows: usize) -> Vec<f64> {
        let mut mean = vec![self.bias_deg_h; rows];
        if let (Some([coefficient, reference, _]), Some(deg_c)) = (self.temperature, columns.get("temp_degC"))
        {
            mean.iter_mut().zip(deg_c).for_each(|(m, t)| *m += coefficient * (t - reference));
        }
        if let Some(rate) = columns.get("table_rate_deg_s") {
            let factor = 3600.0 * (1.0 + 1e-6 * self.scale_ppm.map_or(0.0, |[ppm, _]| ppm));
            mean.iter_mut().zip(rate).for_each(|(m, r)| *m += factor * r);
        }
        if let (Some([latitude, azimuth]), Some(angle)) = (self.earth_deg, columns.get("table_angle_deg")) {
            let level = EARTH_DEG_H * latitude.to_radians().cos();
            mean.iter_mut().zip(angle).for_each(|(m, a)| *m += level * (a + azimuth).to_radians().cos());
        }
        mean
    }

    /// The text of `model.toml`.
    pub fn toml(&self, case: &str, columns: &Columns) -> String {
        let mut names = vec!["time_s".to_owned(), "rate_deg_h".to_owned()];
        // The author lists what he knows of; the laboratory recorded more.
        names.extend(columns.keys().filter(|c| KNOWN.contains(&c.as_str())).cloned());
        let Levels { n, b, k } = self.levels;
        let mut text = format!(
            "[recording]\ncase = {case:?}\ndescription = {:?}\nsample_rate_hz = {}\ncolumns = {names:?}\n\n\
             [noise]\nN_deg_rt_h = {n}\nB_deg_h = {b}\nK_deg_h_rt_h = {k}\nquantization_lsb_arcsec = 0.0\n\n\
             [bias]\nvalue_deg_h = {}\n",
            self.description, self.rate_hz, self.bias_deg_h
        );
        let [n_rel, b_rel, k_rel] = self.levels_rel;
        let mut uncertainty = format!(
            "\n[uncertainty]\nN_rel = {n_rel}\nB_rel = {b_rel}\nK_rel = {k_rel}\nbias_deg_h = {}\n",
            self.bias_sd_deg_h
        );
        // Writing to a text cannot fail.
        if let Some([coefficient, reference, sd]) = self.temperature {
            let _ = writeln!(
                text,
                "\n[temperature]\ncoefficient_deg_h_per_degC = {coefficient}\nreference_degC = {reference}"
            );
            let _ = writeln!(uncertainty, "temperature_coefficient_deg_h_per_degC = {sd}");
        }
        if let Some([ppm, sd]) = self.scale_ppm {
            let _ = writeln!(text, "\n[scale_factor]\nerror_ppm = {ppm}");
            let _ = writeln!(uncertainty, "scale_factor_ppm = {sd}");
        }
        if let Some([latitude, azimuth]) = self.earth_deg {
            let _ = writeln!(text, "\n[earth]\nlatitude_deg = {latitude}\nazimuth_deg = {azimuth}");
        }
        text + &uncertainty
    }
}
