//! A lot of units: what the values of some units tell about the population that they come from.
//!
//! | module | what it has |
//! |---|---|
//! | [`tolerance`] | exact one-sided tolerance factors of a normal sample |
//! | [`free`] | bounds by order statistics, and that of Hanson and Koopmans |
//! | [`normality`] | the test of Anderson and Darling |
//! | [`batches`] | the bound of a few batches by analysis of variance |
//! | [`censored`] | maximum likelihood for a normal sample of which some values are only bounded |
//! | [`control_chart`] | charts of single values with limits that hold their uncertainty |
//! | [`capability`] | Cp and Cpk with lower bounds |
//! | [`share`] | a counted share with its interval |
//! | [`station`] | groups of values against each other |
//! | [`siblings`] | whether a unit is unlike the others in several quantities together |
//! | [`drift`] | drift of one unit over tests that share a part of their uncertainty |
//! | [`stability`] | scatter of runs and of days of one unit, and its trend |
//! | [`population`] | median, spreads and bounds from values of known uncertainty in sub-lots, some only bounded |
//!
//! All works on the scale on which units scatter normally: the logarithm of a positive magnitude, or the value itself.

pub mod batches;
pub mod capability;
pub mod censored;
pub mod control_chart;
pub mod drift;
pub mod free;
pub mod normality;
pub mod population;
mod restricted;
pub mod risk;
mod sampler;
pub mod share;
pub mod siblings;
pub mod stability;
pub mod station;
pub mod tolerance;
