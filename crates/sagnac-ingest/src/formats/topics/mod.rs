//! Common parts of MCAP files and ROS 1 bags: messages by topic, of which those of one topic are the rows.
//!
//! Both readers are our own. The reader of the crate `mcap` that streams (0.26, `sans_io::LinearReader`) takes every record
//! into memory as a whole, attachments and the chunks of other topics among them, where this one passes over them, and
//! tells no byte at which a damaged file breaks off; it brings 16 crates. The crates for bags map the whole file.

pub(super) mod container;
pub(super) mod message;
mod table;

use crate::error::{IngestError, IngestErrorKind, shorten};
use crate::metadata::Metadata;
use crate::{Candidate, Column, Opened};
use container::{Catalog, Container, Event, Topic};
use message::{Encoding, Layout};
use sagnac_core::message::{Arg, Note, note};
use std::collections::BTreeSet;
use std::ops::ControlFlow;
use table::{Origin, TopicTable};

/// Most topics that are listed.
const LISTED: usize = 20;

/// Topics as a list in one sentence.
fn list<'a>(topics: impl Iterator<Item = &'a Topic>) -> Arg {
    let mut names: Vec<String> = topics
        .map(|t| format!("`{}` ({}, {})", shorten(&t.name), shorten(&t.type_name), t.messages))
        .collect();
    let more = names.len() > LISTED;
    names.truncate(LISTED);
    if more {
        names.push("…".to_owned());
    }
    Arg::Text(if names.is_empty() { "–".to_owned() } else { names.join(", ") })
}

/// Chooses the topic that is the recording: the one wanted, or the only one with messages of an inertial unit.
fn choose<'a>(
    file: &Candidate,
    catalog: &'a Catalog,
    notes: &mut Vec<Note>,
) -> Result<&'a Topic, IngestError> {
    let error = |note: Note| IngestError::new(IngestErrorKind::UnknownFormat, &file.path, note);
    let readable = || catalog.topics.iter().filter(|t| t.readable().is_some() && t.messages > 0);
    if let Some(wanted) = file.options.part.as_deref() {
        let plain = |name: &str| name.trim_matches('/').to_owned();
        let named = |t: &&Topic| plain(&t.name) == plain(wanted);
        if let Some(topic) = readable().find(named) {
            notes.push(note!("ingest.ros.wanted", name = shorten(&topic.name)));
            return Ok(topic);
        }
        let there = catalog.topics.iter().find(named);
        let note = match there {
            None => note!("ingest.ros.no_topic", name = shorten(wanted)),
            Some(t) if t.readable().is_none() => note!("ingest.ros.type_unknown", name = shorten(&t.name))
                .with("type", shorten(&t.type_name))
                .with("encoding", shorten(&t.encoding_name)),
            Some(t) => note!("ingest.ros.no_messages", name = shorten(&t.name)),
        };
        return Err(error(note).hint(note!("ingest.ros.hint.readable", topics = list(readable()))));
    }
    let imus: Vec<&Topic> = readable().filter(|t| t.readable().is_some_and(|(l, _)| l.is_imu())).collect();
    match imus.as_slice() {
        [one] => {
            notes.push(
                note!("ingest.ros.taken", name = shorten(&one.name))
                    .with("type", shorten(&one.type_name))
                    .with("count", one.messages),
            );
            let mut others = catalog.topics.iter().filter(|t| t.name != one.name).peekable();
            if others.peek().is_some() {
                notes.push(note!("ingest.ros.others", topics = list(others)));
            }
            Ok(*one)
        }
        [] => Err(error(note!("ingest.ros.no_imu", topics = list(catalog.topics.iter())))
            .hint(note!("ingest.ros.hint.readable", topics = list(readable())))),
        several => Err(error(note!(
            "ingest.ros.several",
            count = several.len(),
            topics = list(several.iter().copied())
        ))
        .hint("ingest.ros.hint.name_one")),
    }
}

