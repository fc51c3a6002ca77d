//! Sums and extremes of a piece of a channel.

/// Samples looked at at once.
pub(super) const CHUNK: usize = 1024;

/// Sums about an origin and extremes of some values; a NaN among them makes the sum NaN.
pub(super) struct Summary {
    pub sum: f64,
    pub squares: f64,
    pub min: f64,
    pub max: f64,
}

/// Sums about an origin and the extremes of some values.
pub(super) fn summary(values: &[f64], origin: f64) -> Summary {
    // Eight sums at once let the compiler use vector instructions, which one running sum forbids.
    const LANES: usize = 8;
    let (mut sum, mut squares) = ([0.0; LANES], [0.0; LANES]);
    let (mut min, mut max) = ([f64::INFINITY; LANES], [f64::NEG_INFINITY; LANES]);
    let parts = values.chunks_exact(LANES);
    let rest = parts.remainder();
    for part in parts {
        for (lane, &v) in part.iter().enumerate() {
            let d = v - origin;
            sum[lane] += d;
            squares[lane] += d * d;
            min[lane] = if v < min[lane] { v } else { min[lane] };
            max[lane] = if v > max[lane] { v } else { max[lane] };
        }
    }
    for (lane, &v) in rest.iter().enumerate() {
        let d = v - origin;
        sum[lane] += d;
        squares[lane] += d * d;
        min[lane] = v.min(min[lane]);
        max[lane] = v.max(max[lane]);
    }
    Summary {
        sum: sum.iter().sum(),
        squares: squares.iter().sum(),
        min: min.iter().copied().fold(f64::INFINITY, f64::min),
        max: max.iter().copied().fold(f64::NEG_INFINITY, f64::max),
    }
}
