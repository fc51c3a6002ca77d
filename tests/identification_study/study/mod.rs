//! Support of the identification study: mixes, an independent generator, an oracle, the usual alternatives, tables.

pub mod allan;
pub mod alternatives;
pub mod claims;
pub mod generator;
pub mod gmwm;
pub mod mixes;
pub mod oracle;
pub mod record;
pub mod rivals;
pub mod run;
pub mod table;
pub mod tally;
pub mod whittle;
