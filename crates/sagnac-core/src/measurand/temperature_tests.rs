use super::super::test_evidence::{
    asked, chi_square, curve, diagonal, near, normal, notes, number, shows, withholds, within,
};
use super::*;
use crate::temperature::SegmentKind;
use crate::temperature::course::{Course, Span, Terms};
use crate::temperature::findings::Schedule;
use crate::temperature::gls::{Fitted, Solved};
use crate::temperature::lag::Profile;
use crate::temperature::order::Tried;
use crate::temperature::posterior::{Best, Posterior};
use crate::temperature::segments::Segment;
use crate::temperature::separate::Separation;
use crate::temperature::zones::Zone;
use nalgebra::DMatrix;

/// A draw of these coefficients and their covariance, with a lag of 2 min.
fn draw(coefficients: &[f64], covariance: DMatrix<f64>) -> Draw {
    Draw {
        shape: vec![120.0, 1.0],
        noise: [0.0; 3],
        coefficients: DVector::from_row_slice(coefficients),
        covariance,
    }
}

/// Lags about `middle` with a deviation of `deviation`, in steps of 2 s from `from`: a coefficient of 0.3 ± 0.01 (rate) and
/// 0.25 ± 0.02 (hysteresis) that grows by `with_lag` for every second.
fn profile((from, count): (f64, i32), (middle, deviation): (f64, f64), with_lag: f64) -> Profile {
    let at = |i: i32| {
        let lag_s = from + 2.0 * f64::from(i);
        AtLag {
            lag_s,
            log_likelihood: -0.5 * ((lag_s - middle) / deviation).powi(2),
            rate: Some((0.3 + with_lag * lag_s, 0.01)),
            hysteresis: Some((0.25 + with_lag * lag_s, 0.02)),
        }
    };
    Profile { weight: 1.0, longest_s: 7200.0, lags: (0..count).map(at).collect() }
}

/// A lag of 120 s, known to 5 s.
fn told() -> Vec<Profile> {
    vec![profile((60.0, 61), (120.0, 5.0), 0.0)]
}

/// Minus 40 to 60 degC at ramps of 2 degC/min: 3 x + 2 P₂(x) = 3 x + 3 x² − 1 of the temperature x in half spans, D = 0.3,
/// h = 0.25. One draw without a spread, so that every reading is that of the best fit.
fn analysis() -> Analysis {
    let coefficients = [3.0, 2.0, 0.3, 0.25];
    let solved = Solved {
        coefficients: DVector::from_row_slice(&coefficients),
        covariance: DMatrix::zeros(4, 4),
        log_likelihood: 0.0,
        powers: vec![1.0; 8],
    };
    let shape = crate::temperature::course::Shape { lag_s: 120.0, play_deg_c: 1.0 };
    Analysis {
        course: Course {
            block_s: 10.0,
            first_s: 0.0,
            rate_deg_h: vec![0.0; 9],
            temperature_deg_c: vec![0.0; 9],
            bridged: 0.0,
        },
        posterior: Posterior {
            terms: Terms { order: 2, rate: true, hysteresis: true },
            span: Span { low: -40.0, high: 60.0 },
            best: Best { shape, fitted: Fitted { noise: [0.0; 3], solved, log_deviation: [1.0; 3] } },
            draws: vec![draw(&coefficients, DMatrix::zeros(4, 4))],
            lags: told(),
            longest_lag_s: 7200.0,
        },
        removed: None,
        order: 2,
        orders: vec![],
        separation: Some(Separation { rate: 3.0, lag: 4.0, hysteresis: 5.0, condition: 1.0 }),
        modelled: vec![0.0; 9],
        level_deg_h: 0.0,
        residual: vec![],
        average_s: 100.0,
        residual_rms: 0.07,
        residual_dof: 33.0,
        ramp_deg_c_min: 2.0,
        slowest_deg_c_min: 1.0,
        both_ways: true,
        parted: true,
    }
}

fn coefficients(a: &mut Analysis, of: &[f64]) {
    a.posterior.best.fitted.solved.coefficients = DVector::from_row_slice(of);
    a.posterior.draws = vec![draw(of, DMatrix::zeros(of.len(), of.len()))];
}

