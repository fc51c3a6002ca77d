//! IEEE 1636.1 test results (ATML), `atml.xml`: a test for each measured quantity, with value, interval, limits and
//! outcome. It is the same in every language.
//!
//! The elements are those of the schema `TestResults` with the common types of IEEE 1671. What the schema demands and a
//! record lacks is written as `unknown`.

use super::xml::{SCHEMA_INSTANCE, Xml, empty, leaf, node, number, stated, xml_document};
use super::{ExportedFile, Exporter};
use crate::estimate::{Rule, Verdict};
use crate::i18n::Lang;
use crate::output::sha256;
use crate::record::{ConditionRecord, LimitRecord, MeasurandRecord, RunRecord};
use crate::report::number::percent;
use crate::report::translator::Translator;
use crate::report::{Document, Renderer, ReportError};
use chrono::{DateTime, FixedOffset, SecondsFormat, TimeDelta};
use serde_json::Value;
use std::io;

const RESULTS: &str = "urn:IEEE-1636.1:2013:TestResults";
const COMMON: &str = "urn:IEEE-1671:2010:Common";

/// Text where the schema demands one and the record has none.
const UNKNOWN: &str = "unknown";

/// Names and texts are those of this language.
const WORDS: Translator = Translator { lang: Lang::En };

/// The quantities of a run as `atml.xml`; of other results nothing.
pub struct Atml;

impl Exporter for Atml {
    fn id(&self) -> &'static str {
        "atml"
    }

    fn files(&self, document: &Document<'_>, _: &Renderer) -> Result<Vec<ExportedFile>, ReportError> {
        let Some(record) = document.run() else { return Ok(vec![]) };
        Ok(vec![ExportedFile::new("atml.xml", written(record)?)])
    }
}

fn written(record: &RunRecord) -> Result<Vec<u8>, ReportError> {
    xml_document(|xml| test_results(xml, record))
}

/// What tells a run from others: the SHA-256 of serial number, hash of the procedure and moment of the evaluation.
pub(super) fn identity(record: &RunRecord) -> String {
    let serial = record.unit_under_test.serial.as_deref().unwrap_or_default();
    let procedure = record.procedure.as_ref().map_or("", |p| p.sha256.as_str());
    sha256(format!("{serial}\n{procedure}\n{}", record.session.evaluated_at).as_bytes())
}

/// When the recordings began and ended; the moment of the evaluation twice where no recording tells its time, and
/// `None` where that is no time either.
pub(super) fn span(record: &RunRecord) -> Option<(DateTime<FixedOffset>, DateTime<FixedOffset>)> {
    let time = |stamp: &str| DateTime::parse_from_rfc3339(stamp).ok();
    let recorded = record.recording.iter().filter_map(|file| {
        let start = time(file.start.as_deref()?)?;
        let length = TimeDelta::try_milliseconds((1e3 * file.duration_s.max(0.0)).round() as i64);
        Some((start, length.and_then(|l| start.checked_add_signed(l)).unwrap_or(start)))
    });
    let whole = recorded.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)));
    whole.or_else(|| time(&record.session.evaluated_at).map(|at| (at, at)))
}

/// Name of a row: the quantity, the channel, and the phase of a test of several.
pub(super) fn row_name(m: &MeasurandRecord, words: Translator) -> String {
    let channel = words.channel(&m.channel, &m.id);
    let parts = [Some(words.name("measurand", &m.id)), Some(channel), m.phase.clone()];
    parts.into_iter().flatten().filter(|p| !p.is_empty()).collect::<Vec<_>>().join(" · ")
}

/// A decision rule in words.
pub(super) fn rule(limit: &LimitRecord, words: Translator) -> String {
    match limit.rule {
        Rule::Simple => words.t("rule.simple"),
        Rule::GuardBand => words.with("rule.guard_band", &[("risk", &percent(limit.risk, words.lang))]),
    }
}

