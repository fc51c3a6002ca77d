//! The table of a procedure that asks for the transfer function.

use crate::config::procedure::model::Procedure;
use crate::config::reader::Reader;
use crate::config::section::Section;
use crate::config::table::Table;
use crate::i18n::note;
use crate::measurand::{RESPONSE_FLATNESS, Test};
use crate::rate_table::transfer::TransferTest;
use crate::recording::Role;

/// A test of the transfer function: the table moves over frequency (sine steps, a sweep, random motion), and its measured
/// angle or rate is the input. This table makes its measurands available: `bandwidth_3db`, `bandwidth_3db_model`,
/// `bandwidth_phase_90`, `latency`, `resonance_peak` and `response_flatness`.
#[derive(Table)]
#[table("transfer_test")]
pub(crate) struct TransferKeys {
    /// End of the band of `response_flatness`.
    #[key(quantity = "Hz", above = 0, example = "20 Hz")]
    flat_to_hz: Option<f64>,
    /// Least share of the power of the output that the motion explains at a frequency that counts.
    #[key(above = 0, max = 0.9999, default = 0.9, example = 0.9)]
    least_coherence: f64,
}

impl From<TransferKeys> for TransferTest {
    fn from(keys: TransferKeys) -> TransferTest {
        TransferTest { flat_to_hz: keys.flat_to_hz, least_coherence: keys.least_coherence }
    }
}

/// What a test of the transfer function and its measurands need of each other.
pub(crate) fn validate(procedure: &Procedure, root: &Section, reader: &mut Reader<'_>) {
    for section in root.tables("measurand") {
        let Some(measurand) = section.measurand("id") else { continue };
        let at = section.span_of("id");
        match (&procedure.transfer_test, measurand.test()) {
            (None, Test::Transfer) => {
                let table = "transfer_test";
                reader.error(&at, note!("check_temperature.needs_table", id = measurand.id, table), None);
            }
            (Some(test), Test::Transfer) if *measurand == RESPONSE_FLATNESS && test.flat_to_hz.is_none() => {
                reader.error(&at, "transfer.needs_flat_to", None);
            }
            (Some(_), test) if test != Test::Transfer => {
                reader.error(&at, note!("influence_check.static", id = measurand.id), None);
            }
            _ => {}
        }
    }
    let Some(section) = root.table("transfer_test") else { return };
    let is_input = |role: Role| matches!(role, Role::TableAngle | Role::TableRate);
    if !procedure.channels.iter().any(|c| is_input(c.channel.role)) {
        reader.error(&section.span.clone(), "transfer.no_input", None);
    }
}
