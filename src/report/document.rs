//! What is exported: a result, an explanation or a comparison, with its figures and tables, in one language.

use super::compare::CompareView;
use super::datasheet::SheetView;
use super::explain::{ExplainFile, ExplainView};
use super::joint::{JointFile, JointView};
use super::lot::LotView;
use super::plan::{PlanFile, PlanView};
use super::proof::ProofView;
use super::render::{paper_context, run_context, view_context};
use super::results::{ExplanationResults, Results};
use super::view::{PhasePart, View};
use crate::acceptance::Outcome;
use crate::acceptance::compare::Comparison;
use crate::acceptance::phases::figures as phase_figures;
use crate::figure::Figure;
use crate::i18n::Lang;
use crate::output::Kind;
use crate::record::{DataSheet, LotRecord, ProofRecord, RunRecord};
use minijinja::value::Value;
use serde::Serialize;
use std::borrow::Cow;

/// What every exporter is given.
pub struct Document<'a> {
    /// The language of words and numbers. Records and tables are the same in every language.
    pub lang: Lang,
    /// The figures, in the order of the page.
    pub figures: Cow<'a, [Figure]>,
    /// Tables and other data files, the same in every language: name and contents.
    pub tables: &'a [(String, String)],
    record: Record<'a>,
    template: &'static str,
    context: Value,
}

