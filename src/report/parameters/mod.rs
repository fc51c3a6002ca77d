//! The parameters of a unit for the programs that use them: estimators, autopilots, simulators.
//!
//! A target is one entry of [`TARGETS`]: its quantities with their conversions, the noise that its form has places for, and its
//! file format. The head of each file says by which conventions it is read, what every value stands for, what was left out, and
//! what error the form leaves.

mod axis;
#[cfg(test)]
mod example;
mod form;
mod formats;
mod head;
mod kalman;
mod quantity;
mod target;
mod targets;

pub use targets::{TARGETS, Target, find};

use crate::i18n::{Lang, Note, note};
use crate::record::RunRecord;
use axis::Axis;
use form::FormError;
use target::{AXES, Sheet};

/// Choices of the user.
#[derive(Debug, Clone, Default)]
pub struct Choices {
    /// Channels for x, y and z; empty: those of the result in their order.
    pub channels: Vec<String>,
    /// Rate of the steps of the target, Hz; `None`: its own, or that of the recording.
    pub step_rate_hz: Option<f64>,
    /// Whether all noise quantities are multiplied by the factor with which the deviation is nowhere understated.
    pub inflate: bool,
}

/// The file of a target, as text, and the lines of its head.
#[derive(Debug)]
pub struct Exported {
    /// The file.
    pub text: String,
    /// What its head says.
    pub head: Vec<String>,
}

/// The parameters of a result for a target.
///
/// # Errors
/// A note where channels do not fit, or where the result states nothing that the target takes.
pub fn export(record: &RunRecord, target: &Target, choices: &Choices, lang: Lang) -> Result<Exported, Note> {
    let measured = chosen(Axis::all(record), &choices.channels)?;
    let step_s = choices
        .step_rate_hz
        .map(|rate| 1.0 / rate)
        .or(target.step_s)
        .or_else(|| measured.iter().find_map(|a| a.sample_interval_s))
        .ok_or_else(|| Note::new("export.no_step"))?;
    let errors: Vec<Option<FormError>> =
        measured.iter().map(|a| FormError::of(&target.places.held(a), a)).collect();
    let factor = errors.iter().flatten().map(FormError::inflation).fold(1.0, f64::max);
    if choices.inflate && !factor.is_finite() {
        return Err("export.no_factor".into());
    }
    let written: Vec<Axis> = if choices.inflate {
        measured.iter().map(|a| a.inflated(factor)).collect()
    } else {
        measured.clone()
    };
    let states = |axis: &Axis| {
        target.quantities.iter().any(|q| q.source != quantity::Source::Step && (q.of)(axis, step_s).is_some())
    };
    let Some(worst) = written
        .iter()
        .filter(|a| states(a))
        .max_by(|a, b| a.white.used().unwrap_or(0.0).total_cmp(&b.white.used().unwrap_or(0.0)))
    else {
        return Err(note!("export.nothing", target = target.id));
    };
    let axes: [&Axis; AXES] = std::array::from_fn(|i| written.get(i).unwrap_or(worst));
    let mut head = head::introduction(record, target, lang);
    for (i, axis) in measured.iter().enumerate() {
        head.extend(head::of_axis(i, axis, errors[i], target, lang));
    }
    if written.len() < AXES {
        head.push(head::repeated(written.len(), worst, lang));
    }
    head.push(head::inflation(factor, choices.inflate, lang));
    let unit = record.unit_under_test.serial.as_deref().unwrap_or_default();
    let sheet = Sheet { target, unit, axes, step_s, head };
    Ok(Exported { text: (target.write)(&sheet), head: sheet.head })
}

/// The axes of the channels asked for, in that order.
fn chosen(axes: Vec<Axis>, channels: &[String]) -> Result<Vec<Axis>, Note> {
    let known = || axes.iter().map(|a| a.channel.as_str()).collect::<Vec<_>>().join(", ");
    if axes.is_empty() {
        return Err("export.no_rows".into());
    }
    if channels.is_empty() && axes.len() <= AXES {
        return Ok(axes);
    }
    if channels.is_empty() || channels.len() > AXES {
        return Err(note!("export.too_many", known = known()));
    }
    let of = |channel: &String| {
        let found = axes.iter().find(|a| a.channel == *channel).cloned();
        found.ok_or_else(|| note!("export.no_channel", channel = channel.as_str(), known = known()))
    };
    channels.iter().map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::example::{record, row};
    use super::*;
    use crate::measurand::{ANGLE_RANDOM_WALK, BIAS_TEMPERATURE_SENSITIVITY, RATE_RANDOM_WALK};

    fn exported(target: &str, choices: &Choices) -> Result<Exported, Note> {
        let three = record(vec![
            row(&ANGLE_RANDOM_WALK, "x", 0.1),
            row(&RATE_RANDOM_WALK, "x", 0.5),
            row(&ANGLE_RANDOM_WALK, "y", 0.3),
            row(&ANGLE_RANDOM_WALK, "z", 0.2),
        ]);
        export(&three, find(target).unwrap(), choices, Lang::En)
    }

    #[test]
    fn every_target_has_an_entry_of_its_own_with_texts_in_every_language() {
        for (i, target) in TARGETS.iter().enumerate() {
            assert!(TARGETS[..i].iter().all(|t| t.id != target.id));
            for lang in Lang::ALL {
                let (words, key) = (crate::i18n::table(*lang), target.convention);
                assert!(words.contains_key(key), "{key}");
            }
            let file = exported(target.id, &Choices::default()).unwrap();
            assert!(file.text.contains(target.quantities[0].name) || target.id == "kalman", "{}", file.text);
        }
    }

    #[test]
    fn a_format_without_axes_has_the_worst_of_them_and_channels_have_their_order() {
        let kalibr = exported("kalibr", &Choices::default()).unwrap().text;
        // 0.3 deg/√h.
        assert!(kalibr.contains("\ngyroscope_noise_density: 8.726646e-5\n"), "{kalibr}");
        assert!(kalibr.ends_with("\nupdate_rate: 10.0\n"), "{kalibr}");
        let order = Choices { channels: vec!["y".into(), "x".into()], ..Choices::default() };
        let text = exported("gnss-ins-sim", &order).unwrap().text;
        assert!(text.contains("'gyro_arw': np.array([0.3, 0.1, 0.3])"), "{text}");
        assert!(!text.contains("'gyro_b_stability'"), "what is not stated is not written: {text}");
    }

    #[test]
    fn wrong_channels_and_results_without_rows_are_refused() {
        let with = |channels: &[&str]| Choices {
            channels: channels.iter().map(|c| (*c).to_owned()).collect(),
            ..Choices::default()
        };
        let key = |refused: Result<Exported, Note>| refused.unwrap_err().id;
        assert_eq!(key(exported("kalibr", &with(&["w"]))), "export.no_channel");
        assert_eq!(key(exported("kalibr", &with(&["x", "y", "z", "x"]))), "export.too_many");
        let none = export(&record(vec![]), find("kalibr").unwrap(), &Choices::default(), Lang::En);
        assert_eq!(key(none), "export.no_rows");
        let thermal = record(vec![row(&BIAS_TEMPERATURE_SENSITIVITY, "x", 3.6)]);
        let of = |target| export(&thermal, find(target).unwrap(), &Choices::default(), Lang::En);
        assert_eq!(key(of("kalibr")), "export.nothing");
        let px4 = of("px4").unwrap().text;
        assert!(px4.contains("TC_G0_X1_2\t1.745329e-5\t9\n") && !px4.contains("\tEKF2_"), "{px4}");
    }
}
