//! What the check of a recording and of its model found: the figures of a unit rest on both.

use crate::i18n::{Arg, Note};
use serde_json::Value;

/// Counts of a check with the names of what they count.
const COUNTED: &[(&str, &str)] = &[
    ("gaps", "condition.gaps"),
    ("missing_samples", "condition.missing_samples"),
    ("duplicate_timestamps", "condition.duplicate_timestamps"),
    ("backward_timestamps", "condition.backward_timestamps"),
    ("unparsable", "condition.unparsable"),
    ("non_finite", "condition.non_finite"),
    ("outliers", "condition.outliers"),
    ("saturated", "condition.saturated"),
    ("stuck", "condition.stuck"),
    ("repeated", "condition.repeated"),
    ("implausible", "condition.implausible"),
    ("cut_off", "condition.cut_off"),
];

/// Views of the residual in which a model can fail, with their names.
const VIEWS: &[(&str, &str)] = &[
    ("frequency", "goodness.view.frequency"),
    ("lag", "goodness.view.lag"),
    ("averaging_time", "goodness.view.averaging_time"),
    ("amplitude", "goodness.view.amplitude"),
    ("jump", "goodness.view.jump"),
];

/// Bad samples and gaps of the recording, and a test that was not valid.
pub(super) fn of_recording(result: &Value) -> Vec<Note> {
    let mut out = vec![];
    let count = |name: &str| result.pointer("/integrity")?.get(name)?.as_u64().filter(|n| *n > 0);
    let found: Vec<Arg> = COUNTED
        .iter()
        .filter_map(|(name, key)| Some((count(name)?, *key)))
        .map(|(n, key)| {
            let fault = Note::new("compare.more.fault").with("kind", Arg::Key(key.into())).with("count", n);
            Arg::from(fault)
        })
        .collect();
    if !found.is_empty() {
        out.push(Note::new("compare.more.faults").with("found", Arg::Several(found, ", ".into())));
    }
    let conditions = result.get("conditions").and_then(Value::as_array);
    if conditions.into_iter().flatten().any(|c| c.get("status").and_then(Value::as_str) == Some("invalid")) {
        out.push(Note::new("compare.more.invalid"));
    }
    out
}

/// What a result says of a view in which the model of a channel departs from the record.
fn departure<'a>(result: &'a Value, channel: &str, view: &str) -> Option<&'a Value> {
    let text = |row: &'a Value, name: &str| row.get(name).and_then(Value::as_str);
    result.get("goodness_of_fit")?.as_array()?.iter().find(|row| {
        text(row, "channel") == Some(channel)
            && text(row, "view") == Some(view)
            && row.get("departs").and_then(Value::as_bool) == Some(true)
    })
}

/// Said where the model of a channel departs from the record.
pub(super) fn of_model(result: &Value, channel: &str) -> Option<Note> {
    let departs = VIEWS.iter().filter(|(view, _)| departure(result, channel, view).is_some());
    let names: Vec<Arg> = departs.map(|(_, key)| Arg::Key((*key).into())).collect();
    (!names.is_empty())
        .then(|| Note::new("compare.more.departs").with("views", Arg::Several(names, ", ".into())))
}

/// The jump of the level that the model of a channel does not make: when, and how large.
pub(super) fn jump(result: &Value, channel: &str) -> Option<Note> {
    let row = departure(result, channel, "jump")?;
    let number = |name: &str| row.pointer(&format!("/message/args/{name}"))?.as_f64();
    let note = Note::new("goodness.jump")
        .with("time_s", Arg::rounded(number("time_s")?, 6))
        .with("size", Arg::figures(number("size")?, 3))
        .with("deviations", Arg::rounded(number("deviations")?, 2));
    Some(note)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::i18n::{Lang, Localize};
    use serde_json::json;

    #[test]
    fn faults_and_departures_are_told_and_clean_results_say_nothing() {
        let result = json!({
            "integrity": {"gaps": 2, "outliers": 0, "stuck": 40},
            "conditions": [{"status": "met"}, {"status": "invalid"}],
            "goodness_of_fit": [
                {"channel": "x", "view": "amplitude", "departs": true},
                {"channel": "y", "view": "lag", "departs": true},
                {"channel": "y", "view": "jump", "departs": true,
                 "message": {"args": {"time_s": 18000.0, "size": 0.997, "deviations": 26.3}}},
            ],
        });
        let said: Vec<String> = of_recording(&result).iter().map(|n| n.say(Lang::En)).collect();
        assert!(said[0].contains("Gaps: 2, Stuck samples: 40") && said.len() == 2, "{said:?}");
        let model = of_model(&result, "x").unwrap().say(Lang::En);
        assert!(model.contains("by amplitude") && !model.contains("by lag"), "{model}");
        let jumped = jump(&result, "y").unwrap().say(Lang::En);
        assert!(jumped.contains("0.997") && jumped.contains("18000 s"), "{jumped}");
        assert_eq!(jump(&result, "x"), None);
        assert_eq!((of_recording(&json!({})), of_model(&result, "z")), (vec![], None));
    }
}
