//! Resonance of the unit under vibration: frequency, sharpness and size.

use super::descriptor::Measurand;
use super::evidence::ComparisonEvidence;
use crate::estimate::{Estimate, Spread, UpperLimit};
use crate::influence::Influence;
use crate::influence::resonance::{Measured, Peak, Resonance, Shown};
use crate::message::{Arg, note};

const METHOD: &str = "vibration_spectra";

const FORMULAS: &[&str] =
    &["H(f) = S_aY(f) / S_aa(f)", "H(f) ≈ c₀ + c₁·(f − f₀) + R·(−j/Q) / (1 − (f/f₀)² + jf/(Q·f₀))"];

/// Frequency of the resonance.
pub static VIBRATION_RESONANCE_FREQUENCY: Measurand = of(
    "vibration_resonance_frequency",
    "Hz",
    "frequency at which the output resonates with the acceleration",
    |m, compared| row(m, compared, |peak| normal(peak.frequency_hz), |_| None),
)
.formulas(FORMULAS, "Bendat and Piersol, Random Data");

/// Quality factor of the resonance.
pub static VIBRATION_RESONANCE_QUALITY: Measurand = of(
    "vibration_resonance_quality",
    "1",
    "quality factor of the resonance: its amplification over the response far below it",
    |m, compared| {
        let quality = |peak: &Peak| {
            let Measured { value, standard } = peak.log_quality;
            (!peak.sharp).then(|| (value.exp(), Spread::by_score(|score| (value + score * standard).exp())))
        };
        row(m, compared, quality, |_| None)
    },
)
.also_called(&["vibration_amplification", "q_factor"]);

/// Response of the resonance.
pub static VIBRATION_RESONANCE_RESPONSE: Measurand = of(
    "vibration_resonance_response",
    "deg/h/g",
    "amplitude of the output per acceleration at the resonance",
    |m, compared| row(m, compared, |peak| normal(peak.response).filter(|_| !peak.sharp), |none| none),
);

const fn of(
    id: &'static str,
    unit: &'static str,
    doc: &'static str,
    evaluate: fn(&Measurand, &ComparisonEvidence<'_>) -> Vec<Estimate>,
) -> Measurand {
    Measurand::of_influence(id, unit, doc, Some(Influence::Vibration), evaluate)
}

fn normal(measured: Measured) -> Option<(f64, Spread)> {
    Some((measured.value, Spread::Normal { standard_uncertainty: measured.standard }))
}

/// One row a channel: `value` of a resonance, or `bound` from the largest response where there is none.
fn row(
    m: &Measurand,
    compared: &ComparisonEvidence<'_>,
    value: impl Fn(&Peak) -> Option<(f64, Spread)>,
    bound: impl Fn(Option<UpperLimit>) -> Option<UpperLimit>,
) -> Vec<Estimate> {
    let Some(found) = compared.by_frequency else { return vec![] };
    let Resonance { shown, searched_hz: (from, to) } = found.resonance;
    let (from, to) = (Arg::figures(from, 3), Arg::figures(to, 3));
    let none = |bound| m.not_identifiable(&found.channel, bound, METHOD);
    vec![match shown {
        Shown::Peak(peak) => match value(&peak) {
            Some((value, spread)) => m.measured(&found.channel, value, spread, METHOD).note(note!(
                "resonance.searched",
                from = from,
                to = to
            )),
            None => none(None).note(note!("resonance.sharp")),
        },
        Shown::Beyond => none(None).note(note!("resonance.beyond", from = from, to = to)),
        Shown::Nothing(Some(most)) => none(bound(Some(most))).note(note!(
            "resonance.none",
            from = from,
            to = to,
            most = Arg::figures(most.value, 3)
        )),
        Shown::Nothing(None) => none(None).note(note!("resonance.gaps", from = from, to = to)),
        Shown::Unsearched => none(None).note(note!("resonance.unsearched")),
    }]
}
