//! Numerical tools that know no gyro.

pub mod bracket;
pub(crate) mod compensated;
pub mod cosine;
pub mod decimal;
mod inverse;
pub mod range;
pub mod reml;
pub mod special;
pub(crate) mod sums;
