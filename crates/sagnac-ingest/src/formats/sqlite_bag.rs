//! ROS 2 bags in an SQLite database (`.db3`): a table of topics and one of messages.

use super::topics::container::{Catalog, Container, Event, OnEvent};
use super::topics::message::Encoding;
use crate::error::{IngestError, IngestErrorKind};
use crate::{Candidate, Format, Opened, part_selection};
use rusqlite::{Connection, OpenFlags};
use sagnac_core::message::note;
use std::collections::BTreeSet;
use std::ops::ControlFlow;
use std::path::Path;

/// First bytes of a database.
const MAGIC: &[u8] = b"SQLite format 3\0";

/// A ROS 2 bag in a database.
pub(super) struct SqliteBag;

impl Format for SqliteBag {
    fn id(&self) -> &'static str {
        "rosbag2"
    }

    fn recognises(&self, file: &Candidate) -> bool {
        file.head.starts_with(MAGIC)
    }

    fn open(&self, file: &Candidate) -> Result<Opened, IngestError> {
        part_selection::unpacked(file, "ingest.ros.sqlite")?;
        super::topics::open(file, &BagDatabase)
    }
}

/// Finds the messages in a database.
struct BagDatabase;

/// A topic as the database has it.
struct TopicRow {
    id: u32,
    name: String,
    type_name: String,
    encoding: String,
}

impl TopicRow {
    fn known_encoding(&self) -> Option<Encoding> {
        (self.encoding == "cdr").then_some(Encoding::Cdr)
    }
}

fn open(path: &Path) -> Result<Connection, rusqlite::Error> {
    let flags = OpenFlags::SQLITE_OPEN_READ_ONLY | OpenFlags::SQLITE_OPEN_NO_MUTEX;
    Connection::open_with_flags(path, flags)
}

fn topics(database: &Connection) -> Result<Vec<TopicRow>, rusqlite::Error> {
    let mut found =
        database.prepare("SELECT id, name, type, serialization_format FROM topics ORDER BY id")?;
    let rows = found.query_map([], |row| {
        Ok(TopicRow { id: row.get(0)?, name: row.get(1)?, type_name: row.get(2)?, encoding: row.get(3)? })
    })?;
    rows.collect()
}

/// Topics with the number of their messages.
fn catalog(path: &Path) -> Result<Catalog, rusqlite::Error> {
    let database = open(path)?;
    let mut catalog = Catalog::default();
    for topic in topics(&database)? {
        catalog.channel(topic.id, &topic.name, &topic.type_name, (topic.known_encoding(), &topic.encoding));
    }
    let mut counted = database.prepare("SELECT topic_id, COUNT(*) FROM messages GROUP BY topic_id")?;
    let mut rows = counted.query([])?;
    while let Some(row) = rows.next()? {
        let (id, count): (u32, i64) = (row.get(0)?, row.get(1)?);
        catalog.count(id, u64::try_from(count).unwrap_or(0));
    }
    Ok(catalog)
}

/// Passes topics and messages on, these in the order in which they were logged.
fn scan(path: &Path, on_event: &mut OnEvent<'_>) -> Result<(), rusqlite::Error> {
    let database = open(path)?;
    for topic in topics(&database)? {
        let encoding = (topic.known_encoding(), topic.encoding.as_str());
        let (id, name, type_name) = (topic.id, topic.name.as_str(), topic.type_name.as_str());
        if on_event(Event::Channel { id, topic: name, type_name, encoding }).is_break() {
            return Ok(());
        }
    }
    let mut messages =
        database.prepare("SELECT id, topic_id, timestamp, data FROM messages ORDER BY timestamp, id")?;
    let mut rows = messages.query([])?;
    while let Some(row) = rows.next()? {
        let (at, id, logged): (i64, u32, i64) = (row.get(0)?, row.get(1)?, row.get(2)?);
        let data = row.get_ref(3)?.as_blob().unwrap_or_default();
        let (at, log_ns) = (u64::try_from(at).unwrap_or(0), u64::try_from(logged).unwrap_or(0));
        if on_event(Event::Message { id, log_ns, data, at }) == ControlFlow::Break(()) {
            return Ok(());
        }
    }
    Ok(())
}

/// The diagnostic of a database that is no bag, or is damaged.
fn no_bag(path: &Path, e: &rusqlite::Error) -> IngestError {
    let note = note!("ingest.ros.no_bag", reason = e.to_string());
    IngestError::new(IngestErrorKind::UnknownFormat, path, note).hint("ingest.ros.hint.convert")
}

impl Container for BagDatabase {
    fn index(&self, path: &Path, _bytes: u64) -> Result<Option<Catalog>, IngestError> {
        catalog(path).map(Some).map_err(|e| no_bag(path, &e))
    }

    fn scan(
        &self,
        path: &Path,
        _bytes: u64,
        _skip: &BTreeSet<u64>,
        on_event: &mut OnEvent<'_>,
    ) -> Result<Option<u64>, IngestError> {
        scan(path, on_event).map(|()| None).map_err(|e| no_bag(path, &e))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::open as open_recording;
    use std::ops::ControlFlow;

    /// A temperature as CDR writes it: header, value, variance.
    fn temperature(seconds: i32, value: f64) -> Vec<u8> {
        let mut out = vec![0, 1, 0, 0];
        out.extend_from_slice(&seconds.to_le_bytes());
        out.extend_from_slice(&0u32.to_le_bytes());
        out.extend_from_slice(&1u32.to_le_bytes());
        out.extend_from_slice(&[0, 0, 0, 0]);
        out.extend_from_slice(&value.to_le_bytes());
        out.extend_from_slice(&0f64.to_le_bytes());
        out
    }

    #[test]
    fn messages_of_a_database_are_read() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("bag.db3");
        let database = Connection::open(&path).unwrap();
        database
            .execute_batch(
                "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT, serialization_format TEXT);
                 CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, data BLOB);
                 INSERT INTO topics VALUES(1, '/temp', 'sensor_msgs/msg/Temperature', 'cdr');",
            )
            .unwrap();
        for i in 0..20i32 {
            let insert = "INSERT INTO messages(topic_id, timestamp, data) VALUES(1, ?1, ?2)";
            let data = temperature(1_700_000_000 + i, 25.0 + f64::from(i));
            database.execute(insert, (1_700_000_000_000_000_000i64 + i64::from(i), data)).unwrap();
        }
        drop(database);
        let options = crate::ReadOptions { part: Some("/temp".into()), ..crate::ReadOptions::default() };
        let source = crate::open_with(&path, &options).unwrap();
        assert_eq!(source.format(), "rosbag2");
        let place = source.columns().iter().position(|c| c.name == "temperature").unwrap();
        let mut values = Vec::new();
        source
            .read(&[place], &mut |block| {
                values.extend_from_slice(&block.columns[0]);
                ControlFlow::Continue(())
            })
            .unwrap();
        assert_eq!((values.len(), values[3]), (20, 28.0));
        let other = folder.path().join("other.db");
        Connection::open(&other).unwrap().execute_batch("CREATE TABLE t(x);").unwrap();
        assert!(open_recording(&other).is_err());
    }
}
