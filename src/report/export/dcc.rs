//! Digital Calibration Certificate (DCC) 3.3.0 of a run, `dcc.xml`, its numbers and units as in D-SI 2.2.1.
//!
//! A value has its interval as a coverage interval, which need not be symmetric. The schema demands a standard
//! uncertainty beside it, which a record does not have: it is half the interval divided by the quantile of the normal
//! distribution, and the certificate says so.
//!
//! A verdict is a statement of conformity with our own word in its declaration: `pass`, `fail`, and `noPass` for
//! `indeterminate`, since conformity is not shown and nothing is said to be broken; a reader could take `conditionalPass`
//! for a pass. Without a limit, or where a test could not be carried out, there is no statement.

use super::atml::{Figure, figures, identity, observed, plain, row_name, rule, span, temperatures};
use super::xml::{SCHEMA_INSTANCE, Xml, leaf, node, number, stated, xml_document};
use super::{ExportedFile, Exporter};
use crate::config::laboratory::{Contact, Laboratory};
use crate::estimate::{Rule, Verdict, normal_quantile};
use crate::i18n::{Lang, Note};
use crate::record::{ConditionRecord, LimitRecord, MeasurandRecord, Message, RunRecord};
use crate::report::number::limit_digits;
use crate::report::translator::Translator;
use crate::report::{Document, Renderer, ReportError};
use crate::units::Unit;
use std::collections::BTreeSet;
use std::io;

const CERTIFICATE: &str = "https://ptb.de/dcc";
const SI: &str = "https://ptb.de/si";
const VERSION: &str = "3.3.0";

/// Id of the form that is a calibration certificate.
pub const CERTIFICATE_FORM: &str = "dcc";

/// The certificate of a run as `dcc.xml`; of other results nothing.
pub struct Dcc {
    /// The laboratory that issues it.
    pub laboratory: Option<Laboratory>,
}

impl Exporter for Dcc {
    fn id(&self) -> &'static str {
        CERTIFICATE_FORM
    }

    fn files(&self, document: &Document<'_>, _: &Renderer) -> Result<Vec<ExportedFile>, ReportError> {
        let Some(record) = document.run() else { return Ok(vec![]) };
        let lacking = missing(record, self.laboratory.as_ref());
        let laboratory = self.laboratory.as_ref().filter(|_| lacking.is_empty());
        let laboratory = laboratory.ok_or(ReportError::Refused(lacking))?;
        Ok(vec![ExportedFile::new("dcc.xml", written(record, laboratory)?)])
    }
}

/// What a certificate needs and the record or the file of the laboratory lacks; without a laboratory never empty.
pub fn missing(record: &RunRecord, laboratory: Option<&Laboratory>) -> Vec<Note> {
    let lacks = |of: fn(&Laboratory) -> bool| laboratory.is_some_and(of);
    let facts = [
        (laboratory.is_none(), "dcc.no_laboratory"),
        (lacks(|l| l.customer.is_none()), "dcc.no_customer"),
        (lacks(|l| l.persons.is_empty()), "dcc.no_person"),
        (lacks(|l| l.languages.is_empty() || l.binding_languages.is_empty()), "dcc.no_language"),
        (stated(record.unit_under_test.serial.as_deref()).is_none(), "dcc.no_serial"),
        (record.measurands.is_empty(), "dcc.no_rows"),
        (span(record).is_none(), "dcc.no_date"),
    ];
    facts.into_iter().filter(|(lacking, _)| *lacking).map(|(_, key)| Note::new(key)).collect()
}

fn written(record: &RunRecord, laboratory: &Laboratory) -> Result<Vec<u8>, ReportError> {
    let location = format!("{CERTIFICATE} {CERTIFICATE}/v{VERSION}/dcc.xsd");
    let attributes = [
        ("xmlns:dcc", CERTIFICATE),
        ("xmlns:si", SI),
        ("xmlns:xsi", SCHEMA_INSTANCE),
        ("xsi:schemaLocation", location.as_str()),
        ("schemaVersion", VERSION),
    ];
    let certificate = Certificate { record, laboratory };
    xml_document(|xml| {
        node(xml, "dcc:digitalCalibrationCertificate", &attributes, |xml| {
            node(xml, "dcc:administrativeData", &[], |xml| certificate.administrative_data(xml))?;
            node(xml, "dcc:measurementResults", &[], |xml| {
                node(xml, "dcc:measurementResult", &[], |xml| certificate.results(xml))
            })
        })
    })
}

