//! The job list: a table with one row a recording, in Parquet shards.
//!
//! | column | contents |
//! |---|---|
//! | `uri` | path or address of the recording |
//! | `state` | what tells one state of it from another: size and time, or the tag of the store |
//! | `procedure` | path or address of the procedure (TOML) |
//! | `limits` | the same of the limits |
//! | `model` | the same of the model |
//! | `unit` | the unit as a JSON object with members of `unit_under_test` |
//!
//! All are texts; all but `uri` may be null.

use crate::stores;
use datafusion::arrow::array::{ArrayRef, RecordBatch, StringArray};
use datafusion::arrow::datatypes::{DataType, Field, Schema, SchemaRef};
use datafusion::common::{DataFusionError, Result};
use datafusion::datasource::file_format::parquet::ParquetFormat;
use datafusion::datasource::listing::{ListingOptions, ListingTable, ListingTableConfig, ListingTableUrl};
use datafusion::parquet::arrow::ArrowWriter;
use datafusion::parquet::basic::{Compression, ZstdLevel};
use datafusion::parquet::file::properties::{WriterProperties, WriterPropertiesBuilder};
use futures::TryStreamExt;
use object_store::local::LocalFileSystem;
use object_store::path::Path;
use object_store::{ObjectMeta, ObjectStore, PutMode, PutOptions, PutPayload};
use std::sync::Arc;
use url::Url;

/// Names of the columns, in their order.
pub const JOB_COLUMNS: [&str; 6] = ["uri", "state", "procedure", "limits", "model", "unit"];

/// The schema of a job list.
pub fn schema() -> SchemaRef {
    texts(&JOB_COLUMNS)
}

/// A schema of texts.
pub fn texts(names: &[&str]) -> SchemaRef {
    let fields: Vec<Field> = names.iter().map(|n| Field::new(*n, DataType::Utf8, true)).collect();
    Arc::new(Schema::new(fields))
}

/// The job list in a folder or in a single file.
///
/// # Errors
/// When the address cannot be used.
pub fn table(address: Url) -> Result<Arc<ListingTable>> {
    parquet_table(vec![ListingTableUrl::try_new(address, None)?], schema(), ".parquet")
}

/// Parquet files of a known schema as a table.
///
/// # Errors
/// When the addresses cannot be used.
pub fn parquet_table(
    addresses: Vec<ListingTableUrl>,
    schema: SchemaRef,
    ending: &str,
) -> Result<Arc<ListingTable>> {
    let options = ListingOptions::new(Arc::new(ParquetFormat::default())).with_file_extension(ending);
    let config =
        ListingTableConfig::new_with_multi_paths(addresses).with_listing_options(options).with_schema(schema);
    Ok(Arc::new(ListingTable::try_new(config)?))
}

/// What becomes a job list.
#[derive(Debug, Clone)]
pub struct Listing {
    /// Folder of the recordings, with those below it.
    pub folder: Url,
    /// Endings of the names of recordings, in lower case and without a dot.
    pub endings: Vec<String>,
    /// Procedure of every recording.
    pub procedure: Option<String>,
    /// Limits of every recording.
    pub limits: Option<String>,
    /// Model of every recording.
    pub model: Option<String>,
    /// Rows of a shard.
    pub rows: usize,
}

/// Writes the recordings below a folder as shards into another, which must hold none, and tells their number.
///
/// # Errors
/// When a folder cannot be read or written, or the target has shards already.
pub async fn list(listing: &Listing, target: &Url) -> Result<usize> {
    let (store, prefix) = stores::open(&listing.folder)?;
    let (shards, place) = stores::open(target)?;
    let there: Vec<ObjectMeta> = shards.list(Some(&place)).try_collect().await?;
    if there.iter().any(|f| f.location.as_ref().ends_with(".parquet")) {
        let text = format!("{target} has shards already; name another folder with --out");
        return Err(DataFusionError::Configuration(text));
    }
    let mut found: Vec<ObjectMeta> = store.list(Some(&prefix)).try_collect().await?;
    found.retain(|f| is_recording(&f.location, &prefix, &listing.endings));
    // The order of a store is not told; shards of one folder are to be the same each time.
    found.sort_by(|a, b| a.location.cmp(&b.location));
    for (number, some) in found.chunks(listing.rows.max(1)).enumerate() {
        let path = place.clone().join(format!("jobs-{number:06}.parquet"));
        let bytes = parquet(&batch(listing, some)?, compressed())?;
        put(shards.as_ref(), &path, bytes).await?;
    }
    Ok(found.len())
}

