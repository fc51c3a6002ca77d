//! The magnitudes that figures are right for, and the range of values.
//!
//! A figure rests on squares of values, and a fit on squares of those: between the two bounds none of them leaves the
//! range of a double, over any length of record.

/// Largest magnitude that is taken for a number. No sensor gives more; beyond, one field could make every figure of a
/// record overflow.
pub const LARGEST: f64 = 1e60;

/// Magnitudes below this are zero: no sensor resolves them, and their squares would vanish.
pub const SMALLEST: f64 = 1e-60;

/// True for a number that can be reckoned with: neither NaN nor infinite nor absurdly large.
pub fn usable(value: f64) -> bool {
    value.abs() <= LARGEST
}

/// The value with zero in place of magnitudes below [`SMALLEST`], and of −0.
pub fn settled(value: f64) -> f64 {
    if value.abs() < SMALLEST { 0.0 } else { value }
}

/// The smallest and the largest value; infinities the wrong way round where there is none.
pub fn ends(values: &[f64]) -> (f64, f64) {
    values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(*v), high.max(*v)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_cannot_be_reckoned_with_is_told_from_what_vanishes() {
        assert!(usable(1e60) && usable(-1e60) && usable(0.0) && usable(5e-324));
        assert!(!usable(1.1e60) && !usable(f64::NAN) && !usable(f64::NEG_INFINITY));
        for tiny in [5e-324, -1e-310, 9e-61, -0.0] {
            assert_eq!(settled(tiny).to_bits(), 0, "{tiny:e}");
        }
        assert_eq!(settled(-1e-60), -1e-60);
        assert!(settled(f64::NAN).is_nan());
    }
}
