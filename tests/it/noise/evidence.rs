//! Spectral evidence from whole records, long records, records with gaps, records with lines.

use sagnac::noise::data::{BlockSeries, WelchSpectrum};
use sagnac::noise::evidence::{Evidence, Mask};
use sagnac::noise::identification::Identification;
use sagnac::noise::identification::{self, Options};
use sagnac::noise::model::{NoiseModel, TERMS};
use sagnac::noise::simulate::{Setup, Simulator};
use sagnac_fft::real_forward;

/// Block means of a record in which NaN marks what is missing.
fn blocks(samples: &[f64], block_len: usize) -> BlockSeries {
    let mut out = BlockSeries { block_len: block_len as u64, ..Default::default() };
    for chunk in samples.chunks_exact(block_len) {
        let usable: Vec<f64> = chunk.iter().copied().filter(|v| v.is_finite()).collect();
        out.count.push(usable.len() as u32);
        out.mean.push(usable.iter().sum::<f64>() / usable.len() as f64);
    }
    out
}

/// Averaged periodogram as the contract of `WelchSpectrum` states it.
fn welch(samples: &[f64], segment_len: usize) -> WelchSpectrum {
    let plan = real_forward(segment_len);
    let window: Vec<f64> = (0..segment_len)
        .map(|i| 0.5 - 0.5 * (2.0 * std::f64::consts::PI * i as f64 / segment_len as f64).cos())
        .collect();
    let norm: f64 = window.iter().map(|w| w * w).sum();
    let mut density = vec![0.0; segment_len / 2 + 1];
    let (mut segments, mut from) = (0u64, 0);
    while from + segment_len <= samples.len() {
        let part = &samples[from..from + segment_len];
        let mean = part.iter().sum::<f64>() / segment_len as f64;
        let mut input: Vec<f64> = part.iter().zip(&window).map(|(y, w)| (y - mean) * w).collect();
        let mut output = plan.make_output_vec();
        plan.process(&mut input, &mut output).unwrap();
        for (d, o) in density.iter_mut().zip(&output) {
            *d += o.norm_sqr() / norm;
        }
        segments += 1;
        from += segment_len / 2;
    }
    density.iter_mut().for_each(|d| *d /= segments as f64);
    // Half overlap.
    let averages = 0.947 * segments as f64;
    WelchSpectrum { segment_len, segments, effective_averages: averages, averages_in_sums: averages, density }
}

fn identify(evidence: &Evidence) -> Identification {
    identification::identify("rate", evidence, &Options::standard_terms())
}

#[test]
fn expected_evidence_is_the_mean_of_simulated_evidence() {
    let model = NoiseModel { n: 0.002, b: 0.01, k: 0.01, r: 0.002, q: 0.2 };
    let (samples, tau0_s, runs) = (1024, 10.0, 400);
    let expected = Evidence::expected(&model, samples as u64, tau0_s);
    let mut mean = vec![0.0; expected.bands.len()];
    for run in 0..runs {
        let setup = Setup { bias_deg_h: 3.33, ..Setup::for_record(run, tau0_s, samples as u64) };
        let y = Simulator::new(&model, &setup).take(samples);
        let evidence = Evidence::new(&blocks(&y, 1), None, tau0_s, &[]);
        assert_eq!(evidence.bands.len(), expected.bands.len());
        for (m, band) in mean.iter_mut().zip(&evidence.bands) {
            *m += band.power / runs as f64;
        }
    }
    let mut square = 0.0;
    for (m, band) in mean.iter().zip(&expected.bands) {
        // The ramp is not random: only what is left of the power scatters.
        let random = band.power - model.r * model.r * band.ramp;
        let sigma = (2.0 / (band.dof * runs as f64)).sqrt() * (random * (2.0 * band.power - random)).sqrt();
        let z = (m - band.power) / sigma;
        assert!(z.abs() < 4.5, "{} Hz: {z}", band.low_hz);
        square += z * z;
    }
    let per_band = square / mean.len() as f64;
    assert!((0.6..1.5).contains(&per_band), "{per_band}");
}

