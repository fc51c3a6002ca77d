//! What an operator and a program do: order a test, follow it, read its result.

use super::{Bench, Server};
use crate::support::{result, sagnac, sample};
use serde_json::{Value, json};
use std::fs;
use std::io::{Read, Write};

/// A result without what tells when, from where and by which command it was made.
fn figures(mut result: Value) -> Value {
    for name in ["session", "inputs", "recording"] {
        result[name] = Value::Null;
    }
    for name in ["path", "limits"] {
        result["procedure"][name] = Value::Null;
    }
    result
}

#[test]
fn an_upload_gives_the_result_of_the_command_line() {
    let bench = Bench::new();
    let server = bench.start(&[]);
    let path = sample("pass");
    let recording = fs::read(&path).unwrap();
    let fields = [("serial", "SN-0001"), ("procedure", "static-bias"), ("limits", "sample-unit")];
    let answer = server.form("/api/v1/runs", &fields, Some(("unit.csv", &recording)));
    assert_eq!(answer.status, 202, "{answer:?}");
    let id = answer.json()["id"].as_str().unwrap().to_owned();
    assert_eq!(answer.head("location"), Some(format!("/api/v1/runs/{id}").as_str()));
    let run = server.ended(&id);
    assert_eq!((&run["state"], &run["verdict"]), (&json!("done"), &json!("pass")), "{run}");
    assert_eq!(
        (&run["serial"], &run["recording"], &run["limits"]),
        (&json!("SN-0001"), &json!("unit.csv"), &json!("sample-unit"))
    );
    let args = [
        "run",
        "static-bias",
        &path,
        "--limits",
        "sample-unit",
        "--serial",
        "SN-0001",
        "--no-store",
        "--out",
        "own",
    ];
    assert_eq!(sagnac(bench.folder(), &args).code, 0);
    let own = result(&bench.at("own"));
    let served = server.get(run["result"].as_str().unwrap());
    assert_eq!(served.head("content-type"), Some("application/json"));
    assert_eq!(served.json()["measurands"].to_string(), own["measurands"].to_string());
    assert_eq!(figures(served.json()), figures(own));
    let report = server.get(run["report"].as_str().unwrap());
    assert!(report.body.contains("<strong>pass</strong>"), "{}", report.body.len());
    assert!(report.head("content-security-policy").unwrap().contains("form-action 'none'"));
    // The upload has a name of its own, and the client's name is only shown.
    let uploads: Vec<_> = fs::read_dir(bench.at("data/uploads")).unwrap().flatten().collect();
    assert_eq!(uploads.len(), 1);
    assert!(uploads[0].path().join("recording.csv").is_file());
}

#[test]
fn a_scan_finds_its_recording_and_the_verdict_stays() {
    let bench = Bench::new();
    let server = bench.start(&["--station", "bench 2"]);
    let fields =
        [("serial", "SN-2"), ("procedure", "quick.toml"), ("limits", "quick-limits.toml"), ("lot", "L1")];
    let ordered = server.form("/bench", &fields, None);
    assert_eq!(ordered.status, 303, "{ordered:?}");
    let place = ordered.head("location").unwrap().to_owned();
    let id = place.strip_prefix("/?run=").unwrap();
    let run = server.ended(id);
    assert_eq!(run["verdict"], "fail", "{run}");
    assert_eq!(run["recording"], "in/20270301_SN-2_static.csv");
    for (lang, word, part) in [("en", "FAIL", "exceeds the limit"), ("ru", "НЕ ГОДЕН", "больше нормы")]
    {
        let page = server.page(&place, lang);
        assert_eq!(page.status, 200);
        assert!(page.body.contains(&format!("lang=\"{lang}\"")) && page.body.contains("autofocus"));
        let verdict =
            page.body.split("class=\"verdict fail\"").nth(1).unwrap_or_else(|| panic!("{}", page.body));
        assert!(verdict.contains(word) && verdict.contains('✘'), "{verdict}");
        // One reason and one thing to do.
        assert_eq!(
            (verdict.matches("class=\"reason\"").count(), verdict.matches("class=\"next\"").count()),
            (1, 1)
        );
        assert!(verdict.contains(part), "{verdict}");
        assert!(verdict.contains("sagnac sign"));
        for other in ["/", "/units", "/units/SN-2", "/lots", "/live"] {
            let page = server.page(other, lang);
            assert_eq!(page.status, 200, "{other}");
            // A key without a text, or a value without a place.
            assert!(
                !page.body.contains("undefined") && !page.body.contains("page.bench"),
                "{other}: {}",
                page.body
            );
        }
    }
    // The next scan needs no more than its number: the test is that of the last one.
    let next = server.form("/bench", &[("serial", "SN-1")], None);
    assert_eq!(next.status, 303, "{next:?}");
    let run = server.ended(next.head("location").unwrap().strip_prefix("/?run=").unwrap());
    assert_eq!((&run["verdict"], &run["procedure"]), (&json!("pass"), &json!("quick")));
    let station = bench.at("data/results").join(run["id"].as_str().unwrap());
    assert_eq!(result(&station)["session"]["station"], "bench 2");
    let unknown = server.form("/bench", &[("serial", "SN-3")], None);
    assert_eq!(unknown.status, 422);
    assert!(
        unknown.body.contains("No recording has “SN-3” in its name")
            && unknown.body.contains("value=\"SN-3\"")
    );
}

