//! A linear conversion of numbers: the unit of a file to the unit of the analysis, counts to values.

/// `value · factor + offset`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Affine {
    pub factor: f64,
    pub offset: f64,
}

impl Affine {
    /// Leaves numbers as they are.
    pub const IDENTITY: Affine = Affine { factor: 1.0, offset: 0.0 };

    /// The converted value.
    #[inline]
    pub fn apply(self, value: f64) -> f64 {
        value * self.factor + self.offset
    }

    /// Converts a column in place.
    pub fn apply_all(self, values: &mut [f64]) {
        if self != Affine::IDENTITY {
            values.iter_mut().for_each(|v| *v = self.apply(*v));
        }
    }
}

impl From<(f64, f64)> for Affine {
    fn from((factor, offset): (f64, f64)) -> Affine {
        Affine { factor, offset }
    }
}