fn row(m: &Measurand, a: &Analysis) -> Estimate {
    let found = Findings { analysis: Some(a.clone()), ..Findings::nothing(&asked()) };
    let mut rows = m.evaluate_temperature("g", &found);
    assert_eq!((rows.len(), rows[0].channel.as_str()), (1, "g"));
    rows.remove(0)
}

/// A value that is read from draws is a quantile found by halving.
#[track_caller]
fn reads(row: &Estimate, value: f64) {
    within(row.value.expect("a value"), value, 1e-6);
    assert_eq!((row.method, row.upper_limit), ("thermal_gls", None));
}

#[test]
fn without_a_model_every_row_says_so() {
    for m in [&BIAS_TEMPERATURE_SENSITIVITY, &THERMAL_LAG, &BIAS_RESIDUAL_RMS, &BIAS_OVER_TEMPERATURE_RMS] {
        let rows = m.evaluate_temperature("g", &Findings::nothing(&asked()));
        withholds(&rows[0], None, "thermal_gls");
        assert_eq!(notes(&rows[0]), ["thermal.no_course"]);
    }
    for m in [&RAMP_RATE, &ANGLE_RANDOM_WALK_AT_TEMPERATURE] {
        assert!(m.evaluate_temperature("g", &Findings::nothing(&asked())).is_empty());
    }
}

#[test]
fn the_mean_slope_is_that_of_the_first_legendre_polynomial() {
    // 3 per half a span of 50 degC.
    let mut a = analysis();
    a.posterior.draws[0].covariance = diagonal(&[0.25, 0.0, 0.0, 0.0]);
    let found = row(&BIAS_TEMPERATURE_SENSITIVITY, &a);
    reads(&found, 0.06);
    // 0.5/50 of standard uncertainty.
    within(found.spread.bound(0.06, 0.975).unwrap(), 0.06 + 1.959_964 * 0.01, 1e-3);
    assert_eq!(
        (notes(&found), number(&found, "thermal.order_fixed", "order")),
        (vec!["thermal.order_fixed"], 2.0)
    );
    let tried =
        |order, held_out_rms| Tried { order, log_score: 0.0, scores: vec![], held_out_rms, average_s: 200.0 };
    a.orders = vec![tried(1, 0.5), tried(2, 0.4), tried(3, 0.3)];
    let found = row(&BIAS_TEMPERATURE_SENSITIVITY, &a);
    assert_eq!(number(&found, "thermal.order", "order"), 2.0);
    assert_eq!(number(&found, "thermal.order", "rms"), 0.4);
}

#[test]
fn the_steepest_slope_has_its_sign_and_its_place() {
    // (c₁ + 3 c₂ x)/50: largest at the end where both add.
    for (c1, c2, slope, deg_c) in [
        (3.0, 2.0, 0.18, 60.0),
        (3.0, -2.0, 0.18, -40.0),
        (-3.0, 2.0, -0.18, -40.0),
        (-3.0, -2.0, -0.18, 60.0),
    ] {
        let mut a = analysis();
        coefficients(&mut a, &[c1, c2, 0.3, 0.25]);
        let found = row(&BIAS_TEMPERATURE_SENSITIVITY_MAX, &a);
        reads(&found, slope);
        near(number(&found, "thermal.steepest", "deg_c"), deg_c);
    }
}

#[test]
fn the_range_over_temperature_gives_every_temperature_the_same_weight() {
    // 3 x + 3 x² − 1: from −1.75 at −1/2 to 5 at 1; mean square 9/3 + 4/5 about its mean.
    let a = analysis();
    for (m, value) in [
        (&BIAS_OVER_TEMPERATURE_PEAK_TO_PEAK, 6.75),
        (&BIAS_OVER_TEMPERATURE_RMS, 3.8f64.sqrt()),
        (&BIAS_OVER_TEMPERATURE_3SIGMA, 3.0 * 3.8f64.sqrt()),
    ] {
        let found = row(m, &a);
        reads(&found, value);
        assert_eq!(notes(&found), ["thermal.span"]);
        assert_eq!(number(&found, "thermal.span", "low"), -40.0);
        assert_eq!(number(&found, "thermal.span", "high"), 60.0);
    }
    let mean_square =
        (0..2000).map(|i| f64::from(i) / 1000.0 - 0.9995).map(|x| (3.0 * x + 3.0 * x * x - 1.0).powi(2));
    within(rms(&DVector::from_row_slice(&[3.0, 2.0]), 2).powi(2), mean_square.sum::<f64>() / 2000.0, 1e-5);
}

