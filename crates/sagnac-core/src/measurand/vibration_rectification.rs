//! Rectified bias per mean-square acceleration, band by band.

use super::descriptor::Measurand;
use super::influence::{METHOD, of_temperature, row};
use crate::estimate::{Component, Estimate, InputQuantity};
use crate::influence::Influence;
use crate::influence::comparison::Comparison;
use crate::influence::excitation::Excitation;
use crate::influence::over_frequency::OverFrequency;
use crate::influence::rectification::InBand;
use crate::message::{Arg, Note, note};

/// Bias per mean-square acceleration in every band of the procedure.
pub static VIBRATION_RECTIFICATION_IN_BAND: Measurand = Measurand::of_influence(
    "vibration_rectification_in_band",
    "deg/h/g^2",
    "bias per mean-square acceleration in a band, as the accelerometer shows it",
    Some(Influence::Vibration),
    |m, compared| compared.by_frequency.map_or(vec![], |found| rows(m, found)),
)
.signed()
.also_called(&["vre", "vibration_rectification", "vibration_rectification_error"])
.formulas(
    &[
        "y = y₀ + r·t + Σ k_b·a_b² + e",
        "a_b² = 2·∫ S_aa(f) df, f₁ ≤ f ≤ f₂",
        "u²(k_b) = u²_e + (2·u_a·k_b)² + (p·k_b)²/3",
    ],
    "IEEE Std 952-2020, 12.13; Bendat and Piersol, Random Data",
);

fn rows(m: &Measurand, found: &OverFrequency) -> Vec<Estimate> {
    found.rectification.bands.iter().map(|band| of_band(m, found, band)).collect()
}

fn of_band(m: &Measurand, found: &OverFrequency, band: &InBand) -> Estimate {
    let place = format!("{}@{}", found.channel, band.band.name());
    let withheld = |why: Note| m.not_identifiable(&place, None, METHOD).note(why);
    let elsewhere = match band.shown {
        Excitation::Apart { elsewhere } => elsewhere,
        Excitation::None => return withheld(note!("by_frequency.not_excited")),
        Excitation::Unresolved => return withheld(note!("by_frequency.unresolved")),
        Excitation::InStep { with: Some(other) } => {
            return withheld(note!("by_frequency.in_step", band = other.name()));
        }
        Excitation::InStep { with: None } => return withheld(note!("by_frequency.in_step_beyond")),
    };
    let (Some(regression), Some(per_square)) = (&found.rectification.regression, &band.per_square) else {
        return withheld(note!("by_frequency.not_excited"));
    };
    let of_level = of_level(regression, per_square.value, elsewhere);
    let others = [of_level, of_temperature(regression, band.degrees.as_ref())];
    let row = row(m, regression, &place, per_square, &others).note(note!(
        "by_frequency.excited",
        rms = Arg::figures(band.largest_rms_g, 3),
        percent = Arg::figures(100.0 * elsewhere, 2)
    ));
    if regression.unsettled() { row.note(note!("by_frequency.unsettled")) } else { row }
}

/// The acceleration counts twice in its square. What shook in step with the band elsewhere is taken for up to as rectified as the band.
fn of_level(regression: &Comparison, value: f64, elsewhere: f64) -> Component {
    let shared = 0.5 * elsewhere / 3f64.sqrt();
    let relative = regression.test.level_uncertainty.hypot(shared);
    Component::of(InputQuantity::InfluenceLevel, relative, "1", 2.0 * value)
}

#[cfg(test)]
mod tests {
    use super::super::test_evidence::{combination, notes, withholds};
    use super::*;
    use crate::influence::rectification::Rectification;
    use crate::influence::resonance::{Resonance, Shown};
    use crate::noise::in_band::Band;

    #[test]
    fn a_band_that_is_not_told_apart_has_no_value_and_says_why() {
        let band = |shown| InBand {
            band: Band { from_hz: 20.0, to_hz: 60.0 },
            shown,
            largest_rms_g: 2.0,
            per_square: Some(combination(0.1, 0.01)),
            degrees: None,
        };
        let other = Some(Band { from_hz: 60.0, to_hz: 100.0 });
        for (shown, key) in [
            (Excitation::None, "by_frequency.not_excited"),
            (Excitation::Unresolved, "by_frequency.unresolved"),
            (Excitation::InStep { with: other }, "by_frequency.in_step"),
            (Excitation::InStep { with: None }, "by_frequency.in_step_beyond"),
        ] {
            let found = OverFrequency {
                channel: "g".into(),
                rectification: Rectification { regression: None, bands: vec![band(shown)] },
                resonance: Resonance { shown: Shown::Unsearched, searched_hz: (0.0, 0.0) },
            };
            let row = &rows(&VIBRATION_RECTIFICATION_IN_BAND, &found)[0];
            withholds(row, None, METHOD);
            assert_eq!((notes(row), row.channel.as_str()), (vec![key], "g@20-60Hz"));
        }
    }
}