#[test]
fn a_unit_has_its_attempts_and_a_lot_its_yield() {
    let bench = Bench::new();
    fs::write(
        bench.at("serve.toml"),
        "format = \"serve/1\"\n[[rule]]\npart = \"A-*\"\nprocedure = \"tests/quick.toml\"\nlimits = \"tests/quick-limits.toml\"\n",
    )
    .unwrap();
    let server = bench.start(&["--rules", "serve.toml"]);
    let by_part = |serial: &str, recording: &str, reason: Option<&str>| {
        let order = json!({
            "serial": serial, "part": "A-7", "lot": "L 1",
            "recording": format!("in/20270301_{recording}_static.csv"), "reason": reason,
        });
        server.ended(&server.order(&order))
    };
    assert_eq!(by_part("SN-7", "SN-2", None)["verdict"], "fail");
    assert_eq!(by_part("SN-7", "SN-1", Some("connector reseated"))["verdict"], "pass");
    assert_eq!(by_part("SN-8", "SN-1", None)["verdict"], "pass");
    let unit = server.get("/api/v1/units/SN-7").json();
    let verdicts: Vec<&Value> = unit["attempts"].as_array().unwrap().iter().map(|a| &a["verdict"]).collect();
    assert_eq!(verdicts, [&json!("fail"), &json!("pass")]);
    assert_eq!(unit["attempts"][1]["reason"], "connector reseated");
    let page = server.page("/units/SN-7", "en").body;
    assert!(
        page.contains("connector reseated")
            && page.contains("name=\"reason\"")
            && page.contains("not signed")
    );
    let found = server.ask("GET", "/units?serial=SN-7", &[("authorization", &server.bearer())], b"");
    assert_eq!((found.status, found.head("location")), (303, Some("/units/SN-7")));
    let lot = server.page("/lots?lot=L+1", "ru").body;
    assert!(lot.contains("50,0 %") && lot.contains("(1/2)"), "{lot}");
    assert!(lot.contains("Случайный угловой уход"), "{lot}");
    assert!(!server.page("/lots?lot=L+1&verdict=fail", "en").body.contains("units/SN-7"));
    assert_eq!(server.get("/api/v1/units/none").status, 404);
    let all = server.get("/api/v1/runs?serial=SN-7&limit=1").json();
    assert_eq!(all["runs"].as_array().unwrap().len(), 1);
    assert_eq!(server.get("/api/v1/procedures").json()["rules"][0]["part"], "A-*");
}

/// The numbers and names of the events in a stream.
fn events(stream: &str) -> Vec<(u64, String)> {
    let of = |block: &str, name: &str| {
        block.lines().find_map(|line| Some(line.strip_prefix(name)?.strip_prefix(':')?.trim().to_owned()))
    };
    stream
        .split("\n\n")
        .filter_map(|block| Some((of(block, "id")?.parse().ok()?, of(block, "event")?)))
        .collect()
}

#[test]
fn events_have_numbers_and_are_taken_up_again() {
    let bench = Bench::new();
    let server = bench.start(&["--jobs", "1"]);
    let order = json!({
        "serial": "SN-1", "recording": "in/20270301_SN-1_static.csv", "procedure": "quick.toml", "limits": "quick-limits.toml",
    });
    let first = server.order(&order);
    let id = server.order(&order);
    // The stream is opened while the test waits, and ends with it.
    let stream = server.get(&format!("/api/v1/runs/{id}/events"));
    assert_eq!(stream.head("content-type"), Some("text/event-stream"));
    let all = events(&stream.body);
    assert!(all.windows(2).all(|pair| pair[1].0 == pair[0].0 + 1), "{all:?}");
    let names: Vec<&str> = all.iter().map(|(_, name)| name.as_str()).collect();
    assert_eq!((names[0], *names.last().unwrap()), ("state", "ended"), "{names:?}");
    assert!(stream.body.contains("\"verdict\":\"pass\""), "{}", stream.body);
    let last = all.last().unwrap().0;
    let again = |after: &str| {
        let heads = [("authorization", server.bearer()), ("last-event-id", after.to_owned())];
        let heads = heads.each_ref().map(|(name, value)| (*name, value.as_str()));
        events(&server.ask("GET", &format!("/api/v1/runs/{id}/events"), &heads, b"").body)
    };
    assert_eq!(again(&(last - 1).to_string()), [(last, "ended".to_owned())]);
    assert_eq!(again(&last.to_string()), []);
    // A number of another server, and none at all.
    assert!(!again("999999").is_empty() && !again("x").is_empty());
    assert_eq!(server.ended(&first)["verdict"], "pass");
    assert_eq!(server.get("/api/v1/runs/none/events").status, 404);
}

