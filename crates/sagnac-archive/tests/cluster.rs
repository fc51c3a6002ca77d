//! A scheduler and workers as processes on the loopback.

mod support;

use std::path::Path;
use std::process::Stdio;
use std::time::{Duration, Instant};
use support::*;

const ANALYZE: &str = "SELECT sagnac_analyze(uri) FROM jobs";
const AT: [&str; 2] = ["--at", "2026-05-04T10:00:00Z"];
const ALL: &str =
    "SELECT * EXCLUDE (measurands, faults, effects), length(result_json) AS l FROM results ORDER BY key";

fn over(cluster: &Cluster, portion: &str) -> Vec<String> {
    let scheduler = cluster.address();
    let args = ["--scheduler", &scheduler, "--portion", portion, "--rows-per-task", "1"];
    args.iter().chain(&AT).map(|a| (*a).to_owned()).collect()
}

#[test]
fn a_cluster_gives_the_same_rows_as_one_process() {
    let archive = Archive::of(20, 2000);
    archive.add("broken.csv", "no recording");
    std::fs::remove_dir_all(archive.path("jobs")).unwrap();
    archive.list("jobs");
    let here = archive.run(ANALYZE, "here", &AT);
    let cluster = Cluster::start(3);
    let more = over(&cluster, "8");
    let there = archive.run(ANALYZE, "there", &more.iter().map(String::as_str).collect::<Vec<_>>());
    assert_eq!((here.status.code(), there.status.code()), (Some(1), Some(1)), "{}", said(&there));
    let (here, there) = (archive.query(ALL, "here"), archive.query(ALL, "there"));
    assert_eq!(here.lines().count(), 22);
    assert_eq!(here, there);
    let lists = "SELECT m['id'], m['value'], m['low'], m['high'] FROM \
                 (SELECT key, unnest(measurands) AS m FROM results) ORDER BY key, m['id'], m['channel']";
    assert_eq!(archive.query(lists, "here"), archive.query(lists, "there"));
    assert!(files(Path::new(&archive.path("there")), ".pending").is_empty());
}

/// Starts a run, does something after a while, and tells how the run ended and how long it took since.
fn disturbed(
    archive: &Archive,
    cluster: &mut Cluster,
    after: Duration,
    disturb: impl FnOnce(&mut Cluster),
) -> (Option<i32>, String, Duration) {
    let more = over(cluster, "12");
    let (jobs, out) = (archive.path("jobs"), archive.path("results"));
    let args = ["run", ANALYZE, "--jobs", &jobs, "--out", &out];
    let args: Vec<&str> = args.into_iter().chain(more.iter().map(String::as_str)).collect();
    let run = command(&args).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    std::thread::sleep(after);
    disturb(cluster);
    let since = Instant::now();
    let output = run.wait_with_output().unwrap();
    (output.status.code(), said(&output), since.elapsed())
}

/// Runs again until nothing is left, and checks that nothing is missing or doubled.
fn resumed(archive: &Archive, cluster: &Cluster, recordings: usize) {
    let more = over(cluster, "12");
    let more: Vec<&str> = more.iter().map(String::as_str).collect();
    let done = archive.run(ANALYZE, "results", &more);
    assert_eq!(done.status.code(), Some(0), "{}", said(&done));
    assert_eq!(archive.counts("results"), format!("{recordings},{recordings},{recordings}"));
}

/// A run that met a lost machine ends, or says why, within a minute.
fn ended(code: Option<i32>, text: &str, took: Duration) {
    assert!(took < Duration::from_secs(60), "{took:?}: {text}");
    match code {
        Some(0) => {}
        Some(2) => assert!(text.contains("the same command resumes"), "{text}"),
        other => panic!("{other:?}: {text}"),
    }
}

#[test]
fn a_lost_worker_loses_no_recording() {
    let archive = Archive::of(36, 20_000);
    let mut cluster = Cluster::start(3);
    let (code, text, took) =
        disturbed(&archive, &mut cluster, Duration::from_millis(1500), |c| c.workers[0].kill());
    println!("ended with {code:?} after {took:?}");
    ended(code, &text, took);
    resumed(&archive, &cluster, 36);
}

/// The drill of `docs/archive.md`. About half an hour: `cargo test --release --test cluster -- --ignored --nocapture`.
#[test]
#[ignore = "takes half an hour"]
fn drill() {
    let moments = std::env::var("DRILL_MOMENTS").ok().and_then(|m| m.parse().ok()).unwrap_or(20_u64);
    let mut longest = Duration::ZERO;
    let mut cluster = Cluster::start(3);
    let mut state = 7_u64;
    for moment in 0..moments {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let after = Duration::from_millis(200 + (state >> 33) % 6000);
        let archive = Archive::of(48, 40_000);
        let (code, text, took) = disturbed(&archive, &mut cluster, after, |c| c.workers[0].kill());
        println!("moment {moment}: killed after {after:?}, ended with {code:?} {took:?} later");
        ended(code, &text, took);
        cluster.workers[0] = cluster.worker();
        resumed(&archive, &cluster, 48);
        longest = longest.max(took);
    }
    println!("longest time to the end of a run after a kill: {longest:?}");
    let archive = Archive::of(96, 40_000);
    let (code, text, took) = disturbed(&archive, &mut cluster, Duration::from_secs(3), |c| {
        c.workers.iter_mut().for_each(Process::kill);
    });
    println!("all workers killed: ended with {code:?} after {took:?}: {text}");
    assert_eq!(code, Some(2), "{text}");
    ended(code, &text, took);
    cluster.workers = (0..3).map(|_| cluster.worker()).collect();
    resumed(&archive, &cluster, 96);
    let archive = Archive::of(96, 40_000);
    let (code, text, took) =
        disturbed(&archive, &mut cluster, Duration::from_secs(3), Cluster::restart_scheduler);
    println!("scheduler restarted: ended with {code:?} after {took:?}: {text}");
    ended(code, &text, took);
    resumed(&archive, &cluster, 96);
}
