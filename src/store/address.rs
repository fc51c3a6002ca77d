//! The address of a result folder: the SHA-256 of the list of its files.
//!
//! The list is what `sha256sum` prints of the files in the order of their names, so that anyone can check an address:
//! `find . -type f -printf '%P\n' | LC_ALL=C sort | xargs -d '\n' sha256sum | sha256sum`.

pub use crate::output::sha256;

use crate::output::checksums;
use std::collections::BTreeMap;

/// The address of files, given as names with the SHA-256 of their contents.
pub fn address(files: &BTreeMap<String, String>) -> String {
    sha256(checksums(files).as_bytes())
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
