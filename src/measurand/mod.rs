//! Measurands: what a test determines.

pub mod ids;
