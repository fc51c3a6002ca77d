//! `sagnac sign` and `sagnac approve`: a signature on a folder of results.

use super::{exit, place};
use crate::estimate::Verdict;
use crate::i18n::{Lang, Note};
use crate::output::Kind;
use crate::record::{self, RunRecord};
use crate::signing::{self, Role, SIGNATURES_FOLDER, SignOff, Waived};
use crate::verify::{Finding, Folder, hashes, stated_hashes};
use chrono::{SecondsFormat, Utc};
use clap::{Args, ValueEnum};
use std::path::PathBuf;

#[derive(Debug, Args)]
pub struct SignArgs {
    #[command(flatten)]
    what: KeyArgs,
    /// What the signer did: made the test, checked the result, decided on the unit
    #[arg(long, value_name = "ROLE", default_value = "tested")]
    role: RoleArg,
}

#[derive(Debug, Args)]
pub struct ApproveArgs {
    #[command(flatten)]
    what: KeyArgs,
    /// What the signer did: made the test, checked the result, decided on the unit
    #[arg(long, value_name = "ROLE", default_value = "approved")]
    role: RoleArg,
    /// Row that is let pass in spite of its verdict: the id of its measurand, with @CHANNEL where there are several; several by
    /// repeating the option, each with its reason
    #[arg(long, value_name = "ROW", requires = "reason")]
    waive: Vec<String>,
    /// Reason of a waiver
    #[arg(long, value_name = "TEXT", requires = "waive")]
    reason: Vec<String>,
}

/// What is signed and by which key.
#[derive(Debug, Args)]
struct KeyArgs {
    /// Folder of a result, or its record
    #[arg(value_name = "DIR")]
    folder: PathBuf,
    /// Key of kind Ed25519: a private key, or a public one whose private key the agent holds
    #[arg(long, value_name = "FILE")]
    key: PathBuf,
    /// Name of the signer
    #[arg(long, value_name = "NAME")]
    name: Option<String>,
}

/// What a signer did.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum RoleArg {
    Tested,
    Reviewed,
    Approved,
}

impl From<RoleArg> for Role {
    fn from(role: RoleArg) -> Role {
        match role {
            RoleArg::Tested => Role::Tested,
            RoleArg::Reviewed => Role::Reviewed,
            RoleArg::Approved => Role::Approved,
        }
    }
}

pub fn sign(args: &SignArgs, lang: Lang) -> Result<u8, String> {
    put(&args.what, args.role.into(), vec![], false, lang)
}

pub fn approve(args: &ApproveArgs, lang: Lang) -> Result<u8, String> {
    if args.waive.len() != args.reason.len() {
        return Err(place::error(&"signing.reasons".into(), lang));
    }
    let waivers = args.waive.iter().zip(&args.reason);
    let waivers = waivers.map(|(row, reason)| Waived { row: row.clone(), reason: reason.clone() }).collect();
    put(&args.what, args.role.into(), waivers, true, lang)
}

/// Signs a folder that is as it was written; `follows` where another signature must stand there already.
fn put(args: &KeyArgs, role: Role, waivers: Vec<Waived>, follows: bool, lang: Lang) -> Result<u8, String> {
    let say = |note: Note| place::error(&note, lang);
    let folder = Folder::at(&args.folder).map_err(say)?;
    let wrong: Vec<Finding> =
        hashes(&folder, SIGNATURES_FOLDER).into_iter().filter(Finding::differs).collect();
    if let Some(Finding::Differs(note)) = wrong.first() {
        return Err(say(Note::new("signing.changed").with("why", note.clone())));
    }
    let files = signing::files_of(&folder.path, stated_hashes(&folder.path).into_keys());
    let links = signing::chain(&folder.path, &files);
    if let Some(link) = links.iter().find(|l| !l.broken.is_empty()) {
        return Err(say(Note::new("signing.broken_chain").with("name", link.name.as_str())));
    }
    if follows && links.is_empty() {
        return Err(say("signing.nothing_to_approve".into()));
    }
    let run: Option<RunRecord> = match folder.kind {
        Kind::Result => {
            Some(record::read::open(&folder.record_file()).map_err(|e| say(e.note(&folder.record_file())))?)
        }
        _ => None,
    };
    for waived in &waivers {
        may_be_waived(run.as_ref(), &waived.row).map_err(say)?;
    }
    let procedure = run.as_ref().and_then(|r| r.procedure.as_ref());
    let about = SignOff {
        role,
        signed_at: Utc::now().to_rfc3339_opts(SecondsFormat::Secs, true),
        name: args.name.clone(),
        record: folder.kind.record_file().to_owned(),
        verdict: run.as_ref().map(|r| r.verdict.id().to_owned()),
        serial: run.as_ref().and_then(|r| r.unit_under_test.serial.clone()),
        procedure_sha256: procedure.map(|p| p.sha256.clone()),
        limits_sha256: procedure.and_then(|p| Some(p.limits.as_ref()?.sha256.clone())),
        previous: None,
        waivers,
    };
    let name = signing::sign(&folder.path, &files, &args.key, about).map_err(say)?;
    let written = folder.path.join(SIGNATURES_FOLDER).join(name);
    place::print(&format!("{}\n", place::shown(&written)));
    Ok(exit::PASS)
}

/// Refuses to waive what is no row of the result, or a row that passed.
fn may_be_waived(run: Option<&RunRecord>, row: &str) -> Result<(), Note> {
    let (id, channel) = row.split_once('@').map_or((row, None), |(id, channel)| (id, Some(channel)));
    let rows = run.into_iter().flat_map(|r| &r.measurands);
    let of_row = |m: &&record::MeasurandRecord| m.id == id && channel.is_none_or(|c| m.channel == c);
    let found: Vec<&record::MeasurandRecord> = rows.filter(of_row).filter(|m| m.limit.is_some()).collect();
    match found.as_slice() {
        [] => Err(Note::new("signing.no_row").with("row", row)),
        [one] if matches!(one.verdict, Verdict::Fail | Verdict::Indeterminate) => Ok(()),
        [_] => Err(Note::new("signing.row_passed").with("row", row)),
        several => {
            let channels: Vec<&str> = several.iter().map(|m| m.channel.as_str()).collect();
            Err(Note::new("signing.several_rows").with("row", row).with("channels", channels.join(", ")))
        }
    }
}