/// The status of a verdict, as the schema has them.
fn conformity(verdict: Verdict) -> Option<&'static str> {
    match verdict {
        Verdict::Pass => Some("pass"),
        Verdict::Fail => Some("fail"),
        Verdict::Indeterminate => Some("noPass"),
        Verdict::None | Verdict::Error => None,
    }
}

/// Units of results, each with its name in D-SI. A count is a number.
const UNITS: &[(&str, &str)] = &[
    ("", r"\one"),
    ("1", r"\one"),
    ("ppm", r"\ppm"),
    ("deg/h", r"\degree\per\hour"),
    ("deg/sqrt(h)", r"\degree\per\hour\tothe{0.5}"),
    ("deg/h/sqrt(h)", r"\degree\per\hour\tothe{1.5}"),
    ("deg/h/h", r"\degree\per\hour\tothe{2}"),
    ("arcsec", r"\arcsecond"),
    ("mrad", r"\milli\radian"),
    ("s", r"\second"),
    ("Hz", r"\hertz"),
    ("degC", r"\degreecelsius"),
    ("degC/h", r"\kelvin\per\hour"),
    ("deg/h/degC", r"\degree\per\hour\kelvin"),
    ("deg/h/(degC/min)", r"\degree\minute\per\hour\kelvin"),
    ("mrad/degC", r"\milli\radian\per\kelvin"),
    ("ppm/degC", r"\ppm\per\kelvin"),
    ("deg/h/V", r"\degree\per\hour\volt"),
    ("deg/h/mT", r"\degree\per\hour\milli\tesla"),
    ("deg/h/(m/s^2)^2", r"\degree\second\tothe{4}\per\hour\metre\tothe{2}"),
    ("deg/h/(m/s^2)", r"\degree\second\tothe{2}\per\hour\metre"),
    ("deg/h/kPa", r"\degree\per\hour\kilo\pascal"),
    ("deg/h/kPa^2", r"\degree\per\hour\kilo\pascal\tothe{2}"),
    ("deg/h/A", r"\degree\per\hour\ampere"),
    ("deg/h/A^2", r"\degree\per\hour\ampere\tothe{2}"),
    ("deg/h/V^2", r"\degree\per\hour\volt\tothe{2}"),
    ("deg/h/mT^2", r"\degree\per\hour\milli\tesla\tothe{2}"),
    ("deg/h/(V/m)", r"\degree\metre\per\hour\volt"),
    ("deg/h/(V/m)^2", r"\degree\metre\tothe{2}\per\hour\volt\tothe{2}"),
    ("deg/h/(W/m^2)", r"\degree\metre\tothe{2}\per\hour\watt"),
    ("deg/h/(W/m^2)^2", r"\degree\metre\tothe{4}\per\hour\watt\tothe{2}"),
    ("deg/h/Gy", r"\degree\per\hour\gray"),
    ("deg/h/Gy^2", r"\degree\per\hour\gray\tothe{2}"),
    ("deg/h/(deg/s^2)", r"\second\tothe{2}\per\hour"),
    ("deg/h/(deg/s^2)^2", r"\second\tothe{4}\per\hour\degree"),
    ("ppm/kPa", r"\ppm\per\kilo\pascal"),
    ("ppm/kPa^2", r"\ppm\per\kilo\pascal\tothe{2}"),
    ("ppm/A", r"\ppm\per\ampere"),
    ("ppm/A^2", r"\ppm\per\ampere\tothe{2}"),
    ("ppm/V", r"\ppm\per\volt"),
    ("ppm/V^2", r"\ppm\per\volt\tothe{2}"),
    ("ppm/mT", r"\ppm\per\milli\tesla"),
    ("ppm/mT^2", r"\ppm\per\milli\tesla\tothe{2}"),
    ("ppm/(V/m)", r"\ppm\metre\per\volt"),
    ("ppm/(V/m)^2", r"\ppm\metre\tothe{2}\per\volt\tothe{2}"),
    ("ppm/(W/m^2)", r"\ppm\metre\tothe{2}\per\watt"),
    ("ppm/(W/m^2)^2", r"\ppm\metre\tothe{4}\per\watt\tothe{2}"),
    ("ppm/Gy", r"\ppm\per\gray"),
    ("ppm/Gy^2", r"\ppm\per\gray\tothe{2}"),
    ("ppm/(m/s^2)", r"\ppm\second\tothe{2}\per\metre"),
    ("ppm/(m/s^2)^2", r"\ppm\second\tothe{4}\per\metre\tothe{2}"),
    ("ppm/(deg/s^2)", r"\ppm\second\tothe{2}\per\degree"),
    ("ppm/(deg/s^2)^2", r"\ppm\second\tothe{4}\per\degree\tothe{2}"),
    ("deg/h/sqrt(Hz)", r"\degree\second\tothe{0.5}\per\hour"),
    ("dB", r"\decibel"),
    ("W", r"\watt"),
    ("A", r"\ampere"),
    ("count/arcsec", r"\one\per\arcsecond"),
    ("count/(deg/h)", r"\hour\per\degree"),
];

