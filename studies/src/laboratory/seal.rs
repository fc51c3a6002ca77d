//! Keys apart from cases: whoever answers cannot see them, and whoever scores cannot change them afterwards.

use sagnac::output::sha256;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::{fs, io};

/// File beside the cases that holds the hashes of their keys, one `hash  case` a line.
pub const SEAL: &str = "SEAL";

/// Moves the truths of cases into a folder of keys, and writes their hashes beside the cases.
///
/// # Errors
/// If a file cannot be moved or written.
pub fn seal(cases: &[PathBuf], folder: &Path, keys: &Path) -> io::Result<usize> {
    fs::create_dir_all(keys)?;
    let mut lines = fs::read_to_string(folder.join(SEAL)).unwrap_or_default();
    let mut sealed = 0;
    for case in cases {
        let Ok(truth) = fs::read(case.join("truth.json")) else { continue };
        let name = case.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
        lines.push_str(&format!("{}  {name}\n", sha256(&truth)));
        fs::write(key(keys, &name), truth)?;
        fs::remove_file(case.join("truth.json"))?;
        sealed += 1;
    }
    fs::write(folder.join(SEAL), lines)?;
    Ok(sealed)
}

/// The key of a case, if it is the one that was sealed.
///
/// # Errors
/// If it cannot be read, or is another.
pub fn opened(folder: &Path, keys: &Path, name: &str) -> io::Result<Vec<u8>> {
    let bytes = fs::read(key(keys, name))?;
    let seals = fs::read_to_string(folder.join(SEAL))?;
    let stated: BTreeMap<&str, &str> =
        seals.lines().filter_map(|l| l.split_once("  ")).map(|(hash, name)| (name, hash)).collect();
    if stated.get(name) == Some(&sha256(&bytes).as_str()) {
        Ok(bytes)
    } else {
        Err(io::Error::other(format!("{name}: the key is not the one that was sealed")))
    }
}

fn key(keys: &Path, name: &str) -> PathBuf {
    keys.join(format!("{name}.json"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_key_opens_unless_it_was_changed() {
        let at = std::env::temp_dir().join(format!("laboratory-seal-{}", std::process::id()));
        let (folder, keys) = (at.join("cases"), at.join("keys"));
        let case = folder.join("case-1");
        fs::create_dir_all(&case).unwrap();
        fs::write(case.join("truth.json"), "{}").unwrap();
        assert_eq!(seal(std::slice::from_ref(&case), &folder, &keys).unwrap(), 1);
        assert!(!case.join("truth.json").exists());
        assert_eq!(opened(&folder, &keys, "case-1").unwrap(), b"{}");
        fs::write(keys.join("case-1.json"), "{ }").unwrap();
        let said = opened(&folder, &keys, "case-1").unwrap_err().to_string();
        fs::remove_dir_all(&at).unwrap();
        assert!(said.contains("not the one"), "{said}");
    }
}
