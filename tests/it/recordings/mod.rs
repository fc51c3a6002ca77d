//! Recordings as laboratories have them: formats, dialects, stamps, and what `inspect` says of them.

mod binary;
mod binary_files;
mod bursts;
mod containers;
mod cut;
mod inspect;
mod plausible;
mod raw;
mod second_source;
mod text;
mod time_base;
