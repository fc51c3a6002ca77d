//! Dimensions of units.

/// Number of base dimensions a unit is made of.
pub(super) const BASES: usize = 9;
/// Positions of the base dimensions.
pub(super) const ANGLE: usize = 0;
pub(super) const TIME: usize = 1;
pub(super) const TEMPERATURE: usize = 2;
pub(super) const VOLTAGE: usize = 3;
pub(super) const MAGNETIC: usize = 4;
pub(super) const PRESSURE: usize = 5;
pub(super) const LENGTH: usize = 6;
pub(super) const CURRENT: usize = 7;
pub(super) const COUNT: usize = 8;

/// Exponents of the base dimensions, in halves, so that `1/sqrt(h)` is exact.
pub(super) type Dimension = [i8; BASES];

/// A base quantity.
pub(super) const fn one(base: usize) -> Dimension {
    let mut dimension = [0; BASES];
    dimension[base] = 2;
    dimension
}

/// A base quantity over a power of time.
pub(super) const fn per_time(base: usize, power: i8) -> Dimension {
    let mut dimension = one(base);
    dimension[TIME] = -2 * power;
    dimension
}

/// One over a dimension.
pub(super) const fn inverse(mut dimension: Dimension) -> Dimension {
    let mut i = 0;
    while i < BASES {
        dimension[i] = -dimension[i];
        i += 1;
    }
    dimension
}
