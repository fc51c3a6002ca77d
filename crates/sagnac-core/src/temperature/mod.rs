//! Tests over temperature: the schedule that was run, the bias over temperature with what its rate, its lag and its
//! history add, the noise in each zone, and the warm-up.
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
pub mod sampler;
pub mod segments;
pub mod separate;
pub mod settled;
pub mod start;
mod test;
pub mod track;
pub mod warm_up;
pub mod zones;

pub use test::{SegmentKind, StartAsked, StatedSegment, TemperatureTest, WarmUpTest};
