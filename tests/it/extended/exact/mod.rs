//! A slow reference in extended precision, and the records on which it matters.
#![allow(dead_code, reason = "each test file uses its own part")]

pub mod arithmetic;
pub mod records;
pub mod reference;
pub mod worst;
