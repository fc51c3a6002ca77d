//! The rules of who may ask for what, each by raw requests.

use super::flow::head_of;
use super::{Bench, Server, answer, form, log};
use serde_json::json;
use std::io::{Read, Write};

/// A request that orders a test, with heads of one's own.
fn order(server: &Server, heads: &[(&str, &str)]) -> u16 {
    let body =
        json!({ "serial": "SN-1", "recording": "in/20270301_SN-1_static.csv", "procedure": "quick.toml" });
    server.ask("POST", "/api/v1/runs", heads, body.to_string().as_bytes()).status
}

/// Number of tests that were ordered.
fn ordered(server: &Server) -> usize {
    server.get("/api/v1/runs").json()["runs"].as_array().unwrap().len()
}

#[test]
fn a_foreign_host_is_refused_first_whatever_the_method() {
    let bench = Bench::new();
    let server = bench.start(&[]);
    let bearer = server.bearer();
    for method in ["GET", "HEAD", "POST", "PUT", "DELETE", "OPTIONS", "PATCH"] {
        for path in ["/", "/api/v1/runs", "/healthz", "/assets/bench.css", "/none"] {
            for host in ["evil.example", "127.0.0.1", "127.0.0.1:1", "localhost.evil.example", ""] {
                let answer = server.ask(method, path, &[("host", host), ("authorization", &bearer)], b"");
                assert_eq!(answer.status, 421, "{method} {path} {host}: {answer:?}");
            }
        }
    }
    let port = server.port;
    for own in [format!("localhost:{port}"), format!("127.0.0.1:{port}"), format!("[::1]:{port}")] {
        assert_eq!(server.ask("GET", "/healthz", &[("host", &own)], b"").status, 200, "{own}");
    }
    // Two hosts, none, and another one in the target.
    for raw in [
        format!(
            "GET /healthz HTTP/1.1\r\nhost: localhost:{port}\r\nhost: evil.example\r\nconnection: close\r\n\r\n"
        ),
        "GET /healthz HTTP/1.1\r\nconnection: close\r\n\r\n".to_owned(),
        "GET /healthz HTTP/1.0\r\n\r\n".to_owned(),
        format!(
            "GET http://evil.example/healthz HTTP/1.1\r\nhost: localhost:{port}\r\nconnection: close\r\n\r\n"
        ),
    ] {
        let status = server.raw(raw.as_bytes()).status;
        assert!([400, 421].contains(&status), "{raw}: {status}");
    }
}

#[test]
fn what_changes_something_and_streams_are_not_for_foreign_pages() {
    let bench = Bench::new();
    let server = bench.start(&[]);
    let (bearer, kind) = (server.bearer(), ("content-type", "application/json"));
    let with = |name: &str, value: &str| order(&server, &[("authorization", &bearer), kind, (name, value)]);
    for origin in ["http://evil.example", "null", "http://127.0.0.1", "https://127.0.0.1", ""] {
        assert_eq!(with("origin", origin), 403, "{origin}");
    }
    for site in ["cross-site", "same-site"] {
        assert_eq!(with("sec-fetch-site", site), 403, "{site}");
    }
    assert_eq!(ordered(&server), 0);
    let id = server.order(&bench.order("SN-1"));
    let events = format!("/api/v1/runs/{id}/events");
    for (name, value) in [("origin", "http://evil.example"), ("sec-fetch-site", "cross-site")] {
        let heads = [("authorization", bearer.as_str()), (name, value)];
        assert_eq!(server.ask("GET", &events, &heads, b"").status, 403);
        assert_eq!(server.ask("DELETE", &format!("/api/v1/runs/{id}"), &heads, b"").status, 403);
        let (kind, body) = form(&[("serial", "SN-1")], None);
        let heads = [heads[0], heads[1], ("content-type", &kind)];
        assert_eq!(server.ask("POST", "/bench", &heads, &body).status, 403);
        assert_eq!(server.ask("POST", "/session", &heads, &body).status, 403);
    }
    let own = format!("http://127.0.0.1:{}", server.port);
    assert_eq!(with("origin", &own), 202);
    assert_eq!(with("sec-fetch-site", "same-origin"), 202);
    assert_eq!(ordered(&server), 3);
}

