//! What goes out with a unit: a document for word processors, a certificate of conformity, and an archive of all.

use crate::support::quick::Quick;
use crate::support::{altered, sagnac};
use flate2::read::DeflateDecoder;
use quick_xml::Reader;
use quick_xml::events::Event;
use rawzip::ZipArchive;
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;
use std::fs;
use std::io::Read;
use std::path::Path;
use tempfile::{TempDir, tempdir};

/// The files of an archive.
fn unpacked(path: &Path) -> BTreeMap<String, Vec<u8>> {
    let bytes = fs::read(path).unwrap();
    let archive = ZipArchive::from_slice(&bytes).unwrap();
    let mut entries = archive.entries();
    let mut files = BTreeMap::new();
    while let Some(entry) = entries.next_entry().unwrap() {
        let mut text = vec![];
        let packed = archive.get_entry(entry.wayfinder()).unwrap();
        DeflateDecoder::new(packed.data()).read_to_end(&mut text).unwrap();
        files.insert(String::from_utf8(entry.file_path().as_ref().to_vec()).unwrap(), text);
    }
    files
}

/// The texts of a part of a document, a line for each paragraph; the part is well-formed.
fn paragraphs(part: &[u8]) -> Vec<String> {
    let mut reader = Reader::from_str(std::str::from_utf8(part).unwrap());
    let (mut lines, mut line, mut is_text) = (vec![], String::new(), false);
    loop {
        match reader.read_event().unwrap() {
            Event::Start(e) if e.name().as_ref() == b"w:t" => is_text = true,
            Event::End(e) if e.name().as_ref() == b"w:t" => is_text = false,
            Event::End(e) if e.name().as_ref() == b"w:p" => lines.push(std::mem::take(&mut line)),
            Event::Text(t) if is_text => line.push_str(&t.decode().unwrap()),
            Event::Eof => return lines,
            _ => {}
        }
    }
}

/// A test of a unit, `pass` or `fail`, with a protocol of a house; the folder `r` holds its result.
fn tested(end: &str) -> TempDir {
    let dir = tempdir().unwrap();
    let quick = Quick::new(end);
    let keys = "[report]\nprotocol = \"GT-{serial}\"\norganisation = { en = \"Gyro Laboratory\", ru = \"Лаборатория гироскопов\" }\n\
                signatories = [\"quality_control\"]\n";
    let procedure = altered(dir.path(), "p.toml", &quick.procedure, &[("[report]\n", keys)]);
    let args =
        ["run", &procedure, &quick.recording, "--limits", &quick.limits, "--serial", "SN-1", "--out", "r"];
    let said = sagnac(dir.path(), &args);
    assert_eq!(said.code, i32::from(end == "fail"), "{said:?}");
    dir
}

#[test]
fn a_document_for_word_processors_has_the_report_with_its_figures() {
    let dir = tested("pass");
    let at = dir.path();
    let said = sagnac(at, &["report", "r", "--format", "docx,html,json", "--out", "d"]);
    assert_eq!(said.code, 0, "{said:?}");
    let parts = unpacked(&at.join("d/report.docx"));
    let body = paragraphs(&parts["word/document.xml"]);
    let has = |text: &str| body.iter().any(|line| line.contains(text));
    for text in ["Verdict: pass", "Angle random walk N, °/√h", "Sign-off", "Quality control", "Decision rule"]
    {
        assert!(has(text), "{text}: {body:?}");
    }
    assert_eq!(
        paragraphs(&parts["word/header1.xml"]),
        ["Gyro Laboratory · Acceptance test report · No. GT-SN-1"]
    );
    assert!(paragraphs(&parts["word/footer1.xml"])[0].contains("SN-1"));
    // Every relation leads to a part, and every picture has one.
    let relations = String::from_utf8(parts["word/_rels/document.xml.rels"].clone()).unwrap();
    let pictures = parts.keys().filter(|name| name.starts_with("word/media/")).count();
    let document = String::from_utf8(parts["word/document.xml"].clone()).unwrap();
    assert!(pictures > 0 && document.matches("<pic:pic ").count() == pictures, "{relations}");
    for target in relations.split("Target=\"").skip(1).filter_map(|rest| rest.split('"').next()) {
        assert!(parts.contains_key(&format!("word/{target}")), "{target}");
    }
    // The same page gives the same bytes, so that it is verified as the others are.
    let verified = sagnac(at, &["verify", "d"]);
    assert!(verified.code == 0 && verified.out.contains("Nothing differs."), "{verified:?}");
    fs::write(at.join("d/report.docx"), b"PK").unwrap();
    assert_eq!(sagnac(at, &["verify", "d"]).code, 1);
}

