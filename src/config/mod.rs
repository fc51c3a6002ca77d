//! TOML files whose keys are described once, as data: reading with every problem placed, and the parts of schema and
//! guide that follow from the description.
//!
//! [`procedure`], [`model`], [`bench`], [`alternatives`], [`schedule`], [`sheet`], [`proof`], [`manifest`], [`layout`], [`laboratory`],
//! [`serve`], [`watch`] and [`user`] are the files; the others know none of them.

pub mod alternatives;
pub mod bench;
pub(crate) mod contained_files;
pub mod diagnostics;
pub mod external;
pub mod laboratory;
pub mod layout;
mod line_repair;
pub mod manifest;
pub mod model;
pub mod procedure;
pub mod program;
pub mod proof;
pub mod quantity;
pub(crate) mod read_tables;
pub(crate) mod reader;
pub mod recording_keys;
pub(crate) mod role_words;
pub mod schedule;
pub(crate) mod section;
pub mod serve;
pub mod sheet;
pub mod shipped;
pub mod spec;
mod syntax;
pub(crate) mod table;
pub(crate) mod text_file;
mod texts;
pub mod user;
pub(crate) mod values;
pub mod watch;
