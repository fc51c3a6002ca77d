//! Signatures: a chain that holds, and every way in which it does not.

use crate::documents::{tested, verified};
use crate::support::quick::Quick;
use crate::support::{Said, altered, sagnac};
use ssh_key::{LineEnding, PrivateKey};
use std::fs;
use std::path::Path;

/// Writes a key made from a seed, and its public part beside it.
fn key(dir: &Path, name: &str, seed: u8) {
    let key = PrivateKey::from(ssh_key::private::Ed25519Keypair::from_seed(&[seed; 32]));
    key.write_openssh_file(&dir.join(name), LineEnding::LF).unwrap();
    fs::write(dir.join(format!("{name}.pub")), key.public_key().to_openssh().unwrap()).unwrap();
}

fn put(dir: &Path, verb: &str, key: &str, more: &[&str]) -> Said {
    sagnac(dir, &[&[verb, "r", "--key", key], more].concat())
}

#[test]
fn two_keys_sign_one_after_the_other() {
    let dir = tempfile::tempdir().unwrap();
    let at = dir.path();
    let quick = Quick::new("pass");
    // The procedure asks for two signatures by two keys.
    let both = [("[report]\n", "[report]\nsignatures = [\"tested\", \"approved\"]\n")];
    let procedure = altered(at, "p.toml", &quick.procedure, &both);
    let run = Quick { procedure, ..quick };
    assert_eq!(run.run(at, &["--out", "r"]).code, 0);
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
    assert!(said.contains("made anew") && !said.contains("not what the record gives"), "{said}");
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
    let said = put(at, "approve", "lead", &["--waive", &failed, "--reason", "deviation permit 17"]);
    assert_eq!(said.code, 0, "{said:?}");
    let (code, said) = verified(at, &["r"]);
    assert_eq!(code, 0, "{said}");
    assert!(said.contains(&format!("lets {failed} pass: deviation permit 17")), "{said}");
    assert!(said.contains("numbers of the record: fail"), "{said}");
    sagnac(at, &["report", "r", "--out", "anew", "--format", "md"]);
    let page = fs::read_to_string(at.join("anew/report.md")).unwrap();
    assert!(page.contains("deviation permit 17") && page.contains("FAIL"), "{page}");
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
