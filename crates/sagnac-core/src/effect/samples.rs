//! Effects on single samples.

use super::{Drivers, Values};

/// An effect on single samples. The engine knows how each is found; here is what it does.
pub trait Samples: Sync {
    /// Applies the effect to a simulated rate, deg/h, on the grid of the drivers; `seed` fixes every draw. Rows of which
    /// `keep` becomes false are not written.
    fn apply(&self, values: &Values, drivers: &Drivers, seed: u64, rate: &mut [f64], keep: &mut [bool]);
}