/// A unit of a result in D-SI: its name there, with the factor of values in it; and its name as a unit outside D-SI, where
/// it has none of its own and is converted to one of its dimension.
fn si_unit(unit: &str) -> (Option<(&'static str, f64)>, Option<String>) {
    if let Some((_, name)) = UNITS.iter().find(|(own, _)| *own == unit) {
        return (Some((*name, 1.0)), None);
    }
    let given = Unit::parse(unit).ok();
    let alike = |(own, name): &(&str, &'static str)| {
        let factor = given.as_ref()?.factor_to(&Unit::parse(own).ok()?).ok()?;
        Some((*name, factor))
    };
    let plain: String = unit.chars().filter(|c| !c.is_whitespace()).collect();
    (UNITS.iter().find_map(alike), Some(format!("|{plain}")))
}

/// A number with its unit. One outside D-SI stands beside the number that it is converted to.
fn quantity(xml: &mut Xml, figure: &Figure, unit: &str) -> io::Result<()> {
    match si_unit(unit) {
        (Some((name, factor)), Some(other)) => node(xml, "si:hybrid", &[], |xml| {
            real(xml, figure, name, factor)?;
            real(xml, figure, &other, 1.0)
        }),
        (Some((name, factor)), None) => real(xml, figure, name, factor),
        (None, other) => real(xml, figure, other.as_deref().unwrap_or(r"\one"), 1.0),
    }
}

fn real(xml: &mut Xml, figure: &Figure, unit: &str, factor: f64) -> io::Result<()> {
    node(xml, "si:real", &[], |xml| {
        leaf(xml, "si:value", &[], &number(factor * figure.value))?;
        leaf(xml, "si:unit", &[], unit)?;
        let (Some((low, high)), Some(coverage)) = (figure.interval, figure.coverage) else { return Ok(()) };
        let (low, high) = (factor * low, factor * high);
        let standard = (0.5 * (high - low) / coverage_factor(coverage)).abs();
        if !standard.is_finite() {
            return Ok(());
        }
        node(xml, "si:measurementUncertaintyUnivariate", &[], |xml| {
            node(xml, "si:coverageIntervalMU", &[], |xml| {
                leaf(xml, "si:valueStandardMU", &[], &number(standard))?;
                leaf(xml, "si:intervalMin", &[], &number(low))?;
                leaf(xml, "si:intervalMax", &[], &number(high))?;
                // The schema allows no exponent here.
                leaf(xml, "si:coverageProbability", &[], &coverage.to_string())
            })
        })
    })
}

/// Half the length of an interval of a normal distribution, in standard deviations.
fn coverage_factor(coverage: f64) -> f64 {
    normal_quantile(0.5 * (1.0 + coverage))
}

fn optional(xml: &mut Xml, name: &str, text: Option<&str>) -> io::Result<()> {
    stated(text).map_or(Ok(()), |text| leaf(xml, name, &[], text))
}

/// A program in its version.
fn software(xml: &mut Xml, list: &str, name: &str, version: &str) -> io::Result<()> {
    node(xml, list, &[], |xml| {
        node(xml, "dcc:software", &[], |xml| {
            node(xml, "dcc:name", &[], |xml| leaf(xml, "dcc:content", &[], name))?;
            leaf(xml, "dcc:release", &[], &format!("v{version}"))?;
            leaf(xml, "dcc:type", &[], "application")
        })
    })
}

struct Certificate<'a> {
    record: &'a RunRecord,
    laboratory: &'a Laboratory,
}