/// The record that the JSON file of a document holds.
#[derive(Serialize)]
#[serde(untagged)]
enum Record<'a> {
    Run(&'a RunRecord),
    Explanation(&'a ExplainFile),
    Comparison(&'a Comparison),
    Lot(&'a LotRecord),
    Joint(&'a JointFile),
    Plan(&'a PlanFile),
    DataSheet(&'a DataSheet),
    Proof(&'a ProofRecord),
}

impl<'a> Document<'a> {
    /// The document of a run or an analysis.
    pub fn of_run(outcome: &'a Outcome, lang: Lang) -> Document<'a> {
        let Outcome { record, figures, tables } = outcome;
        Document {
            lang,
            context: run_context(&View::new(record, figures, lang), record, lang),
            template: "report",
            figures: figures.into(),
            tables,
            record: Record::Run(record),
        }
    }

    /// The document of a test of several phases, whose outcomes stand in the order of the phases of `record`; `None` for
    /// one that was not recorded.
    pub fn of_phases(record: &'a RunRecord, phases: &[Option<Outcome>], lang: Lang) -> Document<'a> {
        let figures: Vec<Vec<Figure>> =
            record.phases.iter().zip(phases).map(|(p, o)| phase_figures(&p.id, o.as_ref())).collect();
        let parts: Vec<PhasePart<'_>> = record
            .phases
            .iter()
            .zip(phases)
            .zip(&figures)
            .map(|((phase, o), figures)| PhasePart { phase, record: o.as_ref().map(|o| &o.record), figures })
            .collect();
        Document {
            lang,
            context: run_context(&View::of_phases(record, &parts, lang), record, lang),
            template: "phases",
            figures: figures.concat().into(),
            tables: &[],
            record: Record::Run(record),
        }
    }

    /// The document of an explanation.
    pub fn of_explanation(results: &'a ExplanationResults, lang: Lang) -> Document<'a> {
        let ExplanationResults { file, figures, tables } = results;
        let view = ExplainView::new(&file.explanation, figures, &file.context, lang);
        Document {
            lang,
            context: view_context(&view, lang),
            template: "explain",
            figures: figures.into(),
            tables,
            record: Record::Explanation(file),
        }
    }

    /// The document of a comparison.
    pub fn of_comparison(
        comparison: &'a Comparison,
        figures: &'a [Figure],
        tables: &'a [(String, String)],
        lang: Lang,
    ) -> Document<'a> {
        Document {
            lang,
            context: view_context(&CompareView::new(comparison, figures, lang), lang),
            template: "compare",
            figures: figures.into(),
            tables,
            record: Record::Comparison(comparison),
        }
    }

    /// The document of a lot.
    pub fn of_lot(lot: &'a LotRecord, tables: &'a [(String, String)], lang: Lang) -> Document<'a> {
        Document {
            lang,
            context: view_context(&LotView::new(lot, lang), lang),
            template: "lot",
            figures: Cow::Borrowed(&[]),
            tables,
            record: Record::Lot(lot),
        }
    }

    /// The document of several recordings that are explained together.
    pub fn of_joint(file: &'a JointFile, tables: &'a [(String, String)], lang: Lang) -> Document<'a> {
        Document {
            lang,
            context: view_context(&JointView::new(file, lang), lang),
            template: "joint",
            figures: Cow::Borrowed(&[]),
            tables,
            record: Record::Joint(file),
        }
    }

    /// The document of a plan.
    pub fn of_plan(file: &'a PlanFile, tables: &'a [(String, String)], lang: Lang) -> Document<'a> {
        Document {
            lang,
            context: view_context(&PlanView::new(file, lang), lang),
            template: "plan",
            figures: Cow::Borrowed(&[]),
            tables,
            record: Record::Plan(file),
        }
    }

    /// The document of a data sheet.
    pub fn of_datasheet(
        sheet: &'a DataSheet,
        figures: &'a [Figure],
        tables: &'a [(String, String)],
        lang: Lang,
    ) -> Document<'a> {
        Document {
            lang,
            context: view_context(&SheetView::new(sheet, figures, lang), lang),
            template: "datasheet",
            figures: figures.into(),
            tables,
            record: Record::DataSheet(sheet),
        }
    }

    /// The document of a proof.
    pub fn of_proof(
        proof: &'a ProofRecord,
        figures: &'a [Figure],
        tables: &'a [(String, String)],
        lang: Lang,
    ) -> Document<'a> {
        Document {
            lang,
            context: view_context(&ProofView::new(proof, figures, lang), lang),
            template: "proof",
            figures: figures.into(),
            tables,
            record: Record::Proof(proof),
        }
    }

    /// The lot that the document is of.
    pub fn lot(&self) -> Option<&'a LotRecord> {
        match self.record {
            Record::Lot(lot) => Some(lot),
            _ => None,
        }
    }

    /// The run that the document is of.
    pub fn run(&self) -> Option<&'a RunRecord> {
        match self.record {
            Record::Run(run) => Some(run),
            _ => None,
        }
    }

    /// What the folder of the document holds.
    pub fn kind(&self) -> Kind {
        match self.record {
            Record::Run(_) => Kind::Result,
            Record::Explanation(_) => Kind::Explanation,
            Record::Comparison(_) => Kind::Comparison,
            Record::Lot(_) => Kind::Lot,
            Record::Joint(_) => Kind::Joint,
            Record::Plan(_) => Kind::Plan,
            Record::DataSheet(_) => Kind::DataSheet,
            Record::Proof(_) => Kind::Proof,
        }
    }

    /// Name of a page, such as `report.html`, by the ending of its file.
    pub fn page(&self, ending: &str) -> String {
        format!("{}.{ending}", self.kind().page_stem())
    }

    /// Name of the template that makes a page, by the ending of its file.
    pub fn template(&self, ending: &str) -> String {
        format!("{}.{ending}", self.template)
    }

    /// What templates see: `v`, the view; `locale`, the words of the language; `run`, the record of a run.
    pub fn context(&self) -> &Value {
        &self.context
    }

    /// What templates see where the page is to be printed: the same, and `paper`.
    pub fn paper_context(&self) -> Value {
        paper_context(self.context.clone())
    }

    /// What the document is of, for the head of a page: the unit, the case, the procedure or the model.
    pub fn subject(&self) -> String {
        match self.record {
            Record::Run(run) => run.unit_under_test.serial.clone().unwrap_or_default(),
            Record::Explanation(file) => file.explanation.case.clone(),
            Record::Comparison(_) => String::new(),
            Record::Lot(lot) => lot.procedure.id.clone(),
            Record::Joint(file) => file.explanation.case.clone(),
            Record::Plan(file) => file.plan.case.clone(),
            Record::DataSheet(sheet) => sheet.model.clone().unwrap_or_default(),
            Record::Proof(proof) => proof.title.text().to_owned(),
        }
    }

    /// When the record was made, RFC 3339.
    pub fn made_at(&self) -> &str {
        match self.record {
            Record::Run(run) => &run.session.evaluated_at,
            Record::Explanation(file) => &file.context.explained_at,
            Record::Comparison(comparison) => &comparison.compared_at,
            Record::Lot(lot) => &lot.session.evaluated_at,
            Record::Joint(file) => &file.context.explained_at,
            Record::Plan(file) => &file.context.planned_at,
            Record::DataSheet(sheet) => &sheet.made_at,
            Record::Proof(proof) => &proof.proved_at,
        }
    }

    /// The record, for a JSON file.
    pub fn record(&self) -> impl Serialize {
        &self.record
    }

    /// The figures whose data are to be kept beside the record. A phase keeps its own.
    pub fn own_figures(&self) -> &[Figure] {
        if self.template == "phases" { &[] } else { &self.figures }
    }
}

impl Results {
    /// The document of the whole.
    pub fn whole(&self, lang: Lang) -> Document<'_> {
        match self {
            Results::Run(results) if results.outcome.record.phases.is_empty() => {
                Document::of_run(&results.outcome, lang)
            }
            Results::Run(results) => Document::of_phases(&results.outcome.record, &results.phases, lang),
            Results::Explanation(results) => Document::of_explanation(results, lang),
            Results::Comparison(comparison, figures, tables) => {
                Document::of_comparison(comparison, figures, tables, lang)
            }
            Results::Lot(lot, tables) => Document::of_lot(lot, tables, lang),
            Results::Joint(results) => Document::of_joint(&results.file, &results.tables, lang),
            Results::Plan(file, tables) => Document::of_plan(file, tables, lang),
            Results::DataSheet(sheet, figures, tables) => {
                Document::of_datasheet(sheet, figures, tables, lang)
            }
            Results::Proof(proof, figures, tables) => Document::of_proof(proof, figures, tables, lang),
        }
    }

    /// The documents that stand in folders below that of the whole, each with its folder, such as `phases/static`.
    pub fn parts(&self, lang: Lang) -> Vec<(String, Document<'_>)> {
        if let Results::Joint(results) = self {
            let folders = results.file.explanation.recordings.iter().map(|r| r.folder.clone());
            let parts =
                folders.zip(&results.recordings).filter_map(|(folder, e)| Some((folder, e.as_ref()?)));
            return parts.map(|(folder, e)| (folder, Document::of_explanation(e, lang))).collect();
        }
        let Results::Run(results) = self else { return vec![] };
        let phases = results.outcome.record.phases.iter().zip(&results.phases);
        let phases = phases.filter_map(|(phase, o)| phase.folder.clone().zip(o.as_ref()));
        let explanation = results.explanation.as_ref().map(|e| ("explain".to_owned(), e));
        let phases = phases.map(|(folder, o)| (folder, Document::of_run(o, lang)));
        let explanation = explanation.map(|(folder, e)| (folder, Document::of_explanation(e, lang)));
        phases.chain(explanation).collect()
    }
}
