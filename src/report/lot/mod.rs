//! The view of a lot: words and printed numbers, ready for a template and for the terminal.

mod csv;
mod quantity;
mod reasons;

pub use csv::csv;
pub use quantity::QuantityView;
pub(super) use reasons::{condition_reason, measurand_reason, reasons, several_channels};

use super::document::{Contents, Documented, Record};
use super::number::date_time;
use super::translator::{Field, Translator};
use crate::estimate::Verdict;
use crate::figure::Figure;
use crate::i18n::Lang;
use crate::output::Kind;
use crate::record::{LotRecord, LotUnit, SerialSource};
use serde::Serialize;

/// Everything that the page of a lot shows.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LotView {
    /// Title of the procedure.
    pub title: String,
    /// Id of the worst verdict, for colours.
    pub verdict: &'static str,
    /// The worst verdict in words.
    pub verdict_word: String,
    /// How many units there are, in words.
    pub size: String,
    /// How many units have each verdict, the worst first.
    pub counts: Vec<CountView>,
    /// Where the serial numbers were taken from.
    pub serials: String,
    /// Procedure, limits, session.
    pub identity: Vec<Field>,
    /// The units: errors first, then failed, undecided, and passed ones; else in the order of the record.
    pub units: Vec<LotUnitView>,
    /// The quantities that have a limit, each over all units.
    pub quantities: Vec<QuantityView>,
    /// Line at the foot of every page.
    pub footer: String,
    /// The program with its version.
    pub generator: String,
}

/// A verdict and how many units have it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CountView {
    /// Id of the verdict.
    pub verdict: &'static str,
    /// The verdict in words.
    pub verdict_word: String,
    /// Units.
    pub n: usize,
}

/// A unit, printed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LotUnitView {
    /// Serial number.
    pub serial: String,
    /// Where it was taken from, in words.
    pub serial_from: String,
    /// The recording as named.
    pub recording: String,
    /// Folder of its report.
    pub folder: String,
    /// Id of the verdict, for colours.
    pub verdict: &'static str,
    /// The verdict in words.
    pub verdict_word: String,
    /// How many limits are met, in words; empty without a limit.
    pub met: String,
    /// Why it does not pass; empty where it does.
    pub reasons: Vec<String>,
}

impl Documented for LotRecord {
    fn record(&self) -> Record<'_> {
        Record::Lot(self)
    }

    fn kind(&self) -> Kind {
        Kind::Lot
    }

    fn subject(&self) -> Option<&str> {
        Some(&self.procedure.id)
    }

    fn made_at(&self) -> &str {
        &self.session.evaluated_at
    }

    fn program_version(&self) -> Option<&str> {
        Some(&self.program.version)
    }

    fn contents(&self, _: &[Figure], lang: Lang) -> Contents {
        Contents::view("lot", &LotView::new(self, lang), lang)
    }
}

impl LotView {
    /// Builds the view.
    pub fn new(lot: &LotRecord, lang: Lang) -> LotView {
        let words = Translator { lang };
        let mut units: Vec<&LotUnit> = lot.units.iter().collect();
        units.sort_by_key(|u| std::cmp::Reverse(u.verdict.max(Verdict::Pass)));
        let generator = format!("{} {}", lot.program.name, lot.program.version);
        LotView {
            title: words.local(&lot.procedure.title),
            verdict: lot.verdict.id(),
            verdict_word: words.verdict(lot.verdict),
            size: words.with("lot.size", &[("n", &lot.units.len().to_string())]),
            counts: lot
                .counts
                .present()
                .into_iter()
                .map(|(verdict, n)| CountView {
                    verdict: verdict.id(),
                    verdict_word: words.verdict(verdict),
                    n,
                })
                .collect(),
            serials: serials(&lot.units, words),
            identity: identity(lot, words),
            units: units.into_iter().map(|u| unit_view(u, words)).collect(),
            quantities: quantity::quantities(&lot.units, words),
            footer: [&revision(lot, words), &date_time(&lot.session.evaluated_at), &generator]
                .map(String::as_str)
                .join(" · "),
            generator,
        }
    }
}

impl LotUnitView {
    /// One unit, printed.
    pub fn new(unit: &LotUnit, lang: Lang) -> LotUnitView {
        unit_view(unit, Translator { lang })
    }
}

fn unit_view(unit: &LotUnit, words: Translator) -> LotUnitView {
    let met = unit.measurands.iter().filter(|m| m.verdict == Verdict::Pass).count();
    let (met, all) = (met.to_string(), unit.measurands.len().to_string());
    LotUnitView {
        serial: unit.serial().to_owned(),
        serial_from: words.name("serial_from", unit.serial_from.id()),
        recording: unit.recording.clone(),
        folder: unit.folder.clone(),
        verdict: unit.verdict.id(),
        verdict_word: words.verdict(unit.verdict),
        met: if unit.measurands.is_empty() {
            String::new()
        } else {
            words.with("terminal.met", &[("met", &met), ("all", &all)])
        },
        reasons: reasons(unit, words),
    }
}

/// How many serial numbers were taken from where.
fn serials(units: &[LotUnit], words: Translator) -> String {
    let of = |source: SerialSource| units.iter().filter(|u| u.serial_from == source).count();
    let parts: Vec<String> = SerialSource::ALL
        .into_iter()
        .map(|source| (source, of(source)))
        .filter(|(_, n)| *n > 0)
        .map(|(source, n)| format!("{} ({n})", words.name("serial_from", source.id())))
        .collect();
    words.with("lot.serials", &[("sources", &parts.join("; "))])
}

fn revision(lot: &LotRecord, words: Translator) -> String {
    let p = &lot.procedure;
    words.with("report.id_revision", &[("id", &p.id), ("revision", &p.revision)])
}

fn identity(lot: &LotRecord, words: Translator) -> Vec<Field> {
    let mut out = vec![Field { label: words.t("report.procedure"), value: revision(lot, words) }];
    let mut put = |key: &str, value: Option<&str>| {
        if let Some(value) = value.filter(|v| !v.trim().is_empty()) {
            out.push(Field { label: words.t(key), value: value.to_owned() });
        }
    };
    put("report.standard", lot.procedure.standard.as_ref().map(|s| words.local(s)).as_deref());
    if let Some(l) = &lot.procedure.limits {
        let id = words.with("report.id_revision", &[("id", &l.id), ("revision", &l.revision)]);
        put("report.limits", Some(&format!("{} ({id})", words.local(&l.title))));
    }
    put("report.station", lot.session.station.as_deref());
    put("report.operator", lot.session.operator.as_deref());
    put("report.evaluated_at", Some(&date_time(&lot.session.evaluated_at)));
    put("report.program", Some(&format!("{} {}", lot.program.name, lot.program.version)));
    out
}
