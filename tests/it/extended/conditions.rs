//! Time base, temperature track, faults, closed forms and long records against references that lose no digit.

use crate::extended::exact;
use crate::extended::exact::arithmetic::X;
use crate::extended::exact::reference as slow;
use crate::extended::exact::worst::Worst;
use crate::support::synthetic::white;
use sagnac::acceptance::condition::stability_track::StabilityTrack;
use sagnac::noise::allan::{AllanAccumulator, AllanPlan};
use sagnac::noise::digest::{DigestPlan, RateAccumulator};
use sagnac::noise::family::Estimator;
use sagnac::noise::lines::find_lines;
use sagnac::noise::static_bias::{EARTH_RATE_DEG_H, Orientation, Uncertain, earth_rate, flicker_bracket};
use sagnac::noise::tau_grid::TauGrid;
use sagnac::recording::clock::{Cadence, Clock, ClockError, Step, Tracker};
use sagnac::recording::faults::FaultLog;
use sagnac::recording::value_checks::{ValueChecks, ValueFacts, ValueFaults};
use sagnac::recording::{Channel, ColumnRef, Role, SampleBlock, Sink};
use sagnac::units::Unit;

/// Stamps whose exact values are the doubles; everything about them follows in extended precision.
#[test]
fn intervals_and_jitter_are_right_for_hard_stamps() {
    let mut worst = Worst::default();
    let jitter = |i: u64| white(9, i);
    type Stamp = Box<dyn Fn(u64) -> f64>;
    let cases: [(&str, Stamp); 6] = [
        ("1 kHz from 1970", Box::new(move |i| 1.7e9 + i as f64 * 1e-3 + 2e-6 * jitter(i))),
        ("1 kHz from 0", Box::new(move |i| i as f64 * 1e-3 + 2e-6 * jitter(i))),
        ("1 Hz from 1970", Box::new(move |i| 1.7e9 + i as f64 + 1e-3 * jitter(i))),
        (
            "nanoseconds from 1970",
            Box::new(move |i| ((1.7e18 as u64) + i * 10_000_000) as f64 + 1e4 * jitter(i)),
        ),
        ("steps of 1e-9", Box::new(move |i| 5.0 + i as f64 * 1e-9 + 1e-12 * jitter(i))),
        ("steps of 1e15", Box::new(move |i| i as f64 * 1e15 + 1e10 * jitter(i))),
    ];
    for (name, stamp) in cases {
        let stamps: Vec<f64> = (0..5000).map(&*stamp).collect();
        let clock = Clock::probe(&stamps).unwrap_or_else(|e| panic!("{name}: {e}"));
        let mut tracker = Tracker::new(clock);
        assert_eq!(tracker.step(stamps[0], None), Step::Next);
        for block in stamps[1..].chunks(333) {
            assert!(tracker.take_unbroken(block), "{name}");
        }
        let steps: Vec<X> = stamps.windows(2).map(|w| X::from(w[1]) - X::from(w[0])).collect();
        let n = X::from(steps.len());
        let mean = (X::from(stamps[4999]) - X::from(stamps[0])) / &n;
        let squares = exact::arithmetic::sum(steps.iter().map(|d| (d - &mean).square()));
        let expected = (squares / &n / X::from(2.0)).sqrt().to_f64();
        // The interval is the slope of the stamps over their numbers, by least squares.
        let middle = X::from(2499.5);
        let about = |i: usize| X::from(i) - &middle;
        let products = (0..5000).map(|i| about(i) * (X::from(stamps[i]) - X::from(stamps[0])));
        let slope =
            exact::arithmetic::sum(products) / exact::arithmetic::sum((0..5000).map(|i| about(i).square()));
        worst.compare("tracker interval", name, "", tracker.mean_interval_s(), slope.to_f64(), 0.0);
        worst.compare("tracker jitter", name, "", tracker.jitter_s().unwrap(), expected, 0.0);
    }
    worst.print();
    worst.assert_none_wrong();
}

