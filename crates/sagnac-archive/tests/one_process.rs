//! The program in one process: results, errors as data, resuming.

mod support;

use std::path::Path;
use std::process::Stdio;
use std::time::Duration;
use support::*;

const ANALYZE: &str = "SELECT sagnac_analyze(uri) FROM jobs";

#[test]
fn a_run_gives_what_the_program_gives() {
    let archive = Archive::empty();
    std::fs::copy(file("samples/unit-pass.csv"), archive.path("recordings/pass.csv")).unwrap();
    std::fs::copy(file("samples/unit-fail.csv"), archive.path("recordings/fail.csv")).unwrap();
    let done = program(&[
        "list",
        &archive.path("recordings"),
        "--out",
        &archive.path("jobs"),
        "--procedure",
        &file("procedures/static-bias.toml"),
        "--limits",
        &file("procedures/limits/sample-unit.toml"),
    ]);
    assert!(done.status.success(), "{}", said(&done));
    let job = archive.path("job.toml");
    std::fs::write(&job, "jobs = \"jobs\"\nout = \"results\"\ncall = \"run\"\n").unwrap();
    let done = program(&["run", &job, "--at", "2026-05-04T10:00:00Z"]);
    assert_eq!(done.status.code(), Some(0), "{}", said(&done));
    let sql = "SELECT serial, verdict, evaluated_at, procedure, engine, length(hash) AS h, samples, \
               sagnac_measurand(measurands, 'static_bias')['unit'] AS unit FROM results ORDER BY uri";
    let version = env!("CARGO_PKG_VERSION");
    let rows = archive.query(sql, "results");
    let rows: Vec<&str> = rows.lines().skip(1).collect();
    for (row, verdict) in rows.iter().zip(["fail", "pass"]) {
        let fields: Vec<&str> = row.split(',').collect();
        assert_eq!(fields[..2], ["SN-0001", verdict]);
        assert_eq!(fields[2..6], ["2026-05-04T10:00:00Z", "static-bias", version, "64"]);
        assert_eq!(fields[7], "deg/h");
    }
    assert_eq!(rows.len(), 2);
    let facade = sagnac::Procedure::load(file("procedures/static-bias.toml"))
        .and_then(|p| p.with_limits(file("procedures/limits/sample-unit.toml")))
        .unwrap()
        .evaluated_at("2026-05-04T10:00:00Z".parse().unwrap())
        .run(&sagnac::Recording::open(archive.path("recordings/pass.csv")).unwrap(), &<_>::default())
        .unwrap();
    let sql = "SELECT result_json FROM results WHERE verdict = 'pass'";
    let csv = archive.query(sql, "results");
    let text = csv.lines().nth(1).unwrap().trim_matches('"').replace("\"\"", "\"");
    assert_eq!(text, serde_json::to_string(facade.record()).unwrap());
}

#[test]
fn errors_are_data() {
    let archive = Archive::empty();
    archive.add("good.csv", &recording(1, 2000));
    archive.add("empty.csv", "");
    archive.add("broken.csv", "time_s,rate_deg_h\n\u{1}\u{2}nothing,here\nat,all\n");
    archive.add("gone.csv", &recording(2, 10));
    std::fs::write(archive.path("recordings/noise.parquet"), b"PAR1 is no recording").unwrap();
    archive.list("jobs");
    std::fs::remove_file(archive.path("recordings/gone.csv")).unwrap();
    let done = archive.run(ANALYZE, "results", &[]);
    assert_eq!(done.status.code(), Some(1), "{}", said(&done));
    assert!(said(&done).contains("5 recordings: 1 results, 4 errors kept as data"), "{}", said(&done));
    let sql = "SELECT uri, error_kind, error IS NOT NULL AS e, verdict FROM results ORDER BY uri";
    let rows = archive.query(sql, "results");
    let kind = |name: &str| {
        let row = rows.lines().find(|r| r.contains(name)).unwrap();
        row.split(',').skip(1).collect::<Vec<_>>().join(",")
    };
    assert_eq!(kind("gone.csv"), "missing,true,");
    assert_eq!(kind("noise.parquet"), "recording,true,");
    assert_eq!(kind("good.csv"), ",false,none");
    for name in ["empty.csv", "broken.csv"] {
        assert!(kind(name).ends_with(",true,"), "{rows}");
    }
    // What is wrong with a recording stays wrong: it is not tried again.
    let again = archive.run(ANALYZE, "results", &[]);
    assert_eq!(again.status.code(), Some(0), "{}", said(&again));
    assert!(said(&again).starts_with("0 recordings"), "{}", said(&again));
}

#[test]
fn a_wrong_procedure_is_told_with_its_place() {
    let archive = Archive::of(2, 300);
    let procedure = archive.path("wrong.toml");
    std::fs::write(&procedure, "format = \"procedure/1\"\nid = 7\n").unwrap();
    let sql = format!("SELECT sagnac_run(uri, '{procedure}', NULL) FROM jobs");
    let done = archive.run(&sql, "results", &[]);
    assert_eq!(done.status.code(), Some(1), "{}", said(&done));
    let rows = archive.query("SELECT DISTINCT procedure, error_kind, error FROM results", "results");
    assert!(rows.contains("wrong,configuration,") && rows.contains("wrong.toml:2:"), "{rows}");
    let missing = archive.run("SELECT sagnac_run(uri, 'none.toml', NULL) FROM jobs", "other", &[]);
    assert_eq!(missing.status.code(), Some(1), "{}", said(&missing));
    assert!(archive.query("SELECT DISTINCT error_kind FROM results", "other").contains("missing"));
}

