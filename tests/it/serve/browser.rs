//! The bench in a browser without a screen: signed in by the printed address, in both languages, wide and narrow.

use super::Bench;
use crate::report::browser::{browser, required};
use std::path::Path;
use std::process::Command;

/// Time that the browser gives the page and its script, ms.
const VIRTUAL_TIME_MS: u32 = 8000;

/// The page as the browser built it at an address, signed in before by the address with the token; `profile` keeps the cookie.
fn open(browser: &Path, profile: &Path, url: &str, size: &str) -> (String, String) {
    let output = Command::new(browser)
        .args([
            "--headless",
            "--no-sandbox",
            "--disable-gpu",
            "--no-first-run",
            "--disable-background-networking",
        ])
        .args(["--disable-component-update", "--disable-sync", "--enable-logging=stderr", "--v=0"])
        .arg(format!("--user-data-dir={}", profile.display()))
        .arg(format!("--window-size={size}"))
        .arg(format!("--virtual-time-budget={VIRTUAL_TIME_MS}"))
        .arg("--dump-dom")
        .arg(url)
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    (
        String::from_utf8_lossy(&output.stdout).into_owned(),
        String::from_utf8_lossy(&output.stderr).into_owned(),
    )
}

#[test]
fn the_bench_signs_in_and_shows_its_verdict() {
    let Some(browser) = browser() else { return required() };
    for (lang, word, heading) in [("en", "PASS", "Scan or type"), ("ru", "ГОДЕН", "Считайте или введите")]
    {
        let bench = Bench::new();
        let server = bench.start(&["--lang", lang]);
        let id = server.order(&bench.order("SN-1"));
        server.ended(&id);
        let profile = bench.at("profile");
        let address = format!("http://127.0.0.1:{}", server.port);
        for (size, page) in [("1600,900", String::new()), ("390,844", format!("?run={id}"))] {
            let url = format!("{address}/{page}#token={}", server.token);
            let (dom, log) = open(&browser, &profile, &url, size);
            assert!(dom.contains(heading), "{dom}\n{log}");
            assert!(!dom.contains(&server.token), "the token stands in the page");
            if !page.is_empty() {
                let verdict = dom.split("class=\"verdict pass\"").nth(1).unwrap_or_else(|| panic!("{dom}"));
                assert!(verdict.contains(word) && verdict.contains('✔'), "{verdict}");
            }
            // Nothing is blocked by the policy and no script fails; the first answer without the token is no error of the page.
            let complaints = log.lines().filter(|line| line.contains("CONSOLE") && !line.contains("401"));
            assert_eq!(complaints.collect::<Vec<_>>(), [""; 0]);
        }
    }
}