/// The conditions on the temperature of the test.
pub(super) fn temperatures(record: &RunRecord) -> impl Iterator<Item = &ConditionRecord> {
    record.conditions.iter().filter(|c| c.id.split('.').next() == Some("temperature"))
}

/// A number that was observed for a condition.
pub(super) fn observed(condition: &ConditionRecord, name: &str) -> Option<f64> {
    condition.observed.get(name).and_then(Value::as_f64).filter(|v| v.is_finite())
}

/// A number of a row that can be written, the ends of its interval and their coverage.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Figure {
    /// Its kind: `value`, `upper_limit` or `lower_limit`.
    pub of: &'static str,
    /// The number.
    pub value: f64,
    /// The ends of the interval.
    pub interval: Option<(f64, f64)>,
    /// Probability with which the interval, or the bound, holds.
    pub coverage: Option<f64>,
}

/// The value of a row; where it has none, its bounds.
pub(super) fn figures(m: &MeasurandRecord) -> Vec<Figure> {
    if let Some(value) = m.value {
        let interval = m.interval.filter(|i| [i.low, i.high, i.coverage].iter().all(|v| v.is_finite()));
        let coverage = interval.map(|i| i.coverage);
        let figure = Figure { of: "value", value, interval: interval.map(|i| (i.low, i.high)), coverage };
        return Some(figure).filter(|f| f.value.is_finite()).into_iter().collect();
    }
    let bound = |of, value, coverage| Figure { of, value, interval: None, coverage: Some(coverage) };
    let upper = m.upper_limit.map(|u| bound("upper_limit", u.value, u.coverage));
    let lower = m.lower_limit.map(|l| bound("lower_limit", l.value, l.coverage));
    [upper, lower].into_iter().flatten().filter(|f| f.value.is_finite()).collect()
}

/// A UUID made of a hash: version 8 of RFC 9562.
fn uuid(hash: &str) -> String {
    let part = |from: usize, to: usize| hash.get(from..to).unwrap_or_default();
    format!("{}-{}-8{}-a{}-{}", part(0, 8), part(8, 12), part(13, 16), part(17, 20), part(20, 32))
}

fn test_results(xml: &mut Xml, record: &RunRecord) -> io::Result<()> {
    let uuid = uuid(&identity(record));
    let attributes =
        [("xmlns:tr", RESULTS), ("xmlns:c", COMMON), ("xmlns:xsi", SCHEMA_INSTANCE), ("uuid", uuid.as_str())];
    node(xml, "tr:TestResults", &attributes, |xml| {
        let operator = stated(record.session.operator.as_deref()).unwrap_or(UNKNOWN);
        node(xml, "tr:Personnel", &[], |xml| {
            empty(xml, "tr:SystemOperator", &[("ID", operator), ("name", operator)])
        })?;
        result_set(xml, record)?;
        test_program(xml, record)?;
        if let Some(station) = stated(record.session.station.as_deref()) {
            node(xml, "tr:TestStation", &[], |xml| leaf(xml, "c:SerialNumber", &[], station))?;
        }
        unit_under_test(xml, record)
    })
}

/// The times of a test as attributes.
fn times(record: &RunRecord) -> Vec<(&'static str, String)> {
    let written = |at: DateTime<FixedOffset>| at.to_rfc3339_opts(SecondsFormat::AutoSi, true);
    let named = |(start, end)| vec![("startDateTime", written(start)), ("endDateTime", written(end))];
    span(record).map(named).unwrap_or_default()
}

