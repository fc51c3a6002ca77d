//! Broken and odd files: every problem is reported at its place, and nothing else.

mod kinds;
mod parquet;
mod recordings;
#[path = "../support/mod.rs"]
mod support;
mod time;
