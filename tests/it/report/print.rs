//! The reports of the shipped procedures on paper and in a narrow window: what an inspector signs is on the first page, no
//! column is cut.

use crate::report::browser::{browser, required};
use crate::support::shared::shared;
use crate::support::{root, sagnac};
use std::path::{Path, PathBuf};
use std::process::Command;

/// Procedure, recording, further arguments: one sample of every shipped procedure, those with the most rows where there
/// are several.
const RUNS: &[(&str, &str, &[&str])] = &[
    ("static-bias", "unit-pass.csv", &["--limits", "sample-unit", "--serial", "SN-0001"]),
    ("temperature-ramp", "temperature-fail.csv", &["--limits", "sample-temperature", "--serial", "SN-0102"]),
    (
        "temperature-soak",
        "temperature-soak-fail.csv",
        &["--limits", "sample-temperature", "--serial", "SN-0105"],
    ),
    ("warm-up", "warm-up-fail.csv", &["--limits", "sample-warm-up", "--serial", "SN-0107"]),
    ("scale-factor", "scale-factor-fail.csv", &["--serial", "SN-1"]),
    ("scale-factor-over-temperature", "scale-factor-over-temperature-fail.csv", &["--serial", "SN-1"]),
    ("threshold", "threshold-fail.csv", &["--serial", "SN-1"]),
    ("maximum-rate", "maximum-rate-fail.csv", &["--serial", "SN-1"]),
    ("transfer-function", "transfer-function-fail.csv", &["--serial", "SN-1"]),
    ("start-up", "start-up-fail.csv", &["--serial", "SN-1"]),
    ("bench-check", "bench-check-fail.csv", &["--serial", "REF-1"]),
    ("acceleration", "acceleration-fail.csv", &["--serial", "SN-1"]),
    ("misalignment", "misalignment-fail.csv", &["--serial", "SN-1"]),
    ("multi-position", "multi-position-software.csv", &["--serial", "SN-1"]),
    ("bias-repeatability", "bias-repeatability-fail.csv", &["--serial", "SN-0112"]),
    ("magnetic-sensitivity", "magnetic-sensitivity-fail.csv", &["--serial", "SN-0114"]),
    ("supply-sensitivity", "supply-sensitivity-fail.csv", &["--serial", "SN-0116"]),
    ("vibration", "vibration-fail.csv", &["--serial", "SN-0118"]),
    ("vibration-by-frequency", "vibration-by-frequency-fail.csv", &["--serial", "SN-0128"]),
    ("pressure-sensitivity", "pressure-sensitivity-fail.csv", &["--serial", "SN-0122"]),
    ("electromagnetic-immunity", "electromagnetic-immunity-fail.csv", &["--serial", "SN-0124"]),
    ("scale-factor-under-pressure", "scale-factor-under-pressure-fail.csv", &["--serial", "SN-0126"]),
    ("output-noise", "output-noise-fail.csv", &["--serial", "SN-0120"]),
    ("acceptance", "acceptance-fail.toml", &[]),
];

/// Pages that the report of a test at rest may have.
const STATIC_PAGES: usize = 7;

/// Where a copy of a page is marked; a link of a page is an annotation of the printed one.
const MARK: &str = "https://mark.invalid/";

fn run(folder: &Path, (procedure, recording, more): (&str, &str, &[&str])) -> PathBuf {
    let file = root().join("procedures").join(procedure).with_extension("toml").display().to_string();
    let sample = root().join("samples").join(recording).display().to_string();
    let run = shared(&[&["run", &file, &sample, "--lang", "en"], more].concat(), "r");
    assert!(run.out.join("report.html").is_file(), "{procedure}: {:?}", run.said);
    // A mark is put into a copy.
    let out = folder.join(format!("{procedure}-en"));
    run.copy_to(&out);
    out
}

fn chromium(browser: &Path, folder: &Path, args: &[&str], page: &Path) -> Vec<u8> {
    let output = Command::new(browser)
        .args(["--headless", "--no-sandbox", "--disable-gpu", "--no-first-run", "--hide-scrollbars"])
        .arg(format!("--user-data-dir={}", folder.join("profile").display()))
        .args(args)
        .arg(format!("file://{}", page.display()))
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    output.stdout
}

