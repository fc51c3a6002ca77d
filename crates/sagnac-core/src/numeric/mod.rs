//! Numerical tools that know no gyro.

pub mod compensated;
pub mod cosine;
pub mod decimal;
pub(crate) mod inverse;
pub mod least_squares;
pub(crate) mod log_determinant;
pub mod optimize;
pub mod order;
pub mod range;
pub mod reml;
pub mod special;
pub(crate) mod sums;