#[test]
fn a_test_that_waits_or_runs_is_cancelled() {
    let bench = Bench::new();
    let server = bench.start(&["--jobs", "1"]);
    let long = json!({ "serial": "SN-1", "recording": "in/pipe.csv", "procedure": "quick.toml" });
    fs::write(bench.at("in/pipe.csv"), fs::read(sample("pass")).unwrap()).unwrap();
    let ids: Vec<String> = (0..3).map(|_| server.order(&long)).collect();
    let cancel = |id: &str| {
        server
            .ask("DELETE", &format!("/api/v1/runs/{id}"), &[("authorization", &server.bearer())], b"")
            .status
    };
    assert_eq!(cancel(&ids[2]), 202);
    assert_eq!(server.run(&ids[2])["state"], "cancelled");
    assert_eq!(cancel(&ids[2]), 409);
    assert_eq!(cancel("none"), 404);
    let first = cancel(&ids[0]);
    let run = server.ended(&ids[0]);
    // It may have ended before the request came.
    assert!(first == 409 || run["state"] == "cancelled" || run["state"] == "done", "{first} {run}");
    assert_eq!(server.ended(&ids[1])["state"], "done");
    let left: Vec<_> = fs::read_dir(bench.at("data/running")).unwrap().flatten().collect();
    assert!(left.len() <= 1, "{left:?}");
    if run["state"] == "cancelled" {
        assert!(!bench.at("data/results").join(&ids[0]).exists());
    }
}

#[test]
fn a_recording_that_cannot_be_read_is_told_in_words() {
    let bench = Bench::new();
    let server = bench.start(&[]);
    fs::write(bench.at("in/20270301_SN-5_static.csv"), "no,recording\na,b\n").unwrap();
    let run = server.ended(&server.order(&bench.order("SN-5")));
    assert_ne!(run["verdict"], "pass");
    let told = format!("{}{}", run["said"], run["reasons"]);
    assert!(told.contains("20270301_SN-5_static.csv") || told.contains("column"), "{run}");
    let page = server.page(&format!("/?run={}", run["id"].as_str().unwrap()), "ru").body;
    assert!(page.contains("НЕ ИСПЫТАН"), "{page}");
}

#[test]
fn the_interface_describes_itself_and_answers_as_described() {
    let bench = Bench::new();
    let server = bench.start(&[]);
    let described = server.get("/api/v1/openapi.json").json();
    assert_eq!(described["openapi"], "3.1.0");
    let run = server.ended(&server.order(&bench.order("SN-1")));
    let known = described["components"]["schemas"]["Run"]["properties"].as_object().unwrap();
    let given = run.as_object().unwrap();
    assert_eq!(given.keys().collect::<std::collections::BTreeSet<_>>(), known.keys().collect());
    for name in described["components"]["schemas"]["Run"]["required"].as_array().unwrap() {
        assert!(!given[name.as_str().unwrap()].is_null(), "{name}");
    }
    for (path, operations) in described["paths"].as_object().unwrap() {
        for method in operations.as_object().unwrap().keys().filter(|m| *m == "get") {
            let path = path.replace("{id}", run["id"].as_str().unwrap()).replace("{file}", "result.json");
            let path = path.replace("{serial}", "SN-1");
            assert_eq!(server.get(&format!("/api/v1{path}")).status, 200, "{method} {path}");
        }
    }
}

#[test]
fn charts_come_from_the_store_that_keeps_the_results() {
    let bench = Bench::new();
    assert_eq!(sagnac(bench.folder(), &["store", "init", "kept"]).code, 0);
    let server = bench.start(&["--store", "kept"]);
    assert_eq!(server.ended(&server.order(&bench.order("SN-1")))["verdict"], "pass");
    let page = server.page("/units/SN-1", "en").body;
    assert!(page.contains("SN-1/charts\""), "{page}");
    let charts = server.page("/units/SN-1/charts", "en");
    assert_eq!(charts.status, 200, "{charts:?}");
    assert!(charts.body.contains("<html") && charts.body.contains("SN-1"));
    assert_eq!(server.page("/units/none/charts", "en").status, 404);
}

/// Reads the head of an answer, and leaves its body.
pub fn head_of(server: &Server, path: &str) -> (std::net::TcpStream, String) {
    let mut stream = server.connect();
    let request = format!(
        "GET {path} HTTP/1.1\r\nhost: 127.0.0.1:{}\r\nauthorization: {}\r\n\r\n",
        server.port,
        server.bearer()
    );
    stream.write_all(request.as_bytes()).unwrap();
    let mut head = vec![];
    let mut byte = [0];
    while !head.ends_with(b"\r\n\r\n") && stream.read(&mut byte).is_ok_and(|read| read == 1) {
        head.push(byte[0]);
    }
    (stream, String::from_utf8_lossy(&head).into_owned())
}
