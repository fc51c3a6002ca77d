//! Paths, names, fields and files that want something else than a test.

use super::{Bench, form};
use crate::support::root;
use serde_json::json;
use std::fs;
use std::path::Path;

const FIELDS: [(&str, &str); 3] =
    [("serial", "SN-1"), ("procedure", "quick.toml"), ("limits", "quick-limits.toml")];

#[test]
fn recordings_lie_below_the_folders_wherever_a_name_leads() {
    let bench = Bench::new();
    fs::write(bench.at("secret.csv"), "time_s,rate_deg_h\n0,1\n").unwrap();
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink(bench.at("secret.csv"), bench.at("in/link.csv")).unwrap();
        std::os::unix::fs::symlink(bench.folder(), bench.at("in/out")).unwrap();
        std::os::unix::fs::symlink("/etc", bench.at("in/etc")).unwrap();
    }
    let server = bench.start(&[]);
    let absolute = bench.at("secret.csv").display().to_string();
    let climbing = bench.at("in/../secret.csv").display().to_string();
    let names = [
        "../secret.csv",
        "in/../secret.csv",
        "in/../../etc/passwd",
        "/etc/passwd",
        "etc/passwd",
        "link.csv",
        "in/link.csv",
        "out/secret.csv",
        "in/out/secret.csv",
        "./../secret.csv",
        "..\\secret.csv",
        "in/%2e%2e/secret.csv",
        "/proc/self/environ",
        "in\u{0}/../secret.csv",
        "//etc/passwd",
        "file:///etc/passwd",
        "~/.ssh/id_ed25519",
        "*.csv",
        "in",
        "",
        &absolute,
        &climbing,
    ];
    for name in names {
        let order = json!({ "serial": "SN-1", "recording": name, "procedure": "quick.toml" });
        let answer = server.post("/api/v1/runs", &order);
        assert!([403, 422].contains(&answer.status), "{name:?}: {answer:?}");
        let body = answer.body.to_lowercase();
        assert!(!body.contains("root:") && !body.contains("rate_deg_h"), "{name}: {answer:?}");
    }
    // Of a file outside, nothing is told, not even whether it is there.
    let [there, not_there] = ["/etc/passwd", "/etc/none"].map(|name| {
        let order = json!({ "serial": "SN-1", "recording": name, "procedure": "quick.toml" });
        server.post("/api/v1/runs", &order)
    });
    assert_eq!((there.status, there.body.replace("passwd", "none")), (not_there.status, not_there.body));
    assert!(server.get("/api/v1/runs").json()["runs"].as_array().unwrap().is_empty());
    let listed = server.get("/api/v1/recordings").body;
    assert!(!listed.contains("secret") && !listed.contains("link") && !listed.contains("passwd"), "{listed}");
}

#[test]
fn procedures_and_limits_are_those_that_are_offered() {
    let bench = Bench::new();
    fs::write(bench.at("in/evil.toml"), "format = \"procedure/1\"\n").unwrap();
    let server = bench.start(&[]);
    let evil = bench.at("in/evil.toml").display().to_string();
    for name in ["../in/evil.toml", &evil, "in/evil.toml", "--help", "-", "/etc/passwd", "none", "quick"] {
        let mut order = bench.order("SN-1");
        order["procedure"] = json!(name);
        assert_eq!(server.post("/api/v1/runs", &order).status, 422, "{name}");
        let mut order = bench.order("SN-1");
        order["limits"] = json!(name);
        assert_eq!(server.post("/api/v1/runs", &order).status, 422, "{name}");
    }
    for (body, expected) in [
        ("", 400),
        ("[]", 422),
        ("{", 400),
        ("null", 400),
        ("{\"serial\": 1}", 400),
        ("{\"serial\": \"a\", \"path\": \"/etc/passwd\"}", 400),
        ("{\"serial\":\"a\",\"serial\":\"b\"}", 400),
    ] {
        let heads = [("authorization", server.bearer()), ("content-type", "application/json".to_owned())];
        let heads = heads.each_ref().map(|(name, value)| (*name, value.as_str()));
        let status = server.ask("POST", "/api/v1/runs", &heads, body.as_bytes()).status;
        assert_eq!(status, expected, "{body}");
    }
    let mut order = bench.order("SN-1");
    order["lot"] = json!("x".repeat(70_000));
    assert_eq!(server.post("/api/v1/runs", &order).status, 413);
}

