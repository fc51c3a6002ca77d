//! The magnitudes that figures are right for, and the range of values.
//!
//! A figure rests on squares of values, and a fit on squares of those: between the two bounds none of them leaves the
//! range of a double, over any length of record.

/// Largest magnitude that is taken for a number. No sensor gives more; beyond, one field could make every figure of a
/// record overflow.
pub const MAX_MAGNITUDE: f64 = 1e60;

/// Magnitudes below this are zero: no sensor resolves them, and their squares would vanish.
pub const MIN_MAGNITUDE: f64 = 1e-60;

/// True for a number that can be reckoned with: neither NaN nor infinite nor absurdly large.
pub fn usable(value: f64) -> bool {
    value.abs() <= MAX_MAGNITUDE
}

/// The value with zero in place of magnitudes below [`MIN_MAGNITUDE`], and of −0.
pub fn settled(value: f64) -> f64 {
    if value.abs() < MIN_MAGNITUDE { 0.0 } else { value }
}

/// A closed interval of numbers, both ends included. One with `low > high` holds none.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

impl Bounds {
    /// From `low` to `high`.
    pub const fn new(low: f64, high: f64) -> Bounds {
        Bounds { low, high }
    }

    /// Length of the interval; negative where it holds nothing.
    pub fn width(self) -> f64 {
        self.high - self.low
    }

    /// Whether a number lies inside or on an end.
    pub fn contains(self, x: f64) -> bool {
        x >= self.low && x <= self.high
    }

    /// The nearest number inside. NaN stays NaN.
    pub fn clamp(self, x: f64) -> f64 {
        if x < self.low {
            self.low
        } else if x > self.high {
            self.high
        } else {
            x
        }
    }

    /// True where the numbers inside differ by more than the rounding of their digits, a billionth of their size.
    pub fn is_wide(self) -> bool {
        self.width() > 1e-9 * self.low.abs().max(self.high.abs())
    }
}

/// The smallest and the largest value; infinities the wrong way round, which hold nothing, where there is none.
pub fn ends(values: &[f64]) -> Bounds {
    let wider = |b: Bounds, v: &f64| Bounds { low: b.low.min(*v), high: b.high.max(*v) };
    values.iter().fold(Bounds { low: f64::INFINITY, high: f64::NEG_INFINITY }, wider)
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

    #[test]
    fn bounds_hold_their_ends_and_clamp_to_them() {
        let bounds = ends(&[3.0, -1.0, 2.0]);
        assert_eq!(bounds, Bounds::new(-1.0, 3.0));
        assert_eq!(bounds.width(), 4.0);
        assert_eq!([-2.0, -1.0, 0.5, 3.0, 7.0].map(|x| bounds.clamp(x)), [-1.0, -1.0, 0.5, 3.0, 3.0]);
        assert!(bounds.contains(-1.0) && bounds.contains(3.0) && !bounds.contains(3.1));
        assert!(bounds.clamp(f64::NAN).is_nan() && !bounds.contains(f64::NAN));
        assert!(ends(&[]).width() < 0.0 && !ends(&[]).contains(0.0) && !ends(&[]).is_wide());
        assert!(!ends(&[20.0, 20.0 + 1e-9]).is_wide() && ends(&[20.0, 20.0 + 1e-7]).is_wide());
    }
}
