use super::*;
use crate::config::model::{Claim, parse};
use crate::effect::Column;
use crate::i18n::{Lang, Localize};
use crate::noise::data::NoiseType;
use crate::noise::model::{NoiseModel, unit_allan_variance};
use crate::numeric::cosine::dct2;
use crate::series::Series;
use std::f64::consts::PI;

fn claim(rest: &str) -> Claim {
    model(rest).claim
}

fn model(rest: &str) -> crate::config::model::ModelFile {
    let text = format!("[recording]\nsample_rate_hz = 1\n{rest}");
    parse("test", text.as_bytes()).unwrap_or_else(|e| panic!("{e}"))
}

fn order(claim: &Claim, seed: u64, duration_s: f64) -> Order<'_> {
    Order { claim, seed, over: Over::Duration { duration_s, start_s: 0.0, drivers: &[] } }
}

fn rates(claim: &Claim, seed: u64, samples: usize) -> Vec<f64> {
    Simulation::begin(order(claim, seed, samples as f64)).unwrap().all().unwrap().rate_deg_h
}

/// Mean power of each cosine mode over runs.
fn powers(claim: &Claim, n: usize, runs: u64) -> Vec<f64> {
    let mut power = vec![0.0; n];
    for run in 0..runs {
        for (p, c) in power.iter_mut().zip(dct2(&rates(claim, 1 + run, n))) {
            *p += c * c / runs as f64;
        }
    }
    power
}

#[test]
fn the_density_is_the_claimed_one_up_to_the_nyquist_frequency() {
    let (n, runs) = (4096, 100);
    for text in
        ["N_deg_rt_h = 0.01", "B_deg_h = 1.0", "K_deg_h_rt_h = 30.0", "N_deg_rt_h = 0.002\nB_deg_h = 0.3"]
    {
        let claim = claim(&format!("[noise]\n{text}\n"));
        let power = powers(&claim, n, runs);
        let expected = |k: usize| claimed_density(&claim.noise, k as f64 / (2.0 * n as f64));
        // Geometric bands from mode 32 on, where cosine modes of 1/f noise show its density within 0.7 %, and bands of
        // a sixteenth of the whole towards the end.
        let mut low = 32;
        let mut bands = 0;
        while low < n {
            let high = (low * 2).min(low + n / 16).min(n);
            let ratio = (low..high).map(|k| power[k] / expected(k)).sum::<f64>() / (high - low) as f64;
            let chance = 4.0 * (2.0 / (runs as f64 * (high - low) as f64)).sqrt();
            assert!(
                (ratio - 1.0).abs() < 0.007f64.max(chance) + 0.003,
                "{text}: modes {low}..{high}: {ratio}"
            );
            assert!(chance < 0.12, "{chance}");
            low = high;
            bands += 1;
        }
        assert!(bands > 16);
    }
}

#[test]
fn a_filter_of_every_form_has_the_density_that_fits_use() {
    let (n, runs) = (4096usize, 100);
    let crate::effect::Model::Spectrum(filter) = crate::effect::find("bandwidth_filter").unwrap().model()
    else {
        panic!("a spectrum")
    };
    for form in 1..=7 {
        let text = format!(
            "[noise]\nN_deg_rt_h = 0.01\n[[effect]]\nkind = \"bandwidth_filter\"\n[effect.parameters]\ncutoff_hz = 0.12\nform = {form}\n"
        );
        let claim = claim(&text);
        let power = powers(&claim, n, runs);
        let mut low = 64;
        while low < n {
            let high = low + 64;
            let bin = crate::effect::ModeBin {
                frequency_hz: (low as f64 + 31.5) / (2.0 * n as f64),
                mode: low,
                modes: 64,
                samples: n,
                dt_s: 1.0,
                even_ends: false,
            };
            let factor = filter.density(&[0.12, f64::from(form)], &bin);
            let ratio = power[low..high].iter().sum::<f64>() / 64.0 / (0.36 * factor);
            // A steep fall inside a band, and a zero at the Nyquist frequency, are left out.
            if factor > 0.004 {
                // Four standard deviations of the mean of 64 modes, and the slope of the filter within them.
                let chance = 4.0 * (2.0 / (64.0 * runs as f64)).sqrt();
                assert!((ratio - 1.0).abs() < 0.02 + chance, "form {form}, mode {low}: {ratio}");
            }
            low = high;
        }
    }
}