/// The page with a mark in the last field to be signed.
fn marked(html: &str) -> String {
    let sign_off = html.find("class=\"signoff\"").expect("a sign-off");
    let table = sign_off + html[sign_off..].find("</table>").expect("its table");
    let end = html[..table].rfind("</td>").expect("its last field");
    for before in ["class=\"verdict", "class=\"measurands", "class=\"conditions"] {
        let at = html.find(before);
        assert!(at.is_some_and(|at| at < sign_off), "{before} does not stand before the sign-off");
    }
    format!("{}<a href=\"{MARK}signed\">.</a>{}", &html[..end], &html[end..])
}

/// A printed page as the numbers of its annotations, in the order of the paper.
fn pages(pdf: &[u8]) -> Vec<Vec<u32>> {
    let text = String::from_utf8_lossy(pdf);
    let of_page = |object: &str| -> Vec<u32> {
        let list = object.split("/Annots [").nth(1).and_then(|l| l.split(']').next()).unwrap_or_default();
        list.split(" 0 R").filter_map(|n| n.trim().parse().ok()).collect()
    };
    let objects = text.split("endobj");
    objects.filter(|o| o.contains("/Type /Page\n")).map(of_page).collect()
}

/// The number of the object that holds the mark.
fn mark(pdf: &[u8]) -> Option<u32> {
    let text = String::from_utf8_lossy(pdf);
    let object = text.split("endobj").find(|o| o.contains(&format!("{MARK}signed")))?;
    object.trim_start().split(' ').next()?.parse().ok()
}

#[test]
fn what_is_signed_is_on_the_first_page_of_every_shipped_procedure() {
    let Some(browser) = browser() else { return required() };
    let folder = tempfile::tempdir().unwrap();
    let shipped = std::fs::read_dir(root().join("procedures")).unwrap();
    let shipped = shipped.filter(|e| e.as_ref().unwrap().path().extension().is_some_and(|e| e == "toml"));
    assert_eq!(shipped.count(), RUNS.len(), "every shipped procedure is printed");
    for run_of in RUNS {
        let english = run(folder.path(), *run_of);
        let russian = folder.path().join(format!("{}-ru", run_of.0));
        let (from, to) = (english.display().to_string(), russian.display().to_string());
        let said = sagnac(folder.path(), &["report", &from, "--lang", "ru", "--out", &to]);
        assert_eq!(said.code, 0, "{said:?}");
        for result in [english, russian] {
            let html = marked(&std::fs::read_to_string(result.join("report.html")).unwrap());
            let (page, print) = (result.join("marked.html"), result.join("print.pdf"));
            std::fs::write(&page, html).unwrap();
            let to = format!("--print-to-pdf={}", print.display());
            chromium(&browser, folder.path(), &["--no-pdf-header-footer", &to], &page);
            let pdf = std::fs::read(&print).unwrap();
            let (pages, mark) = (pages(&pdf), mark(&pdf).expect("the mark is printed"));
            let at = pages.iter().position(|annotations| annotations.contains(&mark));
            assert_eq!(at, Some(0), "{}: the sign-off is on page {at:?}, counted from 0", result.display());
            assert!(pages.len() > 1, "{}: the first page is the whole", result.display());
            if run_of.0 == "static-bias" {
                assert!(pages.len() <= STATIC_PAGES, "{}: {} pages", result.display(), pages.len());
            }
        }
    }
}

#[test]
fn no_column_is_cut_in_a_window_of_a_thousand_pixels() {
    let Some(browser) = browser() else { return required() };
    let folder = tempfile::tempdir().unwrap();
    for run_of in [RUNS[0], RUNS[2], RUNS[4]] {
        let result = run(folder.path(), run_of);
        let html = std::fs::read_to_string(result.join("report.html")).unwrap();
        // Without its policy the page tells what it measures of itself.
        let measure = "<script>addEventListener('load', () => { document.documentElement.dataset.cut = \
                       [...document.querySelectorAll('.measurands, .conditions')].map(t => t.parentElement)\
                       .filter(e => e.scrollWidth > e.clientWidth).map(e => e.scrollWidth - e.clientWidth).join() \
                       + ';' + innerWidth; });</script></body>";
        let html = html.replace("Content-Security-Policy", "").replace("</body>", measure);
        let page = result.join("measured.html");
        std::fs::write(&page, html).unwrap();
        let dom = chromium(&browser, folder.path(), &["--window-size=1000,900", "--dump-dom"], &page);
        let dom = String::from_utf8_lossy(&dom);
        let cut = dom.split("data-cut=\"").nth(1).and_then(|c| c.split('"').next()).expect("it was measured");
        assert_eq!(cut, ";1000", "{}: cut by so many px; width of the window", run_of.0);
    }
}
