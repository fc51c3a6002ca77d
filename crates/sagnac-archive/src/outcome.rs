//! What the evaluation of one recording gives, as a value and as an Arrow struct.

use datafusion::arrow::array::{
    ArrayBuilder, ArrayRef, Float64Builder, LargeStringBuilder, ListBuilder, StringBuilder, StructArray,
    StructBuilder, UInt64Builder,
};
use datafusion::arrow::datatypes::{DataType, Field, Fields};
use sagnac::record::{FaultRecord, MeasurandRecord};
use std::sync::Arc;

/// The result of one recording, or the reason why there is none.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Outcome {
    /// Serial number of the unit.
    pub serial: Option<String>,
    /// Family of the unit.
    pub family: Option<String>,
    /// Lot of the unit.
    pub lot: Option<String>,
    /// Verdict by its id: `pass`, `fail`, `indeterminate`, `error`, `none`; of an explanation `consistent`, `mismatch`,
    /// `unknown-mismatch`.
    pub verdict: Option<String>,
    /// When it was evaluated, RFC 3339, UTC.
    pub evaluated_at: Option<String>,
    /// Start of the recording, RFC 3339, where its stamps are absolute.
    pub recorded_at: Option<String>,
    /// Measured quantities, as in `result.json`.
    pub measurands: Vec<MeasurandRecord>,
    /// Faults of the recording, at most 100 of a kind.
    pub faults: Vec<FaultRecord>,
    /// Effects that an explanation found, the principal one first.
    pub effects: Vec<String>,
    /// SHA-256 of the bytes of the recording, hexadecimal; of several files, of their hashes in sequence.
    pub hash: Option<String>,
    /// Rows read.
    pub samples: Option<u64>,
    /// The whole `result.json` or `explain.json`.
    pub result_json: Option<String>,
    /// Why there is no result.
    pub error: Option<Failure>,
}

/// Why a recording has no result.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Failure {
    /// Kind.
    pub kind: FailureKind,
    /// One or more sentences.
    pub text: String,
}

/// Kind of a failure.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FailureKind {
    /// There is no such recording.
    Missing,
    /// The recording, procedure, limits or model could not be reached; another attempt may succeed.
    Access,
    /// The recording cannot be read as one.
    Recording,
    /// Procedure, limits or model are wrong.
    Configuration,
    /// The recording holds too little to evaluate.
    NotEvaluable,
    /// An argument cannot be used, or contradicts the recording.
    Argument,
    /// The program has a fault: the evaluation broke off.
    Program,
}

impl FailureKind {
    /// Its id in the column `error_kind`.
    pub fn id(self) -> &'static str {
        match self {
            FailureKind::Missing => "missing",
            FailureKind::Access => "access",
            FailureKind::Recording => "recording",
            FailureKind::Configuration => "configuration",
            FailureKind::NotEvaluable => "not_evaluable",
            FailureKind::Argument => "argument",
            FailureKind::Program => "program",
        }
    }
}

impl Failure {
    /// A failure with its sentence.
    pub fn new(kind: FailureKind, text: impl Into<String>) -> Failure {
        Failure { kind, text: text.into() }
    }
}

impl From<Failure> for Outcome {
    fn from(failure: Failure) -> Outcome {
        Outcome { error: Some(failure), ..Outcome::default() }
    }
}

fn text(name: &str) -> Field {
    Field::new(name, DataType::Utf8, true)
}

fn number(name: &str) -> Field {
    Field::new(name, DataType::Float64, true)
}

fn count(name: &str) -> Field {
    Field::new(name, DataType::UInt64, true)
}

/// Fields of a measured quantity, in the order of [`append_measurand`].
pub fn measurand_fields() -> Fields {
    Fields::from(vec![
        text("id"),
        text("channel"),
        number("value"),
        number("low"),
        number("high"),
        number("at_most"),
        text("unit"),
        text("verdict"),
        number("limit_min"),
        number("limit_max"),
    ])
}

fn fault_fields() -> Fields {
    Fields::from(vec![text("kind"), text("channel"), count("row"), count("count")])
}

fn list(name: &str, item: DataType) -> Field {
    Field::new(name, DataType::List(Arc::new(Field::new("item", item, true))), true)
}

/// Fields of an outcome, as the functions return them and as result files hold them.
pub fn fields() -> Fields {
    Fields::from(vec![
        text("serial"),
        text("family"),
        text("lot"),
        text("verdict"),
        text("evaluated_at"),
        text("recorded_at"),
        list("measurands", DataType::Struct(measurand_fields())),
        list("faults", DataType::Struct(fault_fields())),
        list("effects", DataType::Utf8),
        text("hash"),
        count("samples"),
        Field::new("result_json", DataType::LargeUtf8, true),
        text("error"),
        text("error_kind"),
    ])
}

/// The Arrow type of an outcome.
pub fn data_type() -> DataType {
    DataType::Struct(fields())
}

fn texts<'a>(all: &'a [Outcome], of: impl Fn(&'a Outcome) -> Option<&'a str>) -> ArrayRef {
    let mut builder = StringBuilder::new();
    all.iter().for_each(|o| builder.append_option(of(o)));
    Arc::new(builder.finish())
}

