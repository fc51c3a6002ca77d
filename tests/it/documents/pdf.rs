//! PDF: an archive that can be read by people and programs, and checked by itself.

use crate::documents::{tested, verified};
use crate::support::{sagnac, shipped};
use sagnac::report::pdf::MAKES_PDF;
use std::fs;
use std::path::Path;

/// True where this build makes none, which is said.
fn skipped() -> bool {
    if !MAKES_PDF {
        println!("skipped: built without the feature pdf");
    }
    !MAKES_PDF
}

#[test]
fn a_build_without_pdf_says_so_before_any_work() {
    if MAKES_PDF {
        println!("skipped: built with the feature pdf");
        return;
    }
    let dir = tempfile::tempdir().unwrap();
    let said = sagnac(dir.path(), &["report", "nothing", "--format", "pdf", "--out", "p"]);
    assert!(said.code == 2 && said.err.contains("--features pdf"), "{said:?}");
    assert!(!dir.path().join("p").exists());
}

#[test]
fn pages_are_named_where_a_pdf_is_asked_for_alone() {
    let dir = tempfile::tempdir().unwrap();
    let said = sagnac(dir.path(), &["report", "nothing", "--pages", "summary"]);
    assert!(said.code == 2 && said.err.contains("--format pdf"), "{said:?}");
}

/// Metadata of a PDF/A-3a that is a PDF/UA-1 too.
fn is_archive(bytes: &[u8]) -> bool {
    let has = |text: &str| bytes.windows(text.len()).any(|w| w == text.as_bytes());
    bytes.starts_with(b"%PDF-1.7")
        && has("<pdfaid:part>3</pdfaid:part>")
        && has("<pdfaid:conformance>A</pdfaid:conformance>")
        && has("<pdfuaid:part>1</pdfuaid:part>")
}

#[test]
fn a_report_is_the_same_twice_and_checked_without_its_folder() {
    if skipped() {
        return;
    }
    let dir = tested("pass");
    let at = dir.path();
    for (out, lang, pages) in [("en", "en", "all"), ("ru", "ru", "all"), ("one", "en", "summary")] {
        let args =
            ["report", "r", "--format", "json,csv,pdf", "--pages", pages, "--lang", lang, "--out", out];
        let said = sagnac(at, &args);
        assert_eq!(said.code, 0, "{said:?}");
        let pdf = fs::read(at.join(out).join("report.pdf")).unwrap();
        assert!(is_archive(&pdf), "{out}");
        let again = sagnac(at, &[&args[..args.len() - 1], &["again"]].concat());
        assert_eq!(again.code, 0, "{again:?}");
        assert!(fs::read(at.join("again/report.pdf")).unwrap() == pdf, "{out}: not the same bytes");
        fs::remove_dir_all(at.join("again")).unwrap();

        let (language, attached) = sagnac::report::pdf::attached(&pdf).unwrap();
        assert_eq!(language, lang);
        for name in ["result.json", "procedure.toml", "limits.toml", "figures/data.json"] {
            assert!(attached.get(name) == Some(&fs::read(at.join(out).join(name)).unwrap()), "{out}: {name}");
        }
        fs::write(at.join("lone.pdf"), &pdf).unwrap();
        let (code, said) = verified(at, &["lone.pdf"]);
        assert!(code == 0 && said.contains("byte for byte"), "{out}: {said}");
        fs::write(at.join("lone.pdf"), [&pdf, b"% more\n".as_slice()].concat()).unwrap();
        let (code, said) = verified(at, &["lone.pdf"]);
        assert!(code == 1 && said.contains("7 bytes of an update follow"), "{out}: {said}");
        for place in [pdf.len() / 3, pdf.len() / 2, pdf.len() - 40] {
            let mut bad = pdf.clone();
            bad[place] ^= 1;
            fs::write(at.join("lone.pdf"), &bad).unwrap();
            let (code, said) = verified(at, &["lone.pdf"]);
            assert_eq!(code, 1, "{out}, byte {place}: {said}");
        }
    }
    let pages = |out: &str| fs::metadata(at.join(out).join("report.pdf")).unwrap().len();
    assert!(pages("one") < pages("en"));
}