impl Certificate<'_> {
    /// An element with a text in every language of the certificate; nothing where it is empty.
    fn texts(&self, xml: &mut Xml, name: &str, of: impl Fn(Translator) -> String) -> io::Result<()> {
        let text = |lang: &Lang| (lang.code(), of(Translator { lang: *lang }));
        let texts: Vec<(&str, String)> = self.laboratory.languages.iter().map(text).collect();
        if texts.iter().all(|(_, text)| text.is_empty()) {
            return Ok(());
        }
        node(xml, name, &[], |xml| {
            texts.iter().try_for_each(|(code, text)| leaf(xml, "dcc:content", &[("lang", *code)], text))
        })
    }

    fn administrative_data(&self, xml: &mut Xml) -> io::Result<()> {
        software(xml, "dcc:dccSoftware", "sagnac", env!("CARGO_PKG_VERSION"))?;
        node(xml, "dcc:coreData", &[], |xml| self.core_data(xml))?;
        node(xml, "dcc:items", &[], |xml| node(xml, "dcc:item", &[], |xml| self.item(xml)))?;
        node(xml, "dcc:calibrationLaboratory", &[], |xml| {
            self.contact(xml, "dcc:contact", &self.laboratory.contact)
        })?;
        node(xml, "dcc:respPersons", &[], |xml| {
            self.laboratory.persons.iter().try_for_each(|person| {
                node(xml, "dcc:respPerson", &[], |xml| {
                    node(xml, "dcc:person", &[], |xml| {
                        self.texts(xml, "dcc:name", |words| words.local(&person.name))
                    })?;
                    optional(xml, "dcc:role", person.role.as_deref())?;
                    leaf(xml, "dcc:mainSigner", &[], if person.main_signer { "true" } else { "false" })
                })
            })
        })?;
        if let Some(customer) = &self.laboratory.customer {
            self.contact(xml, "dcc:customer", customer)?;
        }
        node(xml, "dcc:statements", &[], |xml| self.statements(xml))
    }

    fn core_data(&self, xml: &mut Xml) -> io::Result<()> {
        leaf(xml, "dcc:countryCodeISO3166_1", &[], &self.laboratory.contact.country)?;
        for lang in &self.laboratory.languages {
            leaf(xml, "dcc:usedLangCodeISO639_1", &[], lang.code())?;
        }
        for lang in &self.laboratory.binding_languages {
            leaf(xml, "dcc:mandatoryLangCodeISO639_1", &[], lang.code())?;
        }
        let identity: String = identity(self.record).chars().take(32).collect();
        leaf(xml, "dcc:uniqueIdentifier", &[], &format!("sagnac-{identity}"))?;
        if let Some((begin, end)) = span(self.record) {
            leaf(xml, "dcc:beginPerformanceDate", &[], &begin.date_naive().to_string())?;
            leaf(xml, "dcc:endPerformanceDate", &[], &end.date_naive().to_string())?;
        }
        leaf(xml, "dcc:performanceLocation", &[], self.laboratory.place.id())
    }

    /// The unit under test. Who made it is not known.
    fn item(&self, xml: &mut Xml) -> io::Result<()> {
        let unit = &self.record.unit_under_test;
        self.texts(xml, "dcc:name", |words| words.t("dcc.item"))?;
        optional(xml, "dcc:model", unit.model.as_deref().or(unit.family.as_ref().map(|f| f.text())))?;
        let numbers =
            [("report.serial", &unit.serial), ("report.part", &unit.part), ("report.lot", &unit.lot)];
        node(xml, "dcc:identifications", &[], |xml| {
            numbers.into_iter().try_for_each(|(key, value)| {
                stated(value.as_deref()).map_or(Ok(()), |value| self.identification(xml, key, value))
            })
        })
    }

    fn identification(&self, xml: &mut Xml, key: &str, value: &str) -> io::Result<()> {
        node(xml, "dcc:identification", &[], |xml| {
            leaf(xml, "dcc:issuer", &[], "manufacturer")?;
            leaf(xml, "dcc:value", &[], value)?;
            self.texts(xml, "dcc:name", |words| words.t(key))
        })
    }

    fn contact(&self, xml: &mut Xml, name: &str, contact: &Contact) -> io::Result<()> {
        node(xml, name, &[], |xml| {
            self.texts(xml, "dcc:name", |words| words.local(&contact.name))?;
            optional(xml, "dcc:eMail", contact.email.as_deref())?;
            optional(xml, "dcc:phone", contact.phone.as_deref())?;
            node(xml, "dcc:location", &[], |xml| {
                optional(xml, "dcc:city", Some(&contact.city))?;
                optional(xml, "dcc:countryCode", Some(&contact.country))?;
                optional(xml, "dcc:postCode", contact.postcode.as_deref())?;
                optional(xml, "dcc:state", contact.state.as_deref())?;
                optional(xml, "dcc:street", contact.street.as_deref())?;
                optional(xml, "dcc:streetNo", contact.number.as_deref())
            })
        })
    }

    /// The verdict on the unit, and the units that D-SI has no name for.
    fn statements(&self, xml: &mut Xml) -> io::Result<()> {
        let record = self.record;
        node(xml, "dcc:statement", &[("refType", "basic_conformity")], |xml| {
            self.texts(xml, "dcc:declaration", |words| {
                let verdict = words.verdict(record.verdict);
                format!("{}: {verdict}. {}", words.t("report.verdict"), said(&record.summary, words))
            })?;
            optional(xml, "dcc:conformity", conformity(record.verdict))
        })?;
        let rows = record.measurands.iter();
        let limits = rows.clone().filter_map(|m| m.limit.as_ref()).map(|l| l.unit.as_str());
        let units: BTreeSet<&str> = rows.map(|m| m.unit.as_str()).chain(limits).collect();
        units.into_iter().try_for_each(|unit| {
            let (si, Some(other)) = si_unit(unit) else { return Ok(()) };
            let defined = si.map(|(name, factor)| format!("{} {name}", number(factor)));
            node(xml, "dcc:statement", &[], |xml| {
                leaf(xml, "dcc:nonSIDefinition", &[], defined.as_deref().unwrap_or(unit))?;
                leaf(xml, "dcc:nonSIUnit", &[], &other)
            })
        })
    }

    fn results(&self, xml: &mut Xml) -> io::Result<()> {
        let record = self.record;
        self.texts(xml, "dcc:name", |words| match &record.procedure {
            Some(procedure) => words.local(&procedure.title),
            None => words.t("report.title_analysis"),
        })?;
        node(xml, "dcc:usedMethods", &[], |xml| self.methods(xml))?;
        software(xml, "dcc:usedSoftware", &record.program.name, &record.program.version)?;
        if !record.instruments.is_empty() {
            node(xml, "dcc:measuringEquipments", &[], |xml| self.instruments(xml))?;
        }
        node(xml, "dcc:influenceConditions", &[], |xml| self.influences(xml))?;
        node(xml, "dcc:results", &[], |xml| record.measurands.iter().try_for_each(|m| self.result(xml, m)))
    }

    /// The procedure with its limits, and how uncertainties are stated.
    fn methods(&self, xml: &mut Xml) -> io::Result<()> {
        if let Some(procedure) = &self.record.procedure {
            node(xml, "dcc:usedMethod", &[], |xml| {
                self.texts(xml, "dcc:name", |words| words.local(&procedure.title))?;
                optional(xml, "dcc:norm", procedure.standard.as_ref().map(|s| s.text()))?;
                let limits = procedure.limits.as_ref().map(|l| (&l.id, &l.revision, &l.sha256));
                let files = [Some((&procedure.id, &procedure.revision, &procedure.sha256)), limits];
                files.into_iter().flatten().try_for_each(|(id, revision, sha256)| {
                    leaf(xml, "dcc:reference", &[], &format!("{id} {revision} SHA-256:{sha256}"))
                })
            })?;
        }
        node(xml, "dcc:usedMethod", &[("refType", "basic_uncertainty")], |xml| {
            self.texts(xml, "dcc:name", |words| words.t("dcc.uncertainty"))?;
            self.texts(xml, "dcc:description", |words| {
                let factor = limit_digits(coverage_factor(0.95), 3, words.lang);
                words.with("dcc.uncertainty_text", &[("factor", &factor), ("coverage", "95")])
            })
        })
    }

    fn instruments(&self, xml: &mut Xml) -> io::Result<()> {
        self.record.instruments.iter().try_for_each(|instrument| {
            node(xml, "dcc:measuringEquipment", &[], |xml| {
                self.texts(xml, "dcc:name", |words| words.local(&instrument.name))?;
                if let Some(due) = stated(instrument.calibration_due.as_deref()) {
                    let until = |words: Translator| format!("{}: {due}", words.t("report.calibration_due"));
                    self.texts(xml, "dcc:description", until)?;
                }
                let Some(serial) = stated(instrument.serial.as_deref()) else { return Ok(()) };
                node(xml, "dcc:identifications", &[], |xml| self.identification(xml, "report.serial", serial))
            })
        })
    }

    /// The temperatures that were observed; where there are none, a sentence says so.
    fn influences(&self, xml: &mut Xml) -> io::Result<()> {
        let is_observed = |c: &&ConditionRecord| observed(c, "min").or(observed(c, "max")).is_some();
        let found: Vec<&ConditionRecord> = temperatures(self.record).filter(is_observed).collect();
        let attributes = [("refType", "basic_temperature")];
        if found.is_empty() {
            return node(xml, "dcc:influenceCondition", &attributes, |xml| {
                self.texts(xml, "dcc:name", |words| words.t("condition.temperature"))?;
                node(xml, "dcc:data", &[], |xml| {
                    self.texts(xml, "dcc:text", |words| words.t("dcc.no_temperature"))
                })
            });
        }
        let places = [("min", "basic_temperatureMin"), ("max", "basic_temperatureMax")];
        found.into_iter().try_for_each(|condition| {
            node(xml, "dcc:influenceCondition", &attributes, |xml| {
                let channel = condition.id.split_once('.').map(|(_, channel)| channel);
                self.texts(xml, "dcc:name", |words| {
                    let name = words.t("condition.temperature");
                    let parts = [Some(name.as_str()), channel, condition.phase.as_deref()];
                    parts.into_iter().flatten().collect::<Vec<_>>().join(" · ")
                })?;
                self.texts(xml, "dcc:description", |words| said(condition.message.as_slice(), words))?;
                node(xml, "dcc:data", &[], |xml| {
                    let of = |(id, kind)| observed(condition, id).map(|value| (id, kind, value));
                    places.into_iter().filter_map(of).try_for_each(|(id, kind, value)| {
                        node(xml, "dcc:quantity", &[("refType", kind)], |xml| {
                            self.texts(xml, "dcc:name", |words| words.name("observed", id))?;
                            real(xml, &plain(value), r"\degreecelsius", 1.0)
                        })
                    })
                })
            })
        })
    }

    /// A row of the record.
    fn result(&self, xml: &mut Xml, m: &MeasurandRecord) -> io::Result<()> {
        node(xml, "dcc:result", &[], |xml| {
            self.texts(xml, "dcc:name", |words| row_name(m, words))?;
            self.texts(xml, "dcc:description", |words| said(&m.notes, words))?;
            let figures = figures(m);
            node(xml, "dcc:data", &[], |xml| match figures.as_slice() {
                [] => self.figure(xml, m, None),
                figures => figures.iter().try_for_each(|figure| self.figure(xml, m, Some(figure))),
            })
        })
    }

    fn figure(&self, xml: &mut Xml, m: &MeasurandRecord, figure: Option<&Figure>) -> io::Result<()> {
        node(xml, "dcc:quantity", &[("refType", "basic_measuredValue")], |xml| {
            match figure {
                Some(figure) => {
                    self.texts(xml, "dcc:name", |words| figure_name(figure, words))?;
                    quantity(xml, figure, &m.unit)?;
                }
                None => self.texts(xml, "dcc:noQuantity", |words| words.t("report.not_identifiable"))?,
            }
            self.method_and_limit(xml, m)
        })
    }

    fn method_and_limit(&self, xml: &mut Xml, m: &MeasurandRecord) -> io::Result<()> {
        node(xml, "dcc:usedMethods", &[], |xml| {
            node(xml, "dcc:usedMethod", &[], |xml| {
                self.texts(xml, "dcc:name", |words| words.name("how", &m.method))
            })
        })?;
        let Some(limit) = &m.limit else { return Ok(()) };
        node(xml, "dcc:measurementMetaData", &[], |xml| {
            node(xml, "dcc:metaData", &[("refType", "basic_conformity")], |xml| {
                let norm = if limit.rule == Rule::GuardBand { "JCGM 106" } else { "ILAC-G8" };
                leaf(xml, "dcc:norm", &[], norm)?;
                optional(xml, "dcc:reference", Some(&limit.source))?;
                self.texts(xml, "dcc:declaration", |words| {
                    let verdict = words.verdict(m.verdict);
                    words.with("dcc.judged", &[("rule", &rule(limit, words)), ("verdict", &verdict)])
                })?;
                optional(xml, "dcc:conformity", conformity(m.verdict))?;
                self.limits(xml, limit)
            })
        })
    }

    fn limits(&self, xml: &mut Xml, limit: &LimitRecord) -> io::Result<()> {
        // What an end is called, what the schema calls it, and its value.
        let ends = [
            ("dcc.limit_min", None, limit.min),
            ("dcc.limit_max", None, limit.max),
            ("dcc.acceptance_min", Some("basic_acceptanceLimitLower"), limit.acceptance_min),
            ("dcc.acceptance_max", Some("basic_acceptanceLimitUpper"), limit.acceptance_max),
        ];
        let known = ends.into_iter().filter_map(|(key, kind, end)| Some((key, kind, end?)));
        let known: Vec<_> = known.filter(|(.., end)| end.is_finite()).collect();
        if known.is_empty() {
            return Ok(());
        }
        node(xml, "dcc:data", &[], |xml| {
            known.into_iter().try_for_each(|(key, kind, end)| {
                let kind: Vec<(&str, &str)> = kind.map(|kind| ("refType", kind)).into_iter().collect();
                node(xml, "dcc:quantity", &kind, |xml| {
                    self.texts(xml, "dcc:name", |words| words.t(key))?;
                    quantity(xml, &plain(end), &limit.unit)
                })
            })
        })
    }
}

