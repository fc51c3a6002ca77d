//! Goodness of fit on simulated records: correct models are called wrong as often as stated, and departures are found
//! and placed. The study is `cargo xtask validate goodness-of-fit`.

use sagnac::noise::composite::{Composite, Damped, Described};
use sagnac::noise::model::NoiseModel;
use sagnac::noise::residual::{GoodnessOfFit, View};
use sagnac_studies::goodness_of_fit::{Record, false_alarms, p_value, simulated};

#[test]
fn correct_models_are_called_wrong_as_often_as_stated() {
    if !crate::support::long::wanted("correct_models_are_called_wrong_as_often_as_stated") {
        return;
    }
    // At 5 %: in 60 records of each mix, 11 or more come with a probability of 1e-4.
    for (name, shares) in false_alarms(60, 4_000_000, [0.05]) {
        for (view, share) in View::ALL.iter().zip(shares[0]) {
            assert!(share < 11.0 / 60.0, "{name} {view:?}: {share}");
        }
    }
}

/// The departure of a view, which must be significant.
fn departure(fit: &GoodnessOfFit, view: View) -> (f64, f64, f64) {
    let failures = fit.failures();
    let judged =
        failures.iter().find(|j| j.view == view).unwrap_or_else(|| panic!("{view:?}: {:?}", fit.views));
    (judged.departure.from, judged.departure.to, judged.departure.excess)
}

#[test]
fn a_disturbance_that_the_model_lacks_is_placed_in_every_view_that_shows_it() {
    let white = Composite::from(NoiseModel { n: 0.002, ..Default::default() });
    let disturbed = Composite {
        quasi_periodic: vec![Damped { rms_deg_h: 0.05, frequency_hz: 0.05, decay_time_s: 60.0 }],
        ..white.clone()
    };
    let given = Described { model: white, ..Default::default() };
    let samples = simulated(&disturbed, 11, 32_768);
    let fit = Record::of(&samples, 1 << 18).judge(Some(&given));
    // Full width at half power 1/(π·60 s) = 0.0053 Hz; power there 2σ²T = 0.3/2 over 0.0144 of white noise.
    let (from, to, excess) = departure(&fit, View::Frequency);
    assert!(from > 0.03 && from < 0.05 && to > 0.05 && to < 0.08 && excess > 1.0, "{from} {to} {excess}");
    // Autocorrelation of the disturbance: maxima at multiples of 20 s, minima between.
    let (lag, _, r) = departure(&fit, View::Lag);
    let expected =
        0.0025 / (0.0144 + 0.0025) * (-lag / 60.0).exp() * (2.0 * std::f64::consts::PI * 0.05 * lag).cos();
    assert!((r - expected).abs() < 0.04 && r.abs() > 0.08, "{lag} {r} {expected}");
    // Its Allan deviation is largest at 0.37 of its period.
    let (from, to, excess) = departure(&fit, View::AveragingTime);
    assert!(from <= 8.0 && (8.0..=256.0).contains(&to) && excess > 0.1, "{from} {to} {excess}");
    for octave in fit.octaves.iter().filter(|o| (4.0..=32.0).contains(&o.tau_s)) {
        let truth =
            disturbed.allan_variance(octave.tau_s, 1.0) / given.model.allan_variance(octave.tau_s, 1.0);
        assert!((octave.ratio / truth - 1.0).abs() < 0.1, "{octave:?} {truth}");
    }
    assert!(p_value(&fit, View::Amplitude).unwrap() > 0.001);
}

#[test]
fn heavy_tails_show_in_the_amplitudes_alone() {
    let white = Composite::from(NoiseModel { n: 0.002, ..Default::default() });
    let mut samples = simulated(&white, 12, 32_768);
    // One sample in a thousand five standard deviations off.
    for (i, y) in samples.iter_mut().enumerate().filter(|(i, _)| i % 1000 == 500) {
        *y += if i % 2000 == 500 { 0.6 } else { -0.6 };
    }
    let fit = Record::of(&samples, 1 << 18).judge(None);
    let failures: Vec<View> = fit.failures().iter().map(|j| j.view).collect();
    assert_eq!(failures, [View::Amplitude]);
    let amplitude = fit.amplitude.unwrap();
    assert!(amplitude.beyond > 15 && amplitude.expected_beyond < 3.0, "{amplitude:?}");
    assert!(amplitude.excess_kurtosis > 0.3);
}

#[test]
fn noise_above_the_block_rate_is_judged_on_single_samples() {
    let white = Composite::from(NoiseModel { n: 0.002, ..Default::default() });
    let markov = Composite {
        markov: vec![Damped { rms_deg_h: 0.05, frequency_hz: 0.0, decay_time_s: 1.5 }],
        ..white.clone()
    };
    let samples = simulated(&markov, 13, 65_536);
    let given = Described { model: white, ..Default::default() };
    let fit = Record::of(&samples, 2048).judge(Some(&given));
    assert_eq!(fit.whitened.as_ref().unwrap().step_s, 32.0);
    let samples_look = fit.sample_correlation.as_ref().unwrap();
    assert_eq!(samples_look.step_s, 1.0);
    assert!(samples_look.p_value < 1e-6 && samples_look.worst <= 3, "{samples_look:?}");
    let (lag, _, r) = departure(&fit, View::Lag);
    assert!(lag <= 3.0 && r > 0.03, "{lag} {r}");
}

#[test]
fn only_the_longest_stretch_is_whitened_and_its_share_is_known() {
    let white = Composite::from(NoiseModel { n: 0.002, ..Default::default() });
    let samples = simulated(&white, 14, 10_000);
    let mut record = Record::of(&samples, 1 << 18);
    for i in 2000..2500 {
        (record.blocks.mean[i], record.blocks.count[i]) = (f64::NAN, 0);
    }
    let whitened = record.judge(None).whitened.unwrap();
    assert_eq!(whitened.values.len(), 7500);
    assert!((whitened.share - 7500.0 / 9500.0).abs() < 1e-12);
    let variance = whitened.values.iter().map(|v| v * v).sum::<f64>() / 7500.0;
    assert!((variance - 1.0).abs() < 0.08, "{variance}");
}

#[test]
fn records_too_short_or_without_a_model_have_no_views() {
    let record = Record::of(&[0.1, -0.2, 0.3, 0.05, -0.1], 1 << 18);
    assert_eq!(record.judge(None), GoodnessOfFit::default());
    let constant = Record::of(&[1.0; 5000], 1 << 18);
    assert!(constant.judge(None).views.is_empty());
}
