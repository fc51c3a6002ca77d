//! The parts of a noise model as figures show them: which style, which words.

use crate::figure::Style;
use crate::noise::composite::Part;
use crate::noise::data::NoiseType;
use crate::noise::model::TERMS;

/// Number of the style of lines; N, B, K, Q and R come first.
const LINE: u8 = 5;
const MARKOV: u8 = 6;
const QUASI_PERIODIC: u8 = 7;

/// Style of a part. Processes of one kind share it.
pub fn style(part: Part) -> Style {
    Style::Term(match part {
        Part::Term(term) => TERMS.iter().position(|t| *t == term).unwrap_or(0) as u8,
        Part::Line(_) => LINE,
        Part::Markov(_) => MARKOV,
        Part::QuasiPeriodic(_) => QUASI_PERIODIC,
    })
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
