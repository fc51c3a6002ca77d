//! The table of results, and how its files are written.
//!
//! `<folder>/procedure=<name>/engine=<version>/part-<run>-<portion>.parquet`, one row a recording: `key`, `uri`, `procedure_path`,
//! `limits_path`, `model_path`, then the fields of an outcome.

use crate::ENGINE_VERSION;
use crate::functions::Function;
use crate::job_list::{compressed, parquet, put};
use crate::outcome;
use datafusion::arrow::array::{
    Array, ArrayRef, AsArray, BooleanArray, RecordBatch, StringArray, UInt32Array,
};
use datafusion::arrow::compute::{concat_batches, filter_record_batch, sort_to_indices, take_record_batch};
use datafusion::arrow::datatypes::{DataType, Field, Schema, SchemaRef};
use datafusion::common::{DataFusionError, Result};
use datafusion::datasource::file_format::parquet::ParquetFormat;
use datafusion::datasource::listing::{ListingOptions, ListingTable, ListingTableConfig, ListingTableUrl};
use datafusion::parquet::file::properties::EnabledStatistics;
use datafusion::parquet::schema::types::ColumnPath;
use object_store::ObjectStore;
use object_store::path::Path;
use std::collections::BTreeSet;
use std::sync::Arc;
use url::Url;

/// Columns that say what was asked; they come before those of an outcome.
const REQUEST_COLUMNS: [&str; 5] = ["key", "uri", "procedure_path", "limits_path", "model_path"];

/// The schema of a result file.
pub fn schema() -> SchemaRef {
    let asked = REQUEST_COLUMNS.iter().map(|n| Arc::new(Field::new(*n, DataType::Utf8, true)));
    Arc::new(Schema::new(asked.chain(outcome::fields().iter().cloned()).collect::<Vec<_>>()))
}

/// The results in a folder, with the columns `procedure` and `engine` of its partitions.
///
/// # Errors
/// When the address cannot be used.
pub fn table(folder: Url) -> Result<Arc<ListingTable>> {
    let partitions = ["procedure", "engine"].map(|n| (n.to_owned(), DataType::Utf8)).to_vec();
    let options = ListingOptions::new(Arc::new(ParquetFormat::default()))
        .with_file_extension(".parquet")
        .with_table_partition_cols(partitions);
    let config = ListingTableConfig::new(ListingTableUrl::try_new(folder, None)?)
        .with_listing_options(options)
        .with_schema(schema());
    Ok(Arc::new(ListingTable::try_new(config)?))
}

/// What a portion gave.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Counts {
    /// Recordings with a result.
    pub results: u64,
    /// Recordings whose error is kept as data.
    pub errors: u64,
    /// Recordings that could not be reached: nothing is kept of them, and the next run tries again.
    pub unreached: u64,
}

impl std::ops::AddAssign for Counts {
    fn add_assign(&mut self, other: Counts) {
        self.results += other.results;
        self.errors += other.errors;
        self.unreached += other.unreached;
    }
}

/// Writes rows of a run into a folder.
pub struct Writer {
    /// The store of the folder.
    pub store: Arc<dyn ObjectStore>,
    /// The folder there.
    pub folder: Path,
    /// Name of the run; no two runs have the same.
    pub run: String,
    /// The function that was called.
    pub function: Function,
}

