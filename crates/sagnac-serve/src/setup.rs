//! What a server is started with.

use crate::texts::Lang;
use serde::{Deserialize, Serialize};
use std::net::SocketAddr;
use std::path::PathBuf;
use thiserror::Error;

/// What a server is started with.
#[derive(Debug, Clone)]
pub struct Setup {
    /// The program that tests.
    pub program: PathBuf,
    /// Folder of everything that is kept.
    pub data: PathBuf,
    /// Further folders with recordings.
    pub recordings: Vec<PathBuf>,
    /// Further folders with procedures and limits.
    pub procedures: Vec<PathBuf>,
    /// What the program carries.
    pub shipped: Shipped,
    /// Tests by part number. The first that fits holds.
    pub rules: Vec<Rule>,
    /// Store that results are kept in.
    pub store: Option<PathBuf>,
    /// Test station.
    pub station: Option<String>,
    /// Language of pages that ask for none.
    pub lang: Lang,
    /// Where to listen.
    pub listen: Listen,
    /// Tests at a time.
    pub jobs: usize,
    /// Largest upload, bytes.
    pub max_upload: u64,
    /// Largest sum of all uploads, bytes.
    pub upload_quota: u64,
    /// True where the server may run with all rights.
    pub allow_root: bool,
}

/// Names of procedures and limits that the program carries.
#[derive(Debug, Clone, Default)]
pub struct Shipped {
    /// Procedures.
    pub procedures: Vec<String>,
    /// Limits.
    pub limits: Vec<String>,
}

/// The test of a part number.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Rule {
    /// Pattern of the part number: `*` is any characters, `?` a single one.
    pub part: String,
    /// Procedure: an absolute path, or the name of a shipped one.
    pub procedure: String,
    /// Limits: an absolute path, or the name of shipped ones.
    pub limits: Option<String>,
}

/// Where a server listens.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Listen {
    /// Address and port; port 0 is any that is free.
    pub address: SocketAddr,
    /// How browsers reach it through a proxy that has the certificate.
    pub behind_proxy: Option<PublicOrigin>,
}

/// Scheme and host of a server as browsers know it: `https://bench.example.com`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PublicOrigin {
    host: String,
}

/// A public address that cannot be used.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum ProxyError {
    /// Without encryption.
    #[error("does not begin with https://")]
    NotEncrypted,
    /// More or less than a host, perhaps with a port.
    #[error("is no host")]
    NotAHost,
}

impl PublicOrigin {
    /// Reads `https://HOST` or `https://HOST:PORT`.
    ///
    /// # Errors
    /// Another scheme, or more than a host.
    pub fn parse(text: &str) -> Result<PublicOrigin, ProxyError> {
        let host = text.strip_prefix("https://").ok_or(ProxyError::NotEncrypted)?;
        let host = host.strip_suffix('/').unwrap_or(host).to_ascii_lowercase();
        let is_host = |c: char| c.is_ascii_alphanumeric() || ".-:[]".contains(c);
        if host.is_empty() || !host.chars().all(is_host) {
            return Err(ProxyError::NotAHost);
        }
        let host = host.strip_suffix(":443").map(str::to_owned).unwrap_or(host);
        Ok(PublicOrigin { host })
    }

    /// Host, with the port where it is not the usual one.
    pub fn host(&self) -> &str {
        &self.host
    }

    /// Scheme and host, as browsers send it.
    pub fn origin(&self) -> String {
        format!("https://{}", self.host)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_public_address_is_encrypted_and_no_more_than_a_host() {
        let host = |text: &str| PublicOrigin::parse(text).map(|o| o.host().to_owned());
        assert_eq!(host("https://Bench.example.com/").unwrap(), "bench.example.com");
        assert_eq!(host("https://bench:8443").unwrap(), "bench:8443");
        assert_eq!(host("https://bench:443").unwrap(), "bench");
        assert_eq!(host("http://bench"), Err(ProxyError::NotEncrypted));
        for wrong in ["https://", "https://bench/a", "https://a@b", "https://a b", "https://*"] {
            assert_eq!(host(wrong), Err(ProxyError::NotAHost), "{wrong}");
        }
    }
}
