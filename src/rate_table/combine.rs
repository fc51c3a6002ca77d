//! What scatters and what does not, in one confidence distribution.

use crate::estimate::Spread;
use crate::numeric::reml::Combination;

/// The spread of a value that scatters as `random` says, times `factor`, with contributions known otherwise (standard
/// uncertainties in the unit of the result): Student's law with the degrees of freedom of Welch and Satterthwaite.
pub fn spread(random: &Combination, factor: f64, others: &[f64]) -> Spread {
    let scatter = (random.standard * factor).powi(2);
    let total = scatter + others.iter().map(|u| u * u).sum::<f64>();
    let dof = if scatter > 0.0 { random.dof * (total / scatter).powi(2) } else { f64::INFINITY };
    Spread::StudentT { standard_uncertainty: total.sqrt(), dof: dof.min(1e9) }
}
