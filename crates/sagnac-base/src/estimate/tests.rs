use super::*;

fn limit(max: f64, rule: Rule) -> Limit {
    Limit { min: None, max: Some(max), rule, risk: 0.05, source: "test".into() }
}

fn normal(value: f64, u: f64) -> Estimate {
    Estimate::measured(
        "static_bias",
        "rate",
        value,
        "deg/h",
        Spread::Normal { standard_uncertainty: u },
        "mean",
    )
}

#[test]
fn guard_band_follows_iso_14253() {
    // ISO 14253-1: acceptance limit is 1.645 u inside the tolerance limit.
    let j = judge(&normal(0.5, 0.1), &limit(1.0, Rule::GuardBand));
    assert_eq!(j.verdict, Verdict::Pass);
    assert!((j.acceptance_max.unwrap() - (1.0 - 0.164_485_363)).abs() < 1e-6);
    assert_eq!(judge(&normal(0.9, 0.1), &limit(1.0, Rule::GuardBand)).verdict, Verdict::Indeterminate);
    assert_eq!(judge(&normal(1.1, 0.1), &limit(1.0, Rule::GuardBand)).verdict, Verdict::Indeterminate);
    assert_eq!(judge(&normal(1.2, 0.1), &limit(1.0, Rule::GuardBand)).verdict, Verdict::Fail);
    assert_eq!(judge(&normal(1.0001, 0.1), &limit(1.0, Rule::Simple)).verdict, Verdict::Fail);
}

#[test]
fn specific_risk_is_that_of_jcgm_106() {
    let j = judge(&normal(0.9, 0.1), &limit(1.0, Rule::GuardBand));
    assert!((j.specific_risk.unwrap() - 0.158_655_25).abs() < 1e-6);
    let j = judge(&normal(1.0, 0.1), &limit(1.0, Rule::Simple));
    assert!((j.specific_risk.unwrap() - 0.5).abs() < 1e-9);
}

#[test]
fn chi_square_bounds_scale_with_the_value() {
    // edf 10: 95 % factors on a deviation are 0.70 and 1.75 (NIST SP 1065 practice).
    let i = Spread::ChiSquare { dof: 10.0 }.interval(1.0, 0.95).unwrap();
    assert!((i.low - 0.6987).abs() < 1e-3 && (i.high - 1.7549).abs() < 1e-3, "{i:?}");
    let e =
        Estimate::measured("russian_drift_100s", "rate", 1.0, "deg/h", Spread::ChiSquare { dof: 10.0 }, "s");
    let j = judge(&e, &limit(2.0, Rule::GuardBand));
    let acceptance = j.acceptance_max.unwrap();
    let at_limit = Spread::ChiSquare { dof: 10.0 }.bound(acceptance, 0.95).unwrap();
    assert!((at_limit - 2.0).abs() < 1e-9);
}

#[test]
fn what_a_record_cannot_show_is_never_failed() {
    let bound = |v| Some(UpperLimit { value: v, coverage: 0.95 });
    let e = |v| Estimate::not_identifiable("bias_instability", "rate", bound(v), "deg/h", "whittle");
    assert_eq!(judge(&e(0.5), &limit(1.0, Rule::GuardBand)).verdict, Verdict::Pass);
    assert_eq!(judge(&e(5.0), &limit(1.0, Rule::GuardBand)).verdict, Verdict::Indeterminate);
}

#[test]
fn curves_are_read_both_ways() {
    let curve = Spread::Curve((-40..=40).map(|i| (f64::from(i) / 10.0, 2.0 + 0.03 * f64::from(i))).collect());
    assert!((curve.bound(2.0, 0.975).unwrap() - (2.0 + 0.3 * 1.959_964)).abs() < 1e-6);
    assert!((curve.probability_above(2.0, 2.3).unwrap() - 0.158_655).abs() < 1e-5);
    // Beyond its ends the probability goes on to fall: 6 and 18 standard deviations.
    for z in [6.0, 18.0f64] {
        let found = curve.probability_above(2.0, 2.0 + 0.3 * z).unwrap();
        assert!((found / normal_probability(-z) - 1.0).abs() < 1e-6, "{z}: {found}");
        assert!(curve.probability_above(2.0, 2.0 - 0.3 * z).unwrap() > 0.999_999);
    }
    // One that ends at a bound of the quantity has nothing beyond it.
    let ends = Spread::Curve(vec![(-4.0, 0.0), (0.0, 0.0), (4.0, 2.0)]);
    assert!(ends.probability_above(0.0, -1.0).unwrap() > 0.999_9);
}

#[test]
fn acceptance_lies_inside_limits_on_both_sides_of_zero() {
    let points = (-40..=40).map(|i| (f64::from(i) / 10.0, 0.5 + 0.05 * f64::from(i) / 10.0)).collect();
    let e = Estimate { spread: Spread::Curve(points), ..normal(0.5, 0.05) };
    let both = Limit { min: Some(-1.0), ..limit(1.0, Rule::GuardBand) };
    let j = judge(&e, &both);
    let (low, high) = (j.acceptance_min.unwrap(), j.acceptance_max.unwrap());
    assert!((-1.0..-0.9).contains(&low) && (0.8..1.0).contains(&high), "{low} {high}");
    assert_eq!(j.verdict, Verdict::Pass);
}

#[test]
fn a_curve_through_zero_moves_the_limit_by_a_difference() {
    // A value that may have either sign is no deviation: by a factor the limit would be 0.17 here.
    let points = (-40..=40).map(|i| (f64::from(i) / 10.0, 0.1 + 0.03 * f64::from(i))).collect();
    let e = Estimate { spread: Spread::Curve(points), ..normal(0.1, 0.3) };
    let j = judge(&e, &limit(1.0, Rule::GuardBand));
    assert!((j.acceptance_max.unwrap() - (1.0 - 0.3 * 1.644_854)).abs() < 1e-3, "{:?}", j.acceptance_max);
}

