//! The tree of groups and datasets: every group with columns of numbers is a part that may be the recording.

use super::attributes;
use super::number::Storage;
use crate::Column;
use crate::metadata::stated_sample_rate_hz;
use crate::part_selection::Part;
use hdf5_reader::error::Error;
use hdf5_reader::group::Group;
use hdf5_reader::{CompoundField, Dataset, Datatype, Hdf5File, SliceInfo};
use sagnac_core::message::{Note, note};
use sagnac_core::units::Affine;
use std::collections::BTreeSet;

/// Deepest group and most objects that are looked at.
const MAX_DEPTH: usize = 16;
const MAX_OBJECTS: usize = 4096;
/// A dataset with more columns, and a record with more fields, is no recording.
const MAX_WIDTH: u64 = 1024;
/// Most elements of an array in a field of a record.
const ARRAY: u64 = 16;

/// Where the values of a column stand.
#[derive(Debug, Clone)]
pub(super) struct Place {
    /// Path of the dataset.
    pub dataset: String,
    /// The part that is read.
    pub pick: Pick,
    /// How a number is stored; `None` where there is none.
    pub storage: Option<Storage>,
    /// From the number stored to the value.
    pub conversion: Affine,
    /// Number that stands for a missing value.
    pub missing: Option<f64>,
    /// For stamps that f64 cannot hold: the whole number that is taken off first.
    pub base: Option<i128>,
    /// Size of the dataset as its shape tells, bytes.
    pub logical_bytes: u64,
}

/// The part of a dataset that is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Pick {
    /// Everything, in order.
    All,
    /// A column of `width`; the rows lie along the first dimension, or along the last one.
    Column { index: u64, width: u64, rows_last: bool },
    /// A number at an offset of a record.
    Field { offset: usize },
}

/// A group with its columns.
#[derive(Debug, Default)]
pub(super) struct GroupPart {
    pub part: Part,
    pub places: Vec<Place>,
    pub notes: Vec<Note>,
    pub metadata: Vec<(String, String)>,
    pub stated_rate_hz: Option<f64>,
}

/// What a file holds.
#[derive(Debug, Default)]
pub(super) struct FileTree {
    pub parts: Vec<GroupPart>,
    pub notes: Vec<Note>,
    /// Attributes of the root group.
    pub metadata: Vec<(String, String)>,
    pub stated_rate_hz: Option<f64>,
}

impl FileTree {
    /// The same with one dataset alone, where its path was asked for instead of that of a group.
    pub fn narrowed(mut self, wanted: Option<&str>) -> FileTree {
        let Some(wanted) = wanted.map(|w| w.trim_matches('/')).filter(|w| !w.is_empty()) else { return self };
        if self.parts.iter().any(|p| p.part.name.trim_matches('/') == wanted) {
            return self;
        }
        let is_it = |p: &Place| p.dataset.trim_matches('/') == wanted;
        if let Some(i) = self.parts.iter().position(|p| p.places.iter().any(is_it)) {
            let mut part = self.parts.swap_remove(i);
            let keep: Vec<bool> = part.places.iter().map(is_it).collect();
            let mut kept = keep.iter();
            part.part.columns.retain(|_| kept.next().copied().unwrap_or(false));
            part.places.retain(is_it);
            part.part.name = wanted.to_owned();
            self.parts = vec![part];
        }
        self
    }
}

/// Looks at every group.
pub(super) fn walk(file: &Hdf5File) -> Result<FileTree, Error> {
    let mut found = FileTree::default();
    let root = file.root_group()?;
    let (metadata, rate) = describe_attributes(&root.attributes().unwrap_or_default());
    (found.metadata, found.stated_rate_hz) = (metadata, rate);
    let mut seen = BTreeSet::new();
    let mut left = MAX_OBJECTS;
    let mut waiting = vec![(root, String::from("/"), 0usize)];
    while let Some((group, path, depth)) = waiting.pop() {
        if !seen.insert(group.address()) || left == 0 {
            continue;
        }
        let (groups, datasets, mut notes) = members(&group, &path)?;
        left = left.saturating_sub(groups.len() + datasets.len() + 1);
        if left == 0 {
            found.notes.push(note!("ingest.hdf5.many_objects", count = MAX_OBJECTS));
        }
        let mut part =
            GroupPart { part: Part { name: path.clone(), columns: Vec::new() }, ..GroupPart::default() };
        part.notes.append(&mut notes);
        if depth > 0 {
            (part.metadata, part.stated_rate_hz) =
                describe_attributes(&group.attributes().unwrap_or_default());
        }
        for dataset in &datasets {
            add(&mut part, dataset, &path);
        }
        if !part.part.columns.is_empty() {
            found.parts.push(part);
        }
        if depth < MAX_DEPTH {
            // The last one is taken first, so that groups come in the order of the file.
            for child in groups.into_iter().rev() {
                let below = join(&path, child.name());
                // MATLAB keeps what cells and structures refer to in groups of this kind.
                if !child.name().starts_with('#') {
                    waiting.push((child, below, depth + 1));
                }
            }
        }
    }
    Ok(found)
}

