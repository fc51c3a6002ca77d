//! Tests over temperature: the schedule that was run, the bias over temperature with what its rate, its lag and its
//! history add, the noise in each zone, and the warm-up.
//!
//! | module | what it has |
//! |---|---|
//! | [`track`], [`start`] | block means of a recording; when the unit was switched on |
//! | [`segments`], [`findings`] | ramps and dwells that were run; everything found over temperature |
//! | [`course`], [`gls`] | the regressors of a bias over temperature; least squares in noise found beside it |
//! | [`order`], [`posterior`], [`sampler`], [`read`] | the degree of the polynomial; draws of the model; readings from them |
//! | [`removed`] | whether the slow part was taken out before delivery |
//! | [`lag`], [`separate`] | sensitivity by lag; whether rate, lag and hysteresis can be told apart |
//! | [`compensation`], [`zones`] | coefficients for compensation; white noise by zone of temperature |
//! | [`warm_up`] | the time that a unit needs after switching on |
//!
//! Works on block averages, so that time and memory do not grow with the sample rate. Knows no procedure: what a
//! procedure asks is in [`TemperatureTest`].

pub mod compensation;
pub mod course;
pub mod findings;
pub mod gls;
pub mod lag;
pub mod order;
pub mod posterior;
pub mod read;
pub mod removed;
pub mod sampler;
pub mod segments;
pub mod separate;
pub mod start;
pub mod stays;
mod test;
pub mod track;
pub mod warm_up;
pub mod zones;

pub use test::{SegmentKind, StartAsked, StatedSegment, TemperatureTest, WarmUpTest};
