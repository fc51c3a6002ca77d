//! Dimensions of units.

/// Number of base dimensions a unit is made of.
pub(super) const BASE_COUNT: usize = 10;

/// A base dimension, in the order in which a [`Dimension`] has them.
#[derive(Clone, Copy)]
pub(super) enum Base {
    Angle,
    Time,
    Temperature,
    Voltage,
    Magnetic,
    Pressure,
    Length,
    Current,
    Count,
    Level,
}

/// Exponents of the base dimensions, in halves, so that `1/sqrt(h)` is exact.
pub(super) type Dimension = [i8; BASE_COUNT];

/// A base dimension alone.
pub(super) const fn one(base: Base) -> Dimension {
    let mut dimension = [0; BASE_COUNT];
    dimension[base as usize] = 2;
    dimension
}

/// The product of two base dimensions.
pub(super) const fn product(one: Base, other: Base) -> Dimension {
    let mut dimension = [0; BASE_COUNT];
    dimension[one as usize] = 2;
    dimension[other as usize] = 2;
    dimension
}

/// A base dimension over a power of time.
pub(super) const fn per_time(base: Base, power: i8) -> Dimension {
    let mut dimension = one(base);
    dimension[Base::Time as usize] = -2 * power;
    dimension
}

/// One over a dimension.
pub(super) const fn inverse(mut dimension: Dimension) -> Dimension {
    let mut i = 0;
    while i < BASE_COUNT {
        dimension[i] = -dimension[i];
        i += 1;
    }
    dimension
}
