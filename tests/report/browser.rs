//! A report opened in a browser without a screen: no network request, no complaint on the console, the verdict shown.

use crate::fixture;
use sagnac::i18n::Lang;
use sagnac::report::{Renderer, render_html};
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;

const BROWSERS: &[&str] = &["chromium", "chromium-browser", "google-chrome", "google-chrome-stable"];

fn browser() -> Option<PathBuf> {
    let path = std::env::var_os("PATH")?;
    std::env::split_paths(&path).flat_map(|d| BROWSERS.iter().map(move |b| d.join(b))).find(|p| p.is_file())
}

/// The page as the browser built it, what it wrote to its log, and its log of the network.
fn open(browser: &Path, page: &Path, folder: &Path) -> (String, String, String) {
    let netlog = folder.join("net.json");
    let output = Command::new(browser)
        .args([
            "--headless",
            "--no-sandbox",
            "--disable-gpu",
            "--disable-quic",
            "--no-first-run",
            "--disable-background-networking",
            "--disable-component-update",
            "--disable-sync",
            "--enable-logging=stderr",
            "--v=0",
        ])
        .arg(format!("--user-data-dir={}", folder.join("profile").display()))
        .arg(format!("--log-net-log={}", netlog.display()))
        .arg("--dump-dom")
        .arg(format!("file://{}", page.display()))
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    (
        String::from_utf8_lossy(&output.stdout).into_owned(),
        String::from_utf8_lossy(&output.stderr).into_owned(),
        std::fs::read_to_string(&netlog).unwrap_or_default(),
    )
}

/// Requests that pages made: the browser's own housekeeping has no page as its initiator.
fn requests_of_pages(netlog: &str) -> Vec<String> {
    let mut lines: Vec<String> = netlog
        .lines()
        .filter(|l| l.contains("\"initiator\"") && !l.contains("\"initiator\":\"not an origin\""))
        .filter(|l| l.contains("\"url\":\"http") || l.contains("\"url\":\"ws"))
        .map(str::to_owned)
        .collect();
    lines.dedup();
    lines
}

#[test]
fn a_report_opens_quietly_in_a_browser() {
    let Some(browser) = browser() else {
        assert!(
            std::env::var_os("SAGNAC_REQUIRE_BROWSER").is_none_or(|v| v != "1"),
            "no browser found; looked for {}",
            BROWSERS.join(", ")
        );
        let _ = writeln!(std::io::stderr(), "SKIPPED: no browser found; looked for {}", BROWSERS.join(", "));
        return;
    };
    for (record, word) in [(fixture::three_channels(), "fail"), (fixture::error(), "error")] {
        let folder = tempfile::tempdir().unwrap();
        let page = folder.path().join("report.html");
        let html = render_html(&record, &fixture::figures::all(), Lang::En, &Renderer::new()).unwrap();
        // Names of XML dialects are no requests; nothing else may look like one.
        let links = html.replace("http://www.w3.org/2000/svg", "");
        assert!(
            !links.contains("http://") && !links.contains("https://"),
            "the report refers to the network"
        );
        std::fs::write(&page, &html).unwrap();
        let (dom, log, netlog) = open(&browser, &page, folder.path());
        assert!(dom.contains(&format!("<strong>{word}</strong>")), "the verdict is not in the page");
        assert_eq!(dom.matches("<svg").count(), 5);
        assert!(!log.contains("CONSOLE"), "{log}");
        assert!(netlog.contains("\"events\""), "the browser kept no log of the network");
        assert!(requests_of_pages(&netlog).is_empty(), "{:?}", requests_of_pages(&netlog));
    }
}

#[test]
fn the_watch_for_complaints_and_requests_is_awake() {
    let Some(browser) = browser() else {
        let _ = writeln!(std::io::stderr(), "SKIPPED: no browser found; looked for {}", BROWSERS.join(", "));
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let page = folder.path().join("loud.html");
    std::fs::write(
        &page,
        "<!DOCTYPE html><p>x</p><img src=\"http://127.0.0.1:9/x.png\"><script>console.error('loud')</script>",
    )
    .unwrap();
    let (_, log, netlog) = open(&browser, &page, folder.path());
    assert!(log.contains("CONSOLE") && log.contains("loud"), "{log}");
    assert!(!requests_of_pages(&netlog).is_empty(), "a request went unseen");
}
