//! Hashes of the files of a folder, in the form that `sha256sum --check` reads.

use sha2::{Digest, Sha256};
use std::collections::BTreeMap;
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// Name of the file that holds the hashes of all others in its folder.
pub const CHECKSUMS_FILE: &str = "SHA256SUMS";

/// SHA-256 of some bytes, hexadecimal.
pub fn sha256(bytes: &[u8]) -> String {
    hexadecimal(&Sha256::digest(bytes))
}

/// Stand-in for the hash of a file that cannot be read: opening it says why.
pub const UNREAD_HASH: &str = "unread";

/// SHA-256 of a file, hexadecimal; `None` for what is no file or cannot be read.
pub fn sha256_of_file(path: &Path) -> Option<String> {
    let file = path.is_file().then(|| File::open(path).ok()).flatten()?;
    sha256_of_reader(file).ok()
}

/// SHA-256 of the first bytes of a file; `None` for what is no file, is shorter, or cannot be read.
pub fn sha256_of_beginning(path: &Path, bytes: u64) -> Option<String> {
    let file = path.is_file().then(|| File::open(path).ok()).flatten()?;
    let is_long = file.metadata().is_ok_and(|m| m.len() >= bytes);
    is_long.then(|| sha256_of_reader(file.take(bytes)).ok()).flatten()
}

/// SHA-256 of everything that can be read.
pub(super) fn sha256_of_reader(mut from: impl Read) -> std::io::Result<String> {
    let (mut hash, mut block) = (Sha256::new(), vec![0; 1 << 16]);
    loop {
        match from.read(&mut block) {
            Ok(0) => return Ok(hexadecimal(&hash.finalize())),
            Ok(n) => hash.update(block.get(..n).unwrap_or_default()),
            Err(e) if e.kind() == std::io::ErrorKind::Interrupted => {}
            Err(e) => return Err(e),
        }
    }
}

/// What identifies files in their order: the hash of one, that of the hashes of several.
pub fn sha256_of_several(hashes: impl Iterator<Item = String>) -> String {
    let mut all: Vec<String> = hashes.collect();
    match all.as_slice() {
        [_] => all.swap_remove(0),
        several => sha256(several.join("\n").as_bytes()),
    }
}

fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// The text of the file: a line for each file, in the order of their names.
pub fn checksums(hashes: &BTreeMap<String, String>) -> String {
    hashes.iter().map(|(name, hash)| format!("{hash}  {name}\n")).collect()
}

/// The hashes that a text states, by the names of the files; `None` for a text that this program does not write.
pub fn read_checksums(text: &str) -> Option<BTreeMap<String, String>> {
    let line = |line: &str| {
        let (hash, name) = line.split_once("  ")?;
        let is_hash =
            hash.len() == 64 && hash.bytes().all(|b| b.is_ascii_digit() || (b'a'..=b'f').contains(&b));
        is_hash.then(|| (name.to_owned(), hash.to_owned()))
    };
    let hashes: BTreeMap<String, String> = text.lines().map(line).collect::<Option<_>>()?;
    // Every byte counts: what reads the same and is written otherwise was changed by somebody.
    (checksums(&hashes) == text).then_some(hashes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hashes_come_back_and_every_byte_counts() {
        let hashes = BTreeMap::from([
            ("figures/a.svg".to_owned(), sha256(b"")),
            ("result.json".to_owned(), sha256(b"{}")),
        ]);
        let text = checksums(&hashes);
        // RFC 6234 and FIPS 180-4: the hash of nothing.
        assert!(text.starts_with(
            "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855  figures/a.svg\n"
        ));
        assert_eq!(read_checksums(&text), Some(hashes));
        for changed in
            [text.replace("  ", " "), text.replace('e', "E"), text.replace('\n', "\r\n"), format!("{text}\n")]
        {
            assert_eq!(read_checksums(&changed), None, "{changed}");
        }
    }
}
