//! The spectral evidence of a record: mean power in disjoint frequency bands, with the expectation of every term in
//! them. What a likelihood needs and no more; a few hundred bands whatever the length of the record.
//!
//! Low frequencies come from the cosine modes of the block means (one χ² with one degree of freedom each, no leakage
//! from a random walk), high frequencies from the averaged periodogram. No frequency is used twice.
//! Source: Whittle's likelihood with the expectation of the transform in place of the density (debiased Whittle,
//! Sykulski et al., Biometrika 106, 2019).

mod bands;
mod build;
mod places;
mod scatter;
mod spectrum;

pub use bands::{Band, FineBin, Zone};
pub use build::Mask;
pub use places::{Places, Transform, Turns};
pub use spectrum::Evidence;
