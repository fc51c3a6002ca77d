//! Lists of signers, read as `ssh-keygen -Y verify` reads them: compared with it, where it is installed.

use crate::documents::{signing::key, tested};
use crate::support::sagnac;
use sagnac::signing::{Signers, Standing};
use ssh_key::PublicKey;
use std::fs;
use std::process::{Command, Stdio};

/// Lists of which some let the key sign. `KEY` is the key of the signature, `OTHER` another one, and the owner who is asked for is
/// `anna`.
const LISTS: &[&str] = &[
    "anna KEY",
    "  anna \t KEY comment of several words",
    "anna,bob KEY",
    "anna OTHER",
    "* KEY",
    "an?a KEY",
    "!anna KEY",
    "*,!anna KEY",
    "anna,!anna KEY",
    "!bob,anna KEY",
    "\"anna\" KEY",
    "an\"na\" KEY",
    "anna namespaces=\"sagnac\" KEY",
    "anna namespaces=\"git,sagnac\" KEY",
    "anna namespaces=\"sag*\" KEY",
    "anna namespaces=\"*,!sagnac\" KEY",
    "anna namespaces=\"git\" KEY",
    "anna namespaces=\"\" KEY",
    "anna namespaces=sagnac KEY",
    "anna NAMESPACES=\"sagnac\" KEY",
    "anna valid-after=\"20200101\" KEY",
    "anna valid-after=\"20990101\" KEY",
    "anna valid-before=\"20200101\" KEY",
    "anna valid-before=\"20990101\" KEY",
    "anna valid-before=\"20990101Z\" KEY",
    "anna valid-before=\"209901010101\" KEY",
    "anna valid-before=\"20990101010203Z\" KEY",
    "anna valid-before=\"2099010101\" KEY",
    "anna valid-before=\"20991301\" KEY",
    "anna valid-before=\"\" KEY",
    "anna valid-after=\"19700101Z\" KEY",
    "anna valid-after=\"20990101\",valid-before=\"20200101\" KEY",
    "anna valid-after=\"20200101\",valid-before=\"20990101\",namespaces=\"sagnac\" KEY",
    "anna cert-authority KEY",
    "anna CERT-authority,namespaces=\"sagnac\" KEY",
    "anna foo KEY",
    "anna foo=\"x\" KEY",
    "anna namespaces=\"sagnac\",foo KEY",
    "anna namespaces=\"sagnac\", KEY",
    "anna namespaces=\"sagnac\",namespaces=\"git\" KEY",
    "anna namespaces=\"sagnac\" valid-before=\"20200101\" KEY",
    "anna namespaces=\"sag\\\"nac\" KEY",
    "#anna KEY",
    "KEY",
    "anna",
    "",
    "\"anna KEY",
    "anna KEYx",
    "anna foo KEY\nanna KEY",
    "anna nothing\nanna KEY",
    "bob garbage\nanna KEY",
    "anna namespaces=\"git\" KEY\nanna KEY",
    "anna cert-authority KEY\nanna KEY",
    "anna ssh-rsa AAAA\nanna KEY",
    "anna OTHER\nanna KEY",
    "anna KEY\r\n",
];

#[test]
fn lists_of_signers_are_read_as_ssh_keygen_reads_them() {
    let dir = tested("pass");
    let at = dir.path();
    for (name, seed) in [("anna", 1), ("berta", 2)] {
        key(at, name, seed);
    }
    assert_eq!(sagnac(at, &["sign", "r", "--key", "anna"]).code, 0);
    let public = |name: &str| fs::read_to_string(at.join(format!("{name}.pub"))).unwrap().trim().to_owned();
    let by_ssh_keygen = || {
        let statement = fs::File::open(at.join("r/signatures/01-tested.json")).unwrap();
        let checked = Command::new("ssh-keygen")
            .args(["-Y", "verify", "-f", "signers", "-I", "anna", "-n", "sagnac"])
            .args(["-s", "r/signatures/01-tested.json.sig"])
            .current_dir(at)
            .stdin(statement)
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .status();
        checked.map(|status| status.success())
    };
    let anna = PublicKey::from_openssh(&public("anna")).unwrap();
    let mut allowed = 0;
    for (i, list) in LISTS.iter().enumerate() {
        let text = list.replace("KEY", &public("anna")).replace("OTHER", &public("berta"));
        fs::write(at.join("signers"), text).unwrap();
        let signers = Signers::read(&at.join("signers")).unwrap();
        let is_allowed = matches!(signers.standing(&anna, sagnac::moment::now()), Standing::Allowed(_));
        match by_ssh_keygen() {
            Ok(expected) => assert_eq!(is_allowed, expected, "{list}: {signers:?}"),
            Err(e) => println!("skipped: ssh-keygen: {e}"),
        }
        // The program says the same; a few of them are enough to show it.
        if i % 8 == 0 {
            let said = sagnac(at, &["verify", "r", "--signers", "signers"]);
            assert_eq!(said.code, i32::from(!is_allowed), "{list}: {said:?}");
        }
        allowed += usize::from(is_allowed);
    }
    assert!((15..LISTS.len() - 15).contains(&allowed), "{allowed}");
    // A key is judged at the moment that is asked for.
    let text = format!("anna valid-before=\"20200101Z\" {}", public("anna"));
    fs::write(at.join("signers"), text).unwrap();
    let at_time = |time: &str| sagnac(at, &["verify", "r", "--signers", "signers", "--at", time]);
    assert_eq!(at_time("20191231Z").code, 0);
    let said = at_time("20200102Z");
    assert!(said.code == 1 && said.out.contains("the key is no longer valid"), "{said:?}");
    assert_eq!(at_time("soon").code, 2);
}
