//! The mismatch of a claimed simulation and a recording: located, named, modelled, and the fit shown to improve.

pub mod finding;
