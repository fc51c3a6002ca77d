//! The files of a case: recording, claim, truth, contribution.

use super::case::{Case, Realisation};
use super::classes::same_class;
use super::draw::Draw;
use super::effect::Effect;
use super::kinds::catalogued;
use serde_json::{Value, json};
use std::fmt::Write;
use std::path::Path;

/// Rows kept.
fn kept(case: &Case) -> Vec<bool> {
    let mut kept = vec![true; case.setting.rows];
    for left in case.left_out.iter().chain(&case.stated) {
        left.effect.dropped.iter().for_each(|&i| kept[i] = false);
    }
    kept
}

/// Decimals that show a ten-thousandth of `size`.
fn decimals(size: f64) -> usize {
    (4.0 - size.max(1e-9).log10()).ceil().clamp(3.0, 9.0) as usize
}

/// The text of `recording.csv`.
pub fn recording(case: &Case, made: &Realisation, noise_seed: u64) -> String {
    let s = &case.setting;
    let d = &s.drivers;
    let mut sensors = Draw::new(noise_seed, "sensors");
    let sigma = s.claim.white_sigma();
    let felt = s.claim.temperature.map_or(0.0, |(c, _)| c.abs());
    let thermometer = (0.01 * sigma / felt.max(1e-12)).min(0.003);
    let places = decimals(sigma);
    // A lattice must not be blurred by the printing of it.
    let lsb = case.left_out.iter().map(|l| l.effect.lsb_arcsec).fold(s.claim.lsb_arcsec, f64::max);
    let places = if lsb > 0.0 { places.max(decimals(lsb * s.claim.rate_hz)) } else { places };
    let mut text = s.claim.columns.join(",");
    text.push('\n');
    let width = s.interval_s();
    for (i, keep) in kept(case).into_iter().enumerate() {
        let t = s.time_s[i];
        let noise = [sensors.normal(), sensors.normal()];
        if !keep {
            continue;
        }
        let _ = write!(text, "{t:.6},{:.places$}", made.rate_deg_h[i]);
        if let Some(thermal) = d.any_thermal() {
            let _ = write!(text, ",{:.5}", thermal.at(t) + thermometer * noise[0]);
        }
        if let Some(table) = &d.table {
            let _ = write!(text, ",{:.10}", table.mean(t, width));
        }
        if d.heading.is_some() {
            let _ = write!(text, ",{:.6}", d.heading_deg(t).rem_euclid(360.0));
        }
        if let Some(outer) = &d.outer {
            let _ = write!(text, ",{:.10}", outer.mean(t, width));
        }
        if let Some(supply) = &d.supply {
            let _ = write!(text, ",{:.5}", supply.at(t) + 1e-4 * noise[1]);
        }
        text.push('\n');
    }
    text
}

fn rms(x: &[f64]) -> f64 {
    let mean = x.iter().sum::<f64>() / x.len() as f64;
    (x.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / x.len() as f64).sqrt()
}

fn told(effect: &Effect, strength: f64, case: &Case, contribution: Option<&Vec<f64>>) -> Value {
    let mut parameters = serde_json::Map::new();
    for (name, value) in &effect.parameters {
        parameters.insert((*name).to_string(), json!(value));
    }
    let rms = contribution.filter(|c| !c.is_empty()).map(|c| rms(c));
    if let Some(rms) = rms {
        parameters.insert("rms_deg_h".into(), json!(rms));
    }
    let wheres: Vec<Value> = effect
        .wheres
        .iter()
        .map(|w| json!({"domain": w.domain, "from": w.from, "to": w.to, "local": w.local}))
        .collect();
    json!({
        "kind": effect.kind,
        "catalogued": catalogued(&effect.kind),
        "parameters": parameters,
        "where": wheres,
        "strength": strength.is_finite().then_some(strength),
        "rms_deg_h": rms,
        "class": same_class(&effect.kind, case.setting.scenario),
    })
}

/// The truth as JSON.
pub fn truth(case: &Case, made: &Realisation) -> Value {
    let effects: Vec<Value> = case
        .left_out
        .iter()
        .zip(&made.contributions)
        .map(|(l, c)| told(&l.effect, l.strength, case, Some(c)))
        .collect();
    let stated: Vec<Value> = case.stated.iter().map(|l| told(&l.effect, l.strength, case, None)).collect();
    let known = case.left_out.iter().all(|l| catalogued(&l.effect.kind));
    let verdict = match (effects.is_empty(), known) {
        (true, _) => "consistent",
        (false, true) => "mismatch",
        (false, false) => "unknown-mismatch",
    };
    let d = &case.setting.departure;
    json!({
        "case": case.name,
        "seed": case.seed,
        "scenario": format!("{:?}", case.setting.scenario),
        "rows": case.setting.rows,
        "duration_s": case.setting.duration_s(),
        "verdict": verdict,
        "effects": effects,
        "stated": stated,
        "contribution": contribution(case, made).is_some().then_some("contribution.csv"),
        "departures": {
            "N_rel": d.n_rel, "B_rel": d.b_rel, "K_rel": d.k_rel, "bias_deg_h": d.bias_deg_h,
            "temperature_coefficient_deg_h_per_degC": d.coefficient, "scale_factor_ppm": d.scale_ppm,
        },
    })
}

/// Times and sum of what is left out and can be predicted, mean removed; `None` when there is none.
pub fn contribution(case: &Case, made: &Realisation) -> Option<(Vec<f64>, Vec<f64>)> {
    let parts: Vec<&Vec<f64>> = made.contributions.iter().filter(|c| !c.is_empty()).collect();
    if parts.is_empty() {
        return None;
    }
    let rows: Vec<usize> = kept(case).iter().enumerate().filter(|(_, k)| **k).map(|(i, _)| i).collect();
    let mut sum: Vec<f64> = rows.iter().map(|&i| parts.iter().map(|p| p[i]).sum()).collect();
    let mean = sum.iter().sum::<f64>() / sum.len() as f64;
    sum.iter_mut().for_each(|v| *v -= mean);
    Some((rows.iter().map(|&i| case.setting.time_s[i]).collect(), sum))
}

/// Writes a case into a folder of its own and returns its truth.
pub fn write(case: &Case, folder: &Path, noise_seed: u64) -> std::io::Result<Value> {
    std::fs::create_dir_all(folder)?;
    let made = case.realise(noise_seed);
    let truth = truth(case, &made);
    std::fs::write(folder.join("recording.csv"), recording(case, &made, noise_seed))?;
    std::fs::write(folder.join("model.toml"), case.setting.claim.toml())?;
    std::fs::write(folder.join("truth.json"), serde_json::to_string_pretty(&truth)?)?;
    if let Some((times, values)) = contribution(case, &made) {
        let mut text = String::from("time_s,deg_h\n");
        for (t, v) in times.iter().zip(&values) {
            let _ = writeln!(text, "{t:.6},{v:.9e}");
        }
        std::fs::write(folder.join("contribution.csv"), text)?;
    }
    Ok(truth)
}