#[test]
fn a_curve_that_noise_alone_makes_is_bounded() {
    // A slope of 0.05 ± 1 in half spans: |c|/√3 is at most 1.96/√3 with 95 %.
    let mut a = analysis();
    a.posterior.terms = Terms { order: 1, rate: false, hysteresis: false };
    a.posterior.draws = (0..200).map(|_| draw(&[0.05], diagonal(&[1.0]))).collect();
    let limit = |m: &Measurand, a: &Analysis| {
        let found = row(m, a);
        assert_eq!((found.value, notes(&found)), (None, vec!["thermal_flat.curve", "thermal.span"]));
        found.upper_limit.unwrap().value
    };
    let sigma = limit(&BIAS_OVER_TEMPERATURE_RMS, &a);
    within(sigma, 1.96 / 3f64.sqrt(), 0.06);
    near(limit(&BIAS_OVER_TEMPERATURE_3SIGMA, &a), 3.0 * sigma);
    near(limit(&BIAS_OVER_TEMPERATURE_PEAK_TO_PEAK, &a), 2.0 * 3f64.sqrt() * sigma);
    // Three deviations are by chance in less than one test of twenty, and no bound of a range lies below zero.
    a.posterior.draws = (0..200).map(|_| draw(&[2.5], diagonal(&[1.0]))).collect();
    let found = row(&BIAS_OVER_TEMPERATURE_RMS, &a);
    within(found.value.unwrap(), 2.5 / 3f64.sqrt(), 0.05);
    assert!(curve(&found).iter().all(|(_, v)| *v >= 0.0) && curve(&found)[0].1 == 0.0);
}

#[test]
fn what_cannot_be_negative_is_not_read_as_such() {
    let spread = Spread::Curve(vec![(-1.0, -2.0), (1.0, 0.5)]);
    let found = positive(Reading { value: -0.5, spread });
    assert_eq!(found, Reading { value: 0.0, spread: Spread::Curve(vec![(-1.0, 0.0), (1.0, 0.5)]) });
    assert_eq!(positive(Reading { value: 0.5, spread: Spread::Unknown }).value, 0.5);
}

#[test]
fn the_loop_is_read_where_it_is_widest_without_the_ends() {
    // 2 (D r − b' τ r + h) = 2 (0.6 − 4 (3 + 6 x)/50 + 0.25): 1.988 at x = −0.8, which is −30 degC.
    let a = analysis();
    let found = row(&BIAS_LOOP_WIDTH, &a);
    reads(&found, 2.0 * (0.85 - 4.0 * (3.0 - 4.8) / 50.0));
    near(number(&found, "thermal.loop", "deg_c"), 10.0 - 40.0);
    near(number(&found, "thermal.loop", "rate"), 120.0);
    // Turned over, it has its sign and its other end.
    let mut turned = analysis();
    coefficients(&mut turned, &[-3.0, 2.0, -0.3, -0.25]);
    let found = row(&BIAS_LOOP_WIDTH, &turned);
    reads(&found, -2.0 * (0.85 + 4.0 * (-3.0 + 4.8) / 50.0));
    near(number(&found, "thermal.loop", "deg_c"), 50.0);
    let one_way = row(&BIAS_LOOP_WIDTH, &Analysis { both_ways: false, ..analysis() });
    withholds(&one_way, None, "thermal_gls");
    assert_eq!(notes(&one_way), ["thermal.one_way"]);
}

