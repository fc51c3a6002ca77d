//! Simulated units as the comparison sees them.

use sagnac::noise::block_series::BlockSeriesAccumulator;
use sagnac::noise::composite::{Composite, Sampling};
use sagnac::noise::identify::Identification;
use sagnac::noise::simulate::{Setup, Simulator};
use sagnac::noise::spectral_record::SpectralRecord;
use sagnac::noise::windows::{WindowMeans, WindowStatistics};

/// A simulated record with what was identified from it.
pub struct Unit {
    pub samples: Vec<f64>,
    pub tau0_s: f64,
    pub found: Identification,
}

impl Unit {
    pub fn simulate(model: &Composite, hours: f64, tau0_s: f64, seed: u64) -> Unit {
        let count = (hours * 3600.0 / tau0_s).round() as usize;
        let setup = Setup { bias_deg_h: 0.37, ..Setup::for_record(seed, tau0_s, count as u64) };
        let samples = Simulator::of(model, &setup).take(count);
        let mut blocks = BlockSeriesAccumulator::default();
        blocks.push(&samples, 0);
        let record = SpectralRecord {
            blocks: &blocks.finish(),
            welch: None,
            tau0_s,
            lines: &[],
            sampling: Sampling::Averaging,
        };
        let found = record.identify("rate").identification;
        Unit { samples, tau0_s, found }
    }

    pub fn windows(&self, window_s: f64) -> WindowStatistics {
        let mut means = WindowMeans::new(window_s, self.tau0_s);
        means.push(&self.samples, false);
        means.finish()
    }
}

pub fn share(a: usize, b: usize) -> f64 {
    a as f64 / b.max(1) as f64
}