fn result_set(xml: &mut Xml, record: &RunRecord) -> io::Result<()> {
    let title = record.procedure.as_ref().map(|p| WORDS.local(&p.title));
    let title = title.unwrap_or_else(|| WORDS.t("report.title_analysis"));
    let times = times(record);
    let mut attributes = vec![("ID", "results"), ("name", title.as_str())];
    attributes.extend(times.iter().map(|(name, at)| (*name, at.as_str())));
    node(xml, "tr:ResultSet", &attributes, |xml| {
        let summary: Vec<String> = record.summary.iter().map(|m| WORDS.say(m)).collect();
        if let Some(summary) = stated(Some(&summary.join(" "))) {
            leaf(xml, "tr:Description", &[], summary)?;
        }
        let program = format!("{} {}", record.program.name, record.program.version);
        node(xml, "tr:Parameters", &[], |xml| text_parameter(xml, "results", "program", &program))?;
        environment(xml, record)?;
        outcome(xml, record.verdict)?;
        record.measurands.iter().enumerate().try_for_each(|(i, m)| test(xml, i + 1, m, &times))
    })
}

/// The temperatures that were observed.
fn environment(xml: &mut Xml, record: &RunRecord) -> io::Result<()> {
    let mut found = vec![];
    for condition in temperatures(record) {
        let of = |name: &str| observed(condition, name).map(|v| (format!("{} {name}", condition.id), v));
        found.extend(["min", "mean", "max"].into_iter().filter_map(of));
    }
    if found.is_empty() {
        return Ok(());
    }
    node(xml, "tr:EnvironmentalData", &[], |xml| {
        found.iter().try_for_each(|(name, value)| {
            node(xml, "tr:Environmental", &[("name", name.as_str())], |xml| plain_number(xml, *value, "degC"))
        })
    })
}

/// The outcome of a test. What is neither passed nor failed has our own word as its qualifier: where nothing was to be
/// decided, no decision was started; what is undecided, or could not be tested, did not come to its end.
fn outcome(xml: &mut Xml, verdict: Verdict) -> io::Result<()> {
    let value = match verdict {
        Verdict::Pass => "Passed",
        Verdict::Fail => "Failed",
        Verdict::None => "NotStarted",
        Verdict::Indeterminate | Verdict::Error => "Aborted",
    };
    match verdict {
        Verdict::Pass | Verdict::Fail => empty(xml, "tr:Outcome", &[("value", value)]),
        _ => empty(xml, "tr:Outcome", &[("value", value), ("qualifier", verdict.id())]),
    }
}

