//! Columns that a procedure asks for and a recording does not have, each at the line that asks for it.

use super::diagnostics::Problems;
use super::model::{ChannelSpec, Loaded, Procedure};
use crate::i18n::{Note, note};
use crate::recording::ColumnRef;
use sagnac_ingest::{IngestError, Source};

/// The columns of required channels that cannot be read from a recording, with what it has in their place, and the first of
/// these errors. `None` where all are there.
pub fn missing_columns(procedure: &Loaded<Procedure>, source: &Source) -> Option<(Problems, IngestError)> {
    let mut problems = Problems::default();
    let mut first = None;
    for spec in procedure.value.channels.iter().filter(|c| c.required) {
        let Err(error) = source.resolve(&spec.channel.column) else { continue };
        let message = note!(
            "ingest_error.plain",
            place = source.path().display().to_string(),
            message = error.message().clone()
        );
        let mut problem = procedure.source.error(&spec.column_span, message);
        problem.help = hint(spec, &procedure.value, source, &error);
        problems.list.push(problem);
        first = first.or(Some(error));
    }
    first.map(|error| (problems, error))
}

/// Advice for a missing column: the one that is spelt alike, or else the only one that is likely of the role and is not read yet.
fn hint(spec: &ChannelSpec, procedure: &Procedure, source: &Source, error: &IngestError) -> Option<Note> {
    let ColumnRef::Name(name) = &spec.channel.column else { return error.advice().cloned() };
    if source.columns().iter().any(|c| c.name == *name) {
        return error.advice().cloned();
    }
    let meant = source.similar_column(name).or_else(|| of_role(spec, procedure, source));
    Some(source.columns_hint(meant))
}

fn of_role<'s>(spec: &ChannelSpec, procedure: &Procedure, source: &'s Source) -> Option<&'s str> {
    let read: Vec<usize> =
        procedure.channels.iter().filter_map(|c| source.resolve(&c.channel.column).ok()).collect();
    let suits = |i: usize| {
        let column = source.columns().get(i).filter(|c| c.numeric && !read.contains(&i))?;
        (column.inferred().role == spec.channel.role).then_some(column.name.as_str())
    };
    let mut suiting = (0..source.columns().len()).filter_map(suits);
    match (suiting.next(), suiting.next()) {
        (Some(one), None) => Some(one),
        _ => None,
    }
}
