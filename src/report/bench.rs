//! What the pages of a bench show of a result: verdict, reasons, what to do next, the quantities with a limit.

use super::lot::{reasons, several_channels};
use super::signatures::Signature;
use super::translator::Translator;
use super::view::{limit_text, value};
use crate::acceptance::lot;
use crate::estimate::Verdict;
use crate::i18n::Lang;
use crate::record::{ConditionStatus, LotUnit, MeasurandRecord, RunRecord, SerialSource};
use crate::signing::Link;
use sagnac_serve::{LocalText, Next, Outcome, Quantity};

/// Most reasons that are kept.
const MAX_REASONS: usize = 10;
/// The condition that the recording is of the unit under test.
const UNIT_NAMED: &str = "unit_named";

/// What a bench shows of a result.
pub fn outcome(record: &RunRecord) -> Outcome {
    let unit = lot::of_record(record, SerialSource::Recording, String::new(), String::new());
    let (en, ru) = (Translator { lang: Lang::En }, Translator { lang: Lang::Ru });
    let reasons = reasons(&unit, en).into_iter().zip(reasons(&unit, ru));
    let several = several_channels(&unit);
    Outcome {
        verdict: record.verdict,
        procedure: record.procedure.as_ref().map(|p| p.id.clone()).unwrap_or_default(),
        lot: record.unit_under_test.lot.clone(),
        reasons: reasons.take(MAX_REASONS).map(|(en, ru)| LocalText { en, ru }).collect(),
        next: next(record, &unit),
        quantities: unit.measurands.iter().map(|m| quantity(m, several)).collect(),
    }
}

/// What an operator does next. A condition that is not met comes first: what it spoils tells nothing of the unit.
fn next(record: &RunRecord, unit: &LotUnit) -> Next {
    let mut unmet = unit.conditions.iter().filter(|c| c.status == ConditionStatus::Invalid);
    let longest = record.power.iter().filter_map(|p| p.needed_h).fold(0.0, f64::max);
    match record.verdict {
        Verdict::Pass => Next::HandOn,
        Verdict::Fail => Next::SetAside,
        Verdict::Error => Next::CheckRecording,
        Verdict::None => Next::ChooseLimits,
        Verdict::Indeterminate => match unmet.next() {
            Some(condition) if condition.id == UNIT_NAMED => Next::CheckSerial,
            Some(_) => Next::MeetCondition,
            None if longest > 0.0 => Next::RecordLonger(longest),
            None => Next::ReadReport,
        },
    }
}

fn in_both(of: impl Fn(Translator) -> String) -> LocalText {
    LocalText { en: of(Translator { lang: Lang::En }), ru: of(Translator { lang: Lang::Ru }) }
}

fn quantity(m: &MeasurandRecord, several_channels: bool) -> Quantity {
    let parts = |name: String, channel: String| {
        let channel = several_channels.then_some(channel);
        m.phase.clone().into_iter().chain([name]).chain(channel).collect::<Vec<_>>().join(" · ")
    };
    Quantity {
        id: parts(m.id.clone(), m.channel.clone()),
        name: in_both(|words| parts(words.name("measurand", &m.id), words.channel(&m.channel, &m.id))),
        value: in_both(|words| {
            let has_number =
                [m.value.is_some(), m.upper_limit.is_some(), m.lower_limit.is_some()].contains(&true);
            words.quantity(&value(m, words), if has_number { &m.unit } else { "" })
        }),
        limit: in_both(|words| limit_text(m, words)),
        verdict: m.verdict,
    }
}

/// Who signed, a line each.
pub fn signatures(links: &[Link]) -> Vec<LocalText> {
    let line = |signature: &Signature| {
        let say = |lang: Lang| {
            let view = signature.view(lang);
            let parts = [view.role, view.name, view.at, view.status_word];
            parts.into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join(", ")
        };
        LocalText { en: say(Lang::En), ru: say(Lang::Ru) }
    };
    Signature::of_chain(links).iter().map(line).collect()
}