#[test]
fn texts_of_others_are_no_markup_in_a_document() {
    let dir = tempdir().unwrap();
    let quick = Quick::new("pass");
    let said = quick.run(dir.path(), &["--out", "r", "--operator", "A & <w:b/> \"B\"\u{1b}[2J"]);
    assert_eq!(said.code, 0, "{said:?}");
    let said = sagnac(dir.path(), &["report", "r", "--format", "docx", "--lang", "ru", "--out", "d"]);
    assert_eq!(said.code, 0, "{said:?}");
    let parts = unpacked(&dir.path().join("d/report.docx"));
    let document = String::from_utf8(parts["word/document.xml"].clone()).unwrap();
    assert!(document.contains("A &amp; &lt;w:b/&gt;") && !document.contains('\u{1b}'), "{document}");
    assert!(paragraphs(&parts["word/document.xml"]).iter().any(|line| line.contains("годен")), "{document}");
}

#[test]
fn a_certificate_states_conformity_of_a_unit_that_passed() {
    let dir = tested("pass");
    let at = dir.path();
    let asked = ["report", "r", "--document", "certificate"];
    let said = sagnac(at, &[&asked[..], &["--format", "html,md,docx,json", "--out", "c"]].concat());
    assert_eq!(said.code, 0, "{said:?}");
    let page = fs::read_to_string(at.join("c/certificate.md")).unwrap();
    for text in [
        "# Certificate of conformity",
        "Statement: CONFORMS",
        "Unit SN-1 conforms to Quick (quick, revision A)",
        "procedure quick, revision A",
        "guard band, risk 5\u{202f}%",
        "all 1 quantities with a limit",
        "| Quality control |",
    ] {
        assert!(page.contains(text), "{text}: {page}");
    }
    assert!(!at.join("c/report.html").exists() && at.join("c/certificate.html").exists());
    let body = paragraphs(&unpacked(&at.join("c/certificate.docx"))["word/document.xml"]);
    assert!(body.contains(&"Statement: CONFORMS".to_owned()), "{body:?}");
    let verified = sagnac(at, &["verify", "c"]);
    assert!(verified.code == 0 && verified.out.contains("Nothing differs."), "{verified:?}");
    let forged = page.replace("SN-1", "SN-2");
    fs::write(at.join("c/certificate.md"), forged).unwrap();
    let verified = sagnac(at, &["verify", "c"]);
    assert!(verified.code == 1 && verified.out.contains("certificate.md"), "{verified:?}");

    let said = sagnac(at, &[&asked[..], &["--lang", "ru", "--format", "md", "--out", "ru"]].concat());
    assert_eq!(said.code, 0, "{said:?}");
    assert!(fs::read_to_string(at.join("ru/certificate.md")).unwrap().contains("# Сертификат соответствия"));
}

#[test]
fn there_is_no_certificate_of_anything_but_a_pass() {
    let dir = tested("fail");
    let at = dir.path();
    let asked = |result: &str| sagnac(at, &["report", result, "--document", "certificate", "--out", "c"]);
    let said = asked("r");
    assert!(
        said.code == 2 && said.err.contains("no statement of conformity: the verdict is fail"),
        "{said:?}"
    );
    let quick = Quick::new("pass");
    assert_eq!(sagnac(at, &["analyze", &quick.recording, "--out", "a"]).code, 0);
    let said = asked("a");
    assert!(said.code == 2 && said.err.contains("only a test with limits"), "{said:?}");
    assert!(!at.join("c").exists());
}

