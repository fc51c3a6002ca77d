//! `sagnac schema`: JSON Schema of the formats. Those of what a user writes are made from the tables of keys; those of results are
//! files of `schemas/`, which `cargo xtask schemas` generates from the types of the records.

use super::exit;
use crate::config::procedure::schema;
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
    /// Rules of a watched folder
    Watch,
    /// Devices of a bench
    Bench,
    /// Rules of a bench
    Serve,
    /// datasheet.json
    Datasheet,
    /// What `sagnac history --format json` writes
    History,
}

pub fn main(args: &SchemaArgs) -> Result<u8, String> {
    let made = match args.kind {
        SchemaKind::Procedure => schema::procedure(),
        SchemaKind::Limits => schema::limits(),
        SchemaKind::Manifest => schema::manifest(),
        SchemaKind::Layout => schema::layout(),
        SchemaKind::Model => schema::model(),
        SchemaKind::Proof => schema::proof(),
        SchemaKind::Sheet => schema::sheet(),
        SchemaKind::Watch => schema::watch(),
        SchemaKind::Bench => schema::bench(),
        SchemaKind::Serve => schema::serve(),
        SchemaKind::Schedule => schema::schedule(),
        SchemaKind::Alternatives => schema::alternatives(),
        SchemaKind::Result => return generated(include_str!("../../schemas/result.json")),
        SchemaKind::Explain => return generated(include_str!("../../schemas/explain.json")),
        SchemaKind::Joint => return generated(include_str!("../../schemas/joint.json")),
        SchemaKind::Lot => return generated(include_str!("../../schemas/lot.json")),
        SchemaKind::Plan => return generated(include_str!("../../schemas/plan.json")),
        SchemaKind::ProofResult => return generated(include_str!("../../schemas/proof-result.json")),
        SchemaKind::Datasheet => return generated(include_str!("../../schemas/datasheet.json")),
        SchemaKind::History => return generated(include_str!("../../schemas/history.json")),
    };
    super::place::print(&format!("{made:#}\n"));
    Ok(exit::PASS)
}

fn generated(schema: &str) -> Result<u8, String> {
    super::place::print(schema);
    Ok(exit::PASS)
}
