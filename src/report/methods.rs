//! The methods appendix: every formula a report rests on, with its source. Words are in the locale tables under
//! `methods.<id>`; formulas are the same in every language.

use crate::measurand::{self, MEASURANDS, Measurand};
use crate::record::RunRecord;

/// One entry of the appendix.
#[derive(Debug, Clone, Copy)]
pub struct Method {
    /// Id: `methods.<id>.title` and `methods.<id>.text` are its words.
    pub id: &'static str,
    /// Formulas, one a line, with a point as the decimal mark and no units.
    pub formulas: &'static [&'static str],
    /// Where they come from; `{annex}` is the word of the language for an annex of a standard.
    pub source: &'static str,
    applies: fn(&RunRecord) -> bool,
}

fn measures(record: &RunRecord, measurands: &[&Measurand]) -> bool {
    record.measurands.iter().any(|row| measurands.iter().any(|m| m.id == row.id))
}

fn measured_by(record: &RunRecord, method: &str) -> bool {
    record.measurands.iter().any(|m| m.method == method)
}

fn noise(record: &RunRecord) -> bool {
    !record.noise_models.is_empty()
        || record.figures.iter().any(|f| f.id.starts_with("sigma_tau"))
        || measures(
            record,
            &[
                &measurand::ANGLE_RANDOM_WALK,
                &measurand::BIAS_INSTABILITY,
                &measurand::BIAS_INSTABILITY_MINIMUM,
                &measurand::RATE_RANDOM_WALK,
            ],
        )
}

fn russian(record: &RunRecord) -> bool {
    measures(
        record,
        &[
            &measurand::RUSSIAN_DRIFT_100S,
            &measurand::RUSSIAN_DRIFT_100S_3SIGMA,
            &measurand::RUSSIAN_SIGMA_10S,
            &measurand::RUSSIAN_ARW_10S,
            &measurand::RUSSIAN_DRIFT_100S_PREDICTED,
        ],
    )
}

fn limited(record: &RunRecord) -> bool {
    record.measurands.iter().any(|m| m.limit.is_some())
}

fn fitted_by(record: &RunRecord, name: &str) -> bool {
    record.noise_models.iter().any(|m| m.method == name) || record.measurands.iter().any(|m| m.method == name)
}

