//! Noise under an influence over that without it, band by band.

use super::descriptor::Measurand;
use crate::estimate::{Estimate, Spread, normal_probability};
use crate::influence::comparison::BandChange;
use crate::message::{Arg, note};
use crate::noise::in_band::BandMean;
use statrs::distribution::{ContinuousCDF, FisherSnedecor};

/// Ratio of the noise densities with and without an influence in every band of the procedure.
pub static NOISE_DENSITY_RATIO: Measurand = Measurand::of_influence(
    "noise_density_ratio",
    "1",
    "noise density with an influence over that without it in a band, lines left out",
    None,
    |m, compared| compared.noise.iter().flat_map(|n| &n.bands).map(|band| row(m, band)).collect(),
)
.also_called(&["noise_ratio"])
.formulas(
    &["r² = G₁/G₀", "G = 2 S(f), mean over f₁ ≤ f ≤ f₂", "(G₁/G₀)/r² ~ F(ν₁, ν₀)"],
    "Bendat, Piersol, Random Data, 2010",
);

const METHOD: &str = "welch_ratio";

fn row(m: &Measurand, change: &BandChange) -> Estimate {
    let withheld = || m.not_identifiable(&change.channel, None, METHOD);
    let (Some(without), Some(with)) = (change.without, change.with) else {
        return withheld().note(note!("compared.band_not_shown"));
    };
    let ratio = (with.power / without.power).sqrt();
    m.measured(&change.channel, ratio, spread(ratio, with, without), METHOD).note(note!(
        "compared.band",
        without = Arg::figures(without.power.sqrt(), 3),
        with = Arg::figures(with.power.sqrt(), 3),
        lines = change.lines
    ))
}

/// The spread of the root of a ratio of two independent powers with their degrees of freedom.
fn spread(ratio: f64, with: BandMean, without: BandMean) -> Spread {
    let Ok(law) = FisherSnedecor::new(with.dof, without.dof) else { return Spread::Unknown };
    Spread::by_score(|score| ratio / law.inverse_cdf(normal_probability(-score)).sqrt())
}

#[cfg(test)]
mod tests {
    use super::super::test_evidence::{notes, number, shows, withholds};
    use super::*;

    fn mean(power: f64, dof: f64) -> Option<BandMean> {
        Some(BandMean { power, dof })
    }

    #[test]
    fn the_ratio_is_that_of_the_roots_with_the_quantiles_of_f() {
        let change = BandChange {
            channel: "g@4:20-60Hz".into(),
            without: mean(0.04, 20.0),
            with: mean(0.36, 10.0),
            lines: 2,
        };
        let found = row(&NOISE_DENSITY_RATIO, &change);
        shows(&found, 3.0, METHOD);
        // Quantiles of F(10, 20): 2.7737 at 0.975 and 0.29249 at 0.025 (1 over 3.4185, that of F(20, 10)).
        // The spread is tabulated by quarters of a score, and straight between them.
        let interval = found.interval95().unwrap();
        assert!((interval.low - 3.0 / 2.7737f64.sqrt()).abs() < 2e-3, "{interval:?}");
        assert!((interval.high - 3.0 * 3.4185f64.sqrt()).abs() < 5e-3, "{interval:?}");
        assert_eq!(number(&found, "compared.band", "lines"), 2.0);
        let none = row(&NOISE_DENSITY_RATIO, &BandChange { with: None, ..change });
        withholds(&none, None, METHOD);
        assert_eq!(notes(&none), ["compared.band_not_shown"]);
    }
}