pub(super) fn open(file: &Candidate, container: &'static dyn Container) -> Result<Opened, IngestError> {
    let path = &file.path;
    let catalog = container::catalog(container, path, file.bytes)?;
    if catalog.topics.iter().all(|t| t.messages == 0) {
        if let Some(at) = catalog.broken_at {
            let note = note!("ingest.ros.broken_before", at);
            return Err(IngestError::new(IngestErrorKind::Damaged, path, note).hint("ingest.hint.cut_off"));
        }
        return Err(IngestError::new(IngestErrorKind::Empty, path, "ingest.ros.nothing")
            .hint("ingest.hint.check_written"));
    }
    let mut notes = Vec::new();
    let topic = choose(file, &catalog, &mut notes)?;
    let Some((layout, encoding)) = topic.readable() else {
        return Err(IngestError::new(IngestErrorKind::Empty, path, "ingest.ros.nothing")
            .hint("ingest.hint.check_written"));
    };
    if !catalog.indexed {
        notes.push(note!("ingest.ros.no_index"));
    }
    let cut_off: Vec<Note> = catalog.broken_at.map(|at| note!("ingest.ros.broken", at)).into_iter().collect();
    notes.extend(cut_off.iter().cloned());
    let skip: BTreeSet<u64> = catalog
        .chunks
        .iter()
        .filter(|(_, ids)| !ids.is_empty() && ids.is_disjoint(&topic.ids))
        .map(|(at, _)| *at)
        .collect();
    let first = first_message(file, container, topic, &skip, layout, encoding)?;
    let (columns, origins) = columns(layout, &first, &mut notes);
    let mut metadata = Metadata::default();
    for (key, value) in &catalog.metadata {
        metadata.add(key, value);
    }
    Ok(Opened {
        labels: Vec::new(),
        bad_blocks: Vec::new(),
        columns,
        rows_estimate: Some(topic.messages),
        cut_off,
        notes,
        metadata: metadata.entries(),
        stated_sample_rate_hz: None,
        table: Box::new(TopicTable {
            path: path.clone(),
            bytes: file.bytes,
            container,
            ids: topic.ids.clone(),
            layout,
            encoding,
            origins,
            skip,
        }),
    })
}

/// Times of the first message of a topic, s from 1970: when it was logged, and the stamp of its header.
struct FirstMessage {
    logged_s: i64,
    stamp_s: i64,
}

/// Looks for the first message of a topic that can be read.
fn first_message(
    file: &Candidate,
    container: &dyn Container,
    topic: &Topic,
    skip: &BTreeSet<u64>,
    layout: &Layout,
    encoding: Encoding,
) -> Result<FirstMessage, IngestError> {
    let mut first: Option<FirstMessage> = None;
    container.scan(&file.path, file.bytes, skip, &mut |event| match event {
        Event::Message { id, log_ns, data, .. } if topic.ids.contains(&id) => {
            let message = layout.read(data, encoding);
            let logged_s = i64::try_from(log_ns / 1_000_000_000).unwrap_or(0);
            let found = first.get_or_insert(FirstMessage { logged_s, stamp_s: 0 });
            found.stamp_s = message.and_then(|m| m.stamp).map_or(0, |(s, _)| s);
            // A message that ends early tells no stamp; the next one may.
            if message.is_some() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        }
        _ => ControlFlow::Continue(()),
    })?;
    Ok(first.unwrap_or(FirstMessage { logged_s: 0, stamp_s: 0 }))
}

/// The columns of the messages of a topic, stamps first, with what each is read from.
fn columns(layout: &Layout, first: &FirstMessage, notes: &mut Vec<Note>) -> (Vec<Column>, Vec<Origin>) {
    let column = |name: &str, storage: &str, unit: Option<&str>, epoch_s: Option<i64>| Column {
        name: name.to_owned(),
        numeric: true,
        storage: storage.to_owned(),
        unit: unit.map(str::to_owned),
        epoch_s: epoch_s.map(|s| s as f64),
        rollover_s: None,
        judged: None,
    };
    let time = |name, epoch_s| column(name, "time stamp", Some("s"), Some(epoch_s));
    let (stamp, logged) = (first.stamp_s, first.logged_s);
    let mut all = vec![(time("log_time", logged), Origin::Logged { epoch_s: logged })];
    if layout.has_header() {
        // The sensor's own stamp comes first, unless the driver left it empty.
        let place = usize::from(stamp == 0);
        all.insert(place, (time("header.stamp", stamp), Origin::Stamp { epoch_s: stamp }));
        if stamp == 0 {
            notes.push(note!("ingest.ros.no_stamp"));
        }
    }
    let numbers = layout.numbers().enumerate();
    all.extend(numbers.map(|(i, (name, unit))| (column(name, "number", unit, None), Origin::Number(i))));
    all.into_iter().unzip()
}
