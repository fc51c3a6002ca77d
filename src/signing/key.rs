//! Keys and signatures in the forms of OpenSSH, so that `ssh-keygen -Y verify` checks them too.

use crate::i18n::{Arg, io_reason};
use sagnac_ingest::read_text;
use ssh_key::{Algorithm, HashAlg, LineEnding, PrivateKey, PublicKey, SshSig};
use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};

/// Purpose of the signatures, as `ssh-keygen -n` takes it: a signature for something else is none here.
pub const SIGNATURE_NAMESPACE: &str = "sagnac";

/// Largest file of a key that is read, bytes.
const MAX_KEY_BYTES: u64 = 1 << 20;

/// Why something could not be signed.
#[derive(Debug, thiserror::Error)]
pub enum KeyError {
    /// The file cannot be read.
    #[error("{0}")]
    File(std::io::Error),
    /// It holds no key.
    #[error("{0}")]
    Unreadable(String),
    /// The key is of another kind than Ed25519.
    #[error("{0}")]
    Kind(String),
    /// The agent, or `ssh-keygen`, refuses.
    #[error("{0}")]
    Agent(String),
}

impl KeyError {
    /// The reason; of the operating system in words of the tables.
    pub fn reason(&self) -> Arg {
        match self {
            KeyError::File(e) => io_reason(e).into(),
            other => other.to_string().into(),
        }
    }
}

/// Signs a message. A private key signs by itself; a public key, or a private one with a passphrase, through `ssh-keygen`, which
/// asks the agent or the user.
///
/// # Errors
/// [`KeyError`] for what is no key of kind Ed25519, or where the agent refuses.
pub fn sign(key: &Path, message: &[u8]) -> Result<String, KeyError> {
    let unreadable = |e: &dyn std::fmt::Display| KeyError::Unreadable(e.to_string());
    let text = read_text(key, MAX_KEY_BYTES).map_err(KeyError::File)?;
    if let Ok(public) = PublicKey::from_openssh(text.trim()) {
        ed25519(&public.algorithm())?;
        return through_agent(key, message);
    }
    let private = PrivateKey::from_openssh(text.as_bytes()).map_err(|e| unreadable(&e))?;
    ed25519(&private.algorithm())?;
    if private.is_encrypted() {
        return through_agent(key, message);
    }
    let signature =
        private.sign(SIGNATURE_NAMESPACE, HashAlg::Sha512, message).map_err(|e| unreadable(&e))?;
    signature.to_pem(LineEnding::LF).map_err(|e| unreadable(&e))
}

fn ed25519(algorithm: &Algorithm) -> Result<(), KeyError> {
    match algorithm {
        Algorithm::Ed25519 => Ok(()),
        other => Err(KeyError::Kind(other.to_string())),
    }
}

fn through_agent(key: &Path, message: &[u8]) -> Result<String, KeyError> {
    let failed = |e: std::io::Error| KeyError::Agent(format!("ssh-keygen: {e}"));
    let mut child = Command::new("ssh-keygen")
        .args(["-Y", "sign", "-n", SIGNATURE_NAMESPACE, "-f"])
        .arg(key)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .map_err(failed)?;
    if let Some(mut input) = child.stdin.take() {
        input.write_all(message).map_err(failed)?;
    }
    let out = child.wait_with_output().map_err(failed)?;
    if !out.status.success() {
        let said = String::from_utf8_lossy(&out.stderr);
        return Err(KeyError::Agent(said.trim().to_owned()));
    }
    // One form of the same signature, whoever made it.
    let signature = SshSig::from_pem(&out.stdout).and_then(|s| s.to_pem(LineEnding::LF));
    signature.map_err(|e| KeyError::Agent(e.to_string()))
}

/// Why a signature does not hold.
#[derive(Debug, PartialEq, Eq)]
pub enum Invalid {
    /// It is none, or one of another message; in the words of the library.
    Library(String),
    /// It reads as one, and is not written as this program and OpenSSH write it.
    Rewritten,
}

/// Checks a signature on a message; gives the public key that it was made with.
///
/// # Errors
/// [`Invalid`].
pub fn verify(message: &[u8], signature: &str) -> Result<PublicKey, Invalid> {
    let said = |e: ssh_key::Error| Invalid::Library(e.to_string());
    let text = signature;
    let signature = SshSig::from_pem(text).map_err(said)?;
    // Every byte counts: what reads the same and is written otherwise was changed by somebody.
    if signature.to_pem(LineEnding::LF).map_err(said)? != text {
        return Err(Invalid::Rewritten);
    }
    let key = PublicKey::from(signature.public_key().clone());
    key.verify(SIGNATURE_NAMESPACE, message, &signature).map_err(said)?;
    Ok(key)
}

/// The fingerprint of a key, as `ssh-keygen -l` prints it.
pub fn fingerprint(key: &PublicKey) -> String {
    key.fingerprint(HashAlg::Sha256).to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A key for tests: that of the first test vector of RFC 8032, section 7.1.
    pub fn key() -> PrivateKey {
        let seed = [
            0x9d, 0x61, 0xb1, 0x9d, 0xef, 0xfd, 0x5a, 0x60, 0xba, 0x84, 0x4a, 0xf4, 0x92, 0xec, 0x2c, 0xc4,
            0x44, 0x49, 0xc5, 0x69, 0x7b, 0x32, 0x69, 0x19, 0x70, 0x3b, 0xac, 0x03, 0x1c, 0xae, 0x7f, 0x60,
        ];
        PrivateKey::from(ssh_key::private::Ed25519Keypair::from_seed(&seed))
    }

    #[test]
    fn a_signature_holds_for_its_message_alone() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("key");
        key().write_openssh_file(&path, LineEnding::LF).unwrap();
        let signature = sign(&path, b"message").unwrap();
        let signer = verify(b"message", &signature).unwrap();
        assert_eq!(signer.key_data(), key().public_key().key_data());
        assert!(verify(b"messagf", &signature).is_err());
        assert!(verify(b"message", &signature.replacen('A', "B", 1)).is_err());
        assert!(fingerprint(&signer).starts_with("SHA256:"));
    }

    #[test]
    fn a_signature_for_something_else_is_none() {
        let other = key().sign("file", HashAlg::Sha512, b"message").unwrap().to_pem(LineEnding::LF).unwrap();
        assert!(verify(b"message", &other).is_err());
    }
}
