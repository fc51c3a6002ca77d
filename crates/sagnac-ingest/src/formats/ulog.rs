//! ULog, the flight log of PX4: topics with records of one format each. Bursts of samples in a record become rows.

use super::loaded::{self, About, LoadedColumn};
use crate::error::{IngestError, IngestErrorKind};
use crate::part_selection::{Part, choose};
use crate::{Candidate, Format, Opened};
use std::collections::BTreeMap;

/// A ULog file.
pub(super) struct ULog;

/// First bytes of the file.
const MAGIC: &[u8] = b"ULog\x01\x12\x35";

/// Bytes before the first message: mark, version, moment.
const HEADER: usize = 16;

/// Deepest format in a format.
const DEPTH: usize = 4;

/// Most fields of a topic.
const FIELDS: usize = 1024;

/// A number of a record.
#[derive(Debug, Clone, PartialEq)]
struct Field {
    name: String,
    kind: Kind,
    at: usize,
}

/// How a number is stored, little endian.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F32,
    F64,
    Bool,
    Char,
}

impl Kind {
    fn of(name: &str) -> Option<Kind> {
        Some(match name {
            "int8_t" => Kind::I8,
            "uint8_t" => Kind::U8,
            "int16_t" => Kind::I16,
            "uint16_t" => Kind::U16,
            "int32_t" => Kind::I32,
            "uint32_t" => Kind::U32,
            "int64_t" => Kind::I64,
            "uint64_t" => Kind::U64,
            "float" => Kind::F32,
            "double" => Kind::F64,
            "bool" => Kind::Bool,
            "char" => Kind::Char,
            _ => return None,
        })
    }

    fn size(self) -> usize {
        match self {
            Kind::I8 | Kind::U8 | Kind::Bool | Kind::Char => 1,
            Kind::I16 | Kind::U16 => 2,
            Kind::I32 | Kind::U32 | Kind::F32 => 4,
            Kind::I64 | Kind::U64 | Kind::F64 => 8,
        }
    }

    fn read(self, record: &[u8], at: usize) -> f64 {
        let Some(bytes) = record.get(at..at + self.size()) else { return f64::NAN };
        let mut wide = [0u8; 8];
        wide.iter_mut().zip(bytes).for_each(|(w, b)| *w = *b);
        let whole = u64::from_le_bytes(wide);
        match self {
            Kind::I8 => f64::from(whole as i8),
            Kind::U8 | Kind::Bool | Kind::Char => f64::from(whole as u8),
            Kind::I16 => f64::from(whole as i16),
            Kind::U16 => f64::from(whole as u16),
            Kind::I32 => f64::from(whole as i32),
            Kind::U32 => f64::from(whole as u32),
            Kind::I64 => whole as i64 as f64,
            Kind::U64 => whole as f64,
            Kind::F32 => f64::from(f32::from_bits(whole as u32)),
            Kind::F64 => f64::from_bits(whole),
        }
    }
}

/// A topic with its records.
#[derive(Debug, Default)]
struct Topic {
    name: String,
    format: String,
    fields: Vec<Field>,
    values: Vec<Vec<f64>>,
}

impl Format for ULog {
    fn id(&self) -> &'static str {
        "ulog"
    }

    fn recognises(&self, file: &Candidate) -> bool {
        file.head.starts_with(MAGIC)
    }

    fn open(&self, file: &Candidate) -> Result<Opened, IngestError> {
        let bytes = loaded::bytes(file)?;
        let log = Log::read(&bytes).ok_or_else(|| {
            IngestError::new(IngestErrorKind::Damaged, &file.path, "ingest.ulog.damaged")
                .hint("ingest.hint.damaged")
        })?;
        let mut topics: Vec<(String, Vec<LoadedColumn>)> =
            log.topics.into_values().map(|t| (t.name.clone(), columns(t))).collect();
        let parts: Vec<Part> = topics
            .iter()
            .map(|(name, columns)| Part {
                name: name.clone(),
                columns: columns.iter().map(|c| (c.described.clone(), c.values.len() as u64)).collect(),
            })
            .collect();
        let (index, notes) = choose(&file.path, &parts, file.options.part.as_deref())?;
        let (_, columns) = topics.swap_remove(index);
        loaded::opened(file, columns, About { notes, metadata: log.metadata, sample_rate_hz: None })
    }
}

