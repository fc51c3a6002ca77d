//! What a procedure says of its bench: who checks it, who demands it, and which thermometers are compared.

use super::model::Procedure;
use super::named_channel::channel_of;
use super::reader::Reader;
use super::section::Section;
use crate::i18n::note;
use crate::measurand;
use crate::recording::Role;

/// Reports what a bench and its thermometers cannot be.
pub(super) fn validate(procedure: &Procedure, root: &Section, reader: &mut Reader<'_>) {
    bench(procedure, root, reader);
    thermometer_pairs(procedure, root, reader);
}

/// Reports a bench that is neither checked nor demanded, or both at once.
fn bench(procedure: &Procedure, root: &Section, reader: &mut Reader<'_>) {
    let (Some(bench), Some(section)) = (&procedure.bench, root.table("bench")) else { return };
    match (bench.releases_for_s, bench.released_within_s) {
        (None, None) => {
            reader.error(&section.span, "bench.states_nothing", Some("bench.help.states_nothing".into()));
        }
        (Some(_), Some(_)) => {
            let help = Some("bench.help.both".into());
            reader.error(&section.span_of("released_within"), "bench.both", help);
        }
        _ => {}
    }
    if bench.released_within_s.is_some() && bench.check == procedure.id {
        let message = note!("bench.own_check", id = procedure.id.as_str());
        reader.error(&section.span_of("check"), message, None);
    }
}

/// Reports pairs of other channels, of one channel, and ids that stand for something else.
fn thermometer_pairs(procedure: &Procedure, root: &Section, reader: &mut Reader<'_>) {
    let mut seen: Vec<String> = vec![];
    for section in root.tables("thermometer_pair") {
        for key in ["channel", "reference"] {
            let suits = |role| role == Role::Temperature;
            channel_of((section, key), procedure, root, suits, "check.needs_temperature", reader);
        }
        let (one, other) = (section.text("channel"), section.text("reference"));
        if one.is_some() && one == other {
            reader.error(&section.span_of("reference"), "thermometer_pair.one_channel", None);
        }
        let Some(id) = section.text("id") else { continue };
        let at = section.span_of("id");
        if measurand::find(&id).is_some() || measurand::called(&id).is_some() {
            reader.error(&at, note!("external.of_standard", id = id.as_str()), None);
        } else if seen.contains(&id) || procedure.externals.iter().any(|e| e.id == id) {
            reader.error(&at, note!("external.twice", id = id.as_str()), None);
        }
        seen.push(id);
    }
}
