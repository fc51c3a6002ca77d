//! How long pages take beside running tests.

use super::Bench;
use serde_json::json;
use std::fs;
use std::time::Instant;

/// Requests that are timed.
const REQUESTS: usize = 1000;
/// Rows of a recording whose test takes long.
const ROWS: usize = 3_000_000;

#[test]
#[ignore = "measures time: cargo xtask study serve-latency"]
fn pages_answer_beside_two_running_tests() {
    let bench = Bench::new();
    let head = "time_s,rate_deg_h\n";
    let rows = (0..ROWS).map(|i| format!("{i},{}\n", (i * 7919 % 1000) as f64 / 1000.0));
    let text: String = std::iter::once(head.to_owned()).chain(rows).collect();
    for serial in ["SN-8", "SN-9"] {
        fs::write(bench.at("in").join(format!("20270301_{serial}_static.csv")), &text).unwrap();
    }
    let server = bench.start(&["--jobs", "2"]);
    let begin = || {
        ["SN-8", "SN-9"].map(|serial| {
            let answer = server.post("/api/v1/runs", &bench.order(serial));
            assert_eq!(answer.status, 202, "{answer:?}");
            answer.json()["id"].as_str().unwrap().to_owned()
        })
    };
    let mut running = begin();
    let mut took = vec![];
    let (mut beside, mut orders) = (0, 1);
    while took.len() < REQUESTS {
        let path = ["/", "/api/v1/runs", "/units/SN-8", "/lots"][took.len() % 4];
        let begun = Instant::now();
        let answer = server.get(path);
        took.push(begun.elapsed().as_secs_f64() * 1000.0);
        assert!([200, 404].contains(&answer.status), "{path}: {answer:?}");
        let state = |id: &str| server.get(&format!("/api/v1/runs/{id}")).json()["state"] == json!("running");
        beside += usize::from(running.iter().all(|id| state(id)));
        if !running.iter().any(|id| state(id)) {
            running = begin();
            orders += 1;
        }
    }
    took.sort_by(f64::total_cmp);
    let share = |p: f64| took[((took.len() - 1) as f64 * p) as usize];
    println!(
        "{REQUESTS} requests, {beside} beside two tests ({orders} orders): median {:.1} ms, 99 % {:.1} ms, longest {:.1} ms",
        share(0.5),
        share(0.99),
        share(1.0)
    );
    assert!(beside > REQUESTS / 4, "{beside}");
}