/// Sentences, one behind the other.
fn said(messages: &[Message], words: Translator) -> String {
    messages.iter().map(|m| words.say(m)).collect::<Vec<_>>().join(" ")
}

/// What a number of a row is: its value, or a bound on it.
fn figure_name(figure: &Figure, words: Translator) -> String {
    let coverage = limit_digits(100.0 * figure.coverage.unwrap_or(0.95), 3, words.lang);
    match figure.of {
        "upper_limit" => words.with("dcc.at_most", &[("coverage", &coverage)]),
        "lower_limit" => words.with("dcc.at_least", &[("coverage", &coverage)]),
        _ => words.t("report.value"),
    }
}

#[cfg(test)]
mod tests {
    use super::super::xml::reading::{Element, elements, ending};
    use super::*;
    use crate::config::laboratory;
    use crate::measurand::MEASURANDS;
    use crate::record::read;
    use std::path::Path;

    fn sample() -> RunRecord {
        let root = Path::new(env!("CARGO_MANIFEST_DIR"));
        read::open(&root.join("samples/lot/SN-3001/result.json")).unwrap()
    }

    fn a_laboratory() -> Laboratory {
        let text = "format = \"laboratory/1\"\nlanguages = [\"en\", \"ru\"]\n\
                    [laboratory]\nname = \"L\"\ncity = \"C\"\ncountry = \"DE\"\n\
                    [customer]\nname = \"O'Neil & <Sons>\"\ncity = \"Cork\"\ncountry = \"IE\"\n\
                    [[person]]\nname = \"A. Ivanova\"\nmain_signer = true\n";
        laboratory::parse("l.toml", text.as_bytes()).unwrap_or_else(|e| panic!("{e}"))
    }

