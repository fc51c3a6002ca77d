//! Which attempt a test is, and what came before it, whatever clocks, other operators and tidy hands do.

use crate::store::{a_result, kept, store, store_says, with_store, write_result};
use crate::support::{limits, procedure, program, result, sagnac, sample};
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::process::{Child, Command, Stdio};

fn run(folder: &Path, sample_name: &str, out: &str) -> Value {
    let (procedure, limits, sample) = (procedure(), limits(), sample(sample_name));
    let args = ["run", &procedure, &sample, "--limits", &limits, "--serial", "SN-1", "--out", out];
    let said = sagnac(folder, &[&args[..], &["--store", "store"]].concat());
    assert!(said.code < 2, "{said:?}");
    result(&folder.join(out))
}

fn start(folder: &Path, args: &[&str]) -> Child {
    Command::new(program())
        .current_dir(folder)
        .args(args)
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap()
}

#[test]
fn attempts_at_the_same_time_have_numbers_of_their_own() {
    const RUNS: usize = 4;
    let dir = with_store();
    let (procedure, limits, pass) = (procedure(), limits(), sample("pass"));
    let outs: Vec<String> = (0..RUNS).map(|i| format!("r{i}")).collect();
    let children: Vec<Child> = outs
        .iter()
        .map(|out| {
            let args = ["run", &procedure, &pass, "--limits", &limits, "--serial", "1", "--out", out];
            start(dir.path(), &[&args[..], &["--store", "store"]].concat())
        })
        .collect();
    for child in children {
        let output = child.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    }
    let numbers: BTreeSet<u64> =
        outs.iter().map(|out| result(&dir.path().join(out))["attempt"]["number"].as_u64().unwrap()).collect();
    assert_eq!(numbers, (1..=RUNS as u64).collect());
    assert!(crate::support::names(&dir.path().join("store/attempts")).is_empty());
    store(dir.path(), &["verify", "store"]);
}

#[test]
fn a_clock_that_is_set_back_makes_no_retest_a_first_test() {
    let dir = with_store();
    // The first test fails in the afternoon; the second one passes in the morning, by its clock.
    let first = a_result("SN-1", "L", "2026-03-01T15:00:00Z", 1.2);
    write_result(dir.path(), "first", &first);
    store(dir.path(), &["import", "store", "first"]);
    let address = kept(&dir.path().join("store"))[0].0.clone();
    let mut second = a_result("SN-1", "L", "2026-03-01T08:00:00Z", 0.5);
    second["attempt"] = json!({"number": 2, "earlier": [{"number": 1, "result": address}], "summary": []});
    write_result(dir.path(), "second", &second);
    store(dir.path(), &["import", "store", "second"]);
    for again in [false, true] {
        if again {
            store(dir.path(), &["rebuild", "store"]);
        }
        let said = sagnac(dir.path(), &["history", "--store", "store", "--format", "json"]);
        let history: Value = serde_json::from_str(&said.out).unwrap();
        let order: Vec<(u64, &str)> = history["results"]
            .as_array()
            .unwrap()
            .iter()
            .map(|r| (r["attempt"].as_u64().unwrap(), r["verdict"].as_str().unwrap()))
            .collect();
        assert_eq!(order, [(1, "fail"), (2, "pass")], "{again}");
        assert_eq!(history["yields"][0]["first_pass"]["count"], 0, "{again}");
    }
    store(dir.path(), &["verify", "store"]);
}

#[test]
fn a_chain_with_a_hole_is_named_and_no_yield_is_told_over_it() {
    let dir = with_store();
    run(dir.path(), "fail", "a");
    run(dir.path(), "pass", "b");
    let failed =
        kept(&dir.path().join("store")).into_iter().find(|(_, f)| result(f)["verdict"] == "fail").unwrap();
    fs::remove_dir_all(&failed.1).unwrap();
    store(dir.path(), &["rebuild", "store"]);
    let said = store_says(dir.path(), &["verify", "store"]);
    assert!(said.code == 1 && said.err.contains(&failed.0), "{said:?}");
    let said = sagnac(dir.path(), &["history", "--store", "store"]);
    assert!(said.out.contains("earlier attempts are partly missing"), "{}", said.out);
    let said = sagnac(dir.path(), &["history", "--store", "store", "--format", "json"]);
    let history: Value = serde_json::from_str(&said.out).unwrap();
    assert_eq!((&history["yields"], &history["counts"]["incomplete"]), (&json!([]), &json!(1)));
    assert_eq!(history["results"][0]["attempt"], 2, "as the result states");
    // The next test does not take the number of the one that is gone, and says so.
    let next = run(dir.path(), "pass", "c");
    assert_eq!(next["attempt"]["number"], 3);
    assert!(next["attempt"]["summary"].to_string().contains("does not hold"), "{}", next["attempt"]);
}

#[test]
fn corrections_do_not_run_in_a_circle() {
    let dir = with_store();
    for (name, hour) in [("a", 10), ("b", 11), ("c", 12)] {
        write_result(dir.path(), name, &a_result("SN-1", "L", &format!("2026-03-01T{hour}:00:00Z"), 0.5));
        store(dir.path(), &["import", "store", name]);
    }
    let [a, b, c] = [0, 1, 2].map(|i| kept(&dir.path().join("store"))[i].0.clone());
    let by = |old: &str, new: &str| {
        store_says(dir.path(), &["supersede", "store", old, "--by", new, "--reason", "r"])
    };
    assert_eq!(by(&a, &b).code, 0);
    assert_eq!(by(&b, &c).code, 0);
    // A later correction does not make the earlier one unsaid: b leads to c still.
    std::thread::sleep(std::time::Duration::from_millis(1100));
    assert_eq!(by(&a, &c).code, 0);
    for (old, new) in [(&c, &a), (&c, &b), (&b, &a), (&a, &a)] {
        let said = by(old, new);
        assert!(said.code == 2 && said.err.contains("counts in place"), "{said:?}");
    }
    store(dir.path(), &["verify", "store"]);
}

#[test]
fn two_operators_do_not_close_a_circle_together() {
    for _ in 0..6 {
        let dir = with_store();
        for (name, hour) in [("a", 10), ("b", 11)] {
            write_result(dir.path(), name, &a_result("SN-1", "L", &format!("2026-03-01T{hour}:00:00Z"), 0.5));
            store(dir.path(), &["import", "store", name]);
        }
        let [a, b] = [0, 1].map(|i| kept(&dir.path().join("store"))[i].0.clone());
        let children = [(&a, &b), (&b, &a)].map(|(old, new)| {
            start(dir.path(), &["store", "supersede", "store", old, "--by", new, "--reason", "r"])
        });
        let mut codes = children.map(|mut child| child.wait().unwrap().code());
        codes.sort();
        assert_eq!(codes, [Some(0), Some(2)]);
        store(dir.path(), &["verify", "store"]);
    }
}