#[test]
fn stamps_finer_than_a_double_are_shared_by_rows_and_others_are_refused() {
    // A double of 1.7e9 has steps of 238 ns: hundreds of rows share a stamp, and their mean rate is what is left.
    let stamps: Vec<f64> = (0..5000).map(|i| 1.7e9 + f64::from(i) * 1e-9).collect();
    let clock = Clock::probe(&stamps).unwrap();
    assert!((clock.interval_s / 1e-9 - 1.0).abs() < 1e-4 && clock.cadence != Cadence::Even, "{clock:?}");
    assert!(matches!(Clock::probe(&[1.7e9; 50]), Err(ClockError::NotGrowing)));
    assert!(matches!(Clock::probe(&[f64::NAN; 50]), Err(ClockError::TooFew)));
    assert!(matches!(Clock::probe(&[1.0]), Err(ClockError::TooFew)));
    assert!(matches!(Clock::declared(1e-320), Err(ClockError::Rate { .. })));
    assert!(matches!(Clock::declared(f64::INFINITY), Err(ClockError::Rate { .. })));
    // Alternating stamps of the largest size: no clock, and no overflow.
    let wild: Vec<f64> = (0..100).map(|i| if i % 2 == 0 { 1e60 } else { -1e60 }).collect();
    assert!(matches!(Clock::probe(&wild), Err(ClockError::Falling { .. })));
}

#[test]
fn the_temperature_track_is_right_on_hard_records() {
    let mut worst = Worst::default();
    let base = |offset: f64, scale: f64| -> Vec<f64> {
        (0..6000).map(|i| offset + scale * (white(4, i) + 1e-3 * i as f64)).collect()
    };
    let mut spiked = base(20.0, 0.01);
    spiked[500] = 1e60;
    let mut early = base(20.0, 0.01);
    early[0] = -1e30;
    let records = [
        ("20 degC", base(20.0, 0.01)),
        ("offset 1e9 times the noise", base(1e7, 0.01)),
        ("offset 1e15 times the noise", base(1e13, 0.01)),
        ("one spike of 1e60", spiked),
        ("first sample -1e30", early),
        ("constant", vec![20.1; 6000]),
    ];
    const SMOOTHED: usize = 60;
    for (name, y) in records {
        let mut track = StabilityTrack::new(SMOOTHED as f64, 1.0, None);
        for (k, part) in y.chunks(777).enumerate() {
            track.push(part, 777.0 * k as f64, k > 0);
        }
        let found = track.finish().unwrap();
        let largest = y.iter().fold(0.0f64, |m, v| m.max(v.abs()));
        let mut running = slow::phase(&y);
        let smooth: Vec<X> =
            (SMOOTHED..running.len()).map(|i| &running[i] - &running[i - SMOOTHED]).collect();
        running.clear();
        let n = SMOOTHED as f64;
        let smooth: Vec<f64> = smooth.iter().map(|s| (s / &X::from(n)).to_f64()).collect();
        let least = smooth.iter().copied().fold(f64::INFINITY, f64::min);
        let greatest = smooth.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        worst.compare("temperature mean", name, "", found.mean, slow::mean(&y).to_f64(), largest);
        worst.compare("temperature smoothed", name, "least", found.smooth_min.value, least, 0.0);
        worst.compare("temperature smoothed", name, "greatest", found.smooth_max.value, greatest, 0.0);
        let mut steepest = X::zero();
        for part in y.chunks_exact(1800) {
            let centre = slow::mean(part);
            let (mut xy, mut xx) = (X::zero(), X::zero());
            for (i, v) in part.iter().enumerate() {
                let x = X::from(i as f64 - 899.5);
                xy = xy + &x * &(X::from(*v) - &centre);
                xx = xx + x.square();
            }
            let slope = xy / xx * X::from(3600.0);
            if (slope.abs() - steepest.abs()).is_positive() {
                steepest = slope;
            }
        }
        let got = found.steepest_deg_c_per_h.unwrap();
        let range = y.iter().fold(0.0f64, |m, v| m.max((v - y[0]).abs()));
        worst.compare("temperature trend", name, "", got, steepest.to_f64(), range);
    }
    worst.print();
    worst.assert_none_wrong();
}

