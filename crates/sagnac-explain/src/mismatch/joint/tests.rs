use super::*;
use crate::claim::Uncertainty;
use crate::effect::{ClaimedMean, Column, Temperature};
use crate::noise::model::NoiseModel;

/// Samples of a recording, of one second each.
const SAMPLES: usize = 3000;
/// N of the unit, deg/√h: a deviation of 0.6 deg/h a sample.
const N: f64 = 0.01;

/// Standard normal numbers from a linear congruential generator, by the sum of twelve.
struct Normals(u64);

impl Normals {
    fn next(&mut self) -> f64 {
        let mut uniform = || {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 11) as f64 / (1u64 << 53) as f64
        };
        (0..12).map(|_| uniform()).sum::<f64>() - 6.0
    }
}

fn claim() -> Claim {
    Claim {
        case: "unit".to_owned(),
        description: Default::default(),
        sample_rate_hz: 1.0,
        columns: None,
        noise: NoiseModel { n: N, ..NoiseModel::default() },
        quantization_lsb_arcsec: 0.0,
        mean: ClaimedMean {
            bias_deg_h: 2.0,
            temperature: Some(Temperature { coefficient_deg_h_per_degc: 0.0, reference_degc: 20.0 }),
            ..ClaimedMean::default()
        },
        uncertainty: Uncertainty { n_rel: 0.02, bias_deg_h: 0.1, ..Uncertainty::default() },
        effects: vec![],
    }
}

/// A recording over a ramp of its own, with a coefficient of temperature in deg/h/°C.
fn recording(i: usize, coefficient: f64) -> Recording {
    let mut normals = Normals(900 + i as u64);
    let ramp = |t: f64| 20.0 + 4.0 * (t / 3000.0 * (2.0 + i as f64)).sin();
    let time_s: Vec<f64> = (0..SAMPLES).map(|k| k as f64).collect();
    let temperature: Vec<f64> = time_s.iter().map(|t| ramp(*t)).collect();
    let rate = |t: &f64| 2.0 + 0.1 * i as f64 + coefficient * (t - 20.0) + 0.6 * normals.next();
    let rate_deg_h = temperature.iter().map(rate).collect();
    let series = Series {
        index: (0..SAMPLES as u64).collect(),
        time_s,
        rate_deg_h,
        columns: BTreeMap::from([(Column::Temperature, temperature)]),
        sample_interval_s: 1.0,
        ..Series::default()
    };
    Recording { name: format!("r{i}"), folder: format!("{i}"), series }
}

fn of(coefficients: &[f64]) -> JointOutcome {
    let recordings = coefficients.iter().enumerate().map(|(i, c)| recording(i, *c)).collect();
    explain_jointly(recordings, &claim(), &Options::default(), &mut |_| {})
        .unwrap_or_else(|e| panic!("{:?}", e.note))
}

#[test]
fn several_recordings_find_what_none_finds_alone() {
    let outcome = of(&[0.012; 6]);
    let joint = &outcome.explanation;
    let blind = joint.recordings.iter().filter(|r| r.alone.verdict == MismatchVerdict::Consistent).count();
    assert!(blind >= 4, "{joint:?}");
    let [shared] = &joint.shared[..] else { panic!("{joint:?}") };
    assert_eq!((shared.kind.as_str(), joint.verdict), ("temp_linear", MismatchVerdict::Mismatch));
    let found = &shared.parameters["coefficient_deg_h_per_degC"];
    assert!((found.ci95[0]..=found.ci95[1]).contains(&0.012), "{found:?}");
    assert!(found.ci95[1] - found.ci95[0] < 0.012, "{found:?}");
    assert!(
        shared.agreement_p_value > 0.01 && shared.predicted_gain > 0.0 && shared.of.len() == 6,
        "{shared:?}"
    );
    assert!(outcome.augmented.states(crate::effect::find("temp_linear").unwrap()));
}

#[test]
fn a_correct_claim_shares_nothing() {
    let joint = of(&[0.0; 3]).explanation;
    assert_eq!(
        (joint.verdict, joint.shared.len(), joint.unlike.len()),
        (MismatchVerdict::Consistent, 0, 0),
        "{joint:?}"
    );
}

#[test]
fn recordings_that_disagree_share_no_law() {
    let joint = of(&[0.3, 0.1, 0.3]).explanation;
    assert!(joint.shared.iter().all(|s| s.kind != "temp_linear"), "{joint:?}");
    let unlike = joint.unlike.iter().find(|s| s.kind == "temp_linear").unwrap();
    assert!(unlike.agreement_p_value < 1e-6, "{unlike:?}");
    assert_eq!(joint.verdict, MismatchVerdict::Mismatch);
}

#[test]
fn what_a_recording_takes_for_an_event_of_its_own_does_not_bend_the_law() {
    // Strong enough for single recordings, whose temperature goes one way, to show it as a ramp or as what it is.
    let joint = of(&[0.05; 4]).explanation;
    let shared = joint.shared.iter().find(|s| s.kind == "temp_linear").unwrap_or_else(|| panic!("{joint:?}"));
    let found = &shared.parameters["coefficient_deg_h_per_degC"];
    assert!((found.ci95[0]..=found.ci95[1]).contains(&0.05), "{found:?}");
    assert!(joint.recordings.iter().all(|r| r.together.verdict == MismatchVerdict::Consistent), "{joint:?}");
}