fn allan_variance(y: &[f64], m: usize) -> f64 {
    let means: Vec<f64> = y.chunks_exact(m).map(|c| c.iter().sum::<f64>() / m as f64).collect();
    means.windows(2).map(|w| (w[1] - w[0]).powi(2)).sum::<f64>() / (2.0 * (means.len() - 1) as f64)
}

/// Allan variance of samples whose density is the claimed one up to the Nyquist frequency.
fn sampled_allan_variance(noise: &NoiseModel, m: usize) -> f64 {
    let points = 400_000;
    let sum: f64 = (0..points)
        .map(|p| {
            // Dense towards 0, where the density of 1/f noise is.
            let u = (p as f64 + 0.5) / points as f64;
            let x = 0.5 * u * u;
            let transfer = (PI * m as f64 * x).sin().powi(4) / (m as f64 * (PI * x).sin()).powi(2);
            claimed_density(noise, x) * transfer * u
        })
        .sum();
    4.0 * sum / points as f64
}

#[test]
fn allan_deviations_are_the_closed_forms() {
    let n = 1 << 18;
    for (text, term, scale) in [
        ("N_deg_rt_h = 0.01", NoiseType::AngleRandomWalk, 0.01),
        ("B_deg_h = 1.0", NoiseType::Flicker, 1.0),
        ("K_deg_h_rt_h = 30.0", NoiseType::RateRandomWalk, 30.0),
    ] {
        let claim = claim(&format!("[noise]\n{text}\n"));
        let runs = 8;
        let records: Vec<Vec<f64>> = (0..runs).map(|run| rates(&claim, 50 + run, n)).collect();
        for m in [1usize, 2, 8, 32, 128, 512] {
            let found = records.iter().map(|y| allan_variance(y, m)).sum::<f64>() / runs as f64;
            let sigma = (found / sampled_allan_variance(&claim.noise, m)).sqrt();
            // Of walks and flicker, the terms have chi-square statistics of their own; this is wide enough for all.
            let tolerance = 0.004 + 1.7 / (runs as f64 * n as f64 / m as f64).sqrt() * 2.0;
            assert!((sigma - 1.0).abs() < tolerance, "{term:?} {m}: {sigma}");
            if m >= 32 {
                let textbook = scale * scale * unit_allan_variance(term, m as f64);
                let sigma = (found / textbook).sqrt();
                assert!((sigma - 1.0).abs() < tolerance + 0.005, "{term:?} {m}: {sigma} of the textbook");
            }
        }
    }
}

#[test]
fn flicker_at_one_sample_is_nine_per_cent_above_the_textbook() {
    let noise = NoiseModel { b: 1.0, ..NoiseModel::default() };
    let ratio = (sampled_allan_variance(&noise, 1) / unit_allan_variance(NoiseType::Flicker, 1.0)).sqrt();
    // (γ + ln π − Ci(π))/π over (2 ln 2)/π.
    assert!((ratio - (1.648_277_f64 / (2.0 * 2f64.ln())).sqrt()).abs() < 1e-4, "{ratio}");
    assert!((ratio - 1.0904).abs() < 1e-3);
}

#[test]
fn the_white_part_has_sixty_n_times_the_root_of_the_rate() {
    let text = "[recording]\nsample_rate_hz = 25\n[noise]\nN_deg_rt_h = 0.003\n";
    let claim = parse("t", text.as_bytes()).unwrap().claim;
    let y = Simulation::begin(order(&claim, 4, 8000.0)).unwrap().all().unwrap().rate_deg_h;
    assert_eq!(y.len(), 200_000);
    let sigma = (y.iter().map(|v| v * v).sum::<f64>() / y.len() as f64).sqrt();
    assert!((sigma / 0.9 - 1.0).abs() < 0.007, "{sigma}");
}

