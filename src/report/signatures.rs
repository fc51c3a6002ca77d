//! The signatures of a result as its pages show them.

use super::number::date_time;
use super::translator::Translator;
use crate::i18n::{Arg, Lang, Localize, note};
use crate::measurand;
use crate::output::MAX_RECORD_BYTES;
use crate::signing::{Link, Role};
use sagnac_ingest::read_file;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// File in which a folder keeps what its pages show of the signatures of another.
pub const SIGNATURES_SHOWN: &str = "signatures.json";

/// A signature, as it was found when the page was made.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Signature {
    /// What the signer did.
    pub role: Role,
    /// Name of the signer, as stated.
    pub name: Option<String>,
    /// When, RFC 3339.
    pub signed_at: String,
    /// Fingerprint of the key; absent where the signature does not hold.
    pub key: Option<String>,
    /// Whether it held, and the files were those that were signed.
    pub holds: bool,
    /// Rows that it lets pass, with the reasons.
    pub waived: Vec<WaivedRow>,
}

/// A row that is let pass.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct WaivedRow {
    /// Measurand, with `@channel` where there are several.
    pub row: String,
    /// Why.
    pub reason: String,
}

/// A row that a signature which holds lets pass, as a page marks it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct WaivedView {
    /// Id of the measurand.
    pub id: String,
    /// Channel; empty where the quantity has but one.
    pub channel: String,
    /// Name of the quantity.
    pub row: String,
    /// Who decided: the name, or else the key.
    pub by: String,
    /// Why.
    pub reason: String,
}

/// The same in the words of a page.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct SignatureView {
    /// What the signer did: the id of the role.
    pub role_id: &'static str,
    /// What the signer did, in words.
    pub role: String,
    /// Name of the signer.
    pub name: String,
    /// When.
    pub at: String,
    /// Fingerprint of the key.
    pub key: String,
    /// Class of the state, for colours.
    pub status: &'static str,
    /// Whether it holds.
    pub status_word: String,
    /// Rows that it lets pass.
    pub waived: Vec<WaivedView>,
}

/// The name of a row as a waiver states it: the id of its measurand, with `@channel` where there are several.
pub fn row_name(row: &str) -> Arg {
    let (id, channel) = row.split_once('@').map_or((row, None), |(id, channel)| (id, Some(channel)));
    let name = match measurand::find(id) {
        Some(_) => Arg::key("measurand", id),
        None => Arg::from(id),
    };
    match channel {
        Some(channel) => note!("signer.row", row = name, channel).into(),
        None => name,
    }
}

/// The rows that signatures let pass which hold.
pub(super) fn waived(signatures: &[Signature], lang: Lang) -> Vec<WaivedView> {
    signatures.iter().filter(|s| s.holds).flat_map(|s| s.waived_view(lang)).collect()
}

/// The signatures that the pages of a folder show, where they are those of another.
pub fn shown(folder: &Path) -> Vec<Signature> {
    let bytes = read_file(&folder.join(SIGNATURES_SHOWN), MAX_RECORD_BYTES).unwrap_or_default();
    serde_json::from_slice(&bytes).unwrap_or_default()
}

impl Signature {
    /// The signatures of a chain, but for links of which nothing can be read.
    pub fn of_chain(links: &[Link]) -> Vec<Signature> {
        let of = |link: &Link| {
            let said = &link.statement.as_ref()?.predicate;
            Some(Signature {
                role: said.role,
                name: said.name.clone(),
                signed_at: said.signed_at.clone(),
                key: link.fingerprint(),
                holds: link.broken.is_empty(),
                waived: said
                    .waivers
                    .iter()
                    .map(|w| WaivedRow { row: w.row.clone(), reason: w.reason.clone() })
                    .collect(),
            })
        };
        links.iter().filter_map(of).collect()
    }

    pub(super) fn view(&self, lang: Lang) -> SignatureView {
        let words = Translator { lang };
        let (status, key) = if self.holds { ("ok", "signer.holds") } else { ("invalid", "signer.broken") };
        SignatureView {
            role_id: self.role.id(),
            role: words.name("signer", self.role.id()),
            name: self.name.clone().unwrap_or_default(),
            at: date_time(&self.signed_at),
            key: self.key.clone().unwrap_or_default(),
            status,
            status_word: words.t(key),
            waived: self.waived_view(lang),
        }
    }

    fn waived_view(&self, lang: Lang) -> Vec<WaivedView> {
        let by = self.name.clone().or_else(|| self.key.clone()).unwrap_or_default();
        let each = |w: &WaivedRow| {
            let (id, channel) = w.row.split_once('@').unwrap_or((&w.row, ""));
            WaivedView {
                id: id.to_owned(),
                channel: channel.to_owned(),
                row: note!("signer.quantity", row = row_name(&w.row)).say(lang),
                by: by.clone(),
                reason: w.reason.clone(),
            }
        };
        self.waived.iter().map(each).collect()
    }
}