#[test]
fn a_gap_holds_only_the_terms_that_there_are() {
    let mut a = analysis();
    let d = best_draw(&a);
    assert_eq!((d.shape.clone(), d.coefficients.len()), (vec![120.0, 1.0], 4));
    near(gap(&d, &d.coefficients, 0.0, &a), 2.0 * (0.6 - 0.24 + 0.25));
    a.posterior.terms = Terms { order: 2, rate: false, hysteresis: false };
    near(gap(&d, &d.coefficients, 0.0, &a), -0.48);
    // With a hysteresis alone, its coefficient follows the polynomial.
    a.posterior.terms = Terms { order: 2, rate: false, hysteresis: true };
    near(gap(&d, &d.coefficients, 0.0, &a), 2.0 * (0.3 - 0.24));
    let without = Draw { shape: vec![], ..d };
    near(gap(&without, &without.coefficients, 0.0, &a), 0.6);
}

#[test]
fn coefficients_beside_a_lag_that_is_told_are_their_own() {
    let a = analysis();
    let rate = row(&BIAS_TEMPERATURE_RATE_SENSITIVITY, &a);
    within(rate.value.unwrap(), 0.3, 1e-4);
    within(rate.spread.bound(0.3, 0.975).unwrap(), 0.3 + 1.96 * 0.01, 2e-3);
    // The gap is twice its coefficient.
    let gap = row(&THERMAL_HYSTERESIS, &a);
    within(gap.value.unwrap(), 0.5, 1e-4);
    within(gap.spread.bound(0.5, 0.975).unwrap(), 0.5 + 1.96 * 0.04, 2e-3);
    let lag = row(&THERMAL_LAG, &a);
    within(lag.value.unwrap(), 120.0, 0.01);
    within(lag.spread.bound(120.0, 0.975).unwrap(), 120.0 + 1.96 * 5.0, 0.01);
    for found in [&rate, &gap, &lag] {
        assert_eq!(notes(found), ["thermal.separation"]);
        let inflations = ["rate", "lag", "hysteresis"].map(|n| number(found, "thermal.separation", n));
        assert_eq!(inflations, [3.0, 4.0, 5.0]);
    }
    let unknown = row(&THERMAL_LAG, &Analysis { separation: None, ..a });
    assert_eq!(number(&unknown, "thermal.separation", "lag"), 1e6);
}

#[test]
fn where_no_lag_explains_the_record_too_the_value_is_that_without_one() {
    let mut a = analysis();
    // Lags from 0 on, of a deviation of 5 s: a coefficient that does not go with them is known as well as without.
    a.posterior.lags = vec![profile((0.0, 31), (0.0, 5.0), 0.0)];
    let found = row(&BIAS_TEMPERATURE_RATE_SENSITIVITY, &a);
    within(found.value.unwrap(), 0.3, 1e-3);
    assert_eq!(notes(&found), ["thermal.separation"]);
    let lag = row(&THERMAL_LAG, &a);
    assert_eq!((lag.value, notes(&lag)), (None, vec!["thermal.no_lag"]));
    let limit = lag.upper_limit.unwrap();
    assert!((5.0..15.0).contains(&limit.value) && limit.coverage == 0.95, "{limit:?}");
    // One that grows by 0.02 a second is known far worse beside a lag.
    a.posterior.lags = vec![profile((0.0, 31), (0.0, 5.0), 0.02)];
    for (m, value, u) in [(&BIAS_TEMPERATURE_RATE_SENSITIVITY, 0.3, 0.01), (&THERMAL_HYSTERESIS, 0.5, 0.04)] {
        let found = row(m, &a);
        within(found.value.unwrap(), value, 0.05);
        assert_eq!(notes(&found), ["thermal.lag_or_rate"]);
        within(number(&found, "thermal.lag_or_rate", "u"), u, 1e-6);
        near(number(&found, "thermal.lag_or_rate", "lag"), 120.0);
    }
    // A coefficient that no lag moves is still not single where the lag has no end: 90 % of those looked at.
    a.posterior.lags = vec![profile((0.0, 31), (0.0, 1e9), 0.0)];
    a.posterior.longest_lag_s = 60.0;
    let found = row(&THERMAL_HYSTERESIS, &a);
    assert_eq!(notes(&found), ["thermal.lag_or_rate"]);
    near(number(&found, "thermal.lag_or_rate", "lag"), 1.0);
    let lag = row(&THERMAL_LAG, &a);
    withholds(&lag, None, "thermal_gls");
    near(number(&lag, "thermal.any_lag", "lag"), 1.0);
}

