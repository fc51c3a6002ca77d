//! Signatures: a chain that holds, and every way in which it does not.

use crate::documents::{tested, verified};
use crate::support::quick::Quick;
use crate::support::{Said, altered, names, sagnac};
use sagnac::i18n::{Lang, Localize, Note};
use ssh_key::{LineEnding, PrivateKey};
use std::fs;
use std::path::Path;
use tempfile::TempDir;

/// Writes a key made from a seed, and its public part beside it.
pub fn key(dir: &Path, name: &str, seed: u8) {
    let key = PrivateKey::from(ssh_key::private::Ed25519Keypair::from_seed(&[seed; 32]));
    key.write_openssh_file(&dir.join(name), LineEnding::LF).unwrap();
    fs::write(dir.join(format!("{name}.pub")), key.public_key().to_openssh().unwrap()).unwrap();
}

fn put(dir: &Path, verb: &str, key: &str, more: &[&str]) -> Said {
    sagnac(dir, &[&[verb, "r", "--key", key], more].concat())
}

/// A folder with the result `r` of a unit whose procedure asks for two signatures by two keys.
fn demanding() -> TempDir {
    let dir = tempfile::tempdir().unwrap();
    let quick = Quick::new("pass");
    let both = [("[report]\n", "[report]\nsignatures = [\"tested\", \"approved\"]\n")];
    let procedure = altered(dir.path(), "p.toml", &quick.procedure, &both);
    let run = Quick { procedure, ..quick };
    assert_eq!(run.run(dir.path(), &["--out", "r"]).code, 0);
    dir
}

#[test]
fn two_keys_sign_one_after_the_other() {
    let dir = demanding();
    let at = dir.path();
    key(at, "anna", 1);
    key(at, "lead", 2);
    let (code, said) = verified(at, &["r"]);
    assert_eq!(code, 1, "{said}");
    assert!(said.contains("asks for a signature that is not there: tested"), "{said}");
    let refused = put(at, "approve", "lead", &[]);
    assert!(refused.code == 2 && refused.err.contains("nothing to approve"), "{refused:?}");

    assert_eq!(put(at, "sign", "anna", &["--name", "A. Ivanova"]).code, 0);
    // One key is one person: it does not fill both places.
    assert_eq!(put(at, "approve", "anna", &[]).code, 0);
    let (code, said) = verified(at, &["r"]);
    assert!(code == 1 && said.contains("not there: approved"), "{said}");
    assert_eq!(put(at, "approve", "lead", &["--name", "Lead"]).code, 0);
    let (code, said) = verified(at, &["r"]);
    assert_eq!(code, 0, "{said}");
    assert!(said.contains("by A. Ivanova, as stated") && said.contains("03-approved.json"), "{said}");

    let public = fs::read_to_string(at.join("anna.pub")).unwrap();
    fs::write(at.join("signers"), format!("anna@factory {public}\n")).unwrap();
    let (code, said) = verified(at, &["r", "--signers", "signers"]);
    assert!(code == 1 && said.contains("tested") && said.contains("by anna@factory"), "{said}");
    assert!(said.contains("not in the list of signers"), "{said}");

    // A report made anew shows them, and is checked with what it shows.
    let anew = sagnac(at, &["report", "r", "--out", "anew"]);
    assert_eq!(anew.code, 0, "{anew:?}");
    let page = fs::read_to_string(at.join("anew/report.md")).unwrap();
    assert!(page.contains("A. Ivanova") && page.contains("SHA256:") && page.contains("holds"), "{page}");
    let page = fs::read_to_string(at.join("anew/report.html")).unwrap();
    assert!(page.contains("no qualified electronic signatures"));
    let (_, said) = verified(at, &["anew"]);
    assert!(
        said.contains("reproduce from the record") && !said.contains("not what the record gives"),
        "{said}"
    );
}

#[test]
fn a_changed_folder_is_not_signed_and_a_changed_signature_does_not_hold() {
    let dir = tested("pass");
    let at = dir.path();
    key(at, "anna", 1);
    key(at, "lead", 2);
    fs::write(at.join("r/report.md"), "x").unwrap();
    let said = put(at, "sign", "anna", &[]);
    assert!(said.code == 2 && said.err.contains("report.md: changed"), "{said:?}");

    let dir = tested("pass");
    let at = dir.path();
    key(at, "anna", 1);
    key(at, "lead", 2);
    put(at, "sign", "anna", &[]);
    put(at, "approve", "lead", &[]);
    let signatures = at.join("r/signatures");
    for entry in fs::read_dir(&signatures).unwrap() {
        let file = entry.unwrap().path();
        let good = fs::read(&file).unwrap();
        for place in (0..good.len()).step_by(good.len().div_ceil(12)) {
            let mut bad = good.clone();
            bad[place] ^= 1;
            fs::write(&file, &bad).unwrap();
            let files = sagnac::signing::files_of(
                &at.join("r"),
                sagnac::verify::stated_hashes(&at.join("r")).into_keys(),
            );
            let links = sagnac::signing::chain(&at.join("r"), &files);
            assert!(links.iter().any(|l| !l.broken.is_empty()), "{}: byte {place}", file.display());
        }
        fs::write(&file, &good).unwrap();
    }
    assert_eq!(verified(at, &["r"]).0, 0);

    // The first link is taken away.
    fs::remove_file(signatures.join("01-tested.json")).unwrap();
    let (code, said) = verified(at, &["r"]);
    assert!(code == 1 && said.contains("does not follow the signature before it"), "{said}");
    let said = put(at, "approve", "lead", &[]);
    assert!(said.code == 2 && said.err.contains("does not hold"), "{said:?}");
}