#[test]
fn nothing_but_json_and_forms_with_parts_is_taken() {
    let bench = Bench::new();
    let server = bench.start(&[]);
    let bearer = server.bearer();
    for kind in [
        "text/plain",
        "application/x-www-form-urlencoded",
        "text/json",
        "application/jsonp",
        "",
        "application/json, text/plain",
    ] {
        assert_eq!(order(&server, &[("authorization", &bearer), ("content-type", kind)]), 415, "{kind}");
    }
    assert_eq!(order(&server, &[("authorization", &bearer)]), 415);
    for path in ["/bench", "/session", "/language", "/runs/x/cancel"] {
        let heads = [("authorization", bearer.as_str()), ("content-type", "text/plain")];
        assert_eq!(server.ask("POST", path, &heads, b"token=x").status, 415, "{path}");
    }
    let kind = ("content-type", "application/json; charset=utf-8");
    assert_eq!(order(&server, &[("authorization", &bearer), kind]), 202);
    // No answer to another origin's question, and no method that asks one.
    let asked = [("origin", "http://evil.example"), ("access-control-request-method", "POST")];
    for (method, path) in [("OPTIONS", "/api/v1/runs"), ("GET", "/healthz"), ("GET", "/api/v1/runs")] {
        let answer = server.ask(method, path, &asked, b"");
        assert!(answer.heads.iter().all(|(name, _)| !name.starts_with("access-control")), "{answer:?}");
    }
}

#[test]
fn no_get_changes_anything() {
    let bench = Bench::new();
    let server = bench.start(&["--jobs", "1"]);
    let id = server.order(&bench.order("SN-1"));
    server.ended(&id);
    for path in ["/bench", "/session", "/language", &format!("/runs/{id}/cancel")] {
        for method in ["GET", "HEAD"] {
            let status = server.ask(method, path, &[("authorization", &server.bearer())], b"").status;
            assert_eq!(status, 405, "{method} {path}");
        }
    }
    let query = "/api/v1/runs?serial=SN-9&recording=in/20270301_SN-1_static.csv&procedure=quick.toml";
    assert_eq!(server.get(query).status, 200);
    assert_eq!(ordered(&server), 1);
}

#[test]
fn without_the_token_there_is_a_sign_of_life_and_a_sign_in() {
    let bench = Bench::new();
    let server = bench.start(&[]);
    let id = server.order(&bench.order("SN-1"));
    let result = format!("/api/v1/results/{id}/result.json");
    server.ended(&id);
    let wrong = "0".repeat(64);
    let other_port = format!("sagnac_token_{}={}", server.port.wrapping_add(1), server.token);
    let tries: [Vec<(&str, String)>; 5] = [
        vec![],
        vec![("authorization", format!("Bearer {wrong}"))],
        vec![("authorization", format!("Bearer {}", &server.token[..63]))],
        vec![("cookie", format!("sagnac_token_{}={wrong}", server.port))],
        vec![("cookie", other_port)],
    ];
    for heads in &tries {
        let heads: Vec<(&str, &str)> = heads.iter().map(|(name, value)| (*name, value.as_str())).collect();
        let paths = [
            "/",
            "/units",
            "/lots",
            "/live",
            "/api/v1/runs",
            "/api/v1/openapi.json",
            "/api/v1/units/SN-1",
            &result,
            "/none",
        ];
        for path in paths {
            let answer = server.ask("GET", path, &heads, b"");
            assert_eq!(answer.status, 401, "{path} {heads:?}");
            assert!(!answer.body.contains("SN-1") && !answer.body.contains(&server.token), "{path}");
        }
        assert_eq!(order(&server, &[&heads[..], &[("content-type", "application/json")]].concat()), 401);
        assert_eq!(server.ask("DELETE", &format!("/api/v1/runs/{id}"), &heads, b"").status, 401);
    }
    // The token is text of 256 bits, and none of it is in an address.
    assert_eq!(server.token.len(), 64);
    assert_eq!(server.ask("GET", &format!("/?token={}", server.token), &[], b"").status, 401);
    for path in ["/healthz", "/api/v1/healthz", "/assets/bench.css", "/assets/bench.js"] {
        assert_eq!(server.ask("GET", path, &[], b"").status, 200, "{path}");
    }
}

#[test]
fn the_token_becomes_a_cookie_that_no_script_reads() {
    let bench = Bench::new();
    let server = bench.start(&[]);
    let sign_in = |token: &str| {
        let body = json!({ "token": token }).to_string();
        server.ask("POST", "/session", &[("content-type", "application/json")], body.as_bytes())
    };
    let given = sign_in(&server.token);
    assert_eq!(given.status, 204, "{given:?}");
    let cookie = given.head("set-cookie").unwrap();
    for part in ["HttpOnly", "SameSite=Strict", "Path=/"] {
        assert!(cookie.contains(part), "{cookie}");
    }
    let pair = cookie.split(';').next().unwrap();
    assert_eq!(server.ask("GET", "/", &[("cookie", pair)], b"").status, 200);
    for wrong in ["", "0", &server.token[1..], &format!("{}0", server.token)] {
        let answer = sign_in(wrong);
        assert_eq!((answer.status, answer.head("set-cookie")), (401, None), "{wrong}");
    }
    // The same without a script.
    let (kind, body) = form(&[("token", &server.token)], None);
    let by_form = server.ask("POST", "/session", &[("content-type", &kind)], &body);
    assert_eq!((by_form.status, by_form.head("location")), (303, Some("/")));
    // Each process has its own.
    let token = server.token.clone();
    drop(server);
    assert_ne!(bench.start(&[]).token, token);
}

