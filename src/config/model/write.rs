//! A claim as a TOML file, its keys in the order of the contract. Reading it gives the same claim to the bit.

use super::{Claim, Stated};
use crate::effect::{Column, Value};
use crate::i18n::LocalText;
use std::fmt::Write as _;

/// Numbers in a line of a list.
const PER_LINE: usize = 8;

/// The text of a claim.
pub fn write(claim: &Claim) -> String {
    let mut out = String::from("[recording]\n");
    let line = |out: &mut String, key: &str, value: String| {
        let _ = writeln!(out, "{key} = {value}");
    };
    if !claim.case.is_empty() {
        line(&mut out, "case", quoted(&claim.case));
    }
    if !claim.description.is_empty() {
        line(&mut out, "description", local(&claim.description));
    }
    line(&mut out, "sample_rate_hz", float(claim.sample_rate_hz));
    if let Some(columns) = &claim.columns {
        let names = ["time_s", "rate_deg_h"].into_iter().chain(columns.iter().copied().map(Column::name));
        line(&mut out, "columns", format!("[{}]", names.map(quoted).collect::<Vec<_>>().join(", ")));
    }
    let mut table = |name: &str, keys: &[(&str, f64)]| {
        let _ = writeln!(out, "\n[{name}]");
        for (key, value) in keys {
            let _ = writeln!(out, "{key} = {}", float(*value));
        }
    };
    table(
        "noise",
        &[
            ("N_deg_rt_h", claim.noise.n),
            ("B_deg_h", claim.noise.b),
            ("K_deg_h_rt_h", claim.noise.k),
            ("quantization_lsb_arcsec", claim.quantization_lsb_arcsec),
        ],
    );
    table("bias", &[("value_deg_h", claim.mean.bias_deg_h)]);
    if let Some(t) = claim.mean.temperature {
        let keys = [
            ("coefficient_deg_h_per_degC", t.coefficient_deg_h_per_degc),
            ("reference_degC", t.reference_degc),
        ];
        table("temperature", &keys);
    }
    if let Some(error_ppm) = claim.mean.scale_factor_ppm {
        table("scale_factor", &[("error_ppm", error_ppm)]);
    }
    if let Some(e) = claim.mean.earth {
        table("earth", &[("latitude_deg", e.latitude_deg), ("azimuth_deg", e.azimuth_deg)]);
    }
    let u = &claim.uncertainty;
    table(
        "uncertainty",
        &[
            ("N_rel", u.n_rel),
            ("B_rel", u.b_rel),
            ("K_rel", u.k_rel),
            ("bias_deg_h", u.bias_deg_h),
            ("temperature_coefficient_deg_h_per_degC", u.temperature_coefficient_deg_h_per_degc),
            ("scale_factor_ppm", u.scale_factor_ppm),
        ],
    );
    let where_stated = [
        ("N_deg_rt_h", u.n_deg_rt_h),
        ("B_deg_h", u.b_deg_h),
        ("K_deg_h_rt_h", u.k_deg_h_rt_h),
        ("N_at_most_deg_rt_h", u.n_at_most_deg_rt_h),
        ("B_at_most_deg_h", u.b_at_most_deg_h),
        ("K_at_most_deg_h_rt_h", u.k_at_most_deg_h_rt_h),
        ("skewness", u.skewness),
    ];
    for (key, value) in where_stated.into_iter().filter(|(_, value)| *value > 0.0) {
        let _ = writeln!(out, "{key} = {}", float(value));
    }
    for stated in &claim.effects {
        effect(stated, "effect", &mut out);
    }
    out
}

/// Appends an effect as a table of some name.
pub(crate) fn effect(stated: &Stated, table: &str, out: &mut String) {
    let _ = write!(out, "\n[[{table}]]\nkind = {}\n[{table}.parameters]\n", quoted(stated.effect.kind()));
    let (numbers, lists): (Vec<_>, Vec<_>) =
        stated.values.iter().partition(|(_, value)| !matches!(value, Value::List(_)));
    let declared = |name: &str| stated.effect.params().iter().position(|p| p.name == name);
    let mut numbers = numbers;
    numbers.sort_by_key(|(name, _)| declared(name).unwrap_or(usize::MAX));
    for (name, value) in numbers.into_iter().chain(lists) {
        let text = match value {
            Value::Number(number) => float(*number),
            Value::Text(text) => quoted(text),
            Value::List(list) => {
                let lines =
                    list.chunks(PER_LINE).map(|c| c.iter().map(|v| float(*v)).collect::<Vec<_>>().join(", "));
                format!("[\n  {},\n]", lines.collect::<Vec<_>>().join(",\n  "))
            }
        };
        let _ = writeln!(out, "{name} = {text}");
    }
}

/// The shortest text that reads as the same number; TOML floats have a point or an exponent.
fn float(value: f64) -> String {
    format!("{value:?}")
}

/// A TOML string.
/// A text in one language for all, or a table of it by language.
fn local(text: &LocalText) -> String {
    if text.by_language().is_empty() {
        return quoted(text.text());
    }
    let texts: Vec<String> =
        text.by_language().iter().map(|(code, text)| format!("{code} = {}", quoted(text))).collect();
    format!("{{ {} }}", texts.join(", "))
}

fn quoted(text: impl AsRef<str>) -> String {
    toml::Value::String(text.as_ref().to_owned()).to_string()
}