#[test]
fn a_result_that_takes_the_place_of_another_is_not_the_signed_one() {
    let (dir, other) = (tested("pass"), tested("fail"));
    let at = dir.path();
    key(at, "anna", 1);
    put(at, "sign", "anna", &[]);
    fs::rename(at.join("r/signatures"), other.path().join("r/signatures")).unwrap();
    let (code, said) = verified(other.path(), &["r"]);
    assert!(code == 1 && said.contains("signed with another result.json"), "{said}");
}

#[test]
fn a_row_is_waived_beside_its_verdict() {
    let dir = tested("fail");
    let at = dir.path();
    key(at, "anna", 1);
    key(at, "lead", 2);
    put(at, "sign", "anna", &[]);
    let failed = crate::support::result(&at.join("r"))["measurands"]
        .as_array()
        .unwrap()
        .iter()
        .find(|m| m["verdict"] == "fail")
        .unwrap()["id"]
        .as_str()
        .unwrap()
        .to_owned();
    for (row, why) in [("no_such_row", "is no row"), ("static_bias@nowhere", "is no row")] {
        let said = put(at, "approve", "lead", &["--waive", row, "--reason", "none"]);
        assert!(said.code == 2 && said.err.contains(why), "{said:?}");
    }
    let said = put(at, "approve", "lead", &["--waive", &failed]);
    assert_eq!(said.code, 2, "a waiver without a reason: {said:?}");
    for empty in ["", "  "] {
        let said = put(at, "sign", "lead", &["--role", "approved", "--waive", &failed, "--reason", empty]);
        assert!(said.code == 2 && said.err.contains("reason of the waiver is empty"), "{said:?}");
    }
    let said = put(
        at,
        "sign",
        "lead",
        &["--role", "approved", "--waive", &failed, "--reason", "deviation permit 17"],
    );
    assert_eq!(said.code, 0, "{said:?}");
    let (code, said) = verified(at, &["r"]);
    assert_eq!(code, 0, "{said}");
    let name = Note::new(format!("measurand.{failed}")).say(Lang::En);
    assert!(said.contains(&format!("lets {name} pass: deviation permit 17")), "{said}");
    assert!(said.contains("numbers of the record: fail"), "{said}");
    assert!(said.contains(&format!("The verdict is fail; waived in spite of it: {name}")), "{said}");
    // Marked where the verdict stands, and in its row; the verdict itself stays.
    sagnac(at, &["report", "r", "--out", "anew", "--format", "md,html"]);
    let page = fs::read_to_string(at.join("anew/report.md")).unwrap();
    let heading = page.lines().find(|l| l.contains("FAIL")).unwrap();
    assert!(heading.contains(&format!("waived: {name}")), "{heading}");
    assert!(page.contains("deviation permit 17"), "{page}");
    let row = page.lines().find(|l| l.starts_with("| ") && l.contains("fail (waived)")).unwrap();
    assert!(row.contains(&name), "{row}");
    // A line that a signature fills is not left blank for another.
    assert!(!page.contains("| Tested by |") && page.contains("| Reviewed by |"), "{page}");
    let page = fs::read_to_string(at.join("anew/report.html")).unwrap();
    assert!(page.contains(&format!("<span class=\"waived\">waived: {name}")), "{name}");
    let unsigned = fs::read_to_string(at.join("r/report.md")).unwrap();
    assert!(unsigned.contains("| Tested by |") && !unsigned.contains("waived:"), "{unsigned}");
}

#[test]
fn what_a_killed_sign_leaves_is_named_and_replaced() {
    let dir = tested("pass");
    let at = dir.path();
    key(at, "anna", 1);
    let signatures = at.join("r/signatures");
    fs::create_dir(&signatures).unwrap();
    assert_eq!(verified(at, &["r"]).0, 0, "an empty folder is all that was made");
    fs::write(signatures.join("01-tested.json.sig"), "half").unwrap();
    fs::write(signatures.join(".01-tested.json.partial-00000000-abcdef"), "half").unwrap();
    let (code, said) = verified(at, &["r"]);
    assert!(code == 1 && said.contains("a signature without its statement"), "{said}");
    let said = put(at, "sign", "anna", &[]);
    assert_eq!(said.code, 0, "{said:?}");
    assert_eq!(verified(at, &["r"]).0, 0);
    // One that was to be of another role goes too.
    fs::write(signatures.join("02-approved.json.sig"), "half").unwrap();
    assert_eq!(put(at, "sign", "anna", &["--role", "reviewed"]).code, 0);
    let all = names(&signatures);
    assert!(!all.contains(&"02-approved.json.sig".to_owned()), "{all:?}");
    assert_eq!(verified(at, &["r"]).0, 0);
}

