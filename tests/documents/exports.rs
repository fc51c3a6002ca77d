//! Forms for other programs give the numbers back.

use crate::support::{result, sagnac};
use crate::tested;
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::RowAccessor;
use std::fs::{self, File};

#[test]
fn quantities_come_back_to_the_bit_from_csv_and_parquet() {
    let dir = tested("pass", "");
    let made = sagnac(dir.path(), &["report", "r", "--format", "csv,parquet,junit", "--out", "forms"]);
    assert_eq!(made.code, 0, "{made:?}");
    let record = result(&dir.path().join("r"));
    let rows = record["measurands"].as_array().unwrap();
    let at = dir.path().join("forms");

    let mut csv = csv::Reader::from_path(at.join("measurands.csv")).unwrap();
    let names = csv.headers().unwrap().clone();
    let column = |name: &str| names.iter().position(|n| n == name).unwrap();
    let (value, low, verdict) = (column("value"), column("low"), column("verdict"));
    let written: Vec<csv::StringRecord> = csv.records().map(Result::unwrap).collect();
    assert_eq!(written.len(), rows.len());
    for (line, row) in written.iter().zip(rows) {
        assert_eq!(line[value].parse::<f64>().ok(), row["value"].as_f64());
        assert_eq!(line[low].parse::<f64>().ok(), row["interval"]["low"].as_f64());
        assert_eq!(&line[verdict], row["verdict"].as_str().unwrap());
    }

    let parquet = SerializedFileReader::new(File::open(at.join("measurands.parquet")).unwrap()).unwrap();
    let table: Vec<_> = parquet.get_row_iter(None).unwrap().map(Result::unwrap).collect();
    assert_eq!(table.len(), rows.len());
    for (line, row) in table.iter().zip(rows) {
        assert_eq!(line.get_string(0).unwrap(), row["id"].as_str().unwrap());
        assert_eq!(line.get_double(value).ok(), row["value"].as_f64());
    }

    let junit = fs::read_to_string(at.join("junit.xml")).unwrap();
    let limits = rows.iter().filter(|r| !r["limit"].is_null()).count();
    let conditions = record["conditions"].as_array().unwrap().len();
    assert!(junit.contains(&format!("tests=\"{}\"", limits + conditions)), "{junit}");
    assert!(junit.contains("name=\"static_bias\"") && junit.contains("failures=\"0\""), "{junit}");
}