    fn read_back(record: &RunRecord) -> Vec<Element> {
        elements(&written(record, &a_laboratory()).unwrap())
    }

    fn numbers(found: &[Element], end: &str) -> Vec<u64> {
        let of = |e: &&Element| e.text.parse::<f64>().unwrap().to_bits();
        ending(found, end).iter().map(of).collect()
    }

    #[test]
    fn numbers_read_back_to_the_bit() {
        let mut record = sample();
        record.measurands[0].value = Some(1.0 / 3.0 * 1e-9);
        let found = read_back(&record);
        let rows = &record.measurands;
        let bits = |values: Vec<f64>| values.into_iter().map(f64::to_bits).collect::<Vec<_>>();
        let place = "dcc:result/dcc:data/dcc:quantity/si:real";
        let given = rows.iter().flat_map(figures).map(|f| f.value).collect();
        assert_eq!(numbers(&found, &format!("{place}/si:value")), bits(given));
        let interval = format!("{place}/si:measurementUncertaintyUnivariate/si:coverageIntervalMU");
        let of = |end: &str| numbers(&found, &format!("{interval}/si:{end}"));
        let intervals: Vec<_> = rows.iter().filter_map(|m| m.interval).collect();
        assert_eq!(of("intervalMin"), bits(intervals.iter().map(|i| i.low).collect()));
        assert_eq!(of("intervalMax"), bits(intervals.iter().map(|i| i.high).collect()));
        assert_eq!(of("coverageProbability"), bits(intervals.iter().map(|i| i.coverage).collect()));
        let first = f64::from_bits(of("valueStandardMU")[0]);
        assert!((first * 2.0 * 1.96 / (intervals[0].high - intervals[0].low) - 1.0).abs() < 1e-4);
    }