/// The entries that several measurands share, in the order of the report.
const METHODS: &[Method] = &[
    Method {
        id: "runs",
        formulas: &["m = (x'V⁻¹x)⁻¹·x'V⁻¹y;  Q(σ²) = d'(Z(σ²I + C)Z')⁻¹d;  d = Zm"],
        source: "IEEE Std 952, 12.11; Paule, Mandel 1982; Viechtbauer 2007",
        applies: |r| measured_by(r, "means_of_runs"),
    },
    Method {
        id: "influence",
        formulas: &["y = y₀ + r·t + k·(x − x₀) + ν;  cov ν = N₀²V₀ + N₁²V₁ + B²V_B + K²V_K + s²V_s"],
        source: "IEEE Std 952, 12.11; Patterson, Thompson 1971",
        applies: |r| measured_by(r, "alternating_intervals"),
    },
    Method {
        id: "table_positions",
        formulas: &["yₚ = K·Ωₚ + y₀;  Ωₚ = Ω_E·(cos φ·cos E·cos A + sin φ·sin E)"],
        source: "IEEE Std 952, 12.11",
        applies: |r| measured_by(r, "earth_rate_positions"),
    },
    Method {
        id: "table_turns",
        formulas: &["K = Σ θᵢ·(∫y dt − y₀·Tᵢ) / Σ θᵢ²"],
        source: "Ferraris et al. 1995",
        applies: |r| measured_by(r, "known_angles"),
    },
    Method {
        id: "table_alignment",
        formulas: &["y = y₀ + K·Ω_out·(θ_y·cos β + θ_x·sin β)"],
        source: "IEEE Std 952, 12.12",
        applies: |r| measured_by(r, "outer_axis_turns"),
    },
    Method {
        id: "table_dead_zone",
        formulas: &[
            "D = sgn(x)·max(|x| − δ, 0)",
            "D = x·[|x| > δ]",
            "D = (x − δ)·Φ((x − δ)/σ) + (x + δ)·Φ(−(x + δ)/σ) + σ·[φ((x − δ)/σ) − φ((x + δ)/σ)]",
        ],
        source: "IEEE Std 952, 12.10; IEEE Std 647",
        applies: |r| measures(r, &[&measurand::DEAD_ZONE, &measurand::THRESHOLD]),
    },
    Method {
        id: "table_sine",
        formulas: &["y = A·[1 + α·(T − T̄)]·sin κ(Ω − Ω₀) + b + β·(T − T̄)"],
        source: "Lefèvre, The Fiber-Optic Gyroscope",
        applies: |r| measured_by(r, "sine_response"),
    },
    Method {
        id: "table_levels",
        formulas: &["yⱼ = K·Ωⱼ + y₀ + eⱼ;  S₀ = 1/K;  δⱼ = eⱼ/(K·Ω_max)", "ε = 2·(K₊ − K₋)/(K₊ + K₋)"],
        source: "IEEE Std 952, 12.9; Patterson, Thompson 1971",
        applies: |r| measured_by(r, "table_levels"),
    },
    Method {
        id: "table_largest",
        formulas: &["P(max |s·δⱼ + eⱼ| ≤ max |δⱼ|) = 1/2"],
        source: "JCGM 101:2008",
        applies: |r| {
            measures(
                r,
                &[&measurand::SCALE_FACTOR_NONLINEARITY, &measurand::SCALE_FACTOR_NONLINEARITY_OF_RATE],
            )
        },
    },
    Method {
        id: "allan",
        formulas: &["σ²(τ) = Σᵢ (θᵢ₊₂ₘ − 2θᵢ₊ₘ + θᵢ)² / [2τ²·(M − 2m + 1)],  τ = m·τ₀,  i = 0 … M − 2m"],
        source: "IEEE Std 952, {annex} C; NIST SP 1065",
        applies: noise,
    },
    Method {
        id: "edf",
        formulas: &["σ̂·√(ν / χ²(0.975; ν)) … σ̂·√(ν / χ²(0.025; ν))"],
        source: "Greenhall, Riley 2003; NIST SP 1065",
        applies: noise,
    },
    Method {
        id: "noise_model",
        formulas: &[
            "S(f) = N² + B²/(2πf) + K²/(2πf)² + (4Q²/τ₀)·sin²(πfτ₀)",
            "σ²(τ) = 3Q²/τ² + N²/τ + (2 ln 2/π)·B² + K²τ/3 + R²τ²/2",
        ],
        source: "IEEE Std 952, {annex} C",
        applies: noise,
    },
    Method {
        id: "whittle",
        formulas: &["−ln L = Σₖ [ln S(fₖ) + Iₖ/S(fₖ)]"],
        source: "Whittle 1953",
        applies: |r| fitted_by(r, "whittle"),
    },
    Method {
        id: "damped",
        formulas: &[
            "γ(t) = σ²·exp(−|t|/T)·cos(2πf₀t)",
            "V(t) = 2σ²·Re[(z − 1 + exp(−z))/z²],  z = (1/T − 2πi·f₀)·t;  σ²(τ) = 2[V(τ) − V(2τ)]",
        ],
        source: "IEEE Std 952, {annex} C; Zhang 2008",
        applies: |r| r.noise_models.iter().any(|m| !m.markov.is_empty() || !m.quasi_periodic.is_empty()),
    },
    Method {
        id: "goodness",
        formulas: &["wⱼ = Σₖ cₖ/√Pₖ · √(2/M)·cos[πk(j + ½)/M]", "ν = n²·r₀² / Σ (n − |l|)·rₗ²"],
        source: "Greenhall, Riley 2003; D'Agostino 1970; Anscombe, Glynn 1983; Holm 1979",
        applies: |r| !r.goodness_of_fit.is_empty(),
    },
    Method {
        id: "slope",
        formulas: &["N = σ(τ)·√τ", "K = σ(τ)·√(3/τ)", "R = σ(τ)·√2/τ", "Q = σ(τ)·τ/√3"],
        source: "IEEE Std 952, {annex} C",
        applies: |r| fitted_by(r, "slope_readout"),
    },
    Method {
        id: "bias_instability",
        formulas: &["σ_BI = √(2 ln 2/π)·B = 0.664·B"],
        source: "IEEE Std 952, {annex} C",
        applies: |r| {
            measures(
                r,
                &[
                    &measurand::BIAS_INSTABILITY,
                    &measurand::BIAS_INSTABILITY_MINIMUM,
                    &measurand::BIAS_INSTABILITY_MINIMUM_SCALED,
                ],
            )
        },
    },
    Method {
        id: "not_identifiable",
        formulas: &[],
        source: "JCGM 106:2012",
        applies: |r| r.measurands.iter().any(|m| !m.identifiable),
    },
    Method {
        id: "russian_sigma",
        formulas: &["s = √[ Σⱼ (ȳⱼ − ȳ)² / (n − 1) ],  n = ⌊T/τ⌋"],
        source: "",
        applies: russian,
    },
    Method {
        id: "russian_arw",
        formulas: &["N₁₀ = σ₁₀·√10 / 60"],
        source: "",
        applies: |r| measures(r, &[&measurand::RUSSIAN_ARW_10S]),
    },
    Method {
        id: "russian_prediction",
        formulas: &["E[s²] = 2Q²(n + 1)/(nτ²) + N²/τ + (B²/π)·n·ln n/(n − 1) + K²τn/6 + R²τ²n(n + 1)/12"],
        source: "Barnes 1969 (B₁)",
        applies: |r| measures(r, &[&measurand::RUSSIAN_DRIFT_100S_PREDICTED]),
    },
    Method {
        id: "bias",
        formulas: &[
            "D = ȳ − Ω_IA",
            "u²(D) = N²/T + (B²/π)·[(1 − cos b)/b² + (sin b)/b − Ci(b)] + K²T/3 + 2Q²/T² + u²(Ω_IA),  b = 2πf_L·T",
        ],
        source: "IEEE Std 952, 12.11; JCGM 100:2008",
        applies: |r| measures(r, &[&measurand::STATIC_BIAS]),
    },
    Method {
        id: "earth_rate",
        formulas: &["Ω_IA = Ω_E·(cos φ·cos E·cos A + sin φ·sin E)"],
        source: "",
        applies: |r| measures(r, &[&measurand::STATIC_BIAS, &measurand::EARTH_RATE_COMPONENT]),
    },
    Method {
        id: "spectrum",
        formulas: &["G(f) = 2·S(f), f > 0;  N = √S / 60 = √(G/2) / 60"],
        source: "IEEE Std 952, {annex} C; Welch 1967",
        applies: |r| r.figures.iter().any(|f| f.id.starts_with("spectrum")) || !r.lines.is_empty(),
    },
    Method {
        id: "lines",
        formulas: &["P = 1 − (1 − p₁)ᵐ"],
        source: "",
        applies: |r| {
            !r.lines.is_empty()
                || r.figures.iter().any(|f| f.id.starts_with("spectrum"))
                || measures(r, &[&measurand::LINE_FREQUENCY, &measurand::LINE_AMPLITUDE])
        },
    },
    Method {
        id: "thermal",
        formulas: &[
            "b(t) = Σₖ aₖ·Pₖ(x) + D·dT_c/dt + h·s + ν(t),  x = (2T_c − T₁ − T₂)/(T₂ − T₁)",
            "dT_c/dt = (T − T_c)/τ;  S(f) = N² + B²/(2πf) + K²/(2πf)²",
            "H = D·r − (db/dT)·τ·r + h",
        ],
        source: "IEEE Std 952, 12.11; Shupe 1980",
        applies: |r| r.measurands.iter().any(|m| m.method == "thermal_gls"),
    },
    Method {
        id: "thermal_noise",
        formulas: &["N² = τ·Σ (ȳᵢ₊₂ − 2ȳᵢ₊₁ + ȳᵢ)² / (6n),  ν = n/1.944"],
        source: "IEEE Std 952, {annex} C",
        applies: |r| measures(r, &[&measurand::ANGLE_RANDOM_WALK_AT_TEMPERATURE]),
    },
    Method {
        id: "warm_up",
        formulas: &["b(t) = b∞ + Σⱼ Aⱼ·exp(−t/tⱼ) + ν(t)"],
        source: "IEEE Std 952, 12.5, 12.6",
        applies: |r| measures(r, &[&measurand::WARM_UP_TIME, &measurand::TURN_ON_TRANSIENT]),
    },
];

