//! What no sensor can show is named with its number and bound, in `inspect` and in a result.

use crate::support::synthetic::white;
use crate::support::{result, sagnac};
use tempfile::tempdir;

#[test]
fn numbers_that_no_sensor_shows_are_faults_with_number_and_bound() {
    let dir = tempdir().unwrap();
    for (broken, expected) in [
        ("250000,20.0", "9.00000e8 deg/h is beyond 1.80000e8 deg/h"),
        ("0.1,-400", "-400.000 degC is beyond -273.150 degC"),
    ] {
        let row =
            |i: u64| if i == 2000 { broken.to_owned() } else { format!("{:.6},{}", white(2, i), 20 + i % 2) };
        let rows: String = (0..4000).map(|i| format!("{:.2},{}\n", i as f64 * 0.01, row(i))).collect();
        std::fs::write(dir.path().join("r.csv"), format!("time_s,rate_deg_s,temp_degC\n{rows}")).unwrap();
        let seen = sagnac(dir.path(), &["inspect", "r.csv"]).out;
        let page = seen.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(
            page.contains(expected) && page.contains("no sensor of the kind shows"),
            "{expected}: {page}"
        );
        assert!(!page.contains("If a known angle was turned"), "{page}");
        let _ = std::fs::remove_dir_all(dir.path().join("a"));
        assert_eq!(sagnac(dir.path(), &["analyze", "r.csv", "--out", "a"]).code, 0);
        if broken.starts_with("25") {
            let r = result(&dir.path().join("a"));
            assert_eq!(r["integrity"]["implausible"], 1);
            let conditions = r["conditions"].as_array().unwrap();
            let found = conditions.iter().find(|c| c["id"] == "implausible").unwrap();
            let note = found["note"].as_str().unwrap();
            assert!(found["status"] == "remark" && note.contains(expected), "{note}");
        }
    }
}
