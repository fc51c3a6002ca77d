//! Where a server may listen, and what keeps it from starting.

use super::{Bench, command};
use crate::support::{Said, sagnac};
use std::fs;

fn starts(bench: &Bench, more: &[&str]) -> Said {
    let output = command(bench.folder(), more).output().unwrap();
    Said {
        code: output.status.code().unwrap_or(-1),
        out: String::from_utf8(output.stdout).unwrap(),
        err: String::from_utf8(output.stderr).unwrap(),
    }
}

#[test]
fn beyond_this_computer_a_proxy_with_a_certificate_is_declared() {
    let bench = Bench::new();
    for address in ["0.0.0.0", "::", "192.0.2.1"] {
        let said = starts(&bench, &["--listen", address]);
        assert_eq!((said.code, said.out.as_str()), (2, ""), "{said:?}");
        assert!(said.err.contains(address) && said.err.contains("--behind-proxy"), "{}", said.err);
    }
    for url in ["http://bench.example.com", "bench.example.com", "https://", "https://a/b", "https://a b"] {
        let said = starts(&bench, &["--listen", "0.0.0.0", "--behind-proxy", url]);
        assert_eq!((said.code, said.out.as_str()), (2, ""), "{said:?}");
    }
    // Nothing was made for a server that did not start.
    assert!(!bench.at("data").exists());
    let said = starts(&bench, &["--listen", "0.0.0.0", "--lang", "ru"]);
    assert!(said.err.contains("доступен с других компьютеров"), "{}", said.err);
}

#[test]
fn behind_a_proxy_only_its_name_is_answered_and_the_token_is_needed() {
    let bench = Bench::new();
    // The proxy knows the port, which the printed address does not tell: one that is free now.
    let free = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let port = free.local_addr().unwrap().port();
    drop(free);
    let (port_text, proxy) = (port.to_string(), "https://bench.example.com");
    let mut server = bench.start(&["--port", &port_text, "--listen", "0.0.0.0", "--behind-proxy", proxy]);
    server.port = port;
    assert_eq!(server.ask("GET", "/healthz", &[("host", "bench.example.com")], b"").status, 200);
    assert_eq!(server.ask("GET", "/healthz", &[], b"").status, 421);
    assert_eq!(server.ask("GET", "/", &[("host", "bench.example.com")], b"").status, 401);
    let body = format!("{{\"token\":\"{}\"}}", server.token);
    let heads = [
        ("host", "bench.example.com"),
        ("content-type", "application/json"),
        ("origin", "https://bench.example.com"),
    ];
    let cookie = server.ask("POST", "/session", &heads, body.as_bytes());
    assert!(cookie.head("set-cookie").unwrap().contains("; Secure"), "{cookie:?}");
    assert!(cookie.head("set-cookie").unwrap().starts_with("__Host-"), "{cookie:?}");
    let foreign = [heads[0], heads[1], ("origin", "http://bench.example.com")];
    assert_eq!(server.ask("POST", "/session", &foreign, body.as_bytes()).status, 403);
}

#[test]
#[cfg(unix)]
fn all_rights_are_refused() {
    use std::os::unix::fs::MetadataExt;
    let bench = Bench::new();
    let is_root = fs::metadata(bench.folder()).unwrap().uid() == 0;
    if !is_root {
        eprintln!("SKIPPED: only who has all rights can test that they are refused");
        return;
    }
    let said = sagnac(bench.folder(), &["serve", "--data", "data", "--port", "0"]);
    assert_eq!((said.code, said.out.as_str()), (2, ""), "{said:?}");
    assert!(said.err.contains("--allow-root"), "{}", said.err);
    assert!(!bench.at("data").exists());
}

#[test]
fn one_server_has_a_data_folder_and_damage_is_told() {
    let bench = Bench::new();
    let server = bench.start(&[]);
    let second = starts(&bench, &[]);
    assert_eq!(second.code, 2);
    assert!(second.err.contains("another `sagnac serve`"), "{}", second.err);
    drop(server);
    let queue = bench.at("data/queue.jsonl");
    let whole = fs::read_to_string(&queue).unwrap();
    fs::write(&queue, format!("{whole}no line\n")).unwrap();
    let damaged = starts(&bench, &[]);
    assert!(
        damaged.code == 2 && damaged.err.contains("queue.jsonl") && damaged.err.contains("line 2"),
        "{damaged:?}"
    );
    fs::write(&queue, whole).unwrap();
    for (options, part) in [
        (vec!["--recordings", "none"], "none"),
        (vec!["--procedures", "none"], "none"),
        (vec!["--store", "none"], "none"),
        (vec!["--rules", "none.toml"], "none.toml"),
    ] {
        let said = starts(&bench, &options);
        assert!(said.code == 2 && said.err.contains(part), "{options:?}: {said:?}");
    }
    fs::write(bench.at("serve.toml"), "format = \"serve/1\"\n[[rule]]\npart = \"A\"\nprocedures = \"x\"\n")
        .unwrap();
    let wrong = starts(&bench, &["--rules", "serve.toml"]);
    assert!(wrong.code == 2 && wrong.err.contains("serve.toml:4"), "{wrong:?}");
    bench.start(&[]);
}

#[test]
#[cfg(unix)]
fn the_data_folder_is_the_users_own() {
    use std::os::unix::fs::PermissionsExt;
    let bench = Bench::new();
    let _server = bench.start(&[]);
    assert_eq!(fs::metadata(bench.at("data")).unwrap().permissions().mode() & 0o077, 0);
}