#[test]
fn what_a_client_calls_something_is_only_shown() {
    let bench = Bench::new();
    let server = bench.start(&[]);
    let recording = fs::read(&bench.quick.recording).unwrap();
    let serial = "--out=/tmp/x <script>alert(1)</script> ../.. \"';&";
    let fields = [("serial", serial), FIELDS[1], FIELDS[2], ("lot", "<b>"), ("reason", "{{ 7 * 7 }}")];
    let mut ids = vec![];
    for name in [
        "../../../etc/cron.d/x",
        "/etc/passwd",
        "a<img src=x onerror=alert(1)>.csv",
        "*.csv",
        "..",
        "-rf.csv",
        "con.csv",
    ] {
        let answer = server.form("/api/v1/runs", &fields, Some((name, &recording)));
        assert_eq!(answer.status, 202, "{name}: {answer:?}");
        ids.push(answer.json()["id"].as_str().unwrap().to_owned());
    }
    for id in &ids {
        let run = server.ended(id);
        assert_eq!((&run["verdict"], &run["serial"]), (&json!("pass"), &json!(serial)), "{run}");
        let page = server.page(&format!("/?run={id}"), "en").body;
        assert!(
            !page.contains("<script>alert")
                && !page.contains("<img src=x")
                && page.contains("&lt;script&gt;"),
            "{page}"
        );
    }
    let unit = server.get("/api/v1/runs?limit=1").json();
    assert_eq!(unit["runs"][0]["reason"], "{{ 7 * 7 }}");
    let page = server.page("/units", "en").body;
    assert!(!page.contains("<script>alert") && page.contains("/units/--out%3D"), "{page}");
    // Every upload lies in a folder of its own with a random name, and nowhere else.
    for entry in fs::read_dir(bench.at("data/uploads")).unwrap().flatten() {
        let name = entry.file_name().into_string().unwrap();
        assert!(name.len() == 32 && name.bytes().all(|b| b.is_ascii_hexdigit()), "{name}");
        let files: Vec<_> = fs::read_dir(entry.path()).unwrap().flatten().map(|f| f.file_name()).collect();
        assert!(files.len() == 1 && files[0].to_string_lossy().starts_with("recording"), "{files:?}");
    }
}

#[test]
fn results_give_no_file_but_their_own() {
    let bench = Bench::new();
    let server = bench.start(&[]);
    let id = server.order(&bench.order("SN-1"));
    server.ended(&id);
    let paths = [
        "../queue.jsonl",
        "..%2fqueue.jsonl",
        "%2e%2e/queue.jsonl",
        "%2e%2e%2fqueue.jsonl",
        "figures/../../../queue.jsonl",
        "none",
        "figures",
        "%2fetc%2fpasswd",
        "..%5cqueue.jsonl",
        "%00",
        "",
    ];
    for path in paths {
        let answer = server.get(&format!("/api/v1/results/{id}/{path}"));
        assert!([400, 404].contains(&answer.status), "{path}: {answer:?}");
        assert!(!answer.body.contains("serve-queue/1") && !answer.body.contains("root:"), "{path}");
    }
    for other in ["..", ".", "%2e%2e", "none"] {
        assert_eq!(server.get(&format!("/api/v1/results/{other}/result.json")).status, 404, "{other}");
    }
    assert_eq!(server.get("/assets/..%2f..%2fCargo.toml").status, 404);
}

