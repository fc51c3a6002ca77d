//! Why a unit of a lot does not pass, in sentences.

use crate::estimate::Verdict;
use crate::record::{ConditionStatus, LotCondition, LotUnit, MeasurandRecord, Message};
use crate::report::translator::Translator;
use crate::report::view::{row_reason, summary};

/// Sentences that only count what others name.
const COUNTING: [&str; 2] = ["summary.one_condition_invalid", "summary.conditions_invalid"];

/// The reasons; none for a unit that passes.
pub(in crate::report) fn reasons(unit: &LotUnit, words: Translator) -> Vec<String> {
    if unit.verdict == Verdict::Pass {
        return vec![];
    }
    let mut out: Vec<String> = vec![];
    let mut add = |sentence: String| {
        if !out.contains(&sentence) {
            out.push(sentence);
        }
    };
    unit.errors.iter().for_each(|e| add(words.say(e)));
    if unit.measurands.iter().any(|m| m.phase.is_some()) || unit.conditions.iter().any(|c| c.phase.is_some())
    {
        let failures = unit.summary.iter().filter(|m| m.id == "phases.failed");
        failures.for_each(|m| add(words.say(m)));
        unit.conditions.iter().filter_map(|c| condition_reason(c, words)).for_each(&mut add);
        unit.measurands
            .iter()
            .filter_map(|m| measurand_reason(m, several_channels(unit), words))
            .for_each(&mut add);
    } else {
        let named: Vec<Message> =
            unit.summary.iter().filter(|m| !COUNTING.contains(&m.id.as_ref())).cloned().collect();
        summary(&named, &unit.measurands, several_channels(unit), words).into_iter().for_each(&mut add);
    }
    out
}

/// True where sentences must name the channel.
pub(in crate::report) fn several_channels(unit: &LotUnit) -> bool {
    unit.measurands.iter().any(|m| Some(&m.channel) != unit.measurands.first().map(|f| &f.channel))
}

/// Why a quantity does not pass; `None` where it does.
pub(in crate::report) fn measurand_reason(
    m: &MeasurandRecord,
    several_channels: bool,
    words: Translator,
) -> Option<String> {
    let text = row_reason(m, several_channels, words)?;
    Some(of_phase(m.phase.as_deref(), text))
}

/// Why a condition is not met; `None` where it is.
pub(in crate::report) fn condition_reason(c: &LotCondition, words: Translator) -> Option<String> {
    if c.status != ConditionStatus::Invalid {
        return None;
    }
    let name = words.name("condition", c.id.split('.').next().unwrap_or(&c.id));
    let why = c.message.as_ref().map_or_else(String::new, |m: &Message| words.say(m));
    Some(of_phase(
        c.phase.as_deref(),
        words.with("summary.condition_invalid", &[("condition", &name), ("why", &why)]),
    ))
}

fn of_phase(phase: Option<&str>, text: String) -> String {
    phase.map_or_else(|| text.clone(), |phase| format!("{phase}: {text}"))
}