#[test]
fn a_lag_of_a_block_or_two_is_shown_where_it_is_told() {
    // 20 s to 5 s: 0.5 % of its distribution lie below 7 s, which is less than a block and more than none.
    let mut a = analysis();
    a.posterior.lags = vec![profile((0.0, 31), (20.0, 5.0), 0.0)];
    let found = row(&THERMAL_LAG, &a);
    within(found.value.unwrap(), 20.0, 0.01);
    assert_eq!(notes(&found), ["thermal.separation"]);
}

#[test]
fn a_value_without_a_lag_stays_within_its_interval() {
    let mut a = analysis();
    // The shortest lag says 0.3, all that explain the record nearly 4 more.
    let mut lags = profile((0.0, 31), (0.0, 1e9), 0.0);
    lags.lags.iter_mut().skip(1).for_each(|l| l.rate = Some((4.0, 0.01)));
    lags.lags[0].log_likelihood = -1.9;
    a.posterior.lags = vec![lags];
    let found = row(&BIAS_TEMPERATURE_RATE_SENSITIVITY, &a);
    let interval = found.interval95().unwrap();
    assert!((interval.low..=interval.high).contains(&found.value.unwrap()), "{found:?}");
}

#[test]
fn terms_that_the_schedule_does_not_tell_apart_are_not_stated() {
    let apart = |m: &Measurand, change: fn(&mut Analysis)| {
        let mut a = analysis();
        change(&mut a);
        row(m, &a)
    };
    let three = [&BIAS_TEMPERATURE_RATE_SENSITIVITY, &THERMAL_HYSTERESIS, &THERMAL_LAG];
    for m in three {
        let found = apart(m, |a| a.parted = false);
        assert_eq!((found.value, notes(&found)), (None, vec!["thermal.inseparable"]));
        let told = |name| number(&found, "thermal.inseparable", name);
        // Half of the gap at the middle, 10 degC; ramps of 120 degC/h want slower ones.
        within(told("half_gap"), 0.6 - 0.24 + 0.25, 1e-9);
        near(told("deg_c"), 10.0);
        near(told("rate"), 120.0);
        near(told("other"), 40.0);
        assert!(told("u") < 1e-6);
        assert_eq!(found.upper_limit.is_some(), m.id == "thermal_lag");
    }
    for (ramp, other) in [(0.2, 36.0), (0.21, 4.2)] {
        let mut a = Analysis { ramp_deg_c_min: ramp, parted: false, ..analysis() };
        a.posterior.longest_lag_s = 600.0;
        near(number(&row(&THERMAL_HYSTERESIS, &a), "thermal.inseparable", "other"), other);
    }
    // A lag that is bounded stays so: 120 s and 1.645 deviations.
    let limit = apart(&THERMAL_LAG, |a| a.parted = false).upper_limit.unwrap();
    within(limit.value, 120.0 + 1.645 * 5.0, 5e-3);
    let found = apart(&BIAS_TEMPERATURE_RATE_SENSITIVITY, |a| a.posterior.terms.rate = false);
    assert_eq!(notes(&found), ["thermal.one_way"]);
    let found = apart(&THERMAL_HYSTERESIS, |a| a.posterior.terms.hysteresis = false);
    assert_eq!(notes(&found), ["thermal.one_way"]);
}

#[test]
fn a_narrow_range_tells_neither_lag_nor_rate() {
    // 100 degC at 2 degC/min take 3000 s, less than 0.4 of 9000 s.
    let mut a = analysis();
    a.posterior.longest_lag_s = 9000.0;
    for m in [&BIAS_TEMPERATURE_RATE_SENSITIVITY, &THERMAL_LAG] {
        let found = row(m, &a);
        withholds(&found, None, "thermal_gls");
        for (name, value) in [("range", 100.0), ("crossing", 50.0), ("lag", 150.0)] {
            near(number(&found, "thermal.narrow", name), value);
        }
    }
    assert!(row(&THERMAL_HYSTERESIS, &a).value.is_some());
    a.parted = false;
    assert_eq!(notes(&row(&THERMAL_LAG, &a)), ["thermal.inseparable"]);
}

