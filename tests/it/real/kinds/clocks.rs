//! Clock data against Stable32.

use super::{columns, table};
use crate::support::real::set;
use sagnac::noise::allan::{AllanAccumulator, AllanPlan};
use sagnac::noise::family::Estimator;
use sagnac::noise::tau_grid::TauGrid;
use std::path::Path;

/// Largest relative difference from Stable32 for a statistic of one of its files.
fn against_stable32(folder: &Path, file: &str, rate: &[f64], statistic: &str, estimator: Estimator) -> f64 {
    let wanted: Vec<(u64, f64)> = table(&folder.join("stable32_reference.csv"))
        .iter()
        .filter(|r| r["file"] == file && r["statistic"] == statistic)
        .map(|r| (r["averaging_factor"].parse().unwrap(), r["sigma"].parse().unwrap()))
        .collect();
    assert!(wanted.len() >= 8, "{file} {statistic}");
    let mut allan = AllanAccumulator::new(AllanPlan {
        tau0_s: 1.0,
        grid: TauGrid::List(wanted.iter().map(|w| w.0 as f64).collect()),
        exact: true,
        estimators: vec![estimator],
    });
    allan.push(rate, 0, false);
    let set = allan.finish();
    let points = &set.curve(estimator).unwrap().points;
    let mut worst: f64 = 0.0;
    for (m, sigma) in wanted {
        let ours = points.iter().find(|p| p.m == m).unwrap_or_else(|| panic!("{file} {statistic} m {m}"));
        worst = worst.max((ours.deviation / sigma - 1.0).abs());
    }
    println!("{file} {statistic}: {worst:.1e}");
    worst
}

#[test]
fn clock_data_gives_the_numbers_of_stable32() {
    let Some(folder) = set("ref_stable32_frequency_data") else { return };
    let steps = |file: &str| {
        let phase = columns(&folder.join(file), &["phase_s"]).remove(0);
        phase.windows(2).map(|w| w[1] - w[0]).collect::<Vec<f64>>()
    };
    let ocxo: Vec<f64> = columns(&folder.join("ocxo_frequency.csv.gz"), &["freq_hz"])
        .remove(0)
        .into_iter()
        .map(|f| (f - 1e7) / 1e7)
        .collect();
    let files = [
        ("cs5071a_phase", steps("cs5071a_phase.csv.gz"), 1e-4),
        ("phase_dat", steps("phase_dat.csv"), 1e-4),
        ("tic53230a_phase", steps("tic53230a_phase.csv.gz"), 1e-4),
        // Stable32 was fed differently rounded data there.
        ("ocxo_frequency", ocxo, 2e-3),
    ];
    for (file, rate, tolerance) in files {
        for (statistic, estimator) in
            [("oadev", Estimator::Allan), ("mdev", Estimator::Modified), ("ohdev", Estimator::Hadamard)]
        {
            let worst = against_stable32(&folder, file, &rate, statistic, estimator);
            assert!(worst < tolerance, "{file} {statistic}: {worst:e}");
        }
    }
}
