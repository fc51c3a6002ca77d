//! Broken files: every problem is reported at its place, and nothing else.

mod bad_input_kinds;
mod support;