fn join(path: &str, name: &str) -> String {
    format!("{}/{name}", path.trim_end_matches('/'))
}

/// Groups and datasets in a group, and what was passed over.
type Members = (Vec<Group>, Vec<Dataset>, Vec<Note>);

/// Groups and datasets in a group. A member that cannot be opened is reported and passed over, unless none can.
fn members(group: &Group, path: &str) -> Result<Members, Error> {
    let whole = match group.members() {
        Ok((groups, datasets)) => return Ok((groups, datasets, Vec::new())),
        Err(e) => e,
    };
    let Ok((group_names, dataset_names)) = group.member_names() else { return Err(whole) };
    let (mut groups, mut datasets, mut notes) = (Vec::new(), Vec::new(), Vec::new());
    for name in group_names.iter().take(MAX_OBJECTS) {
        groups.extend(group.group(name));
    }
    for name in dataset_names.iter().take(MAX_OBJECTS) {
        match group.dataset(name) {
            Ok(dataset) => datasets.push(dataset),
            Err(e) => notes.push(note!(
                "ingest.hdf5.not_opened",
                name = crate::error::shorten(&join(path, name)),
                reason = e.to_string()
            )),
        }
    }
    if groups.is_empty() && datasets.is_empty() { Err(whole) } else { Ok((groups, datasets, notes)) }
}

/// Attributes as metadata, and the sample rate among them.
fn describe_attributes(attributes: &[hdf5_reader::Attribute]) -> (Vec<(String, String)>, Option<f64>) {
    let mut metadata = Vec::new();
    let mut rate = None;
    for a in attributes.iter().take(MAX_OBJECTS) {
        let number = attributes::number(a);
        rate = rate.or_else(|| stated_sample_rate_hz(&a.name, number?));
        let value = attributes::text(a).or_else(|| number.map(|v| v.to_string()));
        metadata.extend(value.map(|v| (a.name.clone(), v)));
    }
    (metadata, rate)
}

/// Adds the columns of a dataset to its group.
fn add(part: &mut GroupPart, dataset: &Dataset, group: &str) {
    let told = attributes::read(&dataset.attributes());
    part.stated_rate_hz = part.stated_rate_hz.or(told.rate_hz);
    let name = dataset.name().rsplit('/').next().unwrap_or_default().to_owned();
    let elements = dataset.shape().iter().try_fold(1u64, |n, d| n.checked_mul(*d)).unwrap_or(u64::MAX);
    let element_bytes = dataset.raw_element_size().unwrap_or(usize::MAX) as u64;
    if elements == 1 {
        add_scalar(part, dataset, &name);
        return;
    }
    let factor = told.factor.unwrap_or(1.0) * told.to_s;
    let offset = told.offset.unwrap_or(0.0) * told.to_s;
    let mut described = DescribedDataset {
        path: join(group, &name),
        name,
        told,
        conversion: Affine { factor, offset },
        elements,
        logical_bytes: elements.saturating_mul(element_bytes),
        part,
    };
    match dataset.dtype() {
        Datatype::Compound { fields, .. } => described.add_records(fields, dataset.shape()),
        datatype => described.add_numbers(datatype, dataset.shape()),
    }
}

/// A dataset whose columns are added to its group.
struct DescribedDataset<'a> {
    part: &'a mut GroupPart,
    path: String,
    name: String,
    told: attributes::DatasetAttributes,
    conversion: Affine,
    elements: u64,
    logical_bytes: u64,
}

