//! Results that stand in a Parquet table, one row each.

use super::{of_the_lot, sheet};
use crate::support::{result_table, sagnac};
use tempfile::tempdir;

#[test]
fn the_sheet_of_a_table_is_that_of_its_files() {
    let dir = tempdir().unwrap();
    std::fs::create_dir_all(dir.path().join("kept/procedure=static-bias")).unwrap();
    result_table(&dir.path().join("kept/procedure=static-bias/part-0.parquet"));
    let of_table = sagnac(dir.path(), &["datasheet", "kept", "--out", "table"]);
    assert_eq!((of_table.code, of_table.err.as_str()), (0, ""), "{of_table:?}");
    let (files, table) = (sheet(&of_the_lot().out), sheet(&dir.path().join("table")));
    assert_eq!(files["quantities"], table["quantities"]);
    assert_eq!((&table["units"], &table["lots"]), (&files["units"], &files["lots"]));
    assert_eq!(table["results"][0]["path"].as_str().map(|p| p.starts_with("recordings/")), Some(true));
}

#[test]
fn a_table_without_records_is_refused_by_name() {
    let dir = tempdir().unwrap();
    let columns: [(&str, sagnac::output::Column<f64>); 1] =
        [("value", sagnac::output::Column::Number(|v| Some(*v)))];
    let file = std::fs::File::create(dir.path().join("t.parquet")).unwrap();
    sagnac::output::write_table(&[1.0, 2.0], &columns, file).unwrap();
    std::fs::write(dir.path().join("broken.parquet"), b"PAR1 and nothing").unwrap();
    for (name, told) in [
        ("t.parquet", "column `result_json` is missing"),
        ("broken.parquet", "cannot be read as a Parquet table"),
    ] {
        let said = sagnac(dir.path(), &["datasheet", name, "--out", "s"]);
        assert_eq!(said.code, 2, "{said:?}");
        assert!(said.err.contains(told) && said.err.contains(name), "{said:?}");
    }
}