#[test]
fn what_does_not_belong_among_signatures_is_named() {
    let dir = tested("pass");
    let at = dir.path();
    key(at, "anna", 1);
    put(at, "sign", "anna", &[]);
    let signatures = at.join("r/signatures");
    for (name, made) in [("notes.txt", false), ("deep/notes.txt", true), ("07-tested.json.sig", false)] {
        if made {
            fs::create_dir(signatures.join("deep")).unwrap();
        }
        fs::write(signatures.join(name), "x").unwrap();
        let (code, said) = verified(at, &["r"]);
        assert!(code == 1 && said.contains(name), "{name}: {said}");
        let refused = put(at, "approve", "anna", &[]);
        assert!(refused.code == 2 && refused.err.contains(name), "{name}: {refused:?}");
        fs::remove_file(signatures.join(name)).unwrap();
        let _ = fs::remove_dir(signatures.join("deep"));
    }
    assert_eq!(verified(at, &["r"]).0, 0);
}

#[test]
fn what_demands_signatures_does_not_go_with_a_file() {
    let dir = demanding();
    let at = dir.path();
    // The copy of the procedure is left out, and the lists are written anew.
    crate::documents::forged::forget(&at.join("r"), "procedure.toml");
    let (code, said) = verified(at, &["r"]);
    assert!(
        code == 1 && said.contains("not there: tested") && said.contains("procedure.toml: missing"),
        "{said}"
    );

    let dir = demanding();
    let at = dir.path();
    key(at, "anna", 1);
    assert_eq!(put(at, "sign", "anna", &[]).code, 0);
    let statement = fs::read_to_string(at.join("r/signatures/01-tested.json")).unwrap();
    let statement: serde_json::Value = serde_json::from_str(&statement).unwrap();
    assert_eq!(statement["predicate"]["required"], serde_json::json!(["tested", "approved"]));

    let dir = tested("pass");
    let at = dir.path();
    fs::write(at.join("signers"), "").unwrap();
    let (code, said) = verified(at, &["r", "--signers", "signers"]);
    assert!(code == 1 && said.contains("Nothing in the folder is signed"), "{said}");
}

#[test]
fn no_key_is_used_on_what_the_record_does_not_give() {
    let dir = tested("fail");
    let at = dir.path();
    key(at, "anna", 1);
    crate::documents::forged::rewrite(&at.join("r"), "result.json", |text| {
        text.replace("\"verdict\": \"fail\"", "\"verdict\": \"pass\"")
    });
    let said = put(at, "sign", "anna", &[]);
    assert!(said.code == 2 && said.err.contains("not signed"), "{said:?}");
    assert!(!at.join("r/signatures").exists());
}

#[test]
fn a_key_of_another_kind_or_none_is_refused() {
    let dir = tested("pass");
    let at = dir.path();
    fs::write(at.join("nonsense"), "no key").unwrap();
    let rsa = "ssh-rsa AAAAB3NzaC1yc2EAAAADAQABAAAAgQCqGKukO1De7zhZj6+H0qtjTkVxwTCpvKe4eCZ0FPqri0cb2JZfXJ/DgYSF6vUp\
        wmJG8wVQZKjeGcjDOL5UlsuusFncCzWBQ7RKNUSesmQRMSGkVb1/3j+skZ6UtW+5u09lHNsj6tQ51s1SPrCBkedbNf0Tp0GbMJDyR4e9T04ZZw==";
    fs::write(at.join("rsa.pub"), rsa).unwrap();
    for name in ["nonsense", "rsa.pub", "missing"] {
        let said = put(at, "sign", name, &[]);
        assert!(said.code == 2 && said.err.contains(name), "{name}: {said:?}");
        assert!(!at.join("r/signatures").exists(), "{name}");
    }
}

#[test]
fn openssh_agrees() {
    let dir = tested("pass");
    let at = dir.path();
    key(at, "anna", 1);
    put(at, "sign", "anna", &[]);
    let public = fs::read_to_string(at.join("anna.pub")).unwrap();
    fs::write(at.join("signers"), format!("anna {public}\n")).unwrap();
    let statement = fs::File::open(at.join("r/signatures/01-tested.json")).unwrap();
    let checked = std::process::Command::new("ssh-keygen")
        .args(["-Y", "verify", "-f", "signers", "-I", "anna", "-n", "sagnac"])
        .args(["-s", "r/signatures/01-tested.json.sig"])
        .current_dir(at)
        .stdin(statement)
        .output();
    match checked {
        Ok(said) => assert!(said.status.success(), "{said:?}"),
        Err(e) => println!("skipped: ssh-keygen: {e}"),
    }
}