/// By its ending; what is hidden below the folder, or in it, is none.
fn is_recording(path: &Path, folder: &Path, endings: &[String]) -> bool {
    let hidden = path.prefix_match(folder).is_none_or(|mut below| below.any(|p| p.as_ref().starts_with('.')));
    let name = path.filename().unwrap_or_default().to_lowercase();
    !hidden && endings.iter().any(|e| name.strip_suffix(e).is_some_and(|n| n.ends_with('.')))
}

fn batch(listing: &Listing, found: &[ObjectMeta]) -> Result<RecordBatch> {
    let is_local = listing.folder.scheme() == "file";
    let local = LocalFileSystem::new();
    let uri = |f: &ObjectMeta| -> Result<String> {
        if is_local {
            return Ok(local.path_to_filesystem(&f.location)?.display().to_string());
        }
        let (scheme, host) = (listing.folder.scheme(), listing.folder.host_str().unwrap_or_default());
        Ok(format!("{scheme}://{host}/{}", f.location))
    };
    let uris = found.iter().map(uri).collect::<Result<Vec<_>>>()?;
    // The tag of a local file holds its inode, which a copy or another mount of the share changes.
    let state = |f: &ObjectMeta| match &f.e_tag {
        Some(tag) if !is_local => format!("{} {tag}", f.size),
        _ => format!("{} {}", f.size, f.last_modified.to_rfc3339()),
    };
    let same = |value: &Option<String>| -> ArrayRef {
        Arc::new(found.iter().map(|_| value.as_deref()).collect::<StringArray>())
    };
    let columns: Vec<ArrayRef> = vec![
        Arc::new(StringArray::from_iter_values(uris)),
        Arc::new(StringArray::from_iter_values(found.iter().map(state))),
        same(&listing.procedure),
        same(&listing.limits),
        same(&listing.model),
        same(&None),
    ];
    Ok(RecordBatch::try_new(schema(), columns)?)
}

/// Properties of every file that this program writes: compressed by zstd.
pub fn compressed() -> WriterPropertiesBuilder {
    WriterProperties::builder()
        .set_compression(Compression::ZSTD(ZstdLevel::default()))
        .set_created_by(format!("sagnac-archive {}", crate::ENGINE_VERSION))
}

/// A batch as the bytes of a Parquet file.
///
/// # Errors
/// When it cannot be encoded.
pub fn parquet(batch: &RecordBatch, properties: WriterPropertiesBuilder) -> Result<Vec<u8>> {
    let mut bytes = vec![];
    let mut writer = ArrowWriter::try_new(&mut bytes, batch.schema(), Some(properties.build()))?;
    writer.write(batch)?;
    writer.close()?;
    Ok(bytes)
}

/// Writes an object that appears whole or not at all, and replaces nothing.
///
/// # Errors
/// When it is there already or cannot be written.
pub async fn put(store: &dyn ObjectStore, path: &Path, bytes: Vec<u8>) -> Result<()> {
    let options = PutOptions { mode: PutMode::Create, ..PutOptions::default() };
    store.put_opts(path, PutPayload::from(bytes), options).await?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn recordings_are_told_by_their_endings() {
        let endings = ["csv".to_owned(), "csv.gz".to_owned()];
        let is = |path: &str| is_recording(&Path::from(path), &Path::from(".share/a"), &endings);
        assert!(is(".share/a/unit-1.csv") && is(".share/a/b/UNIT-1.CSV") && is(".share/a/unit.csv.gz"));
        assert!(!is(".share/a/.trash/unit.csv") && !is(".share/a/.unit.csv"));
        assert!(!is(".share/a/csv") && !is(".share/a/unit.json") && !is(".share/other/unit.csv"));
    }
}