#[test]
fn every_kind_of_folder_and_a_history_become_pdf() {
    if skipped() {
        return;
    }
    let dir = tempfile::tempdir().unwrap();
    let at = dir.path();
    let lot = shipped("samples/lot");
    let mut units: Vec<String> =
        fs::read_dir(&lot).unwrap().map(|e| e.unwrap().path().display().to_string()).collect();
    units.retain(|p| Path::new(p).is_dir());
    units.sort();
    let results: Vec<String> = units.iter().map(|u| format!("{u}/result.json")).collect();
    let results: Vec<&str> = results.iter().map(String::as_str).collect();
    let made = |args: &[&str], file: &str| {
        let said = sagnac(at, args);
        assert!(matches!(said.code, 0 | 1 | 3), "{args:?}: {said:?}");
        assert!(is_archive(&fs::read(at.join(file)).unwrap()), "{file}");
    };
    made(
        &[&["datasheet"], results.as_slice(), &["--format", "pdf", "--out", "s"]].concat(),
        "s/datasheet.pdf",
    );
    made(&["compare", "--published", "--format", "pdf", "--out", "c"], "c/comparison.pdf");
    sagnac(at, &["store", "init", "store"]);
    sagnac(at, &["store", "import", "store", &lot]);
    made(&["history", "--store", "store", "--format", "pdf", "--out", "h.pdf"], "h.pdf");
    let said = sagnac(at, &["history", "--store", "store", "--format", "pdf"]);
    assert!(said.code == 2 && said.err.contains("--out"), "{said:?}");
    // What no font shows is named by its number.
    let procedure = crate::support::short_procedure(at);
    let recording = crate::support::sample("pass");
    made(
        &["run", &procedure, &recording, "--serial", "单元-1", "--format", "pdf", "--out", "u"],
        "u/report.pdf",
    );
}

/// Every shipped procedure whose sample is at hand, in both languages.
#[test]
fn every_shipped_test_becomes_pdf_in_both_languages() {
    if skipped() {
        return;
    }
    let dir = tempfile::tempdir().unwrap();
    let at = dir.path();
    let mut made = 0;
    let mut runs: Vec<(String, String)> = vec![];
    for entry in fs::read_dir(shipped("samples")).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_stem().unwrap().to_string_lossy().into_owned();
        if let Some(test) =
            name.strip_suffix("-pass").filter(|_| path.extension().is_some_and(|e| e == "csv"))
        {
            let procedure = if test == "unit" { "static-bias".to_owned() } else { test.to_owned() };
            runs.push((procedure, path.display().to_string()));
        }
    }
    runs.push(("acceptance".to_owned(), shipped("samples/acceptance-pass.toml")));
    for (procedure, recording) in &runs {
        for lang in ["en", "ru"] {
            let out = format!("{procedure}-{lang}");
            let args = [
                "run", procedure, recording, "--serial", "SN-1", "--lang", lang, "--format", "pdf", "--out",
                &out,
            ];
            let said = sagnac(at, &args);
            // A sample may be of another procedure's name; what runs must be typeset.
            if said.code == 2 && said.err.contains(procedure) && !at.join(&out).exists() {
                continue;
            }
            assert!(matches!(said.code, 0 | 1 | 3), "{args:?}: {said:?}");
            assert!(is_archive(&fs::read(at.join(&out).join("report.pdf")).unwrap()), "{out}");
            if lang == "ru" && procedure != "acceptance" {
                fs::copy(at.join(&out).join("report.pdf"), at.join("lone.pdf")).unwrap();
                let (code, said) = verified(at, &["lone.pdf"]);
                assert!(code == 0 && said.contains("byte for byte"), "{out}: {said}");
            }
            made += 1;
        }
    }
    assert!(made >= 12, "{made} of {}", 2 * runs.len());
}