#[test]
fn a_pack_has_everything_of_a_unit_with_its_hashes() {
    let dir = tested("pass");
    let at = dir.path();
    let said = sagnac(at, &["pack", "r", "--out", "SN-1.zip"]);
    assert_eq!(said.code, 0, "{said:?}");
    let files = unpacked(&at.join("SN-1.zip"));
    for name in [
        "result/result.json",
        "result/SHA256SUMS",
        "report.docx",
        "certificate.html",
        "model.toml",
        "parameters/kalibr.txt",
    ] {
        assert!(files.contains_key(name), "{name}: {:?}", files.keys());
    }
    assert_eq!(files["result/report.html"], fs::read(at.join("r/report.html")).unwrap());
    let sums = String::from_utf8(files["SHA256SUMS"].clone()).unwrap();
    assert_eq!(sums.lines().count() + 1, files.len());
    for line in sums.lines() {
        let (hash, name) = line.split_once("  ").unwrap();
        let found: String = Sha256::digest(&files[name]).iter().map(|b| format!("{b:02x}")).collect();
        assert_eq!(hash, found, "{name}");
    }
    // The same result gives the same bytes.
    assert_eq!(sagnac(at, &["pack", "r", "--out", "again.zip", "--quiet"]).code, 0);
    assert_eq!(fs::read(at.join("SN-1.zip")).unwrap(), fs::read(at.join("again.zip")).unwrap());
}

#[test]
fn a_pack_says_what_it_lacks_and_is_made_whole_or_not_at_all() {
    let dir = tested("fail");
    let at = dir.path();
    let said = sagnac(at, &["pack", "r", "--out", "p.zip"]);
    assert!(said.code == 0 && said.out.contains("left out: certificate: no statement"), "{said:?}");
    assert!(!unpacked(&at.join("p.zip")).keys().any(|name| name.starts_with("certificate")));
    let page = at.join("r/report.md");
    fs::write(&page, fs::read_to_string(&page).unwrap().replace("SN-1", "SN-2")).unwrap();
    let said = sagnac(at, &["pack", "r", "--out", "q.zip"]);
    assert!(said.code == 2 && said.err.contains("report.md"), "{said:?}");
    fs::remove_file(&page).unwrap();
    let said = sagnac(at, &["pack", "r", "--out", "q.zip"]);
    assert!(said.code == 2 && said.err.contains("report.md"), "{said:?}");
    let said = sagnac(at, &["pack", "nowhere", "--out", "q.zip"]);
    assert!(said.code == 2 && said.err.contains("nowhere"), "{said:?}");
    assert!(!at.join("q.zip").exists());
}

#[test]
fn a_lot_has_a_matrix_and_a_workbook_with_the_numbers_of_its_record() {
    let dir = tempdir().unwrap();
    let (pass, fail) = (Quick::new("pass"), Quick::new("fail"));
    let args = [
        "run",
        &pass.procedure,
        &pass.recording,
        &fail.recording,
        "--each",
        "--limits",
        &pass.limits,
        "--out",
        "lot",
    ];
    assert_eq!(sagnac(dir.path(), &args).code, 1);
    let at = dir.path();
    let page = fs::read_to_string(at.join("lot/index.md")).unwrap();
    let head = page.split("## Units and quantities").nth(1).unwrap_or_default();
    assert!(head.contains("| Serial number | Angle random walk N, °/√h |"), "{page}");
    let said = sagnac(at, &["report", "lot", "--format", "xlsx", "--out", "x"]);
    assert_eq!(said.code, 0, "{said:?}");
    let sheet =
        String::from_utf8(unpacked(&at.join("x/index.xlsx"))["xl/worksheets/sheet1.xml"].clone()).unwrap();
    let record: serde_json::Value =
        serde_json::from_str(&fs::read_to_string(at.join("lot/index.json")).unwrap()).unwrap();
    let numbers: Vec<f64> =
        sheet.split("<v>").skip(1).filter_map(|rest| rest.split('<').next()?.parse().ok()).collect();
    let units = record["units"].as_array().unwrap();
    let values: Vec<f64> = units.iter().filter_map(|u| u["measurands"][0]["value"].as_f64()).collect();
    assert!(values.len() == 2 && numbers == values, "{sheet}");
    // The styles of a pass and a fail, which are not the same.
    assert!(sheet.contains("s=\"2\"") && sheet.contains("s=\"3\""), "{sheet}");
    let verified = sagnac(at, &["verify", "x"]);
    assert!(verified.code != 2 && !verified.out.contains("index.xlsx"), "{verified:?}");
}
