//! A report opened in a browser without a screen: no network request, no complaint on the console, the verdict shown.

use crate::report::fixture;
use sagnac::i18n::Lang;
use sagnac::report::{Renderer, render_html};
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;

const BROWSERS: &[&str] = &["chromium", "chromium-browser", "google-chrome", "google-chrome-stable"];

/// A browser of this machine; `None` where there is none.
pub fn browser() -> Option<PathBuf> {
    let path = std::env::var_os("PATH")?;
    std::env::split_paths(&path).flat_map(|d| BROWSERS.iter().map(move |b| d.join(b))).find(|p| p.is_file())
}

/// Says that a test is skipped for want of a browser; fails where one is required.
pub fn required() {
    assert!(
        std::env::var_os("SAGNAC_REQUIRE_BROWSER").is_none_or(|v| v != "1"),
        "no browser found; looked for {}",
        BROWSERS.join(", ")
    );
    let _ = writeln!(std::io::stderr(), "SKIPPED: no browser found; looked for {}", BROWSERS.join(", "));
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
    let Some(browser) = browser() else { return required() };
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
fn values_at_the_pointer_are_those_of_the_figure() {
    let Some(browser) = browser() else { return required() };
    let folder = tempfile::tempdir().unwrap();
    let page = folder.path().join("pointed.html");
    let html = render_html(&fixture::pass(), &fixture::figures::all(), Lang::En, &Renderer::new()).unwrap();
    // A second script, let in beside that of the page, moves the pointer and steps by keys.
    let point = "<script>addEventListener('load', () => {
        const svg = document.querySelector('figure svg'), box = document.querySelector('.readings');
        const data = JSON.parse(svg.closest('figure').dataset.readings), f = data.panels[0].frame;
        const m = svg.getScreenCTM(), seen = [];
        const at = (x, y) => svg.dispatchEvent(new PointerEvent('pointermove',
            { clientX: m.e + m.a * x, clientY: m.f + m.d * y, pointerType: 'mouse', bubbles: true }));
        at(f[0] + 0.3 * f[2], f[1] + 0.5 * f[3]); seen.push(box.hidden ? '' : box.innerText);
        svg.dispatchEvent(new KeyboardEvent('keydown', { key: 'ArrowRight', bubbles: true })); seen.push(box.innerText);
        svg.dispatchEvent(new KeyboardEvent('keydown', { key: 'Escape', bubbles: true })); seen.push(String(box.hidden));
        document.documentElement.dataset.seen = JSON.stringify(seen);
      });</script></body>";
    let open_policy =
        html.replace("script-src 'sha256-", "script-src 'unsafe-inline' 'nothing-").replace("</body>", point);
    std::fs::write(&page, open_policy).unwrap();
    let (dom, _, _) = open(&browser, &page, folder.path());
    let seen = dom.split("data-seen=\"").nth(1).and_then(|s| s.split('"').next()).expect("the script ran");
    let seen: Vec<String> = serde_json::from_str(&seen.replace("&quot;", "\"")).unwrap();
    // The abscissa with its unit, then a line for each series.
    assert!(
        seen[0].starts_with("Averaging time τ\n")
            && seen[0].contains("\nfitted model\n")
            && seen[0].contains("°/h"),
        "{seen:?}"
    );
    assert!(seen[1] != seen[0] && !seen[1].is_empty(), "{seen:?}");
    assert_eq!(seen[2], "true", "{seen:?}");
}

#[test]
fn the_watch_for_complaints_and_requests_is_awake() {
    let Some(browser) = browser() else { return required() };
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