#[test]
fn uploads_are_bounded_and_what_is_refused_leaves_nothing() {
    let bench = Bench::new();
    let server = bench.start(&["--max-upload", "1", "--upload-quota", "2"]);
    let count = || fs::read_dir(bench.at("data/uploads")).unwrap().count();
    let large = vec![b'1'; (1 << 20) + 1];
    let refused = server.form("/api/v1/runs", &FIELDS, Some(("a.csv", &large)));
    assert_eq!((refused.status, count()), (413, 0), "{refused:?}");
    let huge = vec![b'1'; 3 << 20];
    assert_eq!((server.form("/api/v1/runs", &FIELDS, Some(("a.csv", &huge))).status, count()), (413, 0));
    // What the order lacks is said after the upload, and the upload is gone.
    let none = server.form("/api/v1/runs", &FIELDS[..1], Some(("a.csv", b"1")));
    assert_eq!((none.status, count()), (422, 0), "{none:?}");
    let most = vec![b'1'; 1_000_000];
    for _ in 0..2 {
        assert_eq!(server.form("/api/v1/runs", &FIELDS, Some(("a.csv", &most))).status, 202);
    }
    let full = server.form("/api/v1/runs", &FIELDS, Some(("a.csv", &most)));
    assert_eq!((full.status, full.json()["error"].as_str(), count()), (507, Some("quota"), 2), "{full:?}");
    // What is cut or malformed is no order.
    let (kind, body) = form(&FIELDS, Some(("a.csv", b"1,2\n")));
    let heads = [("authorization", server.bearer()), ("content-type", kind.clone())];
    let heads = heads.each_ref().map(|(name, value)| (*name, value.as_str()));
    let cut = &body[..body.len() - 20];
    assert_eq!(server.ask("POST", "/api/v1/runs", &heads, cut).status, 400);
    let no_edge = [heads[0], ("content-type", "multipart/form-data")];
    assert_eq!(server.ask("POST", "/api/v1/runs", &no_edge, &body).status, 400);
    let many: Vec<(String, String)> = (0..100).map(|i| (format!("f{i}"), String::new())).collect();
    let many: Vec<(&str, &str)> = many.iter().map(|(n, v)| (n.as_str(), v.as_str())).collect();
    assert_eq!(server.form("/api/v1/runs", &many, None).status, 400);
    assert_eq!(server.form("/api/v1/runs", &[("unknown", "x")], None).status, 400);
    assert_eq!(count(), 2);
    // A quota counts what an earlier server took.
    drop(server);
    let server = bench.start(&["--max-upload", "1", "--upload-quota", "2"]);
    assert_eq!(server.form("/api/v1/runs", &FIELDS, Some(("a.csv", &most))).status, 507);
}

/// Files below a folder, in their order.
fn files(folder: &Path, found: &mut Vec<std::path::PathBuf>) {
    let mut entries: Vec<_> = fs::read_dir(folder).unwrap().flatten().map(|e| e.path()).collect();
    entries.sort();
    for path in entries {
        if path.is_dir() { files(&path, found) } else { found.push(path) }
    }
}

#[test]
fn broken_recordings_end_as_tests_and_never_end_the_server() {
    let bench = Bench::new();
    let server = bench.start(&[]);
    let whole = fs::read(&bench.quick.recording).unwrap();
    let mut broken: Vec<(String, Vec<u8>)> = vec![
        ("empty.csv".to_owned(), vec![]),
        ("cut.csv".to_owned(), whole[..whole.len() / 2 + 3].to_vec()),
        ("zeros.csv".to_owned(), vec![0; 4096]),
        ("bomb.csv.gz".to_owned(), vec![0x1f, 0x8b, 8, 0, 0, 0, 0, 0, 0, 3, 0xff, 0xff, 0xff]),
        ("x.parquet".to_owned(), b"PAR1\xff\xff\xff\x7fPAR1".to_vec()),
        ("x.mcap".to_owned(), b"\x89MCAP0\r\n\xff\xff\xff\xff\xff".to_vec()),
        (
            "manifest.toml".to_owned(),
            b"format = \"recording/1\"\n[[part]]\nfile = \"/etc/passwd\"\n".to_vec(),
        ),
        (
            "up.toml".to_owned(),
            b"format = \"recording/1\"\n[[part]]\nfile = \"../../queue.jsonl\"\n".to_vec(),
        ),
    ];
    let mut corpus = vec![];
    files(&root().join("tests/it/bad_files"), &mut corpus);
    let data = corpus.into_iter().filter(|path| path.extension().is_none_or(|e| e != "rs"));
    broken.extend(
        data.take(12).map(|p| (p.file_name().unwrap().to_string_lossy().into_owned(), fs::read(&p).unwrap())),
    );
    let mut ids = vec![];
    for (name, bytes) in &broken {
        let answer = server.form("/api/v1/runs", &FIELDS, Some((name, bytes)));
        assert_eq!(answer.status, 202, "{name}: {answer:?}");
        ids.push((name, answer.json()["id"].as_str().unwrap().to_owned()));
    }
    for (name, id) in ids {
        let run = server.ended(&id);
        assert!(run["verdict"] != "pass" && run["state"] != "queued", "{name}: {run}");
        let told = run.to_string();
        assert!(
            !told.contains("root:") && !told.contains("serve-queue/1") && !told.contains("panicked"),
            "{name}: {run}"
        );
    }
    assert_eq!(server.ended(&server.order(&bench.order("SN-1")))["verdict"], "pass");
}