#[test]
fn worst_wins_in_the_stated_order() {
    use Verdict::{Error, Fail, Indeterminate, None, Pass};
    assert!(None < Pass && Pass < Indeterminate && Indeterminate < Fail && Fail < Error);
}

#[test]
fn a_quantity_known_to_be_beyond_its_limit_fails_though_it_has_no_value() {
    let at_least = |value: f64, coverage: f64| {
        Estimate::not_identifiable("warm_up_time", "rate", None, "s", "decays_gls")
            .at_least(Some(LowerLimit { value, coverage }))
    };
    let limit = limit(9000.0, Rule::GuardBand);
    let fails = judge(&at_least(10_000.0, 0.95), &limit);
    assert_eq!((fails.verdict, fails.margin), (Verdict::Fail, Some(-1000.0)));
    assert_eq!(judge(&at_least(8000.0, 0.95), &limit).verdict, Verdict::Indeterminate);
    assert_eq!(judge(&at_least(10_000.0, 0.5), &limit).verdict, Verdict::Indeterminate);
}

#[test]
fn a_component_adds_in_quadrature_on_each_side() {
    let half = |spread: &Spread| {
        let interval = spread.interval(1.0, 0.95).unwrap();
        (1.0 - interval.low, interval.high - 1.0)
    };
    let laws = [
        Spread::Normal { standard_uncertainty: 0.03 },
        Spread::StudentT { standard_uncertainty: 0.03, dof: 200.0 },
        Spread::ChiSquare { dof: 20.0 },
        Spread::Curve(vec![(-3.0, 0.7), (0.0, 1.0), (3.0, 1.9)]),
    ];
    for law in &laws {
        let middle = law.bound(1.0, 0.5).unwrap();
        let wider = law.with_component(1.0, 0.1);
        let sides = |of: &Spread| {
            let (low, high) = half(of);
            [middle - 1.0 + low, high + 1.0 - middle]
        };
        for (before, after) in sides(law).into_iter().zip(sides(&wider)) {
            let expected = before.hypot(1.96 * 0.1);
            assert!((after / expected - 1.0).abs() < 0.01, "{law:?}: {after} instead of {expected}");
        }
        assert_eq!(&law.with_component(1.0, 0.0), law);
    }
    assert_eq!(Spread::Unknown.with_component(1.0, 0.1), Spread::Unknown);
}

#[test]
fn a_quantity_between_two_bounds_is_judged_by_both() {
    let between = |low: Option<(f64, f64)>, high: Option<(f64, f64)>| {
        let upper = high.map(|(value, coverage)| UpperLimit { value, coverage });
        Estimate::not_identifiable("maximum_rate", "rate", upper, "deg/s", "levels")
            .at_least(low.map(|(value, coverage)| LowerLimit { value, coverage }))
    };
    let from = Limit { max: None, min: Some(300.0), ..limit(0.0, Rule::GuardBand) };
    for (low, high, verdict, margin) in [
        (Some((325.0, 0.95)), Some((350.0, 0.95)), Verdict::Pass, Some(25.0)),
        (Some((300.0, 0.95)), None, Verdict::Pass, Some(0.0)),
        (Some((275.0, 0.95)), Some((325.0, 0.95)), Verdict::Indeterminate, Some(-25.0)),
        (Some((325.0, 0.5)), None, Verdict::Indeterminate, Some(25.0)),
        (Some((250.0, 0.95)), Some((275.0, 0.95)), Verdict::Fail, Some(-25.0)),
        (None, Some((275.0, 0.5)), Verdict::Indeterminate, None),
        (None, None, Verdict::Indeterminate, None),
    ] {
        let found = judge(&between(low, high), &from);
        assert_eq!((found.verdict, found.margin), (verdict, margin), "{low:?} {high:?}");
    }
    // Inside both limits, or within one of them only.
    let both = Limit { max: Some(400.0), ..from };
    assert_eq!(judge(&between(Some((325.0, 0.95)), Some((350.0, 0.95))), &both).verdict, Verdict::Pass);
    assert_eq!(judge(&between(Some((325.0, 0.95)), None), &both).verdict, Verdict::Indeterminate);
    assert_eq!(judge(&between(None, Some((350.0, 0.95))), &both).verdict, Verdict::Indeterminate);
    assert_eq!(judge(&between(Some((410.0, 0.95)), None), &both).verdict, Verdict::Fail);
}

#[test]
fn a_spread_of_an_interval_has_that_interval_and_one_of_a_resolution_is_even() {
    let skewed = Spread::of_interval(1.0, 2.0, 5.0);
    let interval = skewed.interval(2.0, 0.95).unwrap();
    assert!((interval.low - 1.0).abs() < 0.01 && (interval.high - 5.0).abs() < 0.03, "{interval:?}");
    assert_eq!(skewed.bound(2.0, 0.5), Some(2.0));
    let even = Spread::of_resolution(1.0, 0.5);
    // Of an even law over 0.5 on either side, 95 % lie within 0.475.
    let interval = even.interval(1.0, 0.95).unwrap();
    assert!((interval.low - 0.525).abs() < 0.005 && (interval.high - 1.475).abs() < 0.005, "{interval:?}");
    assert_eq!(Spread::of_resolution(0.1, 0.5).interval(0.1, 0.95).unwrap().low, 0.0);
}
