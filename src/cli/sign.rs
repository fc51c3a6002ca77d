//! `sagnac sign`, and `sagnac approve` for one of its roles: a signature on a folder of results.

use super::options::renderer;
use super::{exit, place};
use crate::estimate::Verdict;
use crate::i18n::{Lang, Note, note};
use crate::moment;
use crate::record::{self, RunRecord};
use crate::signing::{self, Role, SIGNATURES_FOLDER, SignOff, Waived};
use crate::verify::{Finding, Folder, contents, required, run_of, stated_hashes};
use chrono::SecondsFormat;
use clap::{Args, ValueEnum};
use std::path::PathBuf;

/// The folder to sign, the role and the key.
#[derive(Debug, Args)]
pub struct SignArgs {
    /// Folder of a result, or its record
    #[arg(value_name = "DIR")]
    folder: PathBuf,
    /// Key of kind Ed25519: a private key, or a public one whose private key the agent holds
    #[arg(long, value_name = "FILE")]
    key: PathBuf,
    /// Name of the signer
    #[arg(long, value_name = "NAME")]
    name: Option<String>,
    /// What the signer did: made the test, checked the result, decided on the unit [default: tested; of `approve`: approved]
    #[arg(long, value_name = "ROLE")]
    role: Option<RoleArg>,
    /// Row that is let pass in spite of its verdict: the id of its measurand, with @CHANNEL where there are several; several by
    /// repeating the option, each with its reason
    #[arg(long, value_name = "ROW", requires = "reason")]
    waive: Vec<String>,
    /// Reason of a waiver
    #[arg(long, value_name = "TEXT", requires = "waive")]
    reason: Vec<String>,
    /// Folder of the templates that the pages were made with
    #[arg(long, value_name = "DIR")]
    templates: Option<PathBuf>,
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

/// Signs a folder.
pub fn sign(args: &SignArgs, lang: Lang) -> Result<u8, String> {
    put(args, args.role.unwrap_or(RoleArg::Tested).into(), false, lang)
}

/// Signs a folder on which another signature stands already.
pub fn approve(args: &SignArgs, lang: Lang) -> Result<u8, String> {
    put(args, args.role.unwrap_or(RoleArg::Approved).into(), true, lang)
}

/// Signs a folder that is what its record gives; `follows` where another signature must stand there already. No key is used before all
/// of it was checked.
fn put(args: &SignArgs, role: Role, follows: bool, lang: Lang) -> Result<u8, String> {
    let say = |note: Note| place::error(&note, lang);
    let waivers = waivers(args).map_err(say)?;
    let folder = Folder::at(&args.folder).map_err(say)?;
    let _held = signing::hold(&folder.path);
    for finding in contents(&folder, &renderer(args.templates.as_deref(), lang)?) {
        let key = match finding {
            Finding::Differs(_) => "signing.changed",
            Finding::Undone(_) => "signing.unchecked",
            Finding::Agrees(_) | Finding::Unchecked(_) => continue,
        };
        return Err(say(Note::new(key).with("why", finding.note().clone())));
    }
    let files = signing::files_of(&folder.path, stated_hashes(&folder.path).into_keys());
    let links = signing::chain(&folder.path, &files);
    if let Some(link) = links.iter().find(|l| !l.broken.is_empty()) {
        return Err(say(note!("signing.broken_chain", name = link.name.as_str())));
    }
    let strays = signing::strays(&folder.path);
    if let Some(stray) = strays.iter().find(|stray| !signing::is_leftover(stray, links.len())) {
        let why = note!("verify.added", name = stray.as_str());
        return Err(say(note!("signing.changed", why)));
    }
    if follows && links.is_empty() {
        return Err(say("signing.nothing_to_approve".into()));
    }
    let run = run_of(&folder);
    for waived in &waivers {
        may_be_waived(run.as_ref(), &waived.row).map_err(say)?;
    }
    let procedure = run.as_ref().and_then(|r| r.procedure.as_ref());
    let about = SignOff {
        role,
        signed_at: moment::now().to_rfc3339_opts(SecondsFormat::Secs, true),
        name: args.name.clone(),
        record: folder.kind.record_file().to_owned(),
        verdict: run.as_ref().map(|r| r.verdict.id().to_owned()),
        serial: run.as_ref().and_then(|r| r.unit_under_test.serial.clone()),
        procedure_sha256: procedure.map(|p| p.sha256.clone()),
        limits_sha256: procedure.and_then(|p| Some(p.limits.as_ref()?.sha256.clone())),
        required: required(&folder, &links).into_iter().collect(),
        previous: None,
        waivers,
    };
    let name = signing::sign(&folder.path, &files, &args.key, about).map_err(say)?;
    let written = folder.path.join(SIGNATURES_FOLDER).join(name);
    place::print(&format!("{}\n", place::shown(&written)));
    Ok(exit::PASS)
}

/// The rows that are to be let pass, each with its reason.
fn waivers(args: &SignArgs) -> Result<Vec<Waived>, Note> {
    if args.waive.len() != args.reason.len() {
        return Err("signing.reasons".into());
    }
    let each = |(row, reason): (&String, &String)| match reason.trim() {
        "" => Err(note!("signing.empty_reason", row = row.as_str())),
        reason => Ok(Waived { row: row.clone(), reason: reason.to_owned() }),
    };
    args.waive.iter().zip(&args.reason).map(each).collect()
}

/// Refuses to waive what is no row of the result, or a row that passed.
fn may_be_waived(run: Option<&RunRecord>, row: &str) -> Result<(), Note> {
    let (id, channel) = row.split_once('@').map_or((row, None), |(id, channel)| (id, Some(channel)));
    let rows = run.into_iter().flat_map(|r| &r.measurands);
    let of_row = |m: &&record::MeasurandRecord| m.id == id && channel.is_none_or(|c| m.channel == c);
    let found: Vec<&record::MeasurandRecord> = rows.filter(of_row).filter(|m| m.limit.is_some()).collect();
    match found.as_slice() {
        [] => Err(note!("signing.no_row", row)),
        [one] if matches!(one.verdict, Verdict::Fail | Verdict::Indeterminate) => Ok(()),
        [_] => Err(note!("signing.row_passed", row)),
        several => {
            let channels: Vec<&str> = several.iter().map(|m| m.channel.as_str()).collect();
            Err(note!("signing.several_rows", row, channels = channels.join(", ")))
        }
    }
}
