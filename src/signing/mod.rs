//! Signatures on a folder of results: each a statement about its files by the hash (in-toto), signed by a key (SSHSIG), in a
//! chain in which each names the one before.
//!
//! They show that nothing was changed since and by which key it was signed. They are no qualified electronic signatures.

mod chain;
mod key;
mod role;
mod signers;
mod statement;

pub use chain::{Broken, Link, SIGNATURES_FOLDER, chain, files_of, sign};
pub use key::NAMESPACE;
pub use role::Role;
pub use signers::Signers;
pub use statement::{Previous, SignOff, Statement, Subject, Waived};
