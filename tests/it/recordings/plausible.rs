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
            page.contains(expected) && page.contains("no sensor of this kind can output"),
            "{expected}: {page}"
        );
        assert!(!page.contains("If the unit was rotated by a known angle"), "{page}");
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

/// A stream of counts out of step with its format: every value is possible, no change between them is.
#[test]
fn numbers_that_sum_up_to_no_angle_are_not_offered_as_one_and_state_no_scale_factor() {
    let dir = tempdir().unwrap();
    // Rates of up to 30 000 deg/s of either sign, which no rule of their size excludes.
    let broken = |i: u64| 30_000.0 * white(5, i).sin() + 4000.0;
    let rows: String = (0..40_000u64).map(|i| format!("{:.2},{:.6}\n", i as f64 * 0.01, broken(i))).collect();
    std::fs::write(dir.path().join("r.csv"), format!("time_s,rate_deg_s\n{rows}")).unwrap();
    let seen = sagnac(dir.path(), &["inspect", "r.csv"]).out;
    let page = seen.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(page.contains("from one sample to the next; no unit under test"), "{page}");
    assert!(!page.contains("If the unit was rotated by a known angle"), "{page}");
    // Smooth numbers that sum up to 800 000 degrees where a quarter of a turn is stated.
    let smooth = |i: u64| white(5, i) + if (10_000..30_000).contains(&i) { 4000.0 } else { 0.0 };
    let rows: String = (0..40_000u64).map(|i| format!("{:.2},{:.6}\n", i as f64 * 0.01, smooth(i))).collect();
    std::fs::write(dir.path().join("s.csv"), format!("time_s,rate_deg_s\n{rows}")).unwrap();
    let page = sagnac(dir.path(), &["inspect", "s.csv"]).out;
    assert!(!page.contains("swing") && !page.contains("swung"), "{page}");
    let procedure = "format = \"procedure/1\"\n[procedure]\nid = \"turn\"\ntitle = \"Turn\"\nrevision = \"A\"\n\
        standard = \"drawn\"\nclause = \"drawn\"\nauthor = \"drawn\"\n[unit_under_test]\nserial_required = true\n\
        [[channel]]\nid = \"time\"\ncolumn = \"time_s\"\nrole = \"time\"\nunit = \"s\"\n\
        [[channel]]\nid = \"x\"\ncolumn = \"rate_deg_s\"\nrole = \"rate\"\nunit = \"deg/s\"\n\
        [rate_table]\n[[rate_table.turn]]\nchannel = \"x\"\nfrom = \"100 s\"\nto = \"300 s\"\nangle = \"90 deg\"\n\
        angle_uncertainty = \"1 deg\"\n[[rate_table.rest]]\nfrom = \"1 s\"\nto = \"90 s\"\n[conditions]\n\
        minimum_duration = \"1 min\"\n[[instrument]]\nname = \"table\"\ncalibration_due = 2999-12-31\n\
        [[measurand]]\nid = \"scale_factor_error\"\n[[clause]]\nclause = \"1\"\ntitle = \"Turn\"\nstatus = \"here\"\n";
    std::fs::write(dir.path().join("p.toml"), procedure).unwrap();
    for file in ["r.csv", "s.csv"] {
        let out = format!("o-{file}");
        sagnac(dir.path(), &["run", "p.toml", file, "--serial", "SN-0001", "--out", &out]);
        let r = result(&dir.path().join(&out));
        let broken = |c: &serde_json::Value| c["status"] == "invalid";
        let conditions = r["conditions"].as_array().unwrap();
        assert!(conditions.iter().any(broken), "{file}: {conditions:#?}");
    }
}
