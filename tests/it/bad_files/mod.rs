//! Broken and odd files: every problem is reported at its place, and nothing else.

mod kinds;
mod parquet;
mod recordings;
mod time;
