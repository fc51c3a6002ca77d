//! Lines to be signed, and the signatures that there are.

use crate::record::{RunRecord, Signatory};
use crate::report::page::{Block, Column, Table, Value};
use crate::report::signatures::SignatureView;
use crate::report::translator::Translator;
use crate::signing::Role;

/// What a page shows of those who sign.
pub(super) fn sign_off(
    run: Option<&RunRecord>,
    signatures: &[SignatureView],
    words: Translator,
) -> Vec<Block> {
    let boxes =
        ["report.accepted", "report.rejected", "report.on_hold"].map(|key| format!("☐ {}", words.t(key)));
    let disposition = format!("{}: {}", words.t("report.disposition"), boxes.join(" · "));
    let mut out = vec![Block::heading(words.t("report.signoff")), Block::Paragraph(disposition)];
    let lines = blank_lines(run, signatures, words);
    if !lines.is_empty() {
        out.push(Block::Table(
            Table::new("", lines.len())
                .column(Column::default(), lines.iter().map(|(role, _)| role.as_str()))
                .column(words.column("report.name"), lines.iter().map(|(_, name)| name.as_str()))
                .column(words.column("report.signature"), lines.iter().map(|_| Value::Empty))
                .column(words.column("report.date"), lines.iter().map(|_| Value::Empty)),
        ));
    }
    if !signatures.is_empty() {
        let each = |of: fn(&SignatureView) -> Value| signatures.iter().map(of).collect::<Vec<_>>();
        out.push(Block::Table(
            Table::new("", signatures.len())
                .column(words.column("signer.signed"), each(|s| s.role.as_str().into()))
                .column(words.column("report.name"), each(|s| s.name.as_str().into()))
                .column(words.column("report.date"), each(|s| s.at.as_str().into()))
                .column(words.column("signer.key"), each(|s| Value::Code(s.key.clone())))
                .column(
                    words.column("report.state"),
                    each(|s| Value::state(s.status, s.status_word.as_str())),
                ),
        ));
        out.extend(Block::remarks(signatures.iter().flat_map(|s| waivers(s, words))));
        out.push(Block::Hint(words.t("signer.meaning")));
    }
    out
}

/// Those whose signature is still due: what they do, and the name where it is known.
fn blank_lines(
    run: Option<&RunRecord>,
    signatures: &[SignatureView],
    words: Translator,
) -> Vec<(String, String)> {
    let operator = run.and_then(|r| r.session.operator.clone()).unwrap_or_default();
    let known = [
        (Role::Tested, "report.tested_by", operator),
        (Role::Reviewed, "report.reviewed_by", String::new()),
        (Role::Approved, "report.disposition_by", String::new()),
    ];
    let has_signed = |role: Role| signatures.iter().any(|s| s.status == "ok" && s.role_id == role.id());
    let due = known.into_iter().filter(|(role, ..)| !has_signed(*role));
    let others = run.and_then(|r| r.procedure.as_ref()).map(|p| p.signatories.as_slice()).unwrap_or_default();
    let other = |who: &Signatory| (words.name("signatory", who.id()), String::new());
    due.map(|(_, key, name)| (words.t(key), name)).chain(others.iter().map(other)).collect()
}

/// The rows that a signature lets pass, in words.
fn waivers(signature: &SignatureView, words: Translator) -> Vec<String> {
    let said = |w: &crate::report::signatures::WaivedView| {
        words.with("signer.waives", &[("name", &w.by), ("row", &w.row), ("reason", &w.reason)])
    };
    signature.waived.iter().map(said).collect()
}
