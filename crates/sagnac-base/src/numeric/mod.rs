//! Numerical tools that know no gyro.
//!
//! | module | what it has |
//! |---|---|
//! | [`clock_tie`] | offset and rate between two clocks from a quantity that both record |
//! | [`cosine`] | discrete cosine transforms, and the modes of a sinusoid |
//! | [`optimize`] | bisection, golden sections, step rules of Newton ascents, bounded quadratics |
//! | [`least_squares`] | weighted least squares with priors |
//! | [`order`] | sorting by numbers, medians, quantiles |
//! | [`parallel`] | work side by side on all cores |
//! | [`reml`] | linear models with variance components, by restricted maximum likelihood |
//! | [`special`] | special functions |
//! | [`sums`] | compensated and running sums |
//! | [`range`], [`decimal`] | magnitudes that figures are right for; decimals of a number |

pub mod cholesky;
pub mod clock_tie;
pub mod cosine;
pub mod decimal;
pub mod least_squares;
pub mod optimize;
pub mod order;
pub mod parallel;
pub mod range;
pub mod reml;
pub mod special;
pub mod sums;