fn test(
    xml: &mut Xml,
    position: usize,
    m: &MeasurandRecord,
    times: &[(&'static str, String)],
) -> io::Result<()> {
    let id = format!("m{position}");
    let name = row_name(m, WORDS);
    let mut attributes = vec![("ID", id.as_str()), ("name", name.as_str())];
    attributes.extend(times.iter().map(|(name, at)| (*name, at.as_str())));
    attributes.push(("testReferenceID", m.id.as_str()));
    let limit = m.limit.as_ref().filter(|l| l.min.or(l.max).is_some());
    let figures = figures(m);
    node(xml, "tr:Test", &attributes, |xml| {
        node(xml, "tr:Parameters", &[], |xml| parameters(xml, &id, m))?;
        outcome(xml, m.verdict)?;
        if let Some(limit) = limit.filter(|_| figures.is_empty()) {
            test_limits(xml, limit)?;
        }
        figures.iter().try_for_each(|figure| {
            let result = format!("{id}-{}", figure.of);
            node(xml, "tr:TestResult", &[("ID", result.as_str()), ("name", figure.of)], |xml| {
                node(xml, "tr:TestData", &[], |xml| datum(xml, figure, &m.unit))?;
                limit.map_or(Ok(()), |limit| test_limits(xml, limit))
            })
        })
    })
}

/// What a row was obtained from and judged by, apart from its limits.
fn parameters(xml: &mut Xml, id: &str, m: &MeasurandRecord) -> io::Result<()> {
    text_parameter(xml, id, "channel", &m.channel)?;
    if let Some(phase) = &m.phase {
        text_parameter(xml, id, "phase", phase)?;
    }
    text_parameter(xml, id, "method", &m.method)?;
    let Some(limit) = &m.limit else { return Ok(()) };
    text_parameter(xml, id, "decision_rule", &rule(limit, WORDS))?;
    text_parameter(xml, id, "limit_source", &limit.source)?;
    let numbers = [
        ("risk", Some(limit.risk), "1"),
        ("acceptance_min", limit.acceptance_min, limit.unit.as_str()),
        ("acceptance_max", limit.acceptance_max, limit.unit.as_str()),
        ("specific_risk", m.specific_risk, "1"),
    ];
    for (name, value, unit) in numbers {
        if let Some(value) = value.filter(|v| v.is_finite()) {
            parameter(xml, id, name, |xml| plain_number(xml, value, unit))?;
        }
    }
    Ok(())
}

fn parameter(
    xml: &mut Xml,
    id: &str,
    name: &str,
    data: impl FnOnce(&mut Xml) -> io::Result<()>,
) -> io::Result<()> {
    let id = format!("{id}-{name}");
    node(xml, "tr:Parameter", &[("ID", id.as_str()), ("name", name)], |xml| node(xml, "tr:Data", &[], data))
}

fn text_parameter(xml: &mut Xml, id: &str, name: &str, text: &str) -> io::Result<()> {
    parameter(xml, id, name, |xml| {
        node(xml, "c:Datum", &[("xsi:type", "c:string")], |xml| leaf(xml, "c:Value", &[], text))
    })
}

/// A number alone.
pub(super) fn plain(value: f64) -> Figure {
    Figure { of: "", value, interval: None, coverage: None }
}

fn plain_number(xml: &mut Xml, value: f64, unit: &str) -> io::Result<()> {
    datum(xml, &plain(value), unit)
}

/// A number with its unit. An interval stands as error limits, its coverage as confidence from 0 to 1.
fn datum(xml: &mut Xml, figure: &Figure, unit: &str) -> io::Result<()> {
    let value = number(figure.value);
    let mut attributes = vec![("xsi:type", "c:double"), ("value", value.as_str())];
    attributes.extend(stated(Some(unit)).map(|unit| ("nonStandardUnit", unit)));
    if figure.interval.is_none() && figure.coverage.is_none() {
        return empty(xml, "c:Datum", &attributes);
    }
    node(xml, "c:Datum", &attributes, |xml| {
        if let Some((low, high)) = figure.interval {
            node(xml, "c:ErrorLimits", &[], |xml| limit_pair(xml, low, high, unit))?;
        }
        figure.coverage.map_or(Ok(()), |coverage| leaf(xml, "c:Confidence", &[], &number(coverage)))
    })
}

fn test_limits(xml: &mut Xml, limit: &LimitRecord) -> io::Result<()> {
    node(xml, "tr:TestLimits", &[], |xml| {
        node(xml, "tr:Limits", &[], |xml| match (limit.min, limit.max) {
            (Some(low), Some(high)) => limit_pair(xml, low, high, &limit.unit),
            (Some(low), None) => one_limit(xml, "c:SingleLimit", "GE", low, &limit.unit),
            (None, Some(high)) => one_limit(xml, "c:SingleLimit", "LE", high, &limit.unit),
            (None, None) => Ok(()),
        })
    })
}

fn limit_pair(xml: &mut Xml, low: f64, high: f64, unit: &str) -> io::Result<()> {
    node(xml, "c:LimitPair", &[("operator", "AND")], |xml| {
        one_limit(xml, "c:Limit", "GE", low, unit)?;
        one_limit(xml, "c:Limit", "LE", high, unit)
    })
}

fn one_limit(xml: &mut Xml, name: &str, comparator: &str, value: f64, unit: &str) -> io::Result<()> {
    node(xml, name, &[("comparator", comparator)], |xml| plain_number(xml, value, unit))
}

/// The procedure; its hash is the serial number.
fn test_program(xml: &mut Xml, record: &RunRecord) -> io::Result<()> {
    let Some(procedure) = &record.procedure else { return Ok(()) };
    let title = WORDS.local(&procedure.title);
    node(xml, "tr:TestProgram", &[], |xml| {
        node(xml, "c:Definition", &[("name", title.as_str())], |xml| {
            identification(xml, &procedure.id, Some(&procedure.revision), &[])
        })?;
        leaf(xml, "c:SerialNumber", &[], &procedure.sha256)
    })
}

fn unit_under_test(xml: &mut Xml, record: &RunRecord) -> io::Result<()> {
    let unit = &record.unit_under_test;
    let family = unit.family.as_ref().map(|f| WORDS.local(f));
    let model = stated(unit.model.as_deref()).or_else(|| stated(family.as_deref()));
    let numbers =
        [("Part", "part", stated(unit.part.as_deref())), ("Other", "lot", stated(unit.lot.as_deref()))];
    node(xml, "tr:UUT", &[], |xml| {
        if let Some(model) = model {
            node(xml, "c:Definition", &[], |xml| {
                identification(xml, model, unit.revision.as_deref(), &numbers)
            })?;
        }
        leaf(xml, "c:SerialNumber", &[], stated(unit.serial.as_deref()).unwrap_or(UNKNOWN))
    })
}

/// What something is: its version, its model, and numbers by their types and what they are called.
fn identification(
    xml: &mut Xml,
    model: &str,
    version: Option<&str>,
    numbers: &[(&str, &str, Option<&str>)],
) -> io::Result<()> {
    node(xml, "c:Identification", &[], |xml| {
        if let Some(version) = stated(version) {
            leaf(xml, "c:Version", &[], version)?;
        }
        leaf(xml, "c:ModelName", &[], model)?;
        if numbers.iter().all(|(.., number)| number.is_none()) {
            return Ok(());
        }
        node(xml, "c:IdentificationNumbers", &[], |xml| {
            numbers.iter().try_for_each(|(kind, qualifier, number)| {
                let Some(number) = number else { return Ok(()) };
                let attributes = [("number", *number), ("type", *kind), ("qualifier", *qualifier)];
                empty(xml, "c:IdentificationNumber", &attributes)
            })
        })
    })
}

#[cfg(test)]
mod tests {
    use super::super::xml::reading::{self, elements, ending};
    use super::*;
    use crate::record::read;
    use std::path::Path;

    fn sample() -> RunRecord {
        let root = Path::new(env!("CARGO_MANIFEST_DIR"));
        read::open(&root.join("samples/lot/SN-3001/result.json")).unwrap()
    }

    fn bits(values: impl IntoIterator<Item = f64>) -> Vec<u64> {
        values.into_iter().map(f64::to_bits).collect()
    }

    /// Values as they are read at a place.
    fn values(record: &RunRecord, end: &str) -> Vec<u64> {
        let found = elements(&written(record).unwrap());
        let of = |e: &&reading::Element| e.attributes["value"].parse::<f64>().unwrap();
        bits(ending(&found, end).iter().map(of))
    }

    #[test]
    fn numbers_read_back_to_the_bit() {
        let mut record = sample();
        record.measurands[0].value = Some(1.0 / 3.0 * 1e-9);
        record.measurands[1].value = Some(5e-324);
        record.measurands[2].value = Some(-1.797e308);
        let rows = &record.measurands;
        let given = rows.iter().flat_map(figures).map(|f| f.value);
        assert_eq!(values(&record, "tr:TestResult/tr:TestData/c:Datum"), bits(given));
        let intervals = rows.iter().filter_map(|m| m.interval.filter(|_| m.value.is_some()));
        let ends = intervals.flat_map(|i| [i.low, i.high]);
        assert_eq!(values(&record, "c:ErrorLimits/c:LimitPair/c:Limit/c:Datum"), bits(ends));
        let pairs = values(&record, "tr:Limits/c:LimitPair/c:Limit/c:Datum");
        assert_eq!(pairs, bits([-0.5, 0.5]));
        let single: Vec<f64> = rows[1..].iter().filter_map(|m| m.limit.as_ref()?.max).collect();
        assert_eq!(values(&record, "tr:Limits/c:SingleLimit/c:Datum"), bits(single));
    }

    #[test]
    fn names_with_marks_of_xml_read_back_without_control_characters() {
        let mut record = sample();
        record.unit_under_test.serial = Some("A<&>\"'\u{1}7".into());
        record.session.operator = Some("О'Нил & <сын>".into());
        record.session.station = Some("bench \u{1b}[31m 3".into());
        let found = elements(&written(&record).unwrap());
        assert_eq!(ending(&found, "tr:UUT/c:SerialNumber")[0].text, "A<&>\"'7");
        assert_eq!(ending(&found, "tr:SystemOperator")[0].attributes["name"], "О'Нил & <сын>");
        assert_eq!(ending(&found, "tr:TestStation/c:SerialNumber")[0].text, "bench [31m 3");
        assert_eq!(ending(&found, "tr:UUT/c:Definition/c:Identification/c:ModelName")[0].text, "SAMPLE");
    }

    #[test]
    fn outcomes_keep_our_words() {
        let mut record = sample();
        let verdicts = [Verdict::Pass, Verdict::Fail, Verdict::Indeterminate, Verdict::Error, Verdict::None];
        record.measurands.truncate(verdicts.len());
        record.measurands.iter_mut().zip(verdicts).for_each(|(m, v)| m.verdict = v);
        let found = elements(&written(&record).unwrap());
        let said = ending(&found, "tr:Test/tr:Outcome");
        let said: Vec<_> =
            said.iter().map(|e| (&*e.attributes["value"], e.attributes.get("qualifier"))).collect();
        assert_eq!(said[..2], [("Passed", None), ("Failed", None)]);
        let others: Vec<_> = said[2..].iter().map(|(value, q)| (*value, q.map(String::as_str))).collect();
        let expected = [("Aborted", "indeterminate"), ("Aborted", "error"), ("NotStarted", "none")];
        assert_eq!(others, expected.map(|(value, q)| (value, Some(q))));
    }

    #[test]
    fn a_record_that_lacks_much_is_written_all_the_same() {
        let mut record = sample();
        record.procedure = None;
        record.unit_under_test = Default::default();
        record.session = Default::default();
        record.measurands[0].value = Some(f64::NAN);
        record.measurands[1].interval.as_mut().unwrap().high = f64::INFINITY;
        let bytes = written(&record).unwrap();
        let text = String::from_utf8(bytes.clone()).unwrap();
        assert!(!text.contains("NaN") && !text.contains("\"inf\""), "{text}");
        let found = elements(&bytes);
        assert_eq!(ending(&found, "tr:UUT/c:SerialNumber")[0].text, UNKNOWN);
        assert!(ending(&found, "tr:TestProgram").is_empty() && ending(&found, "tr:TestStation").is_empty());
        assert!(!ending(&found, "tr:ResultSet")[0].attributes.contains_key("startDateTime"));
    }

    #[test]
    fn times_are_those_of_the_recording() {
        let mut record = sample();
        let times_of = |record: &RunRecord| times(record).into_iter().map(|t| t.1).collect::<Vec<_>>();
        assert_eq!(times_of(&record), ["2026-11-25T23:30:57Z", "2026-11-25T23:30:57Z"]);
        record.recording[0].start = Some("2026-11-20T10:00:00.5+03:00".into());
        assert_eq!(times_of(&record), ["2026-11-20T10:00:00.500+03:00", "2026-11-22T12:30:00.500+03:00"]);
        record.recording[0].duration_s = f64::MAX;
        assert_eq!(times_of(&record)[0], times_of(&record)[1]);
    }

    #[test]
    fn a_uuid_has_its_version() {
        let uuid = uuid(&identity(&sample()));
        let lengths: Vec<usize> = uuid.split('-').map(str::len).collect();
        assert_eq!(lengths, [8, 4, 4, 4, 12]);
        assert!(uuid.split('-').nth(2).is_some_and(|part| part.starts_with('8')));
    }
}
