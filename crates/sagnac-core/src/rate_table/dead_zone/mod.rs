//! Response to rates near zero: dead zone, threshold, resolution.
//!
//! Static forms are held against the straight line: *subtractive*, D = sgn(x)·max(|x| − δ, 0), *gap*, D = x·[|x| > δ],
//! and *locked*, D = sgn(x)·√(x² − δ²) outside, each about a centre that is fitted too, for the zone lies where the unit
//! believes to be at rest. The half width δ of a form has the interval of its likelihood over the means of the rates with
//! their covariance, slope and offset at their best, averaged over the places where a unit is at rest and any other
//! (`points`). Between two rates of the test the edge of a gap moves nothing: all of that stretch belongs to its interval.
//! The noise is that about the zone that suits best (`about`), of all strengths that the test allows.
//!
//! Forms that fit nearly as well as the best one are not told apart, and the interval covers all of them (`zone`). Each
//! is tested by noise that it cannot enlarge (`fits`): where none fits, nothing is stated of a zone.
//!
//! Outside a zone the output follows the rate by the scale factor. What a test of scale factor said of it may be used: a
//! line that may have any slope takes up most of a small zone. A zone is claimed when a line with the noise of this test
//! would make zones as likely on the average in less than one test of a hundred, of four hundred where the slope is known;
//! draws tell (`chance`).
//!
//! Noise inside the loop carries the input in and out of the zone and rounds it off (*rounded*): the subtractive response
//! is averaged over normal noise σ. Where that fits better than any zone without noise, δ and σ are estimated together;
//! otherwise σ is bounded, and the interval of δ covers it too.

mod about;
mod chance;
mod fits;
mod points;
mod rounded;
mod shape;
mod widths;
mod zone;

pub use shape::Kind;
pub use zone::{DeadZone, evaluate, median};
