//! The signed statement: an in-toto statement (<https://in-toto.io/Statement/v1>) about the files of a folder.

use super::role::Role;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Type that every such statement declares.
pub const STATEMENT_TYPE: &str = "https://in-toto.io/Statement/v1";

/// The kind of what it says of the files.
pub const SIGN_OFF: &str = "urn:sagnac:sign-off:1";

/// A statement.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Statement {
    /// Always [`STATEMENT_TYPE`].
    #[serde(rename = "_type")]
    pub statement_type: String,
    /// The files that it is about.
    pub subject: Vec<Subject>,
    /// Always [`SIGN_OFF`].
    #[serde(rename = "predicateType")]
    pub predicate_type: String,
    /// What it says of them.
    pub predicate: SignOff,
}

/// A file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Subject {
    /// Its name in the folder.
    pub name: String,
    /// Its hashes by their kinds: `sha256`.
    pub digest: BTreeMap<String, String>,
}

/// What a signer says.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SignOff {
    /// What the signer did.
    pub role: Role,
    /// When, RFC 3339, by the clock of the signer's machine.
    pub signed_at: String,
    /// Name of the signer, as given.
    pub name: Option<String>,
    /// The record that it is about, such as `result.json`.
    pub record: String,
    /// Its verdict: `pass`, `fail`, `indeterminate`, `error`, `none`; absent for records that have none.
    pub verdict: Option<String>,
    /// Serial number of the unit, if the record states one.
    pub serial: Option<String>,
    /// SHA-256 of the procedure and of the limits file, if there are any.
    pub procedure_sha256: Option<String>,
    /// See `procedure_sha256`.
    pub limits_sha256: Option<String>,
    /// The roles whose signatures the procedure asks for, so that this is a part of what is signed.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub required: Vec<Role>,
    /// The statement before this one.
    pub previous: Option<Previous>,
    /// Rows that the signer lets pass in spite of their verdict: a record beside the verdict, never a part of it.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub waivers: Vec<Waived>,
}

/// A statement that another one follows.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Previous {
    /// Its file.
    pub name: String,
    /// SHA-256 of that file.
    pub sha256: String,
}

/// A row that is let pass.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Waived {
    /// Measurand, with `@channel` where there are several.
    pub row: String,
    /// Why.
    pub reason: String,
}
