//! A real unit in a thermal chamber, against models of temperature and time fitted by ordinary least squares.
//!
//! `SAGNAC_REAL_DATA=... cargo test --test it real thermal -- --nocapture`; skipped without the folder.

use sagnac::recording::window::TimeSpan;
use sagnac::series::{SeriesOptions, load_series};
use sagnac::temperature::TemperatureTest;
use sagnac::temperature::course::{Course, Terms};
use sagnac::temperature::findings::{Findings, findings, schedule};
use sagnac::temperature::order;
use sagnac::temperature::track::Track;
use std::path::PathBuf;

fn asked() -> TemperatureTest {
    TemperatureTest {
        channel: "temp".into(),
        command: None,
        low_deg_c: -17.0,
        high_deg_c: 73.0,
        end_tolerance_deg_c: 2.0,
        overshoot_deg_c: None,
        ramp_rate_deg_c_h: None,
        ramp_rate_tolerance: 0.1,
        slowest_deg_c_h: 60.0,
        fastest_deg_c_h: 600.0,
        dwell_s: None,
        dwell_drift_deg_c_h: 5.0,
        ramps_each_way: 1,
        sensor_uncertainty_deg_c: 0.5,
        coverage_factor: 2.0,
        zones_deg_c: vec![0.0, 30.0, 60.0],
        residual_average_s: 10.0,
        highest_order: 6,
        segments: vec![],
    }
}

fn sweep(axis: &str) -> Option<(Findings, f64)> {
    let Some(folder) = std::env::var_os("SAGNAC_REAL_DATA") else {
        eprintln!("SAGNAC_REAL_DATA is not set: skipped");
        return None;
    };
    let file = PathBuf::from(folder).join("mems_thermal_chamber_sweep/sweep_xy.csv.gz");
    let options = SeriesOptions { rate: Some(format!("rate_{axis}_deg_s")), ..SeriesOptions::default() };
    let series = load_series(&[file], &options, &mut |_, _| {}).unwrap();
    let temperature = series.columns.iter().find(|(c, _)| c.name().contains("temp")).unwrap().1;
    // The first samples belong to the switching on.
    let mut track = Track::new(2, series.sample_interval_s);
    for (i, at) in series.index.iter().enumerate().skip(6) {
        track.push(0, &series.rate_deg_h[i..=i], *at);
        track.push(1, &temperature[i..=i], *at);
    }
    let means = track.finish().unwrap();
    let test = asked();
    let s = schedule(&means, 1, None, &test);
    Some((findings(&means, 0, 1, s, &test), series.sample_interval_s))
}

/// mdeg/s of deg/h.
fn mdeg_s(deg_h: f64) -> f64 {
    deg_h / 3.6
}

/// Rms of what ordinary least squares leaves of some columns on the course, and of stretches of blocks held out in turn.
fn ordinary(course: &Course, columns: &[Vec<f64>], folds: &[(usize, usize)]) -> (f64, f64) {
    use nalgebra::{DMatrix, DVector};
    let n = course.len();
    let fit = |rows: &[usize]| -> DVector<f64> {
        let x = DMatrix::from_fn(rows.len(), columns.len() + 1, |i, j| {
            if j == 0 { 1.0 } else { columns[j - 1][rows[i]] }
        });
        let y = DVector::from_fn(rows.len(), |i, _| course.rate_deg_h[rows[i]]);
        (x.transpose() * &x).try_inverse().unwrap() * x.transpose() * y
    };
    let error = |c: &DVector<f64>, i: usize| {
        course.rate_deg_h[i] - c[0] - columns.iter().enumerate().map(|(j, v)| c[j + 1] * v[i]).sum::<f64>()
    };
    let all: Vec<usize> = (0..n).collect();
    let whole = fit(&all);
    let inside: f64 = all.iter().map(|i| error(&whole, *i).powi(2)).sum();
    let (mut outside, mut count) = (0.0, 0);
    for held in folds.iter().map(|f| f.0..f.1) {
        let rest: Vec<usize> = all.iter().copied().filter(|i| !held.contains(i)).collect();
        let c = fit(&rest);
        count += held.len();
        outside += held.map(|i| error(&c, i).powi(2)).sum::<f64>();
    }
    ((inside / n as f64).sqrt(), (outside / count as f64).sqrt())
}

