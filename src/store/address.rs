//! The address of a result folder: the SHA-256 of the list of its files.
//!
//! The list is what `sha256sum` prints of the files in the order of their names, so that anyone can check an address:
//! `find . -type f -printf '%P\n' | LC_ALL=C sort | xargs -d '\n' sha256sum | sha256sum`.

use sha2::{Digest, Sha256};
use std::collections::BTreeMap;
use std::fmt::Write;

/// SHA-256 of bytes, hexadecimal.
pub fn sha256(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().fold(String::with_capacity(64), |mut text, byte| {
        let _ = write!(text, "{byte:02x}");
        text
    })
}

/// The address of files, given as names with the SHA-256 of their contents.
pub fn address(files: &BTreeMap<String, String>) -> String {
    let mut list = String::new();
    for (name, hash) in files {
        let _ = writeln!(list, "{hash}  {name}");
    }
    sha256(list.as_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_address_is_that_of_the_tools() {
        assert_eq!(sha256(b""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
        // printf a > x; mkdir d; printf b > d/y; then the command above.
        let files = BTreeMap::from([("x".to_owned(), sha256(b"a")), ("d/y".to_owned(), sha256(b"b"))]);
        assert_eq!(address(&files), EXPECTED);
    }

    const EXPECTED: &str = "3998c61384089c9059bc9f4bc8b7ed90b34e4b6eff5524a367a1f58ed971ddef";
}