#[test]
fn the_residual_is_that_of_the_chosen_order() {
    let mut a = analysis();
    let found = row(&BIAS_RESIDUAL_RMS, &a);
    shows(&found, 0.07, "thermal_gls");
    assert_eq!((chi_square(&found), notes(&found)), (33.0, vec!["thermal.residual"]));
    assert_eq!(number(&found, "thermal.residual", "average_s"), 100.0);
    let tried =
        |order, held_out_rms| Tried { order, log_score: 0.0, scores: vec![], held_out_rms, average_s: 200.0 };
    a.orders = vec![tried(3, 0.3), tried(2, 0.4)];
    let found = row(&BIAS_RESIDUAL_RMS, &a);
    assert_eq!(number(&found, "thermal.held_out", "rms"), 0.4);
    assert_eq!(number(&found, "thermal.held_out", "average_s"), 200.0);
}

#[test]
fn ramps_are_rows_numbered_in_their_order() {
    let segment = |kind, from_s, rate_deg_c_h| Segment {
        kind,
        from_s,
        to_s: from_s + 1800.0,
        begins_deg_c: 0.0,
        ends_deg_c: 0.0,
        rate_deg_c_h,
        rate_uncertainty_deg_c_h: 0.2,
    };
    let schedule = Schedule {
        segments: vec![
            segment(SegmentKind::Soak, 0.0, 0.1),
            segment(SegmentKind::Heating, 1800.0, 60.0),
            segment(SegmentKind::Dwell, 3600.0, 0.1),
            segment(SegmentKind::Cooling, 5400.0, -58.0),
        ],
        reached: Span { low: -40.0, high: 60.0 },
        last_deg_c: 0.0,
        temperature: vec![],
        command: None,
        missing: 0.0,
    };
    let found = Findings { schedule: Some(schedule), ..Findings::nothing(&asked()) };
    let rows = RAMP_RATE.evaluate_temperature("temp", &found);
    assert_eq!(rows.iter().map(|r| r.channel.as_str()).collect::<Vec<_>>(), ["temp@ramp1", "temp@ramp2"]);
    shows(&rows[0], 60.0, "theil_sen");
    shows(&rows[1], -58.0, "theil_sen");
    assert_eq!(normal(&rows[0]), 0.2);
    near(number(&rows[1], "thermal.ramp", "from_h"), 1.5);
    near(number(&rows[1], "thermal.ramp", "to_h"), 2.0);
}

#[test]
fn zones_state_their_noise_or_bound_it() {
    let reading =
        Reading { value: 0.002, spread: Spread::Curve(vec![(-2.0, 0.0016), (0.0, 0.002), (2.0, 0.0024)]) };
    let zone = |deg_c, n, by_slow_noise, slow_share| Zone {
        deg_c,
        n,
        by_slow_noise,
        slow_share,
        average_s: 4.0,
        count: 9,
        smoothed: false,
    };
    let zones = vec![
        zone(-40.0, Some(reading.clone()), false, 0.004),
        zone(20.5, Some(reading.clone()), false, 0.005),
        zone(60.0, Some(reading), true, 0.9),
        zone(70.0, None, false, 0.0),
    ];
    let found = Findings { zones, ..Findings::nothing(&asked()) };
    let rows = ANGLE_RANDOM_WALK_AT_TEMPERATURE.evaluate_temperature("g", &found);
    let names: Vec<&str> = rows.iter().map(|r| r.channel.as_str()).collect();
    assert_eq!(names, ["g@-40", "g@20.5", "g@60", "g@70"]);
    shows(&rows[0], 0.002, "second_differences");
    assert_eq!((notes(&rows[0]), number(&rows[0], "thermal.zone", "average_s")), (vec!["thermal.zone"], 4.0));
    shows(&rows[1], 0.002, "second_differences");
    near(number(&rows[1], "thermal.zone_without_slow", "percent"), 0.5);
    // 0.002 + 0.0004·1.645/2.
    withholds(&rows[2], Some(0.002 + 0.0002 * 1.644_853_626_951_472_2), "second_differences");
    assert_eq!(number(&rows[2], "thermal.zone_slow", "average_s"), 4.0);
    withholds(&rows[3], None, "second_differences");
    assert_eq!(notes(&rows[3]), ["thermal.zone_empty"]);
}