impl DescribedDataset<'_> {
    fn push(&mut self, column: Column, rows: u64, place: Place) {
        self.part.part.columns.push((column, rows));
        self.part.places.push(place);
    }

    fn place(&self, pick: Pick, storage: Option<Storage>) -> Place {
        Place {
            dataset: self.path.clone(),
            pick,
            storage,
            conversion: self.conversion,
            missing: self.told.missing,
            base: None,
            logical_bytes: self.logical_bytes,
        }
    }

    fn column(&self, name: String, storage: Option<Storage>, words: String) -> Column {
        Column {
            name,
            numeric: storage.is_some(),
            storage: storage.map_or(words, Storage::words),
            unit: self.told.unit.clone(),
            epoch_s: self.told.epoch_s,
            rollover_s: None,
            judged: None,
        }
    }

    /// Adds the fields of records as columns; what attributes say of the dataset says nothing of one field.
    fn add_records(&mut self, fields: &[CompoundField], shape: &[u64]) {
        let rows = if matches!(shape, [_]) { self.elements } else { 0 };
        for field in fields.iter().take(MAX_WIDTH as usize) {
            let offset = field.byte_offset as usize;
            let (base, count) = match &field.datatype {
                Datatype::Array { base, dims } => {
                    (base.as_ref(), dims.iter().try_fold(1u64, |n, d| n.checked_mul(*d)).unwrap_or(u64::MAX))
                }
                add_scalar => (add_scalar, 1),
            };
            let storage = Storage::of(base).filter(|_| count <= ARRAY && rows > 0);
            let count = if storage.is_some() { count } else { 1 };
            for k in 0..count {
                let name = if count == 1 { field.name.clone() } else { format!("{}_{}", field.name, k + 1) };
                let step = (k as usize).saturating_mul(storage.map_or(0, Storage::bytes));
                let pick = Pick::Field { offset: offset.saturating_add(step) };
                let bare = Column { unit: None, epoch_s: None, ..self.column(name, storage, kind(base)) };
                let place =
                    Place { conversion: Affine::IDENTITY, missing: None, ..self.place(pick, storage) };
                self.push(bare, rows, place);
            }
        }
    }

    /// Adds a vector as a column, a matrix as several.
    fn add_numbers(&mut self, datatype: &Datatype, shape: &[u64]) {
        let storage = Storage::of(datatype).filter(|_| !self.told.matlab_text);
        let words = if self.told.matlab_text { "text".to_owned() } else { kind(datatype) };
        let name = self.name.clone();
        match shape {
            [rows] => {
                self.push(self.column(name, storage, words), *rows, self.place(Pick::All, storage));
            }
            [a, b] if (*a).min(*b) == 1 => {
                let pick = Pick::Column { index: 0, width: 1, rows_last: *a == 1 };
                self.push(self.column(name, storage, words), (*a).max(*b), self.place(pick, storage));
            }
            [a, b] if (*a).min(*b) <= MAX_WIDTH && self.elements > 0 && storage.is_some() => {
                // A recording has more rows than columns; MATLAB stores matrices with the dimensions exchanged.
                let rows_last = if a == b { self.told.matlab } else { a < b };
                let (rows, width) = if rows_last { (*b, *a) } else { (*a, *b) };
                for index in 0..width {
                    let pick = Pick::Column { index, width, rows_last };
                    let column = self.column(format!("{name}_{}", index + 1), storage, words.clone());
                    self.push(column, rows, self.place(pick, storage));
                }
                let key = if rows_last { "ingest.hdf5.rows_last" } else { "ingest.hdf5.rows_first" };
                let note = Note::new(key).with("name", name).with("rows", rows).with("width", width);
                self.part.notes.push(note);
            }
            _ => {
                let column = self.column(name, None, format!("{} {shape:?}", kind(datatype)));
                let place = Place { missing: None, ..self.place(Pick::All, None) };
                self.push(column, 0, place);
            }
        }
        if (self.told.factor.is_some() || self.told.offset.is_some()) && storage.is_some() {
            self.part.notes.push(note!(
                "ingest.hdf5.scaled",
                name = self.path.as_str(),
                factor = self.told.factor.unwrap_or(1.0),
                offset = self.told.offset.unwrap_or(0.0)
            ));
        }
    }
}

/// A dataset of one element is a remark on the others.
fn add_scalar(part: &mut GroupPart, dataset: &Dataset, name: &str) {
    let text = match dataset.dtype() {
        Datatype::String { .. } | Datatype::VarLen { .. } => {
            dataset.read_strings().ok().and_then(|s| s.into_iter().next())
        }
        _ => {
            let all = SliceInfo::all(dataset.ndim());
            let number = Storage::of(dataset.dtype())
                .and_then(|_| dataset.read_slice::<super::number::Number>(&all).ok())
                .and_then(|a| a.iter().next().map(|n| n.0));
            if let Some(rate) = number.and_then(|v| stated_sample_rate_hz(name, v)) {
                part.stated_rate_hz = part.stated_rate_hz.or(Some(rate));
            }
            number.map(|v| v.to_string())
        }
    };
    part.metadata.extend(text.map(|t| (name.to_owned(), t)));
}

/// The class of a type in words.
fn kind(datatype: &Datatype) -> String {
    match datatype {
        Datatype::FixedPoint { size, .. } => format!("integer of {size} bytes"),
        Datatype::FloatingPoint { size, .. } => format!("number of {size} bytes"),
        Datatype::String { .. } => "text".to_owned(),
        Datatype::VarLen { .. } => "values of varying length".to_owned(),
        Datatype::Compound { .. } => "records".to_owned(),
        Datatype::Array { .. } => "arrays".to_owned(),
        Datatype::Enum { .. } => "enumeration".to_owned(),
        Datatype::Opaque { .. } => "opaque bytes".to_owned(),
        Datatype::Reference { .. } => "references".to_owned(),
        Datatype::Bitfield { .. } => "bit field".to_owned(),
    }
}
