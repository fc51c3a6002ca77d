//! A channel that a key of a procedure names: whether it is declared, and with a role that suits.

use super::model::Procedure;
use super::reader::{Reader, meant, shorten};
use super::section::Section;
use crate::i18n::{Note, note};
use crate::recording::Role;
use sagnac_core::spelling::nearest;

/// Checks that a named channel is declared with a role that suits; says what is there otherwise.
pub(super) fn channel_of(
    (section, key): (&Section, &'static str),
    procedure: &Procedure,
    root: &Section,
    suits: fn(Role) -> bool,
    wanted: &'static str,
    reader: &mut Reader<'_>,
) {
    let Some(id) = section.text(key) else { return };
    let at = section.span_of(key);
    let declared = root.tables("channel").iter().find(|s| s.text("id").as_deref() == Some(id.as_str()));
    let Some(declared) = declared else {
        let known: Vec<String> = root.tables("channel").iter().filter_map(|s| s.text("id")).collect();
        let help = match nearest(&id, known.iter().map(String::as_str)) {
            Some(near) => meant(near),
            None => note!("check.help.declared", channels = known.join(", ")),
        };
        reader.error(&at, note!("check.undeclared", id = shorten(&id)), Some(help));
        return;
    };
    let role = Role::ALL.iter().copied().find(|r| Some(r.id()) == declared.word("role"));
    if let Some(role) = role.filter(|r| !suits(*r)) {
        let message = Note::new(wanted).with("id", id.as_str()).with("role", role.id());
        let fits: Vec<&str> = procedure
            .channels
            .iter()
            .filter(|c| suits(c.channel.role))
            .map(|c| c.channel.id.as_str())
            .collect();
        let help = note!("check.help.suiting", channels = fits.join(", "));
        reader.error(&at, message, (!fits.is_empty()).then_some(help));
    }
}