#[test]
fn a_run_that_was_killed_is_resumed() {
    let archive = Archive::of(24, 4000);
    let (jobs, out) = (archive.path("jobs"), archive.path("results"));
    let args = ["run", ANALYZE, "--jobs", &jobs, "--out", &out, "--portion", "2"];
    for parts in [1, 4] {
        let mut run = Process(command(&args).stdout(Stdio::null()).spawn().unwrap());
        until("some results", Duration::from_secs(60), || {
            files(Path::new(&out), ".parquet").len() >= parts || run.0.try_wait().unwrap().is_some()
        });
        run.kill();
    }
    let done = program(&args);
    assert!(done.status.success(), "{}", said(&done));
    assert_eq!(archive.counts("results"), "24,24,24");
    let again = program(&args);
    assert!(said(&again).starts_with("0 recordings"), "{}", said(&again));
    // What is new, or has changed, is done.
    archive.add("unit-900.csv", &recording(900, 300));
    archive.add("unit-000.csv", &recording(0, 301));
    archive.list("jobs2");
    let done = program(&["run", ANALYZE, "--jobs", &archive.path("jobs2"), "--out", &out]);
    assert!(said(&done).starts_with("2 recordings: 2 results"), "{}", said(&done));
    assert_eq!(archive.counts("results"), "26,26,25");
}

#[test]
fn a_recording_that_is_listed_twice_is_done_once() {
    let archive = Archive::of(3, 300);
    std::fs::copy(archive.path("jobs/jobs-000000.parquet"), archive.path("jobs/more.parquet")).unwrap();
    let done = archive.run(ANALYZE, "results", &[]);
    assert!(done.status.success(), "{}", said(&done));
    assert_eq!(archive.counts("results"), "3,3,3");
}

#[test]
fn what_is_out_of_reach_is_tried_again_later() {
    let archive = Archive::of(2, 300);
    // The server of the bucket is away.
    let sql = "SELECT sagnac_analyze('s3://bucket' || uri) FROM jobs";
    let (jobs, out) = (archive.path("jobs"), archive.path("away"));
    let mut run = command(&["run", sql, "--jobs", &jobs, "--out", &out]);
    run.env("AWS_ENDPOINT", format!("http://127.0.0.1:{}", port())).env("AWS_ALLOW_HTTP", "true");
    run.env("AWS_ACCESS_KEY_ID", "a").env("AWS_SECRET_ACCESS_KEY", "b").env("AWS_REGION", "us-east-1");
    let done = run.output().unwrap();
    assert_eq!(done.status.code(), Some(1), "{}", said(&done));
    assert!(said(&done).contains("2 out of reach"), "{}", said(&done));
    assert_eq!(archive.counts("away"), "0,0,0");
}

#[test]
fn mistakes_are_told_before_anything_runs() {
    let archive = Archive::of(1, 300);
    for (sql, told) in [
        ("SELECT uri FROM jobs", "calls 0 functions"),
        ("SELECT sagnac_analyze(uri), sagnac_explain(uri, model) FROM jobs", "calls 2 functions"),
        ("SELECT sagnac_analyze(uri) FROM jobs LIMIT 3", "outermost part"),
        ("SELECT sagnac_analyze(uri) FROM (SELECT uri FROM jobs)", "is more than"),
        (
            "SELECT sagnac_analyze(uri) FROM jobs WHERE sagnac_analyze(uri)['serial'] = 'a'",
            "condition evaluates",
        ),
        ("SELECT sagnac_analyze(url) FROM jobs", "url"),
        ("SELEC", "SELEC"),
    ] {
        let done = archive.run(sql, "results", &[]);
        assert_eq!(done.status.code(), Some(2), "{sql}: {}", said(&done));
        assert!(said(&done).contains(told), "{sql}: {}", said(&done));
    }
    let absent =
        program(&["run", ANALYZE, "--jobs", &archive.path("absent"), "--out", &archive.path("results")]);
    assert!(said(&absent).contains("there is no such job list"), "{}", said(&absent));
    let twice = program(&["list", &archive.path("recordings"), "--out", &archive.path("jobs")]);
    assert_eq!(twice.status.code(), Some(2));
    assert!(said(&twice).contains("has shards already"), "{}", said(&twice));
    let time = archive.run(ANALYZE, "results", &["--at", "yesterday"]);
    assert!(said(&time).contains("expected RFC 3339"), "{}", said(&time));
}

#[test]
fn lots_are_told_by_aggregates() {
    let archive = Archive::of(12, 1000);
    let done = archive.run("SELECT sagnac_analyze(uri, '{\"lot\": \"L1\"}') FROM jobs", "results", &[]);
    assert!(done.status.success(), "{}", said(&done));
    let rows = archive.query(
        "SELECT lot, count(*) AS n, avg(b['value']) AS m, sagnac_tolerance_upper(b['value'], 0.9, 0.95) AS t \
         FROM (SELECT lot, sagnac_measurand(measurands, 'static_bias') AS b FROM results) GROUP BY lot",
        "results",
    );
    let row: Vec<&str> = rows.lines().nth(1).unwrap().split(',').collect();
    let number = |i: usize| row[i].parse::<f64>().unwrap();
    assert_eq!(row[..2], ["L1", "12"]);
    assert!(
        (number(2) - 10.055).abs() < 0.1 && number(3) > number(2) && number(3) < number(2) + 1.0,
        "{rows}"
    );
}
