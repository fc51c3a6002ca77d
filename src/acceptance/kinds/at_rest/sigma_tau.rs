//! `sigma_tau.csv`: every point of the Allan family with its interval.

use crate::measurand::GyroEvidence;
use crate::noise::intervals::bounded;
use crate::record::DeviationRecord;
use std::fmt::Write;

/// The table of a channel, as the result contract fixes it.
pub fn csv(gyro: &GyroEvidence) -> String {
    let mut out =
        String::from("estimator,tau_s,m,n,stride,deviation_deg_h,low_deg_h,high_deg_h,edf,noise_type\n");
    let scattering = gyro.identification.described.model.without_lines();
    for curve in &gyro.digest.deviations.curves {
        for point in &curve.points {
            let tau_s = point.m as f64 * gyro.tau0_s;
            let noise = scattering.dominant(tau_s, gyro.tau0_s);
            let b = bounded(curve.estimator, point, &curve.stretches, noise);
            let (low, high) = b.interval95.map_or((None, None), |i| (Some(i.low), Some(i.high)));
            let number = |v: Option<f64>| v.map(|v| format!("{v:e}")).unwrap_or_default();
            let _ = writeln!(
                out,
                "{},{},{},{},{},{:e},{},{},{},{}",
                curve.estimator.id(),
                tau_s,
                point.m,
                point.terms,
                point.stride,
                point.deviation,
                number(low),
                number(high),
                if b.edf > 0.0 { format!("{:.4}", b.edf) } else { String::new() },
                noise.id(),
            );
        }
    }
    out
}

/// Share of the record up to which points stand in the report.
const MAX_RECORD_SHARE: f64 = 1.0 / 3.0;

/// Octaves of every estimator, for the report.
pub fn records(gyro: &GyroEvidence) -> Vec<DeviationRecord> {
    let mut out = vec![];
    let scattering = gyro.identification.described.model.without_lines();
    for curve in &gyro.digest.deviations.curves {
        for point in curve.points.iter().filter(|p| p.m.is_power_of_two()) {
            let tau_s = point.m as f64 * gyro.tau0_s;
            if tau_s > gyro.longest_stretch_s * MAX_RECORD_SHARE {
                continue;
            }
            let noise = scattering.dominant(tau_s, gyro.tau0_s);
            let b = bounded(curve.estimator, point, &curve.stretches, noise);
            out.push(DeviationRecord {
                channel: gyro.channel.clone(),
                estimator: curve.estimator.id().to_owned(),
                tau_s,
                deviation_deg_h: b.point.deviation,
                low_deg_h: b.interval95.map(|i| i.low),
                high_deg_h: b.interval95.map(|i| i.high),
                edf: b.edf,
            });
        }
    }
    out
}