/// What a file holds.
#[derive(Default)]
struct Log {
    formats: BTreeMap<String, String>,
    topics: BTreeMap<u16, Topic>,
    metadata: Vec<(String, String)>,
}

impl Log {
    /// Reads all whole messages; `None` where a format cannot be followed.
    fn read(bytes: &[u8]) -> Option<Log> {
        let mut log = Log::default();
        let mut at = HEADER;
        while let Some(head) = bytes.get(at..at + 3) {
            let size = usize::from(u16::from_le_bytes([*head.first()?, *head.get(1)?]));
            let kind = *head.get(2)?;
            // The last message may be cut.
            let Some(body) = bytes.get(at + 3..at + 3 + size) else { break };
            log.message(kind, body)?;
            at += 3 + size;
        }
        Some(log)
    }

    fn message(&mut self, kind: u8, body: &[u8]) -> Option<()> {
        let number = |bytes: &[u8]| Some(u16::from_le_bytes([*bytes.first()?, *bytes.get(1)?]));
        match kind {
            b'F' => {
                let text = String::from_utf8_lossy(body);
                let (name, fields) = text.split_once(':')?;
                self.formats.insert(name.to_owned(), fields.to_owned());
            }
            b'A' => {
                let (instance, id) = (*body.first()?, number(body.get(1..)?)?);
                let format = String::from_utf8_lossy(body.get(3..)?).into_owned();
                let mut fields = Vec::new();
                let mut offset = 0;
                self.follow(&format, "", &mut offset, &mut fields, 0)?;
                let name = if instance == 0 { format.clone() } else { format!("{format}.{instance}") };
                let values = vec![Vec::new(); fields.len()];
                self.topics.insert(id, Topic { name, format, fields, values });
            }
            b'D' => {
                let record = body.get(2..)?;
                if let Some(topic) = self.topics.get_mut(&number(body)?) {
                    for (field, values) in topic.fields.iter().zip(&mut topic.values) {
                        values.push(field.kind.read(record, field.at));
                    }
                }
            }
            b'I' => {
                let length = usize::from(*body.first()?);
                let key = String::from_utf8_lossy(body.get(1..=length)?).into_owned();
                let value = String::from_utf8_lossy(body.get(length + 1..)?).into_owned();
                if key.starts_with("char") && self.metadata.len() < 64 {
                    let name = key.rsplit(' ').next().unwrap_or_default().to_owned();
                    self.metadata.push((name, value.chars().take(200).collect()));
                }
            }
            _ => {}
        }
        Some(())
    }

    /// Adds the numbers of a format at an offset.
    fn follow(
        &self,
        format: &str,
        prefix: &str,
        offset: &mut usize,
        fields: &mut Vec<Field>,
        depth: usize,
    ) -> Option<()> {
        if depth > DEPTH {
            return None;
        }
        for entry in self.formats.get(format)?.split(';').filter(|e| !e.trim().is_empty()) {
            let (kind, name) = entry.trim().split_once(' ')?;
            let (kind, count) = match kind.split_once('[') {
                Some((kind, count)) => (kind, Some(count.trim_end_matches(']').parse::<usize>().ok()?)),
                None => (kind, None),
            };
            for i in 0..count.unwrap_or(1) {
                let name = match count {
                    Some(_) => format!("{prefix}{name}[{i}]"),
                    None => format!("{prefix}{name}"),
                };
                match Kind::of(kind) {
                    Some(kind) => {
                        let is_padding = name.contains("_padding");
                        if fields.len() < FIELDS && !is_padding {
                            fields.push(Field { name, kind, at: *offset });
                        }
                        *offset += kind.size();
                    }
                    None => self.follow(kind, &format!("{name}."), offset, fields, depth + 1)?,
                }
            }
        }
        Some(())
    }
}

/// The columns of a topic; the bursts of a first-in-first-out buffer become rows.
fn columns(topic: Topic) -> Vec<LoadedColumn> {
    let rates = topic.format.contains("gyro") || topic.format == "sensor_combined";
    if topic.format.ends_with("_fifo")
        && let Some(columns) = unfolded(&topic, rates)
    {
        return columns;
    }
    let named = topic.fields.into_iter().zip(topic.values);
    named.map(|(field, values)| column(&field.name, rates, values)).collect()
}

