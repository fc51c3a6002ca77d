//! Numerical tools that know no gyro.

pub mod cosine;
pub mod special;