    #[test]
    fn a_unit_outside_d_si_stands_beside_its_conversion() {
        let mut record = sample();
        record.measurands[0].unit = "deg/h/g^2".into();
        let found = read_back(&record);
        let units = ending(&found, "dcc:quantity/si:hybrid/si:real/si:unit");
        assert_eq!(units[1].text, "|deg/h/g^2");
        let converted = ending(&found, "si:hybrid/si:real/si:value")[0].text.parse::<f64>().unwrap();
        let value = record.measurands[0].value.unwrap();
        assert!((converted * 9.80665 * 9.80665 / value - 1.0).abs() < 1e-12);
        assert_eq!(ending(&found, "dcc:statement/dcc:nonSIUnit")[0].text, "|deg/h/g^2");
        assert_eq!(si_unit("furlong / h"), (None, Some("|furlong/h".into())));
    }

    #[test]
    fn every_unit_of_a_measurand_has_a_name_in_d_si() {
        for unit in MEASURANDS.iter().flat_map(|m| m.recorded_in.iter().copied().chain([m.unit])) {
            let (si, other) = si_unit(unit);
            let (name, factor) = si.unwrap_or_else(|| panic!("{unit}"));
            assert!(name.starts_with('\\') && name.matches(r"\per").count() < 2, "{unit}: {name}");
            assert_eq!(other.is_some(), factor != 1.0, "{unit}");
        }
        assert!(UNITS.iter().all(|(own, _)| own.is_empty() || Unit::parse(own).is_ok()));
    }

