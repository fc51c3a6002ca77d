//! The smallest Allan deviation, raw and over 0.664: two of the three figures that are called bias instability.
//!
//! The minimum is an extreme of a noisy curve. A record of angle random walk alone has one too, wherever it ends;
//! so it is reported with its τ and its degrees of freedom and is no evidence of a floor by itself.

use super::descriptor::Measurand;
use super::evidence::GyroEvidence;
use crate::estimate::{Estimate, Spread};
use crate::message::note;
use crate::noise::intervals::BoundedPoint;
use crate::noise::residual::degrees_of_freedom;

/// The smallest Allan deviation.
pub static BIAS_INSTABILITY_MINIMUM: Measurand = Measurand::at_rest(
    "bias_instability_minimum",
    "deg/h",
    "minimum of the overlapping Allan deviation over octaves up to a fifth of the record",
    |m, gyro, _| vec![minimum(m, gyro, 1.0)],
)
.needs_stillness()
.drift();

/// The smallest Allan deviation as B, if flicker makes it.
pub static BIAS_INSTABILITY_MINIMUM_SCALED: Measurand = Measurand::at_rest(
    "bias_instability_minimum_scaled",
    "deg/h",
    "that minimum divided by 0.664",
    |m, gyro, _| vec![minimum(m, gyro, FLICKER_FLOOR)],
)
.needs_stillness()
.drift();

const METHOD: &str = "overlapping_allan";

/// √(2 ln 2/π): the Allan deviation of flicker noise is this times B.
pub const FLICKER_FLOOR: f64 = 0.664_282_470_3;

/// Largest averaging time read, as a share of the record (result contract).
const LARGEST_SHARE: f64 = 0.2;

fn minimum(m: &Measurand, gyro: &GyroEvidence, divisor: f64) -> Estimate {
    let readable = readable(gyro);
    let Some(lowest) = lowest(gyro) else {
        return m.not_identifiable(&gyro.channel, None, METHOD).note(note!("note.minimum_none"));
    };
    let tau_s = lowest.point.m as f64 * gyro.tau0_s;
    let edf = minimum_edf(gyro, lowest);
    let spread = Spread::ChiSquare { dof: edf };
    let estimate = m.measured(&gyro.channel, lowest.point.deviation / divisor, spread, METHOD).note(note!(
        "note.minimum_at",
        tau_s,
        edf
    ));
    if readable.last().is_some_and(|last| last.point.m == lowest.point.m) {
        estimate.note(note!("note.minimum_at_end"))
    } else if gyro.identification.bias_instability.value.is_none() {
        estimate.note(note!("note.minimum_no_evidence"))
    } else {
        estimate
    }
}

/// The smallest deviation that is read.
pub fn lowest(gyro: &GyroEvidence) -> Option<&BoundedPoint> {
    let positive = readable(gyro).into_iter().filter(|p| p.point.deviation > 0.0);
    positive.min_by(|a, b| a.point.deviation.total_cmp(&b.point.deviation))
}

/// Degrees of freedom of the smallest deviation: those of the prevailing kind of noise, or of the whole description
/// where it holds lines, Markov processes or quasi-periodic disturbances and gives fewer.
pub fn minimum_edf(gyro: &GyroEvidence, lowest: &BoundedPoint) -> f64 {
    let model = &gyro.identification.described.model;
    if model.lines.is_empty() && model.markov.is_empty() && model.quasi_periodic.is_empty() {
        return lowest.edf;
    }
    let whole = degrees_of_freedom(model, &lowest.point, gyro.tau0_s);
    if whole > 0.0 { lowest.edf.min(whole.max(1.0)) } else { lowest.edf }
}

/// Octaves up to a fifth of the record.
pub fn readable(gyro: &GyroEvidence) -> Vec<&BoundedPoint> {
    let samples = gyro.digest.samples as f64;
    gyro.octaves.iter().filter(|p| p.point.m as f64 <= samples * LARGEST_SHARE).collect()
}

#[cfg(test)]
mod tests {
    use super::super::test_evidence::{chi_square, gyro, near, notes, number, point, shows, withholds};
    use super::*;
    use crate::noise::composite::{Composite, Damped, Line};
    use crate::noise::model::NoiseModel;

    /// 1000 samples at 0.5 s: up to m = 200 is read.
    fn with(octaves: &[BoundedPoint]) -> GyroEvidence {
        let mut gyro = gyro();
        gyro.digest.samples = 1000;
        gyro.octaves = octaves.to_vec();
        gyro
    }