/// Whole numbers of up to 2^50: every step of the reference is exact in 128 bits.
#[test]
fn long_records_with_strided_sums_are_right_to_the_last_digits() {
    const COUNT: usize = 4_200_000;
    let value = |i: usize| -> i64 {
        let wide = (white(8, i as u64) * 1e6).round() as i64;
        (1i64 << 50) + wide + i as i64 / 64
    };
    let whole: Vec<i64> = (0..COUNT).map(value).collect();
    let mut a = AllanAccumulator::new(AllanPlan {
        tau0_s: 1.0,
        grid: TauGrid::Octave,
        exact: false,
        estimators: vec![Estimator::Allan, Estimator::Modified, Estimator::Hadamard],
    });
    for (k, part) in whole.chunks(65_536).enumerate() {
        let part: Vec<f64> = part.iter().map(|v| *v as f64).collect();
        a.push(&part, 65_536 * k as u64, k > 0);
    }
    let found = a.finish();
    assert!(found.curves.iter().any(|c| c.points.iter().any(|p| p.stride > 1)), "nothing was strided");
    let mut phase = vec![0i128; COUNT + 1];
    for (i, v) in whole.iter().enumerate() {
        phase[i + 1] = phase[i] + i128::from(v - (1i64 << 50));
    }
    let mut twice = vec![0i128; COUNT + 2];
    for (i, v) in phase.iter().enumerate() {
        twice[i + 1] = twice[i] + v;
    }
    let mut worst = Worst::default();
    for curve in &found.curves {
        for point in curve.points.iter().filter(|p| [1, 8, 128, 2048, 65_536, 1_048_576].contains(&p.m)) {
            let (m, stride) = (point.m as usize, point.stride as usize);
            let (x, order, divisor, power) = match curve.estimator {
                Estimator::Allan => (&phase, 2, 2.0, 2),
                Estimator::Hadamard => (&phase, 3, 6.0, 2),
                _ => (&twice, 3, 2.0, 4),
            };
            let (mut sum, mut terms) = (X::zero(), 0u64);
            let mut partial = 0.0;
            for i in (0..x.len().saturating_sub(order * m)).step_by(stride) {
                let d = if order == 2 {
                    x[i + 2 * m] - 2 * x[i + m] + x[i]
                } else {
                    x[i + 3 * m] - 3 * x[i + 2 * m] + 3 * x[i + m] - x[i]
                };
                // Squares are positive: a thousand of them lose no more than a thousand units of the last place.
                partial += (d as f64).powi(2);
                terms += 1;
                if terms % 1024 == 0 {
                    sum = sum + X::from(std::mem::take(&mut partial));
                }
            }
            sum = sum + X::from(partial);
            assert_eq!(terms, point.terms, "{} at {m}", curve.estimator.id());
            let scale = X::from(divisor) * X::from((m as f64).powi(power)) * X::from(terms as usize);
            let expected = (sum / scale).sqrt().to_f64();
            worst.compare(
                curve.estimator.id(),
                "4.2 million, strided",
                &format!("m = {m}"),
                point.deviation,
                expected,
                0.0,
            );
        }
    }
    worst.print();
    worst.assert_none_wrong();
}

/// Facts and faults of one gyro channel.
fn checked(values: &[f64]) -> (ValueFacts, ValueFaults) {
    let channel = Channel {
        id: "rate".into(),
        column: ColumnRef::Position(1),
        role: Role::Rate,
        unit: Unit::parse("deg/h").unwrap(),
        scale: 1.0,
    };
    let mut checks = ValueChecks::new(&[channel], 1.0);
    let columns = [values.to_vec()];
    checks.push(&SampleBlock {
        first_index: 0,
        first_row: 1,
        time_s: 0.0,
        continues: false,
        values: &columns,
    });
    let (facts, faults) = checks.finish(&mut FaultLog::default());
    (facts[0], faults)
}

/// A record on a lattice of 2^-6 with one outlier, a stuck stretch and samples at a rail.
fn faulty() -> Vec<f64> {
    let mut y: Vec<f64> = (0..6000).map(|i| (white(6, i) * 64.0).round() / 64.0).collect();
    y.iter_mut().for_each(|v| *v = v.min(2.0));
    y[1234] = -100.0;
    y[3000..3100].fill(0.25);
    y
}

#[test]
fn faults_do_not_depend_on_offset_and_scale() {
    let sound = faulty();
    let (facts, faults) = checked(&sound);
    assert_eq!((faults.outliers, faults.stuck), (1, 100));
    assert_eq!(faults.saturated, sound.iter().filter(|v| **v == 2.0).count() as u64);
    assert_eq!(facts.quantization_step, Some(1.0 / 64.0));
    // 2^30 is exact on this lattice; powers of two scale every double exactly.
    for (offset, scale) in [
        (2f64.powi(30), 1.0),
        (-2f64.powi(30), 1.0),
        (0.0, 2f64.powi(-180)),
        (0.0, 2f64.powi(190)),
        (0.0, -1.0),
    ] {
        let moved: Vec<f64> = sound.iter().map(|v| (v + offset) * scale).collect();
        let (other, found) = checked(&moved);
        assert_eq!(found, faults, "{offset} {scale}");
        assert_eq!(other.quantization_step, Some(scale.abs() / 64.0), "{offset} {scale}");
    }
    // At 1e15 times the noise a lattice of its rounding is all that is left, and it is not taken for one of the gyro.
    let coarse: Vec<f64> = sound.iter().map(|v| v + 1e15).collect();
    let (other, found) = checked(&coarse);
    assert_eq!((found.outliers, other.quantization_step), (1, None));
}