#[test]
fn answers_say_what_a_browser_may_do_with_them() {
    let bench = Bench::new();
    let server = bench.start(&[]);
    let id = server.order(&bench.order("SN-1"));
    server.ended(&id);
    let result = |name: &str| format!("/api/v1/results/{id}/{name}");
    let paths = [
        "/",
        "/lots",
        "/none",
        "/api/v1/runs",
        "/assets/bench.js",
        "/healthz",
        &result("report.html"),
        &result("measurands.csv"),
    ];
    for path in paths {
        for answer in [server.get(path), server.ask("GET", path, &[], b"")] {
            let policy =
                answer.head("content-security-policy").unwrap_or_else(|| panic!("{path}: {answer:?}"));
            assert!(
                policy.contains("default-src 'none'") && policy.contains("frame-ancestors 'none'"),
                "{policy}"
            );
            assert_eq!(answer.head("x-content-type-options"), Some("nosniff"), "{path}");
            assert_eq!(answer.head("x-frame-options"), Some("DENY"), "{path}");
            assert_eq!(answer.head("cache-control"), Some("no-store"), "{path}");
            assert_eq!(answer.head("cross-origin-resource-policy"), Some("same-origin"), "{path}");
        }
    }
    let page = server.get("/");
    assert!(page.head("content-security-policy").unwrap().contains("script-src 'self'"));
    assert!(!page.body.contains("<script>") && !page.body.contains("onclick"), "{}", page.body);
}

#[test]
fn the_log_has_no_secret() {
    let bench = Bench::new();
    let server = bench.start(&[]);
    let body = json!({ "token": server.token }).to_string();
    server.ask("POST", "/session", &[("content-type", "application/json")], body.as_bytes());
    server.ask("GET", &format!("/?token={}", server.token), &[], b"");
    server.order(&bench.order("SN-1"));
    let log = log(bench.folder());
    assert!(
        log.contains("POST /session 204")
            && log.contains("GET / 401")
            && log.contains("POST /api/v1/runs 202"),
        "{log}"
    );
    assert!(!log.contains(&server.token) && !log.contains("SN-1"), "{log}");
}

#[test]
fn streams_and_connections_are_bounded() {
    let bench = Bench::new();
    let server = bench.start(&["--jobs", "1"]);
    // A test that does not begin: another process, as one that an earlier server left, holds its lock.
    let before: Vec<String> = (0..3).map(|_| server.order(&bench.order("SN-1"))).collect();
    let id = server.order(&bench.order("SN-1"));
    let folder = bench.at("data/running").join(&id);
    std::fs::create_dir_all(&folder).unwrap();
    let lock = std::fs::File::create(folder.join("lock")).unwrap();
    lock.try_lock().unwrap();
    before.iter().for_each(|id| assert_eq!(server.ended(id)["state"], "done"));
    let path = format!("/api/v1/runs/{id}/events");
    let mut streams = vec![];
    let refused = loop {
        let (stream, head) = head_of(&server, &path);
        if !head.starts_with("HTTP/1.1 200") {
            break head;
        }
        streams.push(stream);
        assert!(streams.len() < 100);
    };
    assert!(refused.starts_with("HTTP/1.1 503"), "{refused}");
    assert_eq!(streams.len(), 32);
    // One that is closed makes room.
    streams.pop();
    let began = std::time::Instant::now();
    while !head_of(&server, &path).1.starts_with("HTTP/1.1 200") {
        assert!(began.elapsed() < super::PATIENCE);
    }
    drop((streams, lock));
    assert_eq!(server.ended(&id)["verdict"], "pass");
    // Connections that say nothing: some are closed at once, and the server still answers when they are gone.
    let silent: Vec<_> = (0..160).map(|_| server.connect()).collect();
    let mut closed = 0;
    for stream in &silent {
        stream.set_read_timeout(Some(std::time::Duration::from_millis(20))).unwrap();
        let mut byte = [0];
        closed += usize::from((&*stream).read(&mut byte).is_ok_and(|read| read == 0));
    }
    assert!(closed >= 20, "{closed}");
    drop(silent);
    let began = std::time::Instant::now();
    loop {
        let mut stream = server.connect();
        let request =
            format!("GET /healthz HTTP/1.1\r\nhost: localhost:{}\r\nconnection: close\r\n\r\n", server.port);
        let _ = stream.write_all(request.as_bytes());
        let mut bytes = vec![];
        let _ = stream.read_to_end(&mut bytes);
        if answer(&bytes).status == 200 {
            break;
        }
        assert!(began.elapsed() < super::PATIENCE);
    }
    let (_stream, head) = head_of(&server, "/healthz");
    assert!(head.starts_with("HTTP/1.1 200"), "{head}");
}
