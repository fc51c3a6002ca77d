//! Forms for other programs give the numbers back.

use crate::documents::tested;
use crate::support::{result, sagnac};
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::RowAccessor;
use std::fs::{self, File};

#[test]
fn quantities_come_back_to_the_bit_from_csv_and_parquet() {
    let dir = tested("pass");
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

const LABORATORY: &str = "format = \"laboratory/1\"\nlanguages = [\"en\", \"ru\"]\nplace = \"laboratory\"\n\
    [laboratory]\nname = { en = \"Gyro Test Laboratory\", ru = \"Лаборатория гироскопов\" }\ncity = \"Berlin\"\ncountry = \"DE\"\n\
    [customer]\nname = \"Works & Sons\"\ncity = \"Hamburg\"\ncountry = \"DE\"\n\
    [[person]]\nname = \"A. Ivanova\"\nmain_signer = true\n";

#[test]
fn a_certificate_names_what_it_lacks_and_has_the_numbers_of_the_result() {
    let dir = tested("pass");
    let at = dir.path();
    let asked =
        |more: &[&str]| sagnac(at, &[&["report", "r", "--format", "dcc,atml", "--out", "c"], more].concat());
    let said = asked(&[]);
    assert!(said.code == 2 && said.err.contains("laboratory is not given"), "{said:?}");
    assert!(!at.join("c").exists());
    for (text, why) in [
        (LABORATORY.replace("country = \"DE\"", "country = \"Germany\""), "no country code"),
        (
            LABORATORY.replace("[[person]]\nname = \"A. Ivanova\"\nmain_signer = true\n", ""),
            "no person responsible",
        ),
        (LABORATORY.replace("laboratory/1", "laboratory/2"), "laboratory/1"),
    ] {
        fs::write(at.join("laboratory.toml"), text).unwrap();
        let said = asked(&["--laboratory", "laboratory.toml"]);
        assert!(said.code == 2 && said.err.contains(why), "{why}: {said:?}");
    }
    fs::write(at.join("laboratory.toml"), LABORATORY).unwrap();
    let said = asked(&["--laboratory", "laboratory.toml"]);
    assert_eq!(said.code, 0, "{said:?}");
    let certificate = fs::read_to_string(at.join("c/dcc.xml")).unwrap();
    assert!(
        certificate.contains("schemaVersion=\"3.3.0\"") && certificate.contains("Works &amp; Sons"),
        "{certificate}"
    );
    assert!(certificate.contains("Лаборатория гироскопов") && certificate.contains("SN-1"), "{certificate}");
    let results = fs::read_to_string(at.join("c/atml.xml")).unwrap();
    let record = result(&at.join("r"));
    let mut values = 0;
    for row in record["measurands"].as_array().unwrap() {
        let Some(value) = row["value"].as_f64() else { continue };
        values += 1;
        assert!(results.contains(&format!("\"{value:?}\"")), "{}: {value:?}", row["id"]);
        // Units that the SI does not name are converted; the original stands beside them.
        assert!(certificate.contains(&format!(">{value:?}<")), "{}: {value:?}", row["id"]);
    }
    assert!(values > 10, "{values}");
    assert_eq!(crate::documents::verified(at, &["c"]).0, 0);
}
