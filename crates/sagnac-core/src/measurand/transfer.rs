//! Bandwidth, delay, resonance and flatness of the response over frequency.

use super::descriptor::Measurand;
use crate::estimate::{Estimate, Spread};
use crate::message::{Arg, note};
use crate::rate_table::transfer::{Shown, Transfer, decibel};

const FORMULAS: &[&str] = &[
    "H(f) = S_ΩY(f) / S_ΩΩ(f)",
    "u²(|H|)/|H|² = (1 − γ²)/(2·n·γ²)",
    "H(f) ≈ K·e^(−j2πfτ) · {1; 1/(1 + jf/f₁); 1/(1 − f²/f₀² + 2jζf/f₀); sinc(fT)·e^(−jπfT)}",
];

/// Name of the method where bands are used, and where a model is.
const OF_BANDS: &str = "transfer_bands";
const OF_MODEL: &str = "transfer_model";

const MILLISECONDS: f64 = 1e3;

/// Frequency where the gain has fallen by 3 dB.
pub static BANDWIDTH_3DB: Measurand = Measurand::of_transfer(
    "bandwidth_3db",
    "Hz",
    "frequency where the gain has fallen to 0.707 of that at frequency zero",
    |m, found| vec![row(m, found, &found.bandwidth_3db(), OF_BANDS, 1.0)],
)
.also_called(&["bandwidth", "bandwidth_3_db"])
.formulas(FORMULAS, "IEEE Std 952-2020, 12.15; Bendat and Piersol, Random Data");

/// The same by the models that fit.
pub static BANDWIDTH_3DB_MODEL: Measurand = Measurand::of_transfer(
    "bandwidth_3db_model",
    "Hz",
    "frequency where the gain has fallen to 0.707, by the models that the record does not tell apart",
    |m, found| vec![by_model(m, found, &found.bandwidth_by_model(), 1.0)],
);

/// Frequency where the phase lags by a quarter of a turn.
pub static BANDWIDTH_PHASE_90: Measurand = Measurand::of_transfer(
    "bandwidth_phase_90",
    "Hz",
    "frequency where the output lags by 90°",
    |m, found| vec![row(m, found, &found.bandwidth_phase_90(), OF_BANDS, 1.0)],
);

/// Delay of slow motion.
pub static LATENCY: Measurand = Measurand::of_transfer(
    "latency",
    "ms",
    "delay of the output against slow motion, from phase over frequency",
    |m, found| vec![by_model(m, found, &found.latency_s(), MILLISECONDS)],
)
.also_called(&["delay", "group_delay"]);

/// Largest rise of the gain.
pub static RESONANCE_PEAK: Measurand = Measurand::of_transfer(
    "resonance_peak",
    "dB",
    "largest rise of the gain over that at frequency zero",
    |m, found| vec![row(m, found, &found.resonance_peak_db(), OF_BANDS, 1.0)],
)
.also_called(&["peaking"]);

/// Largest deviation of the gain in a band.
pub static RESPONSE_FLATNESS: Measurand = Measurand::of_transfer(
    "response_flatness",
    "dB",
    "largest deviation of the gain from that at frequency zero up to the stated frequency",
    |m, found| {
        let row = row(m, found, &found.flatness_db(), OF_BANDS, 1.0);
        let told = match found.test.flat_to_hz {
            Some(to) => note!("transfer.flat_to", to = Arg::figures(to, 4)),
            None => note!("transfer.no_flat_to"),
        };
        vec![row.note(told)]
    },
)
.also_called(&["flatness", "gain_flatness"]);

fn by_model(m: &Measurand, found: &Transfer, shown: &Shown, scale: f64) -> Estimate {
    let row = row(m, found, shown, OF_MODEL, scale);
    match found.best() {
        Some(best) if found.misfits() => {
            row.note(note!("transfer.misfit", percent = Arg::figures(100.0 * best.relative_misfit, 2)))
        }
        Some(_) => {
            let rivals: Vec<Arg> =
                found.rivals().map(|f| Arg::key("transfer_order", f.model.order.id())).collect();
            row.note(note!("transfer.models", models = Arg::Several(rivals, ", ".into())))
        }
        None => row,
    }
}

fn row(m: &Measurand, found: &Transfer, shown: &Shown, method: &'static str, scale: f64) -> Estimate {
    let channel = &found.channel;
    let none = |limit| m.not_identifiable(channel, limit, method);
    let row = match shown {
        Shown::Value(value, spread) => m.measured(channel, scale * value, scaled(spread, scale), method),
        Shown::AtLeast(bound) => none(None).at_least(Some(*bound)),
        Shown::AtMost(bound) => none(Some(*bound)),
        Shown::Nothing => none(None),
    };
    match (found.bands.first(), found.bands.last()) {
        (Some(first), Some(last)) => row.note(note!(
            "transfer.measured",
            from = Arg::figures(first.frequency_hz, 3),
            to = Arg::figures(last.frequency_hz, 3),
            deviation = Arg::figures(decibel(first.standard.max(last.standard)), 2)
        )),
        _ => row.note(note!("transfer.too_few", least = Arg::figures(found.test.least_coherence, 2))),
    }
}

fn scaled(spread: &Spread, scale: f64) -> Spread {
    match spread {
        Spread::Curve(points) => Spread::Curve(points.iter().map(|(s, v)| (*s, scale * v)).collect()),
        other => other.clone(),
    }
}