impl Writer {
    /// Writes what a portion gave: columns `key`, `uri`, `procedure`, `limits`, `model`, `outcome`. One file for each procedure;
    /// each appears whole or not at all. Returns the counts, and what could not be reached.
    ///
    /// # Errors
    /// When a file cannot be written, or the rows are of another kind.
    pub async fn write(&self, portion: usize, batches: &[RecordBatch]) -> Result<(Counts, Vec<String>)> {
        let Some(first) = batches.first() else { return Ok(<_>::default()) };
        let batch = flat(&in_order(&concat_batches(&first.schema(), batches)?)?)?;
        let text = |name: &str| column(&batch, name);
        let (kinds, errors) = (text("error_kind")?, text("error")?);
        let is_unreached = |row: usize| kinds.is_valid(row) && kinds.value(row) == "access";
        let unreached: Vec<String> =
            (0..batch.num_rows()).filter(|r| is_unreached(*r)).map(|r| errors.value(r).to_owned()).collect();
        let failed = kinds.len() - kinds.null_count();
        let counts = Counts {
            results: kinds.null_count() as u64,
            errors: (failed - unreached.len()) as u64,
            unreached: unreached.len() as u64,
        };
        let paths = text(if self.function == Function::Explain { "model_path" } else { "procedure_path" })?;
        let name = |row: usize| partition(self.function, paths.is_valid(row).then(|| paths.value(row)));
        let names: BTreeSet<String> = (0..batch.num_rows()).map(name).collect();
        for wanted in names {
            let keep: BooleanArray =
                (0..batch.num_rows()).map(|r| Some(!is_unreached(r) && name(r) == wanted)).collect();
            let own = filter_record_batch(&batch, &keep)?;
            if own.num_rows() > 0 {
                self.write_file(&wanted, portion, &own).await?;
            }
        }
        Ok((counts, unreached))
    }

    async fn write_file(&self, name: &str, portion: usize, batch: &RecordBatch) -> Result<()> {
        let json = || ColumnPath::from("result_json");
        let properties = compressed()
            .set_column_dictionary_enabled(json(), false)
            .set_column_statistics_enabled(json(), EnabledStatistics::None);
        let file = format!("part-{}-{portion:06}.parquet", self.run);
        let parts = [format!("procedure={name}"), format!("engine={ENGINE_VERSION}"), file];
        let path = parts.into_iter().fold(self.folder.clone(), |path, part| path.join(part));
        put(self.store.as_ref(), &path, parquet(batch, properties)?).await
    }
}

fn column(batch: &RecordBatch, name: &str) -> Result<StringArray> {
    let found = batch.column_by_name(name).and_then(|c| c.as_string_opt::<i32>()).cloned();
    found.ok_or_else(|| DataFusionError::Internal(format!("no text `{name}` in what a portion gave")))
}

/// Rows in the order of their keys: machines finish in any order, files are to be the same.
fn in_order(batch: &RecordBatch) -> Result<RecordBatch> {
    let keys: ArrayRef = Arc::new(column(batch, "key")?);
    let order: UInt32Array = sort_to_indices(&keys, None, None)?;
    Ok(take_record_batch(batch, &order)?)
}

/// Outcomes with their fields as columns.
fn flat(batch: &RecordBatch) -> Result<RecordBatch> {
    let outcome = batch
        .column_by_name("outcome")
        .and_then(|c| c.as_struct_opt())
        .ok_or_else(|| DataFusionError::Internal("no outcome in what a portion gave".to_owned()))?;
    let asked = ["key", "uri", "procedure", "limits", "model"];
    let mut columns: Vec<ArrayRef> = vec![];
    for name in asked {
        columns.push(Arc::new(column(batch, name)?));
    }
    columns.extend(outcome.columns().iter().cloned());
    Ok(RecordBatch::try_new(schema(), columns)?)
}

/// The name of a partition: that of the procedure or model file without its ending, with only what any store takes.
fn partition(function: Function, path: Option<&str>) -> String {
    let Some(path) = path else {
        return match function {
            Function::Analyze => "analysis",
            Function::Run | Function::Explain => "none",
        }
        .to_owned();
    };
    let file = path.rsplit(['/', '\\']).next().unwrap_or(path);
    let stem = file.strip_suffix(".toml").unwrap_or(file);
    let safe = |c: char| if c.is_ascii_alphanumeric() || "-_.".contains(c) { c } else { '_' };
    let name: String = stem.chars().map(safe).collect();
    if function == Function::Explain { format!("explain-{name}") } else { name }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn partitions_are_named_after_their_files() {
        let run = |path: &str| partition(Function::Run, Some(path));
        assert_eq!(run("s3://bucket/p/static-bias.toml"), "static-bias");
        assert_eq!(run("/share/My tests/Bias=1 (new).toml"), "Bias_1__new_");
        assert_eq!(partition(Function::Analyze, None), "analysis");
        assert_eq!(partition(Function::Explain, Some("m/gyro.toml")), "explain-gyro");
    }
}