#[test]
fn a_seed_fixes_every_bit_however_the_record_is_cut() {
    let plain = "[noise]\nN_deg_rt_h = 0.002\nB_deg_h = 0.004\nK_deg_h_rt_h = 0.02\nquantization_lsb_arcsec = 0.01\n\
                [[driver]]\ncolumn = \"temp_degC\"\ntime_s = [0.0, 5e4]\nvalue = [20.0, 40.0]\nnoise = 0.01\n";
    let filtered =
        "[[effect]]\nkind = \"bandwidth_filter\"\n[effect.parameters]\ncutoff_hz = 0.1\nform = 3\n";
    for text in [plain.to_owned(), format!("{plain}{filtered}")] {
        let model = model(&text);
        let over = Over::Duration { duration_s: 200_000.0, start_s: 3.0, drivers: &model.drivers };
        let begin = |seed| Simulation::begin(Order { claim: &model.claim, seed, over }).unwrap();
        let whole = {
            let mut simulation = begin(9);
            simulation.set_block(usize::MAX);
            simulation.next_rows().unwrap().unwrap()
        };
        assert_eq!(whole.time_s.len(), 200_000);
        for block in [1000, 65_536] {
            let mut simulation = begin(9);
            simulation.set_block(block);
            assert!(simulation.all().unwrap() == whole, "{block}");
        }
        assert!(begin(10).all().unwrap().rate_deg_h != whole.rate_deg_h);
        assert_eq!((whole.time_s[0], whole.time_s[199_999]), (3.0, 200_002.0));
    }
}

#[test]
fn the_mean_is_the_formula_of_the_contract() {
    let text = "[bias]\nvalue_deg_h = -3.0\n[temperature]\ncoefficient_deg_h_per_degC = 0.5\nreference_degC = 10.0\n\
                [scale_factor]\nerror_ppm = 100.0\n\
                [[driver]]\ncolumn = \"temp_degC\"\nvalue = [30.0]\n\
                [[driver]]\ncolumn = \"table_rate_deg_s\"\ntime_s = [0.0, 10.0]\nvalue = [0.0, 20.0]\n";
    let model = model(text);
    let over = Over::Duration { duration_s: 11.0, start_s: 0.0, drivers: &model.drivers };
    let rows = Simulation::begin(Order { claim: &model.claim, seed: 1, over }).unwrap().all().unwrap();
    for (t, y) in rows.time_s.iter().zip(&rows.rate_deg_h) {
        let expected = -3.0 + 0.5 * 20.0 + 3600.0 * 1.0001 * 2.0 * t;
        assert!((y - expected).abs() < 1e-9, "{t}: {y}");
    }
    assert_eq!(rows.columns[&Column::TableRate][5], 10.0);
    let text = "[earth]\nlatitude_deg = 60.0\nazimuth_deg = 30.0\n\
                [[driver]]\ncolumn = \"table_angle_deg\"\ntime_s = [0.0, 8.0]\nvalue = [0.0, 720.0]\n";
    let turning = self::model(text);
    let over = Over::Duration { duration_s: 9.0, start_s: 0.0, drivers: &turning.drivers };
    let rows = Simulation::begin(Order { claim: &turning.claim, seed: 1, over }).unwrap().all().unwrap();
    for (i, y) in rows.rate_deg_h.iter().enumerate() {
        let expected = 15.041067 * 0.5 * (90.0 * i as f64 + 30.0).to_radians().cos();
        assert!((y - expected).abs() < 1e-6, "{i}: {y} {expected}");
    }
    assert_eq!(rows.columns[&Column::TableAngle][5], 90.0);
}

#[test]
fn a_quantised_output_counts_whole_steps_and_loses_no_angle() {
    let text = "[noise]\nN_deg_rt_h = 0.002\nquantization_lsb_arcsec = 0.05\n[bias]\nvalue_deg_h = 0.0123\n";
    let claim = claim(text);
    let plain = self::claim("[noise]\nN_deg_rt_h = 0.002\n[bias]\nvalue_deg_h = 0.0123\n");
    let (y, unrounded) = (rates(&claim, 3, 20_000), rates(&plain, 3, 20_000));
    let (mut angle, mut true_angle): (f64, f64) = (0.0, 0.0);
    for (y, x) in y.iter().zip(&unrounded) {
        let steps = y / 0.05;
        assert!((steps - steps.round()).abs() < 1e-9, "{y}");
        angle += y;
        true_angle += x;
        assert!((angle - true_angle).abs() < 0.025 + 1e-6);
    }
    // Alone: 3 Q²/τ², Q = lsb/√12, beside 60² N²/τ.
    let m = 1;
    let expected = 3.0 * 0.05f64.powi(2) / 12.0 + (60.0f64 * 0.002).powi(2);
    let found = allan_variance(&y, m);
    assert!((found / expected - 1.0).abs() < 0.03, "{found} {expected}");
}

