//! What a study over temperature counts.

use sagnac::estimate::Estimate;

/// Hits of intervals, errors over deviations, number stated.
#[derive(Default)]
pub struct Tally {
    pub inside: usize,
    pub stated: usize,
    asked: usize,
    z: f64,
    z2: f64,
    width: Vec<f64>,
    /// Over the deviation of a fit that is told noise, lag, play and order.
    ratio: Vec<f64>,
}

impl Tally {
    pub fn add(&mut self, e: Option<&Estimate>, truth: f64, told: Option<f64>) {
        self.asked += 1;
        let Some((value, i)) = e.and_then(|e| Some((e.value?, e.interval95()?))) else { return };
        self.stated += 1;
        self.inside += usize::from((i.low..=i.high).contains(&truth));
        let u = (i.high - i.low) / 3.92;
        self.z += (value - truth) / u;
        self.z2 += ((value - truth) / u).powi(2);
        self.width.push(u);
        self.ratio.extend(told.map(|t| u / t));
    }

    fn coverage(&self) -> f64 {
        self.inside as f64 / self.stated.max(1) as f64
    }

    pub fn say(&mut self, name: &str) {
        self.width.sort_by(f64::total_cmp);
        let n = self.stated.max(1) as f64;
        let median = self.width.get(self.width.len() / 2).copied().unwrap_or(f64::NAN);
        self.ratio.sort_by(f64::total_cmp);
        let ratio = self.ratio.get(self.ratio.len() / 2).copied().unwrap_or(f64::NAN);
        eprintln!(
            "{name:<42} stated {:>4}/{:<4} covered {:.3}  mean z {:+.3}  rms z {:.3}  median u {median:.3e}  over told {ratio:.2}",
            self.stated,
            self.asked,
            self.coverage(),
            self.z / n,
            (self.z2 / n).sqrt(),
        );
    }
}
