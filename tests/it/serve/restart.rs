//! Kills and restarts: no order is lost, none is carried out twice.

use super::{Bench, PATIENCE, POLL};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::fs;
use std::time::{Duration, Instant};

/// Lines of the queue by the ids that they end.
fn ends(bench: &Bench) -> BTreeMap<String, usize> {
    let mut ends = BTreeMap::new();
    for line in fs::read_to_string(bench.at("data/queue.jsonl")).unwrap().lines().skip(1) {
        let line: Value = serde_json::from_str(line).unwrap();
        if let Some(id) = line["ended"]["id"].as_str() {
            *ends.entry(id.to_owned()).or_default() += 1;
        }
    }
    ends
}

#[test]
fn kills_lose_and_double_nothing() {
    kills_of_the_server(6);
}

#[test]
#[ignore = "takes minutes: cargo xtask study serve-kills"]
fn a_hundred_kills_of_the_server_lose_and_double_nothing() {
    kills_of_the_server(100);
}

/// Servers that are killed after two orders each, every one at another place of its work.
fn kills_of_the_server(kills: u64) {
    /// Pauses before a kill, ms: as long as a test takes, in steps that have no common measure with their number.
    const STEP_MS: u64 = 60;
    const LONGEST_PAUSE_MS: u64 = 410;
    let bench = Bench::new();
    let mut ids = vec![];
    for kill in 0..kills {
        let mut server = bench.start(&["--jobs", "2"]);
        let waits = server.line().contains("Tests at a time: 2");
        assert!(waits);
        ids.extend((0..2).map(|_| server.order(&bench.order("SN-1"))));
        std::thread::sleep(Duration::from_millis(STEP_MS * kill % LONGEST_PAUSE_MS));
        server.child.kill().unwrap();
    }
    let server = bench.start(&["--jobs", "2"]);
    for id in &ids {
        let run = server.ended(id);
        assert_eq!((&run["state"], &run["verdict"]), (&json!("done"), &json!("pass")), "{run}");
    }
    let ends = ends(&bench);
    assert_eq!(ends.len(), ids.len());
    assert!(ends.values().all(|count| *count == 1), "{ends:?}");
    // A result for each order, and nothing unfinished beside them.
    let mut results: Vec<String> = fs::read_dir(bench.at("data/results"))
        .unwrap()
        .map(|e| e.unwrap().file_name().into_string().unwrap())
        .collect();
    results.sort();
    assert_eq!(results, ids);
    // The numbers of the ids go on.
    let next = server.order(&bench.order("SN-1"));
    assert!(next.starts_with(&format!("{:06}-", ids.len() + 1)), "{next}");
}

#[test]
fn a_result_that_is_there_is_not_made_again() {
    let bench = Bench::new();
    let server = bench.start(&[]);
    let id = server.order(&bench.order("SN-1"));
    server.ended(&id);
    drop(server);
    // As if the server had been killed between the result and its line.
    let queue = bench.at("data/queue.jsonl");
    let text = fs::read_to_string(&queue).unwrap();
    let kept: Vec<&str> = text.lines().filter(|line| !line.contains("\"ended\"")).collect();
    fs::write(&queue, format!("{}\n", kept.join("\n"))).unwrap();
    let made =
        fs::metadata(bench.at("data/results").join(&id).join("result.json")).unwrap().modified().unwrap();
    let mut server = bench.start(&[]);
    server.line();
    assert!(server.line().contains("made now: 1"));
    assert_eq!(server.ended(&id)["verdict"], "pass");
    let now =
        fs::metadata(bench.at("data/results").join(&id).join("result.json")).unwrap().modified().unwrap();
    assert_eq!(made, now);
}

#[test]
fn events_of_an_earlier_server_are_taken_up() {
    let bench = Bench::new();
    let server = bench.start(&[]);
    let id = server.order(&bench.order("SN-1"));
    server.ended(&id);
    drop(server);
    let server = bench.start(&[]);
    let heads = [("authorization", server.bearer()), ("last-event-id", "200".to_owned())];
    let heads = heads.each_ref().map(|(name, value)| (*name, value.as_str()));
    let stream = server.ask("GET", &format!("/api/v1/runs/{id}/events"), &heads, b"");
    assert!(stream.body.contains("event: ended") && stream.body.contains("\"pass\""), "{}", stream.body);
}

#[test]
#[cfg(unix)]
fn a_request_to_end_leaves_what_runs_for_the_next_server() {
    let bench = Bench::new();
    let mut server = bench.start(&["--jobs", "1"]);
    let ids: Vec<String> = (0..3).map(|_| server.order(&bench.order("SN-1"))).collect();
    let ended = std::process::Command::new("kill").arg(server.child.id().to_string()).status().unwrap();
    assert!(ended.success());
    let began = Instant::now();
    let code = loop {
        match server.child.try_wait().unwrap() {
            Some(status) => break status.code(),
            None => assert!(began.elapsed() < PATIENCE),
        }
        std::thread::sleep(POLL);
    };
    assert_eq!(code, Some(0));
    drop(server);
    let server = bench.start(&["--jobs", "1"]);
    for id in ids {
        assert_eq!(server.ended(&id)["verdict"], "pass");
    }
    assert_eq!(fs::read_dir(bench.at("data/results")).unwrap().count(), 3);
}