#[test]
fn lines_do_not_depend_on_offset_and_scale() {
    let record = |offset: f64, scale: f64| {
        let y: Vec<f64> = (0..65_536)
            .map(|i| {
                let line = 0.5 * (std::f64::consts::TAU * 0.11 * i as f64).sin();
                ((white(7, i) + line) * 65_536.0).round() / 65_536.0 * scale + offset
            })
            .collect();
        let mut a = RateAccumulator::new(DigestPlan::new(1.0));
        a.push(&y, 0, false);
        find_lines(&a.finish().welch.spectrum, 1.0, 0.01)
    };
    let plain = record(0.0, 1.0);
    assert_eq!(plain.lines.len(), 1);
    assert!((plain.lines[0].frequency_hz - 0.11).abs() < 1e-5);
    assert!((plain.lines[0].amplitude_deg_h - 0.5).abs() < 0.03, "{:?}", plain.lines);
    for (offset, scale) in [(2f64.powi(33), 1.0), (0.0, 2f64.powi(-190)), (0.0, 2f64.powi(190))] {
        let other = record(offset, scale);
        assert_eq!(other.lines.len(), 1, "{offset} {scale}");
        let (a, b) = (other.lines[0], plain.lines[0]);
        assert!((a.frequency_hz / b.frequency_hz - 1.0).abs() < 1e-9, "{offset} {scale}");
        assert!((a.amplitude_deg_h / (b.amplitude_deg_h * scale) - 1.0).abs() < 1e-9, "{offset} {scale}");
    }
}

#[test]
fn earth_rate_and_flicker_bracket_agree_with_extended_precision() {
    let mut worst = Worst::default();
    for (phi, a, e) in
        [(55.75, 0.0, 0.0), (-33.9, 123.4, 5.0), (90.0, 0.0, 90.0), (0.0, 90.0, 0.0), (1e-9, 90.0, 45.0)]
    {
        let rad = |deg: f64| X::from(deg) * X::pi() / X::from(180.0);
        let (p, h, v) = (rad(phi), rad(a), rad(e));
        let expected = X::from(EARTH_RATE_DEG_H) * (p.cos() * v.cos() * h.cos() + p.sin() * v.sin());
        let known = |value: f64| Uncertain { value, uncertainty: 0.0 };
        let got = earth_rate(&Orientation {
            latitude_deg: known(phi),
            heading_deg: known(a),
            elevation_deg: known(e),
        });
        worst.compare(
            "earth rate",
            "orientation",
            &format!("{phi} {a} {e}"),
            got.value,
            expected.to_f64(),
            15.0,
        );
    }
    for b in [1e-9, 1e-3, 0.5, 1.0, 3.0, 4.0, 10.0, 30.0] {
        // Ci by its power series, which converges everywhere; 704 bits bear the cancellation.
        let x = X::from(b);
        let (mut term, mut series) = (X::from(1.0), X::zero());
        for n in 1..400usize {
            term = -(term * x.square()) / X::from(2 * n * (2 * n - 1));
            series = series + &term / &X::from(2 * n);
        }
        let ci = euler() + x.ln() + series;
        let expected = (X::from(1.0) - x.cos()) / x.square() + x.sin() / &x - ci;
        worst.compare(
            "flicker bracket",
            "1e-9 to 30",
            &format!("b = {b}"),
            flicker_bracket(b),
            expected.to_f64(),
            0.0,
        );
    }
    worst.print();
    worst.assert_none_wrong();
}

/// Euler's constant (OEIS A001620) to 48 digits, sixteen at a time: whole numbers that a double holds exactly.
fn euler() -> X {
    let place = X::from(1e16);
    [2_431_042_159_335_939.0, 6_060_651_209_008_240.0, 5_772_156_649_015_328.0]
        .into_iter()
        .fold(X::zero(), |below, digits| (below + X::from(digits)) / &place)
}
