//! The signatures of a folder: whether each holds, by whom it is, and whether those that are asked for are there.

use super::finding::Finding;
use super::folder::{Folder, run_of, stated_hashes};
use super::parts;
use crate::config::procedure::load;
use crate::i18n::{Arg, Note, note};
use crate::output::{Kind, PROCEDURE_FILE};
use crate::record::{ProcedureRecord, RunRecord};
use crate::report::number::date_time;
use crate::report::signatures::row_name;
use crate::signing::{self, Broken, Link, Role, Signers, Standing};
use chrono::{DateTime, Utc};
use std::collections::BTreeSet;

/// By what signatures are judged.
#[derive(Debug, Clone, Copy)]
pub struct Signing<'a> {
    /// Who may sign; anybody where no list was given.
    pub signers: Option<&'a Signers>,
    /// The moment at which keys must be valid.
    pub at: DateTime<Utc>,
}

/// The signatures of a folder, and whether those that its procedure or a signer asks for are there. The units of a lot are signed one by
/// one, or with the lot.
pub fn signatures(folder: &Folder, by: Signing<'_>) -> Vec<Finding> {
    let (mut findings, links) = of_folder(folder, by);
    let mut missing = missing_roles(&links, &required(folder, &links));
    if folder.kind == Kind::Lot {
        let units = parts::record(folder).map(|lot| lot.units).unwrap_or_default();
        let mut all_signed = !units.is_empty();
        for unit in &units {
            let Some(at) = parts::folder_of(folder, unit) else { continue };
            let (of_unit, own) = of_folder(&at, by);
            findings.extend(of_unit.into_iter().map(|f| parts::below(&unit.folder, f)));
            all_signed &= missing_roles(&own, &required(&at, &own)).is_empty() && !own.is_empty();
        }
        if all_signed {
            missing.clear();
        }
    }
    let is_signed = findings.iter().any(|f| f.note().id.starts_with("verify.signed"));
    findings.extend(
        missing
            .into_iter()
            .map(|role| Finding::Differs(note!("verify.role_missing", role = Arg::key("signer", role.id())))),
    );
    if by.signers.is_some() && !is_signed {
        findings.push(Finding::Differs("verify.nothing_signed".into()));
    }
    findings
}

fn of_folder(folder: &Folder, by: Signing<'_>) -> (Vec<Finding>, Vec<Link>) {
    let files = signing::files_of(&folder.path, stated_hashes(&folder.path).into_keys());
    let links = signing::chain(&folder.path, &files);
    let mut findings: Vec<Finding> = links.iter().flat_map(|link| of_link(link, by)).collect();
    let strays = signing::strays(&folder.path).into_iter().map(|name| {
        let key = match signing::is_leftover(&name, links.len()) {
            true => "verify.signature_alone",
            false => "verify.added",
        };
        Finding::Differs(Note::new(key).with("name", name))
    });
    findings.extend(strays);
    (findings, links)
}

/// The roles whose signatures are asked for: by the record, by the copies of the procedures, and by what was signed.
pub fn required(folder: &Folder, links: &[Link]) -> BTreeSet<Role> {
    let mut roles: BTreeSet<Role> = links
        .iter()
        .filter(|link| link.broken.is_empty())
        .filter_map(|link| link.statement.as_ref())
        .flat_map(|statement| statement.predicate.required.iter().copied())
        .collect();
    let run = run_of(folder);
    let lot = (folder.kind == Kind::Lot).then(|| parts::record(folder).ok()).flatten();
    roles.extend(run.iter().flat_map(required_by_record));
    roles.extend(lot.iter().flat_map(|lot| of_procedure(&lot.procedure)));
    let phases = run.iter().flat_map(|run| &run.phases).filter_map(|phase| phase.folder.as_ref());
    let copies = phases.map(|below| folder.path.join(below)).chain([folder.path.clone()]);
    let copies = copies.map(|below| below.join(PROCEDURE_FILE)).filter(|copy| copy.is_file());
    roles.extend(copies.filter_map(|copy| load(&copy).ok()).flat_map(|p| p.value.report.signatures));
    roles
}

/// The roles that the procedures of a record ask for.
fn required_by_record(run: &RunRecord) -> Vec<Role> {
    let phases = run.phases.iter().filter_map(|phase| phase.procedure.as_ref());
    run.procedure.iter().chain(phases).flat_map(of_procedure).collect()
}

fn of_procedure(procedure: &ProcedureRecord) -> Vec<Role> {
    procedure.signatures.iter().flatten().filter_map(|word| Role::of(word)).collect()
}

/// The roles that no signature fills. One key is one person: it does not fill two places.
fn missing_roles(links: &[Link], required: &BTreeSet<Role>) -> Vec<Role> {
    let mut used: Vec<String> = vec![];
    let mut missing = vec![];
    for role in required {
        let own = |l: &&Link| {
            let good = l.broken.is_empty() && l.role() == Some(*role);
            good && l.fingerprint().is_some_and(|f| !used.contains(&f))
        };
        match links.iter().find(own).and_then(Link::fingerprint) {
            Some(fingerprint) => used.push(fingerprint),
            None => missing.push(*role),
        }
    }
    missing
}

fn of_link(link: &Link, by: Signing<'_>) -> Vec<Finding> {
    let name = || link.name.clone();
    if !link.broken.is_empty() {
        let broken = |b: &Broken| {
            let note = |key: &'static str| Note::new(key).with("name", name());
            Finding::Differs(match b {
                Broken::NoStatement => note("verify.link.no_statement"),
                Broken::Unsigned => note("verify.link.unsigned"),
                Broken::Signature(why) => note("verify.link.signature").with("reason", why.as_str()),
                Broken::Rewritten => note("verify.link.rewritten"),
                Broken::File(file) => note("verify.link.file").with("file", file.as_str()),
                Broken::Unsaid(file) => note("verify.link.unsaid").with("file", file.as_str()),
                Broken::Previous => note("verify.link.previous"),
            })
        };
        return link.broken.iter().map(broken).collect();
    }
    let (Some(statement), Some(key)) = (&link.statement, &link.key) else { return vec![] };
    let said = &statement.predicate;
    let note = |key_name: &'static str| {
        Note::new(key_name)
            .with("name", name())
            .with("role", Arg::key("signer", said.role.id()))
            .with("at", date_time(&said.signed_at))
            .with("key", link.fingerprint().unwrap_or_default())
    };
    let mut findings = vec![match by.signers.map(|s| s.standing(key, by.at)) {
        Some(Standing::Allowed(owner)) => Finding::Agrees(note("verify.signed_by").with("owner", owner)),
        Some(Standing::Unknown) => Finding::Differs(note("verify.signed_by_stranger")),
        Some(Standing::Refused(line, why)) => {
            let why = Arg::Key(why.key().to_owned());
            Finding::Differs(note("verify.signed_and_refused").with("line", line).with("why", why))
        }
        None => Finding::Agrees(match said.name.clone() {
            Some(named) => note("verify.signed_as").with("owner", named),
            None => note("verify.signed"),
        }),
    }];
    findings.extend(said.waivers.iter().map(|w| {
        Finding::Unchecked(note!(
            "verify.waived",
            name = name(),
            row = row_name(&w.row),
            reason = w.reason.as_str()
        ))
    }));
    findings
}
