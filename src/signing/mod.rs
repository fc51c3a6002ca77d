//! Signatures on a folder of results: each a statement about its files by the hash (in-toto), signed by a key (SSHSIG), in a
//! chain in which each names the one before.
//!
//! They show that nothing was changed since and by which key it was signed. They are no qualified electronic signatures.

mod chain;
mod key;
mod pattern;
mod role;
mod signers;
mod statement;

pub use crate::output::SIGNATURES_FOLDER;
pub use chain::{Broken, Link, chain, files, files_of, hold, is_leftover, sign, strays};
pub use key::SIGNATURE_NAMESPACE;
pub use role::Role;
pub use signers::{BadLine, Refusal, Signers, Standing, moment};
pub use statement::{Previous, SignOff, Statement, Subject, Waived};
