//! Proofs: something is concealed of a recording, the engine explains what is left in a process of its own, and the answer is
//! judged by rules that were written down before.

mod compare;
mod confined;
mod engine;
mod figures;
mod judge;
mod order;
mod protocol;
mod rows;

use crate::config::model;
use crate::config::proof::{ClaimSource, ProofFile, Source};
use crate::config::text_file;
use crate::figure::Figure;
use crate::i18n::{Note, note};
use crate::record::{
    ClaimOrigin, Hidden, HiddenKind, PROOF_FORMAT, Program, ProofOutcome, ProofRecord, ProofRecording,
};
use crate::report::ExplanationResults;
pub use engine::CLAIM_FILE;
use engine::{RECORDING_FILE, Room};
pub use order::ProofOrder;
use protocol::Protocol;
use rows::{Prepared, text_of};

/// A proof with what its page shows.
#[derive(Debug, Clone, PartialEq)]
pub struct Proved {
    /// The record.
    pub record: ProofRecord,
    /// Figures: the inferred course, then those of the explanations.
    pub figures: Vec<Figure>,
    /// The claim as a model.
    pub claim: String,
}

/// Conceals, explains, unveils, judges. `doing` is told what begins, as a key of the locale tables.
///
/// # Errors
/// A note where the recording is not the one that is named, lacks a column, or cannot be explained.
pub fn prove(order: &ProofOrder<'_>, doing: &mut dyn FnMut(&'static str)) -> Result<Proved, Note> {
    doing("prove.doing.reading");
    let prepared = rows::prepare(order)?;
    let hidden = hidden(order.proof, &prepared);
    let mut protocol = Protocol::default();
    protocol.add("concealed", hidden.iter().map(|h| (h.name.clone(), h.sha256.clone())).collect());

    doing("prove.doing.claim");
    let mut room = Room::new()?;
    let (origin, claim, mut confined) = claim(order, &prepared, &mut room, &mut protocol)?;
    room.put(CLAIM_FILE, &claim)?;
    protocol.add("claim", room.shown());

    doing("prove.doing.explaining");
    room.put(RECORDING_FILE, &text_of(&prepared.shown))?;
    protocol.add("shown", room.shown());
    let (concealed, kept) = room.explain(order.program)?;
    confined &= kept;
    protocol.add("explained", concealed.hashes());
    drop(room);

    let mut unveiled = None;
    if let Some(series) = &prepared.unveiled {
        doing("prove.doing.unveiling");
        let mut room = Room::new()?;
        room.put(CLAIM_FILE, &claim)?;
        room.put(RECORDING_FILE, &text_of(series))?;
        protocol.add("unveiled", room.shown());
        let (said, kept) = room.explain(order.program)?;
        confined &= kept;
        protocol.add("explained_again", said.hashes());
        unveiled = Some(said.results);
    }
    let done = Done { hidden, origin, confined, protocol, concealed: concealed.results, unveiled };
    Ok(told(order, &prepared, done, claim))
}

/// The claim of a proof as the text of a model: where it comes from, and whether its process was confined.
fn claim(
    order: &ProofOrder<'_>,
    prepared: &Prepared,
    room: &mut Room,
    protocol: &mut Protocol,
) -> Result<(ClaimOrigin, String, bool), Note> {
    match &order.proof.claim {
        ClaimSource::Model(path) => {
            let unreadable = || note!("prove.error.unreadable", path = path.display().to_string());
            let text = text_file::read(path).ok().and_then(|bytes| String::from_utf8(bytes).ok());
            Ok((ClaimOrigin::Model, text.ok_or_else(unreadable)?, true))
        }
        ClaimSource::Identified { rate, .. } => {
            room.put("claim.csv", &text_of(prepared.claim.as_ref().unwrap_or(&prepared.shown)))?;
            protocol.add("shown", room.shown());
            let (text, confined) = room.identify(order.program)?;
            room.remove("claim.csv")?;
            let origin = if rate.is_some() { ClaimOrigin::OtherOutput } else { ClaimOrigin::Part };
            Ok((origin, text, confined))
        }
    }
}

/// Steps of the proof.
struct Done {
    hidden: Vec<Hidden>,
    origin: ClaimOrigin,
    confined: bool,
    protocol: Protocol,
    concealed: ExplanationResults,
    unveiled: Option<ExplanationResults>,
}

/// The record and figures of what was done.
fn told(order: &ProofOrder<'_>, prepared: &Prepared, done: Done, claim: String) -> Proved {
    let proof = order.proof;
    let course = compare::course(&done.concealed, &prepared.shown);
    let courses = compare::courses(course.as_deref(), prepared);
    let answers = judge::Answers {
        concealed: &done.concealed.file.explanation,
        unveiled: done.unveiled.as_ref().map(|u| &u.file.explanation),
        courses: &courses,
    };
    let rules = judge::rules(proof, &answers);
    let references = judge::references(proof, &answers);
    let outcome = if rules.iter().all(|r| r.holds) { ProofOutcome::Holds } else { ProofOutcome::Fails };
    let figures = figures::all(prepared, course.as_deref(), &done.concealed, done.unveiled.as_ref());
    let record = ProofRecord {
        format: PROOF_FORMAT.to_owned(),
        program: Program::this(),
        path: order.path.to_owned(),
        sha256: order.sha256.to_owned(),
        title: proof.title.clone(),
        question: proof.question.clone(),
        proved_at: order.proved_at.to_owned(),
        outcome,
        recording: ProofRecording {
            path: prepared.path.clone(),
            sha256: prepared.sha256.clone(),
            simulated: matches!(proof.source, Source::Simulated { .. }),
            rows: prepared.shown.time_s.len(),
            sample_interval_s: prepared.shown.sample_interval_s,
            shown: prepared.shown.columns.keys().map(|c| c.name().to_owned()).collect(),
            decoys: proof.decoys.iter().map(|d| d.name.clone()).collect(),
        },
        hidden: done.hidden,
        claim: done.origin,
        confined: done.confined,
        protocol: done.protocol.steps,
        concealed: done.concealed.file.explanation,
        unveiled: done.unveiled.map(|u| u.file.explanation),
        courses,
        references,
        rules,
    };
    Proved { record, figures, claim }
}

/// Everything that is concealed, with its hash.
fn hidden(proof: &ProofFile, prepared: &Prepared) -> Vec<Hidden> {
    let column = |(name, values): (&String, &Vec<f64>)| Hidden {
        name: name.clone(),
        what: HiddenKind::Column,
        sha256: rows::hash_of(values),
    };
    let mut hidden: Vec<Hidden> = prepared.hidden.iter().map(column).collect();
    if let Some(added) = &prepared.added {
        let what = HiddenKind::Added;
        hidden.push(Hidden { name: added.kinds.join(", "), what, sha256: rows::hash_of(&added.course) });
    }
    if let Source::Simulated { model, .. } = &proof.source
        && let Ok(claim) = model::load(model)
        && !claim.effects.is_empty()
    {
        let kinds: Vec<&str> = claim.effects.iter().map(|e| e.effect.kind()).collect();
        let sha256 = prepared.sha256.clone();
        hidden.push(Hidden { name: kinds.join(", "), what: HiddenKind::Simulated, sha256 });
    }
    hidden
}
