//! What the check of a recording and of its model found: the figures of a unit rest on both.

use crate::i18n::{Arg, Note, note};
use crate::noise::residual::View;
use crate::record::{ConditionStatus, GoodnessOfFitRecord, Integrity, RunRecord};

/// The counts of a check with the names of what they count.
fn counts(found: &Integrity) -> [(u64, &'static str); 12] {
    [
        (found.gaps, "condition.gaps"),
        (found.missing_samples, "condition.missing_samples"),
        (found.duplicate_timestamps, "condition.duplicate_timestamps"),
        (found.backward_timestamps, "condition.backward_timestamps"),
        (found.unparsable, "condition.unparsable"),
        (found.non_finite, "condition.non_finite"),
        (found.outliers, "condition.outliers"),
        (found.saturated, "condition.saturated"),
        (found.stuck, "condition.stuck"),
        (found.repeated, "condition.repeated"),
        (found.implausible, "condition.implausible"),
        (found.cut_off, "condition.cut_off"),
    ]
}

/// Bad samples and gaps of the recording, and a test that was not valid.
pub(super) fn of_recording(result: &RunRecord) -> Vec<Note> {
    let mut out = vec![];
    let fault =
        |(n, key): (u64, &'static str)| note!("compare.more.fault", kind = Arg::Key(key.into()), count = n);
    let found = counts(&result.integrity).into_iter().filter(|(n, _)| *n > 0);
    let found: Vec<Arg> = found.map(|count| Arg::from(fault(count))).collect();
    if !found.is_empty() {
        out.push(note!("compare.more.faults", found = Arg::Several(found, ", ".into())));
    }
    if result.conditions.iter().any(|c| c.status == ConditionStatus::Invalid) {
        out.push(note!("compare.more.invalid"));
    }
    out
}

/// The view in which the model of a channel departs from the record.
fn departure<'a>(result: &'a RunRecord, channel: &str, view: View) -> Option<&'a GoodnessOfFitRecord> {
    result.goodness_of_fit.iter().find(|row| row.channel == channel && row.view == view && row.departs)
}

/// A note on the views in which the model of a channel departs from the record.
pub(super) fn of_model(result: &RunRecord, channel: &str) -> Option<Note> {
    let departs = View::ALL.into_iter().filter(|view| departure(result, channel, *view).is_some());
    let names: Vec<Arg> = departs.map(|view| Arg::Key(format!("goodness.view.{}", view.id()))).collect();
    (!names.is_empty()).then(|| note!("compare.more.departs", views = Arg::Several(names, ", ".into())))
}

/// The jump of the level that the model of a channel does not make: when, and how large.
pub(super) fn jump(result: &RunRecord, channel: &str) -> Option<Note> {
    let row = departure(result, channel, View::Jump)?;
    let number = |name: &str| row.message.args.get(name)?.number();
    let note = note!(
        "goodness.jump",
        time_s = Arg::rounded(number("time_s")?, 6),
        size = Arg::figures(number("size")?, 3),
        deviations = Arg::rounded(number("deviations")?, 2)
    );
    Some(note)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::i18n::{Lang, Localize};
    use crate::record::read;
    use serde_json::{Value, json};

    /// The record of a shipped result with some fields replaced.
    fn record(changes: &Value) -> RunRecord {
        let text = include_str!("../../../tests/fixtures/results/static-bias-without-presentation.json");
        let mut all: Value = serde_json::from_str(text).unwrap();
        for (name, value) in changes.as_object().unwrap() {
            all[name] = value.clone();
        }
        let condition = all["conditions"][0].clone();
        all["conditions"] = json!([condition]);
        if let Some(status) = changes.get("status") {
            all["conditions"][0]["status"] = status.clone();
        }
        read::from_slice(all.to_string().as_bytes()).unwrap()
    }

    fn row(channel: &str, view: &str, args: Value) -> Value {
        json!({"channel": channel, "view": view, "statistic": 0.0, "p_value": 0.0, "departs": true, "from": 0.0,
               "to": null, "excess": 0.0, "message": {"text": "", "id": "", "args": args}})
    }

    #[test]
    fn faults_and_departures_are_told_and_clean_results_say_nothing() {
        let jump_args = json!({"time_s": 18000.0, "size": 0.997, "deviations": 26.3});
        let rows =
            [row("x", "amplitude", json!({})), row("y", "lag", json!({})), row("y", "jump", jump_args)];
        let mut result = record(&json!({"status": "invalid", "goodness_of_fit": rows}));
        result.integrity = Integrity { gaps: 2, stuck: 40, ..Integrity::default() };
        let sentences: Vec<String> = of_recording(&result).iter().map(|n| n.say(Lang::En)).collect();
        assert!(sentences[0].contains("Gaps: 2, Stuck samples: 40") && sentences.len() == 2, "{sentences:?}");
        let model = of_model(&result, "x").unwrap().say(Lang::En);
        assert!(model.contains("by amplitude") && !model.contains("by lag"), "{model}");
        let jumped = jump(&result, "y").unwrap().say(Lang::En);
        assert!(jumped.contains("0.997") && jumped.contains("18000 s"), "{jumped}");
        assert_eq!(jump(&result, "x"), None);
        let mut clean = record(&json!({"status": "ok"}));
        clean.integrity = Integrity::default();
        assert_eq!((of_recording(&clean), of_model(&result, "z")), (vec![], None));
    }
}