/// A column with the unit that PX4 gives its quantity.
fn column(name: &str, rates: bool, values: Vec<f64>) -> LoadedColumn {
    let unit = match name {
        "timestamp" | "timestamp_sample" => Some("us"),
        "temperature" => Some("degC"),
        "x" | "y" | "z" if rates => Some("rad/s"),
        name if name.starts_with("gyro_rad[") => Some("rad/s"),
        _ => None,
    };
    LoadedColumn::new(name, unit, values)
}

/// One row for each sample of the bursts of a record: its time from the last sample and the interval, its value by the scale.
fn unfolded(topic: &Topic, rates: bool) -> Option<Vec<LoadedColumn>> {
    let of = |name: &str| topic.fields.iter().position(|f| f.name == name).and_then(|i| topic.values.get(i));
    let (last, interval, scale, samples) = (of("timestamp_sample")?, of("dt")?, of("scale")?, of("samples")?);
    let mut stamps = Vec::new();
    let mut axes = [Vec::new(), Vec::new(), Vec::new()];
    for (record, count) in samples.iter().enumerate() {
        let count = if count.is_finite() { *count as usize } else { 0 };
        for sample in 0..count.min(64) {
            let before = (count - 1 - sample) as f64;
            let (last, interval) = (last.get(record)?, interval.get(record)?);
            stamps.push(last - before * interval);
            for (values, axis) in axes.iter_mut().zip(["x", "y", "z"]) {
                let raw = of(&format!("{axis}[{sample}]")).and_then(|v| v.get(record)).copied();
                values.push(raw.unwrap_or(f64::NAN) * scale.get(record)?);
            }
        }
    }
    let mut columns = vec![column("timestamp_sample", rates, stamps)];
    columns.extend(axes.into_iter().zip(["x", "y", "z"]).map(|(values, axis)| column(axis, rates, values)));
    Some(columns)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn message(kind: u8, body: &[u8]) -> Vec<u8> {
        let mut out = (body.len() as u16).to_le_bytes().to_vec();
        out.push(kind);
        out.extend_from_slice(body);
        out
    }

    #[test]
    fn topics_and_bursts_are_read() {
        let mut bytes = MAGIC.to_vec();
        bytes.resize(HEADER, 0);
        bytes.extend(message(b'F', b"sensor_gyro:uint64_t timestamp;float x;float[2] y;"));
        bytes.extend(message(
            b'F',
            b"sensor_gyro_fifo:uint64_t timestamp_sample;float dt;float scale;uint8_t samples;int16_t[2] x;",
        ));
        bytes.extend(message(b'A', b"\0\x05\0sensor_gyro"));
        bytes.extend(message(b'A', b"\0\x06\0sensor_gyro_fifo"));
        let mut record = vec![5, 0];
        record.extend_from_slice(&40_000u64.to_le_bytes());
        [0.5f32, 1.5, 2.5].iter().for_each(|v| record.extend_from_slice(&v.to_le_bytes()));
        bytes.extend(message(b'D', &record));
        let mut record = vec![6, 0];
        record.extend_from_slice(&1000u64.to_le_bytes());
        [100.0f32, 0.5].iter().for_each(|v| record.extend_from_slice(&v.to_le_bytes()));
        record.push(2);
        [4i16, -6].iter().for_each(|v| record.extend_from_slice(&v.to_le_bytes()));
        bytes.extend(message(b'D', &record));
        // A message that is cut.
        bytes.extend([9, 0, b'D', 5]);
        let mut log = Log::read(&bytes).unwrap();
        let fifo = columns(log.topics.remove(&6).unwrap());
        assert_eq!(fifo[0].values, [900.0, 1000.0]);
        assert_eq!(fifo[1].values, [2.0, -3.0]);
        let plain = columns(log.topics.remove(&5).unwrap());
        let found: Vec<(&str, f64)> =
            plain.iter().map(|c| (c.described.name.as_str(), c.values[0])).collect();
        assert_eq!(found, [("timestamp", 40_000.0), ("x", 0.5), ("y[0]", 1.5), ("y[1]", 2.5)]);
        assert_eq!(plain[1].described.unit.as_deref(), Some("rad/s"));
    }
}
