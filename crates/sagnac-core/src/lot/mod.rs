//! A lot of units: what the values of some units tell about the population that they come from.
//!
//! | module | what it has |
//! |---|---|
//! | [`tolerance`] | exact one-sided tolerance factors of a normal sample |
//! | [`free`] | bounds by order statistics, and that of Hanson and Koopmans |
//! | [`normality`] | the test of Anderson and Darling |
//! | [`batches`] | the bound of a few batches by analysis of variance |
//! | [`censored`] | maximum likelihood for a normal sample of which some values are only bounded |
//! | [`population`] | median, spreads and bounds from values of known uncertainty in sub-lots, some only bounded |
//!
//! All works on the scale on which units scatter normally: the logarithm of a positive magnitude, or the value itself.

pub mod batches;
pub mod censored;
pub mod free;
pub mod normality;
pub mod population;
mod restricted;
pub mod risk;
mod sampler;
pub mod tolerance;