#[test]
fn a_long_record_is_described_by_blocks_and_periodogram_together() {
    let model = NoiseModel { n: 0.002, b: 0.02, ..Default::default() };
    let (samples, tau0_s) = (1 << 18, 0.5);
    let mut sums = [[0.0; 2]; 2];
    for run in 0..12 {
        let y = Simulator::new(&model, &Setup::for_record(run + 50, tau0_s, samples as u64)).take(samples);
        let whole = Evidence::new(&blocks(&y, 1), None, tau0_s, &[]);
        let two = Evidence::new(&blocks(&y, 16), Some(&welch(&y, 1024)), tau0_s, &[]);
        assert!((two.dof() / whole.dof() - 1.0).abs() < 0.06, "{} {}", two.dof(), whole.dof());
        for pair in two.bands.windows(2) {
            assert!(pair[0].high_hz < pair[1].low_hz, "bands overlap");
        }
        for (sum, evidence) in sums.iter_mut().zip([&whole, &two]) {
            let found = identify(evidence);
            sum[0] += found.angle_random_walk.value.unwrap() / model.n / 12.0;
            sum[1] += found.bias_instability.value.unwrap() / model.b / 12.0;
        }
    }
    for i in 0..2 {
        assert!((sums[0][i] - 1.0).abs() < 0.03, "{sums:?}");
        assert!((sums[1][i] - sums[0][i]).abs() < 0.01, "{sums:?}");
    }
}

#[test]
fn gaps_bias_nothing() {
    let model = NoiseModel { n: 0.002, b: 0.006, k: 0.01, ..Default::default() };
    let (samples, tau0_s, runs) = (18_000, 20.0, 40);
    let mut mean = [0.0; 3];
    let mut covered = [0; 3];
    for run in 0..runs {
        let mut y =
            Simulator::new(&model, &Setup::for_record(run + 900, tau0_s, samples as u64)).take(samples);
        for gap in [1000..1100, 7000..7003, 11_000..11_500] {
            y[gap].fill(f64::NAN);
        }
        for i in (0..samples).step_by(397) {
            y[i] = f64::NAN;
        }
        let evidence = Evidence::new(&blocks(&y, 1), None, tau0_s, &[]);
        assert!(evidence.dof() <= evidence.usable_s / tau0_s);
        assert!(evidence.dof() >= 0.9 * evidence.usable_s / tau0_s, "{}", evidence.dof());
        let found = identify(&evidence);
        for (i, (estimate, truth)) in [
            (&found.angle_random_walk, model.n),
            (&found.bias_instability, model.b),
            (&found.rate_random_walk, model.k),
        ]
        .into_iter()
        .enumerate()
        {
            if let Some(value) = estimate.value {
                mean[i] += value / truth / runs as f64;
                let interval = estimate.interval95().unwrap();
                covered[i] += usize::from(interval.low <= truth && truth <= interval.high);
            } else {
                mean[i] += 1.0 / runs as f64;
                covered[i] += 1;
            }
        }
    }
    for (m, tolerance) in mean.iter().zip([0.005, 0.05, 0.05]) {
        assert!((m - 1.0).abs() < tolerance, "{mean:?}");
    }
    assert!(covered.iter().all(|c| *c >= 34), "{covered:?} of {runs}");
}

#[test]
fn a_masked_line_leaves_no_trace() {
    let model = NoiseModel { n: 0.002, ..Default::default() };
    let (samples, tau0_s) = (36_000, 1.0);
    let mut y = Simulator::new(&model, &Setup::for_record(4, tau0_s, samples as u64)).take(samples);
    let line = 0.03;
    for (i, v) in y.iter_mut().enumerate() {
        *v += 0.05 * (2.0 * std::f64::consts::PI * line * i as f64).sin();
    }
    let open = identify(&Evidence::new(&blocks(&y, 1), None, tau0_s, &[]));
    assert!(open.misfit.probability < 1e-6 && open.misfit.worst_probability < 1e-6);
    let worst = open.misfit.worst_band_hz.unwrap();
    assert!(worst[0] <= line && line <= worst[1], "{worst:?}");
    let mask = Mask { frequency_hz: line, half_width_hz: 0.001, windowed_half_width_hz: 0.001 };
    let masked = identify(&Evidence::new(&blocks(&y, 1), None, tau0_s, &[mask]));
    assert!(masked.misfit.probability > 0.001, "{:?}", masked.misfit);
    assert!((masked.model.n / model.n - 1.0).abs() < 0.02);
    assert!(!masked.claims(TERMS[1]));
}

#[test]
fn useless_records_give_no_estimate_and_no_panic() {
    for values in [vec![], vec![1.0; 5], vec![0.0; 1000], vec![f64::NAN; 1000]] {
        let found = identify(&Evidence::new(&blocks(&values, 1), None, 1.0, &[]));
        assert!(found.estimates().iter().all(|e| e.value.is_none()));
        assert!(found.claimed.is_empty());
    }
    // Every other sample missing: no stretch is long enough, but pairs are.
    let model = NoiseModel { n: 0.002, ..Default::default() };
    let mut y = Simulator::new(&model, &Setup::for_record(4, 1.0, 8192)).take(8192);
    y.iter_mut().step_by(2).for_each(|v| *v = f64::NAN);
    let found = identify(&Evidence::new(&blocks(&y, 1), None, 1.0, &[]));
    assert!((found.model.n / model.n - 1.0).abs() < 0.05, "{}", found.model.n);
}
