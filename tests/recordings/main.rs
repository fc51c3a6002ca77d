//! Recordings as laboratories have them: formats, dialects, stamps, and what `inspect` says of them.

mod binary;
mod bursts;
mod binary_files;
mod containers;
mod inspect;
mod raw;
#[path = "../support/mod.rs"]
mod support;
mod text;
mod time_base;
