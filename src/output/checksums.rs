//! Hashes of the files of a folder, in the form that `sha256sum --check` reads.

use sha2::{Digest, Sha256};
use std::collections::BTreeMap;

/// Name of the file that holds the hashes of all others in its folder.
pub const CHECKSUMS_FILE: &str = "SHA256SUMS";

/// SHA-256 of some bytes, hexadecimal.
pub fn sha256(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect()
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
