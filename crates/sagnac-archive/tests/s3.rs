//! An s3-compatible store: the server of moto, where Python has it.

mod support;

use std::process::{Command, Stdio};
use std::time::Duration;
use support::*;

/// The server, or `None` where it cannot be started.
fn server() -> Option<(Process, u16)> {
    let port = port();
    let probe =
        Command::new("python3").args(["-c", "import moto.server, flask"]).stderr(Stdio::null()).status();
    if !probe.is_ok_and(|s| s.success()) {
        return None;
    }
    let mut server = Command::new("python3");
    server.args(["-m", "moto.server", "-H", "127.0.0.1", "-p", &port.to_string()]);
    let server = Process(server.stdout(Stdio::null()).stderr(Stdio::null()).spawn().ok()?);
    until("the server", Duration::from_secs(60), || listens(port));
    Some((server, port))
}

/// One request of plain HTTP, enough to make a bucket and put an object.
fn put(port: u16, path: &str, body: &[u8]) {
    use std::io::{Read, Write};
    let mut stream = std::net::TcpStream::connect(("127.0.0.1", port)).unwrap();
    let head = format!(
        "PUT {path} HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Length: {}\r\nConnection: close\r\n\
         Authorization: AWS4-HMAC-SHA256 Credential=a/20260101/us-east-1/s3/aws4_request\r\n\r\n",
        body.len()
    );
    stream.write_all(head.as_bytes()).unwrap();
    stream.write_all(body).unwrap();
    let mut answer = String::new();
    stream.read_to_string(&mut answer).unwrap();
    assert!(answer.starts_with("HTTP/1.1 200"), "{path}: {answer}");
}

#[test]
fn recordings_lists_and_results_may_lie_in_a_bucket() {
    let Some((_server, port)) = server() else {
        println!("SKIPPED: python3 with moto.server is not installed");
        return;
    };
    put(port, "/archive", b"");
    for i in 0..5 {
        put(port, &format!("/archive/2026/unit-{i}.csv"), recording(i, 1000).as_bytes());
    }
    put(port, "/archive/2026/broken.csv", b"no recording");
    let with = |args: &[&str]| {
        let mut run = command(args);
        run.env("AWS_ENDPOINT", format!("http://127.0.0.1:{port}")).env("AWS_ALLOW_HTTP", "true");
        run.env("AWS_ACCESS_KEY_ID", "a").env("AWS_SECRET_ACCESS_KEY", "b").env("AWS_REGION", "us-east-1");
        run.output().unwrap()
    };
    let listed = with(&["list", "s3://archive/2026", "--out", "s3://archive/jobs"]);
    assert!(said(&listed).starts_with("6 recordings"), "{}", said(&listed));
    let args = [
        "run",
        "SELECT sagnac_analyze(uri) FROM jobs",
        "--jobs",
        "s3://archive/jobs",
        "--out",
        "s3://archive/results",
        "--portion",
        "2",
    ];
    let done = with(&args);
    assert_eq!(done.status.code(), Some(1), "{}", said(&done));
    assert!(said(&done).starts_with("6 recordings: 5 results, 1 errors"), "{}", said(&done));
    assert!(said(&with(&args)).starts_with("0 recordings"));
    let sql = "SELECT uri, serial, error_kind, strpos(result_json, 's3://archive/2026/unit') > 0 AS named, \
               strpos(result_json, 'sagnac-archive-') > 0 AS copy FROM results ORDER BY uri";
    let rows = with(&["query", sql, "--results", "s3://archive/results", "--csv"]);
    let rows = String::from_utf8(rows.stdout).unwrap();
    let rows: Vec<&str> = rows.lines().skip(1).collect();
    assert_eq!(rows.len(), 6, "{rows:?}");
    assert!(rows[0].starts_with("s3://archive/2026/broken.csv,,"), "{rows:?}");
    assert!(rows[1..].iter().all(|r| r.ends_with(",,true,false")), "{rows:?}");
}
