//! `sagnac schema`: JSON Schema of the formats.

use super::{SchemaArgs, SchemaKind, exit};
use crate::output::Listed;
use crate::record::RunRecord;

pub fn main(args: &SchemaArgs) -> u8 {
    let schema = match args.kind {
        SchemaKind::Procedure => crate::procedure::schema::procedure(),
        SchemaKind::Limits => crate::procedure::schema::limits(),
        SchemaKind::Manifest => crate::procedure::schema::manifest(),
        SchemaKind::Layout => crate::procedure::schema::layout(),
        SchemaKind::Model => crate::procedure::schema::model(),
        SchemaKind::Result => {
            serde_json::to_value(schemars::schema_for!(Listed<RunRecord>)).unwrap_or_default()
        }
    };
    super::place::print(&format!("{schema:#}\n"));
    exit::PASS
}