/// Adds one value to each field of a struct that is being built: texts first, numbers and counts after, each by its place.
struct Row<'a>(&'a mut StructBuilder);

impl Row<'_> {
    fn text(&mut self, place: usize, value: Option<&str>) {
        if let Some(field) = self.0.field_builder::<StringBuilder>(place) {
            field.append_option(value);
        }
    }

    fn number(&mut self, place: usize, value: Option<f64>) {
        if let Some(field) = self.0.field_builder::<Float64Builder>(place) {
            field.append_option(value);
        }
    }

    fn count(&mut self, place: usize, value: u64) {
        if let Some(field) = self.0.field_builder::<UInt64Builder>(place) {
            field.append_value(value);
        }
    }
}

fn append_measurand(m: &MeasurandRecord, row: &mut Row<'_>) {
    row.text(0, Some(&m.id));
    row.text(1, Some(&m.channel));
    row.number(2, m.value);
    row.number(3, m.interval.map(|i| i.low));
    row.number(4, m.interval.map(|i| i.high));
    row.number(5, m.upper_limit.map(|u| u.value));
    row.text(6, Some(&m.unit));
    row.text(7, Some(m.verdict.id()));
    row.number(8, m.limits().min);
    row.number(9, m.limits().max);
}

fn append_fault(f: &FaultRecord, row: &mut Row<'_>) {
    row.text(0, Some(&f.kind));
    row.text(1, f.channel.as_deref());
    row.count(2, f.row);
    row.count(3, f.count);
}

fn builder(fields: Fields) -> StructBuilder {
    let columns = fields
        .iter()
        .map(|f| -> Box<dyn ArrayBuilder> {
            match f.data_type() {
                DataType::Float64 => Box::new(Float64Builder::new()),
                DataType::UInt64 => Box::new(UInt64Builder::new()),
                _ => Box::new(StringBuilder::new()),
            }
        })
        .collect();
    StructBuilder::new(fields, columns)
}

fn lists<'a, T: 'a>(
    all: &'a [Outcome],
    fields: Fields,
    of: impl Fn(&'a Outcome) -> &'a [T],
    append: impl Fn(&T, &mut Row<'_>),
) -> ArrayRef {
    let mut lists = ListBuilder::new(builder(fields));
    for outcome in all {
        for item in of(outcome) {
            append(item, &mut Row(lists.values()));
            lists.values().append(true);
        }
        lists.append(true);
    }
    Arc::new(lists.finish())
}

/// Outcomes as an array of structs, one each.
pub fn array(all: &[Outcome]) -> StructArray {
    let mut effects = ListBuilder::new(StringBuilder::new());
    let mut samples = UInt64Builder::new();
    let mut json = LargeStringBuilder::new();
    for outcome in all {
        outcome.effects.iter().for_each(|e| effects.values().append_value(e));
        effects.append(true);
        samples.append_option(outcome.samples);
        json.append_option(outcome.result_json.as_deref());
    }
    let columns: Vec<ArrayRef> = vec![
        texts(all, |o| o.serial.as_deref()),
        texts(all, |o| o.family.as_deref()),
        texts(all, |o| o.lot.as_deref()),
        texts(all, |o| o.verdict.as_deref()),
        texts(all, |o| o.evaluated_at.as_deref()),
        texts(all, |o| o.recorded_at.as_deref()),
        lists(all, measurand_fields(), |o| &o.measurands, append_measurand),
        lists(all, fault_fields(), |o| &o.faults, append_fault),
        Arc::new(effects.finish()),
        texts(all, |o| o.hash.as_deref()),
        Arc::new(samples.finish()),
        Arc::new(json.finish()),
        texts(all, |o| o.error.as_ref().map(|e| e.text.as_str())),
        texts(all, |o| o.error.as_ref().map(|e| e.kind.id())),
    ];
    StructArray::new(fields(), columns, None)
}

#[cfg(test)]
mod tests {
    use super::*;
    use datafusion::arrow::array::{Array, AsArray};

    #[test]
    fn outcomes_keep_their_rows_apart() {
        let measurand =
            MeasurandRecord { id: "static_bias".into(), value: Some(1.5), ..MeasurandRecord::default() };
        let good = Outcome {
            serial: Some("A".into()),
            measurands: vec![measurand.clone(), MeasurandRecord { value: None, ..measurand }],
            faults: vec![FaultRecord { kind: "gap".into(), row: 7, count: 2, ..FaultRecord::default() }],
            result_json: Some("{}".into()),
            ..Outcome::default()
        };
        let bad: Outcome = Failure::new(FailureKind::Missing, "no file").into();
        let all = array(&[good, bad]);
        assert_eq!(all.len(), 2);
        let column = |name: &str| all.column_by_name(name).unwrap().clone();
        let measurands = column("measurands");
        let of_first = measurands.as_list::<i32>().value(0);
        assert_eq!((of_first.len(), measurands.as_list::<i32>().value(1).len()), (2, 0));
        let values = of_first.as_struct().column_by_name("value").unwrap().clone();
        assert!(values.is_valid(0) && values.is_null(1));
        assert_eq!(column("error_kind").as_string::<i32>().value(1), "missing");
        assert!(column("error").is_null(0) && column("result_json").is_null(1));
    }
}
