//! `sagnac schema`: JSON Schema of the formats.

use super::{SchemaArgs, SchemaKind, exit};
use crate::output::Listed;
use crate::record::RunRecord;

pub fn main(args: &SchemaArgs) -> u8 {
    let schema = match args.kind {
        SchemaKind::Procedure => crate::config::procedure::schema::procedure(),
        SchemaKind::Limits => crate::config::procedure::schema::limits(),
        SchemaKind::Manifest => crate::config::procedure::schema::manifest(),
        SchemaKind::Layout => crate::config::procedure::schema::layout(),
        SchemaKind::Model => crate::config::procedure::schema::model(),
        SchemaKind::Result => {
            serde_json::to_value(schemars::schema_for!(Listed<RunRecord>)).unwrap_or_default()
        }
    };
    super::place::print(&format!("{schema:#}\n"));
    exit::PASS
}
