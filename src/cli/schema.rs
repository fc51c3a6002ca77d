//! `sagnac schema`: JSON Schema of the formats.

use super::exit;
use crate::mismatch::joint::record::JointExplanation;
use crate::output::Listed;
use crate::plan::Plan;
use crate::record::explanation::Explanation;
use crate::record::{DataSheet, HistoryRecord, LotRecord, ProofRecord, RunRecord};
use clap::{Args, ValueEnum};

#[derive(Debug, Args)]
pub struct SchemaArgs {
    /// File format
    kind: SchemaKind,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
pub enum SchemaKind {
    /// A test procedure
    Procedure,
    /// A limits file
    Limits,
    /// A layout of raw binary records
    Layout,
    /// result.json
    Result,
    /// A manifest: several files as one recording
    Manifest,
    /// A model: the expected content of a recording
    Model,
    /// explain.json
    Explain,
    /// joint.json: several recordings explained together
    Joint,
    /// index.json of a lot
    Lot,
    /// plan.json
    Plan,
    /// A schedule: what chamber and table do in a test
    Schedule,
    /// alternatives.toml: what would explain a recording as well
    Alternatives,
    /// A proof file: what is concealed of a recording, and the rules by which the answer is judged
    Proof,
    /// proof.json: what came of a proof
    ProofResult,
    /// A sheet file: rows, names and units of a data sheet
    Sheet,
    /// datasheet.json
    Datasheet,
    /// What `sagnac history --format json` writes
    History,
}

pub fn main(args: &SchemaArgs) -> Result<u8, String> {
    let schema = match args.kind {
        SchemaKind::Procedure => crate::config::procedure::schema::procedure(),
        SchemaKind::Limits => crate::config::procedure::schema::limits(),
        SchemaKind::Manifest => crate::config::procedure::schema::manifest(),
        SchemaKind::Layout => crate::config::procedure::schema::layout(),
        SchemaKind::Model => crate::config::procedure::schema::model(),
        SchemaKind::Proof => crate::config::procedure::schema::proof(),
        SchemaKind::ProofResult => {
            serde_json::to_value(schemars::schema_for!(Listed<ProofRecord>)).unwrap_or_default()
        }
        SchemaKind::Sheet => crate::config::procedure::schema::sheet(),
        SchemaKind::Schedule => crate::config::procedure::schema::schedule(),
        SchemaKind::Alternatives => crate::config::procedure::schema::alternatives(),
        SchemaKind::Plan => serde_json::to_value(schemars::schema_for!(Listed<Plan>)).unwrap_or_default(),
        SchemaKind::Joint => {
            serde_json::to_value(schemars::schema_for!(Listed<JointExplanation>)).unwrap_or_default()
        }
        SchemaKind::Lot => serde_json::to_value(schemars::schema_for!(Listed<LotRecord>)).unwrap_or_default(),
        SchemaKind::Datasheet => {
            serde_json::to_value(schemars::schema_for!(Listed<DataSheet>)).unwrap_or_default()
        }
        SchemaKind::History => serde_json::to_value(schemars::schema_for!(HistoryRecord)).unwrap_or_default(),
        SchemaKind::Explain => {
            serde_json::to_value(schemars::schema_for!(Listed<Explanation>)).unwrap_or_default()
        }
        SchemaKind::Result => {
            serde_json::to_value(schemars::schema_for!(Listed<RunRecord>)).unwrap_or_default()
        }
    };
    super::place::print(&format!("{schema:#}\n"));
    Ok(exit::PASS)
}
