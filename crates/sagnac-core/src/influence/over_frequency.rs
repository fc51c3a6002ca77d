//! Effects of vibration on one gyro channel by frequency.

use super::rectification::Rectification;
use super::resonance::Resonance;

/// Rectified bias and resonance of one channel.
#[derive(Debug, Clone)]
pub struct OverFrequency {
    /// Channel.
    pub channel: String,
    /// The bias that is rectified in every band.
    pub rectification: Rectification,
    /// The resonance that stands out most.
    pub resonance: Resonance,
}