#[allow(clippy::too_many_lines, reason = "one recording, step by step")]
#[test]
fn a_chamber_sweep_is_predicted_better_than_by_the_ladder() {
    for axis in ["x", "y"] {
        let Some((found, _)) = sweep(axis) else { return };
        let s = found.schedule.as_ref().unwrap();
        for g in &s.segments {
            eprintln!(
                "{:?} {:.0}-{:.0} s, {:.1} to {:.1} degC, {:.0} ± {:.0} degC/h",
                g.kind,
                g.from_s,
                g.to_s,
                g.begins_deg_c,
                g.ends_deg_c,
                g.rate_deg_c_h,
                g.rate_uncertainty_deg_c_h
            );
        }
        let a = found.analysis.as_ref().unwrap();
        let course = &a.course;
        let span = course.span();
        let n = course.len();
        let end = course.first_s + n as f64 * course.block_s;
        let at = |k: i32| end * f64::from(k) / 10.0;
        let tenths: Vec<TimeSpan> = (0..10).map(|k| TimeSpan { from_s: at(k), to_s: at(k + 1) }).collect();
        let t: Vec<f64> = course.temperature_deg_c.iter().map(|t| span.argument(*t)).collect();
        let time: Vec<f64> = (0..n).map(|i| i as f64 / n as f64).collect();
        let rate =
            sagnac::temperature::course::rate_per_minute(&course.temperature_deg_c, course.block_s, 10);
        let power = |v: &[f64], k: i32| v.iter().map(|x| x.powi(k)).collect::<Vec<f64>>();
        let power_of = |v: &[f64], most: i32| (1..=most).map(|k| power(v, k)).collect::<Vec<_>>();
        let cubic = vec![power(&t, 1), power(&t, 2), power(&t, 3)];
        let mixed: Vec<f64> = t.iter().zip(&rate).map(|(a, b)| a * b).collect();
        let with_rate = [cubic.clone(), vec![rate.clone(), mixed]].concat();
        let with_time = [with_rate.clone(), vec![time.clone()]].concat();
        let lagged = sagnac::temperature::course::lagged(&course.temperature_deg_c, course.block_s, 3600.0);
        let l: Vec<f64> = lagged.iter().map(|t| span.argument(*t)).collect();
        let with_lag = [cubic.clone(), vec![power(&l, 1), power(&l, 2), power(&l, 3)]].concat();
        eprintln!("{axis}: rms in the sample, of tenths and of whole ramps held out, mdeg/s");
        let (mut best, mut best_by_ramps) = (f64::INFINITY, f64::INFINITY);
        let block = |t: f64| (((t - course.first_s) / course.block_s).round().max(0.0) as usize).min(n);
        let by_tenths: Vec<(usize, usize)> = (0..10).map(|k| (k * n / 10, (k + 1) * n / 10)).collect();
        let ramps: Vec<(usize, usize)> = s
            .segments
            .iter()
            .filter(|s| s.kind.is_ramp())
            .map(|s| (block(s.from_s), block(s.to_s)))
            .collect();
        for (name, columns) in [
            ("linear", &power_of(&t, 1)),
            ("quadratic", &power_of(&t, 2)),
            ("cubic", &cubic),
            ("with rate", &with_rate),
            ("with time", &with_time),
            ("with a lag of 3600 s", &with_lag),
        ] {
            let (inside, outside) = ordinary(course, columns, &by_tenths);
            let (_, over_ramps) = ordinary(course, columns, &ramps);
            best = best.min(outside);
            best_by_ramps = best_by_ramps.min(over_ramps);
            eprintln!(
                "  {name:<24} {:.1}  {:.1}  {:.1}",
                mdeg_s(inside),
                mdeg_s(outside),
                mdeg_s(over_ramps)
            );
        }
        let terms = |order| Terms { order, rate: true, hysteresis: true };
        let tried = order::try_orders(course, span, &tenths, terms, 6);
        let chosen = order::choose(&tried).unwrap();
        let residual = a.residual_by_block();
        let inside = (residual.iter().map(|r| r * r).sum::<f64>() / n as f64).sqrt();
        let slow = a.slow_noise();
        let left = (residual.iter().zip(&slow).map(|(r, s)| (r - s).powi(2)).sum::<f64>() / n as f64).sqrt();
        eprintln!(
            "  ours: order {} by ramps, held out {:.1}; tenths: order {}, held out {:.1}; in the sample {:.1}, less slow noise {:.1}",
            a.order,
            mdeg_s(a.orders.iter().find(|o| o.order == a.order).map_or(f64::NAN, |o| o.held_out_rms)),
            chosen.order,
            mdeg_s(chosen.held_out_rms),
            mdeg_s(inside),
            mdeg_s(left),
        );
        assert!(chosen.held_out_rms < best, "{axis}: {} {best}", chosen.held_out_rms);
        let shown = a.orders.iter().find(|o| o.order == a.order).map_or(f64::INFINITY, |o| o.held_out_rms);
        assert!(shown < 0.7 * best_by_ramps, "{axis}: {shown} {best_by_ramps}");
    }
}
