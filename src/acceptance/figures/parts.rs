//! The parts of a noise model as figures show them: which style, which words.

use crate::figure::Style;
use crate::noise::composite::Part;
use crate::noise::data::NoiseType;
use crate::noise::identification::Identification;
use crate::noise::model::TERMS;

/// Number of the style of lines; N, B, K, Q and R come first.
const LINE_STYLE: u8 = 5;
const MARKOV_STYLE: u8 = 6;
const QUASI_PERIODIC: u8 = 7;

/// Style of a part. Processes of one kind share it.
pub fn style(part: Part) -> Style {
    Style::Term(match part {
        Part::Term(term) => TERMS.iter().position(|t| *t == term).unwrap_or(0) as u8,
        Part::Line(_) => LINE_STYLE,
        Part::Markov(_) => MARKOV_STYLE,
        Part::QuasiPeriodic(_) => QUASI_PERIODIC,
    })
}

/// Style and legend of a part of what was identified: a term that the record does not resolve is dashed, and named so.
pub fn identified(part: Part, found: &Identification) -> (Style, &'static str) {
    match (style(part), part) {
        (Style::Term(n), Part::Term(term)) if !resolves(found, term) => {
            (Style::UnresolvedTerm(n), unresolved_legend(term))
        }
        (style, _) => (style, legend(part)),
    }
}

/// True for a term that is claimed, and for N where a white level was read.
fn resolves(found: &Identification, term: NoiseType) -> bool {
    let is_read = || term == NoiseType::AngleRandomWalk && found.read_angle_random_walk().value.is_some();
    found.claims(term) || is_read()
}

/// Legend of a term that is not resolved.
fn unresolved_legend(term: NoiseType) -> &'static str {
    match term {
        NoiseType::Quantization => "figure.unresolved.quantization",
        NoiseType::AngleRandomWalk => "figure.unresolved.angle_random_walk",
        NoiseType::Flicker => "figure.unresolved.bias_instability",
        NoiseType::RateRandomWalk => "figure.unresolved.rate_random_walk",
        NoiseType::RateRamp => "figure.unresolved.rate_ramp",
    }
}

/// Legend of a part.
pub fn legend(part: Part) -> &'static str {
    match part {
        Part::Term(NoiseType::Quantization) => "figure.legend.quantization",
        Part::Term(NoiseType::AngleRandomWalk) => "figure.legend.angle_random_walk",
        Part::Term(NoiseType::Flicker) => "figure.legend.bias_instability",
        Part::Term(NoiseType::RateRandomWalk) => "figure.legend.rate_random_walk",
        Part::Term(NoiseType::RateRamp) => "figure.legend.rate_ramp",
        Part::Markov(_) => "figure.fit.markov",
        Part::QuasiPeriodic(_) => "figure.fit.quasi_periodic",
        Part::Line(_) => "figure.fit.lines",
    }
}