#[test]
fn effects_act_through_their_own_models() {
    let step =
        claim("[[effect]]\nkind = \"bias_step\"\n[effect.parameters]\nstep_deg_h = 2.0\ntime_s = 50.5\n");
    let y = rates(&step, 1, 100);
    assert_eq!((y[0], y[50], y[51], y[99]), (0.0, 0.0, 2.0, 2.0));
    let louder = claim(
        "[noise]\nN_deg_rt_h = 0.001\n[[effect]]\nkind = \"excess_arw\"\n[effect.parameters]\nN_deg_rt_h = 0.005\n",
    );
    let y = rates(&louder, 1, 100_000);
    let variance = y.iter().map(|v| v * v).sum::<f64>() / y.len() as f64;
    assert!((variance / 0.09 - 1.0).abs() < 0.02, "{variance}: the whole coefficient is stated");
    let markov = claim(
        "[[effect]]\nkind = \"markov_long\"\n[effect.parameters]\ncorrelation_time_s = 50.0\nsigma_deg_h = 0.2\n",
    );
    let y = rates(&markov, 1, 400_000);
    let at = |lag: usize| y.windows(lag + 1).map(|w| w[0] * w[lag]).sum::<f64>() / (y.len() - lag) as f64;
    for lag in [25, 50, 100] {
        let expected = 0.04 * (-(lag as f64) / 50.0).exp();
        assert!((at(lag) / expected - 1.0).abs() < 0.12, "{lag}: {} {expected}", at(lag));
    }
}

#[test]
fn the_rows_of_a_recording_are_kept_with_their_gaps() {
    let index: Vec<u64> = (0..100).chain(140..300).collect();
    let series = Series {
        time_s: index.iter().map(|i| 7.0 + *i as f64).collect(),
        rate_deg_h: vec![0.0; index.len()],
        columns: [(Column::Temperature, index.iter().map(|i| 20.0 + 0.1 * *i as f64).collect())].into(),
        index: index.clone(),
        sample_interval_s: 1.0,
        ..Series::default()
    };
    let text = "[bias]\nvalue_deg_h = 1.0\n[temperature]\ncoefficient_deg_h_per_degC = 0.1\n\
                [[effect]]\nkind = \"bias_step\"\n[effect.parameters]\nstep_deg_h = 5.0\ntime_s = 127.5\n";
    let claim = claim(text);
    let rows = Simulation::begin(Order { claim: &claim, seed: 1, over: Over::Like(&series) })
        .unwrap()
        .all()
        .unwrap();
    assert_eq!(rows.time_s, series.time_s);
    assert_eq!(rows.columns, series.columns);
    for (i, y) in index.iter().zip(&rows.rate_deg_h) {
        let step = if *i > 120 { 5.0 } else { 0.0 };
        assert!((y - (1.0 + 0.01 * *i as f64 + step)).abs() < 1e-9, "{i}: {y}");
    }
}

#[test]
fn what_cannot_be_simulated_is_said() {
    let refused = |claim: &Claim, over: Over<'_>| {
        let begun = Simulation::begin(Order { claim, seed: 1, over });
        begun.err().map(|e| e.note().say(Lang::En)).unwrap_or_default()
    };
    let over = |duration_s: f64| Over::Duration { duration_s, start_s: 0.0, drivers: &[] };
    let quiet = claim("");
    for duration_s in [0.1, 1e15, f64::NAN] {
        assert!(refused(&quiet, over(duration_s)).contains("cannot simulate"), "{duration_s}");
    }
    let warm =
        claim("[[effect]]\nkind = \"temp_linear\"\n[effect.parameters]\ncoefficient_deg_h_per_degC = 1.0\n");
    assert!(refused(&warm, over(100.0)).contains("temp_degC"));
    let fast =
        Series { time_s: vec![0.0, 0.5], index: vec![0, 1], sample_interval_s: 0.5, ..Series::default() };
    assert!(refused(&quiet, Over::Like(&fast)).contains("2 Hz"));
    assert!(refused(&quiet, Over::Like(&Series::default())).contains("no usable rows"));
    let unfinished = claim("[[effect]]\nkind = \"bias_step\"\n[effect.parameters]\nstep_deg_h = 5.0\n");
    let run = Simulation::begin(order(&unfinished, 1, 10.0)).unwrap().all();
    assert!(run.unwrap_err().note().say(Lang::En).contains("lacks parameters"));
}
