//! Who may sign: a list in the form of the `allowed_signers` of OpenSSH.

use ssh_key::PublicKey;
use std::path::Path;

/// Keys and to whom they belong.
#[derive(Debug, Clone, Default)]
pub struct Signers(Vec<(String, PublicKey)>);

impl Signers {
    /// Reads a list: a line for each key, its owner first; `#` begins a comment.
    ///
    /// # Errors
    /// The number of the first line that is none, counted from 1, or what the operating system says.
    pub fn read(path: &Path) -> Result<Signers, (usize, String)> {
        let text = std::fs::read_to_string(path).map_err(|e| (0, e.to_string()))?;
        let mut signers = vec![];
        for (i, line) in text.lines().enumerate() {
            let line = line.trim();
            if line.is_empty() || line.starts_with('#') {
                continue;
            }
            let words: Vec<&str> = line.split_whitespace().collect();
            // Options may stand between the owner and the key.
            let kind = words.iter().skip(1).position(|w| w.starts_with("ssh-") || w.starts_with("sk-"));
            let key = kind.and_then(|k| Some(format!("{} {}", words.get(k + 1)?, words.get(k + 2)?)));
            let key = key.map(|k| PublicKey::from_openssh(&k));
            match (words.first(), key) {
                (Some(owner), Some(Ok(key))) => signers.push(((*owner).to_owned(), key)),
                (_, Some(Err(e))) => return Err((i + 1, e.to_string())),
                _ => return Err((i + 1, String::new())),
            }
        }
        Ok(Signers(signers))
    }

    /// To whom a key belongs.
    pub fn owner(&self, key: &PublicKey) -> Option<&str> {
        self.0.iter().find(|(_, k)| k.key_data() == key.key_data()).map(|(owner, _)| owner.as_str())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn owners_are_found_and_a_line_that_is_none_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("signers");
        let key = "ssh-ed25519 AAAAC3NzaC1lZDI1NTE5AAAAINdamAGCsQq31Uv+08lkBzoO4XLz2qYjJa8CGmj3B1Ea";
        std::fs::write(&path, format!("# list\n\nanna@factory namespaces=\"sagnac\" {key} anna\n")).unwrap();
        let signers = Signers::read(&path).unwrap();
        assert_eq!(signers.owner(&PublicKey::from_openssh(key).unwrap()), Some("anna@factory"));
        std::fs::write(&path, format!("anna {key}\nberta nothing\n")).unwrap();
        assert_eq!(Signers::read(&path).unwrap_err().0, 2);
    }
}