    #[test]
    fn names_with_marks_of_xml_read_back() {
        let mut record = sample();
        record.unit_under_test.serial = Some(" A<&>\"'\u{1}7 ".into());
        let found = read_back(&record);
        assert_eq!(ending(&found, "dcc:identification/dcc:value")[0].text, "A<&>\"'7");
        assert_eq!(ending(&found, "dcc:customer/dcc:name/dcc:content")[0].text, "O'Neil & <Sons>");
    }

    #[test]
    fn what_is_missing_is_named() {
        let mut record = sample();
        let keys = |record: &RunRecord, laboratory: Option<&Laboratory>| {
            missing(record, laboratory).into_iter().map(|n| n.id.into_owned()).collect::<Vec<_>>()
        };
        assert_eq!(keys(&record, Some(&a_laboratory())), [""; 0]);
        assert_eq!(keys(&record, None), ["dcc.no_laboratory"]);
        let bare = ["dcc.no_customer", "dcc.no_person", "dcc.no_language"];
        assert_eq!(keys(&record, Some(&Laboratory::default())), bare);
        record.unit_under_test.serial = Some(" ".into());
        record.measurands.clear();
        record.session.evaluated_at = "today".into();
        let lacking = ["dcc.no_serial", "dcc.no_rows", "dcc.no_date"];
        assert_eq!(keys(&record, Some(&a_laboratory())), lacking);
    }

    #[test]
    fn verdicts_are_statements_and_undecided_is_no_pass() {
        let mut record = sample();
        record.measurands[0].verdict = Verdict::Indeterminate;
        let found = read_back(&record);
        let said = ending(&found, "dcc:metaData/dcc:conformity");
        assert_eq!((said.len(), &*said[0].text, &*said[1].text), (7, "noPass", "pass"));
        let declared = ending(&found, "dcc:metaData/dcc:declaration/dcc:content");
        assert_eq!(declared[0].attributes["lang"], "en");
        assert!(declared[0].text.contains("indeterminate") && declared[1].text.contains("не определено"));
    }
}