/// What every decision rests on, behind the entries of what was measured.
const DECISIONS: &[Method] = &[
    Method {
        id: "guard_band",
        formulas: &["A = TL − z(1 − r)·u", "A = TL·√(χ²(r; ν) / ν)"],
        source: "JCGM 106:2012; ISO 14253-1:2017; ILAC-G8:09/2019",
        applies: limited,
    },
    Method {
        id: "specific_risk",
        formulas: &["P(TL < η | y) = 1 − Φ((TL − y)/u)"],
        source: "JCGM 106:2012",
        applies: limited,
    },
    Method { id: "power", formulas: &[], source: "", applies: |r| !r.power.is_empty() },
    Method { id: "verdict", formulas: &[], source: "", applies: |_| true },
    Method { id: "rounding", formulas: &[], source: "JCGM 100:2008, 7.2.6", applies: |_| true },
];

/// The entry of a measurand that has formulas of its own.
fn own(measurand: &Measurand) -> Option<Method> {
    let Measurand { id, formulas, source, .. } = *measurand;
    (!formulas.is_empty()).then_some(Method { id, formulas, source, applies: |_| true })
}

/// Every entry: of what is measured, those that several measurands share first, and of decisions.
pub fn all() -> impl Iterator<Item = Method> {
    let own = MEASURANDS.iter().filter_map(|m| own(m));
    METHODS.iter().copied().chain(own).chain(DECISIONS.iter().copied())
}

/// The entries that a record calls for.
pub fn applicable(record: &RunRecord) -> impl Iterator<Item = Method> {
    let own = MEASURANDS.iter().filter(|m| measures(record, &[m])).filter_map(|m| own(m));
    let applies = |m: &&Method| (m.applies)(record);
    let shared = METHODS.iter().filter(applies).copied();
    shared.chain(own).chain(DECISIONS.iter().filter(applies).copied())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::i18n::{Lang, lookup};

    #[test]
    fn every_method_has_its_words() {
        for method in all() {
            for part in ["title", "text"] {
                let key = format!("methods.{}.{part}", method.id);
                assert!(lookup(Lang::En, &key).is_some(), "{key}");
            }
        }
    }

    #[test]
    fn every_measurand_has_its_name_in_every_language() {
        for m in MEASURANDS {
            for lang in [Lang::En, Lang::Ru] {
                assert!(lookup(lang, &format!("measurand.{}", m.id)).is_some(), "{} {lang:?}", m.id);
            }
        }
    }
}