    #[test]
    fn the_minimum_is_the_smallest_positive_deviation_up_to_a_fifth_of_the_record() {
        near(FLICKER_FLOOR, (2.0 * std::f64::consts::LN_2 / std::f64::consts::PI).sqrt());
        let mut gyro = with(&[
            point(1, 1.0, 900.0),
            point(25, 0.0, 40.0),
            point(100, 0.1, 12.5),
            point(200, 0.15, 5.0),
            point(201, 0.01, 3.0),
        ]);
        assert_eq!(readable(&gyro).iter().map(|p| p.point.m).collect::<Vec<_>>(), [1, 25, 100, 200]);
        let row = minimum(&BIAS_INSTABILITY_MINIMUM, &gyro, 1.0);
        shows(&row, 0.1, "overlapping_allan");
        assert_eq!((row.channel.as_str(), chi_square(&row)), ("g", 12.5));
        assert_eq!(notes(&row), ["note.minimum_at", "note.minimum_no_evidence"]);
        near(number(&row, "note.minimum_at", "tau_s"), 50.0);
        near(number(&row, "note.minimum_at", "edf"), 12.5);
        // Where flicker is claimed, the minimum is evidence of it.
        gyro.identification.bias_instability.value = Some(0.15);
        let evaluated = BIAS_INSTABILITY_MINIMUM_SCALED.evaluate_gyro(&gyro, &OPTIONS);
        shows(&evaluated[0], 0.1 / 0.664_282_470_3, "overlapping_allan");
        assert_eq!(notes(&evaluated[0]), ["note.minimum_at"]);
        shows(&BIAS_INSTABILITY_MINIMUM.evaluate_gyro(&gyro, &OPTIONS)[0], 0.1, "overlapping_allan");
    }

    const OPTIONS: super::super::Options = super::super::Options { remove_earth_rate: true };

    #[test]
    fn a_minimum_at_the_end_of_what_is_read_is_no_minimum_yet() {
        let row = minimum(&BIAS_INSTABILITY_MINIMUM, &with(&[point(1, 1.0, 9.0), point(64, 0.1, 4.0)]), 1.0);
        shows(&row, 0.1, "overlapping_allan");
        assert_eq!(notes(&row), ["note.minimum_at", "note.minimum_at_end"]);
    }

    #[test]
    fn without_a_point_there_is_no_minimum() {
        for octaves in [vec![], vec![point(64, 0.0, 4.0)], vec![point(201, 0.1, 4.0)]] {
            let row = minimum(&BIAS_INSTABILITY_MINIMUM, &with(&octaves), 1.0);
            withholds(&row, None, "overlapping_allan");
            assert_eq!(notes(&row), ["note.minimum_none"]);
        }
    }

    #[test]
    fn degrees_of_freedom_are_those_of_the_whole_description_where_it_gives_fewer() {
        let white = Composite::from(NoiseModel { n: 0.01, ..Default::default() });
        let process = Damped { rms_deg_h: 1.0, frequency_hz: 0.0, decay_time_s: 30.0 };
        let line = Line { amplitude_deg_h: 1.0, frequency_hz: 0.01 };
        let with_more = [
            Composite { lines: vec![line], ..white.clone() },
            Composite { markov: vec![process], ..white.clone() },
            Composite { quasi_periodic: vec![Damped { frequency_hz: 0.02, ..process }], ..white.clone() },
        ];
        let mut gyro = with(&[]);
        gyro.identification.described.model = white;
        assert_eq!(minimum_edf(&gyro, &point(100, 0.1, 1e6)), 1e6);
        for model in with_more {
            gyro.identification.described.model = model.clone();
            // 100 terms cannot have more than 100 degrees of freedom.
            let few = minimum_edf(&gyro, &point(100, 0.1, 1e6));
            assert!((1.0..=100.0).contains(&few), "{few}");
            near(few, degrees_of_freedom(&model, &point(100, 0.1, 1e6).point, 0.5).max(1.0));
            assert_eq!(minimum_edf(&gyro, &point(100, 0.1, 0.5)), 0.5);
        }
        // A description without power says nothing of them.
        let silent = Line { amplitude_deg_h: 0.0, frequency_hz: 0.01 };
        gyro.identification.described.model = Composite { lines: vec![silent], ..Composite::default() };
        assert_eq!(minimum_edf(&gyro, &point(100, 0.1, 7.0)), 7.0);
    }
}
