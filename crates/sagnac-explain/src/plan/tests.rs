use super::*;
use crate::effect::{ClaimedMean, Temperature, Value, find};
use crate::local_text::LocalText;
use crate::noise::model::NoiseModel;
use crate::schedule::Step;

fn claim() -> Claim {
    Claim {
        case: "unit".to_owned(),
        description: LocalText::from(""),
        sample_rate_hz: 1.0,
        columns: None,
        noise: NoiseModel { n: 0.002, b: 0.001, k: 0.001, ..NoiseModel::default() },
        quantization_lsb_arcsec: 0.0,
        mean: ClaimedMean {
            temperature: Some(Temperature { coefficient_deg_h_per_degc: 0.002, reference_degc: 20.0 }),
            ..ClaimedMean::default()
        },
        uncertainty: Default::default(),
        effects: vec![],
    }
}

fn stated(kind: &str, values: &[(&str, f64)]) -> Stated {
    let values = values.iter().map(|(n, v)| ((*n).to_owned(), Value::Number(*v))).collect();
    Stated { effect: find(kind).unwrap(), values }
}

fn alternatives(of: &[Stated]) -> Vec<Alternative> {
    let one = |(i, s): (usize, &Stated)| Alternative { cause: 1, chosen: i == 0, effects: vec![s.clone()] };
    of.iter().enumerate().map(one).collect()
}

fn planned(of: &[Stated], budget_h: f64) -> Plan {
    plan(&claim(), &alternatives(of), &Limits::usual(3600.0 * budget_h), &mut |_, _| {})
}

#[test]
fn a_drift_and_a_temperature_coefficient_are_told_apart_by_cooling_as_well() {
    let of = [
        stated("temp_linear", &[("coefficient_deg_h_per_degC", 0.004)]),
        stated("rate_ramp", &[("slope_deg_h_per_h", 0.02)]),
    ];
    let plan = planned(&of, 8.0);
    assert_eq!(plan.outcome, PlanOutcome::Decides, "{plan:#?}");
    let schedule = plan.schedule.unwrap();
    assert!(schedule.probability >= ASKED && schedule.duration_h <= 8.0);
    assert!(schedule.schedule.steps.iter().any(|s| matches!(s, Step::Cycle { .. })));
    assert!(plan.causes[0].pairs.iter().all(|p| p.probability > 0.95));
}

#[test]
fn a_smaller_effect_needs_longer_and_a_small_budget_is_too_short() {
    let of = |size: f64| {
        [
            stated("temp_rate", &[("coefficient_deg_h_per_degC_per_min", size)]),
            stated("temp_hysteresis", &[("loop_width_deg_h", size), ("play_degC", 2.0), ("sense", 1.0)]),
        ]
    };
    let hours = |plan: &Plan| plan.schedule.as_ref().map(|s| s.duration_h);
    let (large, small) = (planned(&of(0.06), 24.0), planned(&of(0.02), 24.0));
    assert_eq!(large.outcome, PlanOutcome::Decides, "{large:#?}");
    assert!(hours(&small) >= hours(&large), "{:?} {:?}", hours(&small), hours(&large));
    let short = planned(&of(0.02), 0.75);
    assert!(matches!(short.outcome, PlanOutcome::TooShort | PlanOutcome::Undecidable), "{short:#?}");
}

#[test]
fn one_explanation_leaves_nothing_to_decide() {
    let plan = planned(&[stated("rate_ramp", &[("slope_deg_h_per_h", 0.02)])], 8.0);
    assert_eq!((plan.outcome, plan.schedule), (PlanOutcome::NothingToDecide, None));
}

#[test]
fn a_step_of_the_bias_shows_nothing_later_and_a_turned_gyro_does() {
    let mut claim = claim();
    claim.mean.earth = Some(crate::effect::Earth { latitude_deg: 55.0, azimuth_deg: 80.0 });
    let values = [("step_deg_h", 0.1), ("time_s", 100.0)];
    let of = alternatives(&[stated("bias_step", &values), stated("heading_change", &values)]);
    let plan = plan(&claim, &of, &Limits::usual(8.0 * 3600.0), &mut |_, _| {});
    assert_eq!(plan.outcome, PlanOutcome::Decides, "{plan:#?}");
    let shows: Vec<_> = plan.causes[0].alternatives.iter().map(|a| a.shows_as.as_deref()).collect();
    assert_eq!(shows, [None, Some("earth_rate_projection")]);
    let by_headings = |p: &PairPlan| matches!(p.contrast, record::Contrast::Headings { .. });
    assert!(plan.causes[0].pairs.iter().all(by_headings));
}

#[test]
fn what_no_schedule_tells_apart_is_said() {
    let values = [("step_deg_h", 0.1), ("time_s", 100.0)];
    let of = alternatives(&[stated("bias_step", &values), stated("heading_change", &values)]);
    let limits = Limits { headings: false, ..Limits::usual(8.0 * 3600.0) };
    let plan = plan(&claim(), &of, &limits, &mut |_, _| {});
    assert_eq!((plan.outcome, plan.schedule), (PlanOutcome::Undecidable, None));
}
