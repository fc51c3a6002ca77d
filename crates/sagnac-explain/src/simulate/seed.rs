//! Seeds: one of the user, and of it one for every use.

use rand_xoshiro::SplitMix64;
use rand_xoshiro::rand_core::{Rng as _, SeedableRng as _};

/// The seed of one use of a simulation. Different tags give independent streams of the same seed.
pub fn stream(seed: u64, tag: u64) -> u64 {
    let mut mixed = SplitMix64::seed_from_u64(seed);
    let base = mixed.next_u64();
    SplitMix64::seed_from_u64(base ^ tag.wrapping_mul(0x9e37_79b9_7f4a_7c15)).next_u64()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A step of SplitMix64 (Steele, Lea and Flood 2014) from a state.
    fn split_mix(state: u64) -> u64 {
        let mut z = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    #[test]
    fn recordings_of_a_seed_stay_the_same_and_uses_differ() {
        for (seed, tag) in [(0, 0u64), (7, 1), (7, 2), (u64::MAX, 1000)] {
            let expected = split_mix(split_mix(seed) ^ tag.wrapping_mul(0x9e37_79b9_7f4a_7c15));
            assert_eq!(stream(seed, tag), expected, "{seed} {tag}");
        }
        assert_ne!(stream(7, 1), stream(7, 2));
        assert_ne!(stream(7, 1), stream(8, 1));
    }
}
