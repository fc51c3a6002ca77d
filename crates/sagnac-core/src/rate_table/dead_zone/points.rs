//! Means of the rates with their covariance, and how well a response with a zone fits them.
//!
//! A unit's zone lies where its loop is at rest: where the input is none, about which the rates of a test are set, or,
//! with a bias in front of the zone, where the output is none. Neither need be so: an input axis that stands off, or a
//! bias that is divided, puts it elsewhere. Each of the three is given the same share.

use super::shape::{Kind, Shape};
use crate::numeric::order::{SortByNumber, SortNumbers};
use nalgebra::{Cholesky, DMatrix, DVector};
use std::cell::OnceCell;

/// Centres tried.
pub const CENTRE_COUNT: usize = 41;

/// Divisions of a stretch of centres between which no rate changes sides.
const CENTRE_DIVISIONS: usize = 8;

/// Cost above the least from which a stretch of centres is not looked into.
const MAX_COST_EXCESS: f64 = 30.0;

/// What one zone leaves.
#[derive(Debug, Clone, Copy)]
pub struct Left {
    /// The zone.
    pub shape: Shape,
    /// −2 ln L at the best centre.
    pub least: f64,
    /// That centre, and slope and offset there.
    pub centre: f64,
    pub slope: f64,
    pub offset: f64,
    /// −2 ln of the mean likelihood over all centres where the zone may lie: at its best centre a zone of any width follows
    /// the noise.
    pub over_centres: f64,
}

pub struct Points {
    pub x: Vec<f64>,
    /// Makes the noise of the means white and one: the inverse of the factor of their covariance. A fit is asked for hundreds
    /// of thousands of times, and a product is faster than the solution of a triangle.
    whitening: DMatrix<f64>,
    /// Relative standard uncertainty of the scale factor about the nominal one, where it is known.
    slope_known: Option<f64>,
    /// Output and a constant, over their standard uncertainty and free of correlation.
    of_y: DVector<f64>,
    of_one: DVector<f64>,
    /// Noise of a mean, deg/h.
    noise: f64,
    /// Where a zone may lie, once it is asked for: the line that tells it is a fit to these points.
    place: OnceCell<Place>,
}

/// A gap about one centre.
#[derive(Clone, Copy)]
struct Tried {
    cost: f64,
    slope: f64,
    offset: f64,
    centre: f64,
}

impl Points {
    /// `None` with a covariance that is none.
    pub fn new(
        x: Vec<f64>,
        y: DVector<f64>,
        covariance: DMatrix<f64>,
        slope_known: Option<f64>,
    ) -> Option<Points> {
        let noise = (covariance.trace() / x.len() as f64).sqrt();
        let factor = Cholesky::new(covariance)?;
        let whitening = factor.l_dirty().solve_lower_triangular(&DMatrix::identity(x.len(), x.len()))?;
        let of_y = &whitening * &y;
        let of_one = &whitening * DVector::from_element(x.len(), 1.0);
        Some(Points { x, whitening, slope_known, of_y, of_one, noise, place: OnceCell::new() })
    }

    /// Where a zone may lie.
    fn place(&self) -> Place {
        *self.place.get_or_init(|| {
            let (middle, largest) = self.range();
            let (_, slope, offset) = self.cost(|x| x);
            let (_, apart) = self.spacing();
            let tried = largest / (CENTRE_COUNT - 1) as f64;
            Place::new(middle, 0.5 * largest, -offset / slope, self.noise / slope.abs(), apart, tried)
        })
    }

    /// Middle of the rates and half their range.
    pub fn range(&self) -> (f64, f64) {
        let low = self.x.iter().copied().fold(f64::INFINITY, f64::min);
        let high = self.x.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        (0.5 * (low + high), 0.5 * (high - low))
    }

    /// Smallest rate beside the middle, and the widest distance of neighbours where centres are tried.
    pub fn spacing(&self) -> (f64, f64) {
        let (middle, largest) = self.range();
        let apart = |w: &[f64]| w[1] - w[0];
        let inner = |w: &&[f64]| (0.5 * (w[0] + w[1]) - middle).abs() <= 0.5 * largest;
        let widest = self.x.windows(2).filter(inner).map(apart).fold(0.0, f64::max);
        let beside = self.x.iter().map(|x| (x - middle).abs()).filter(|d| *d > 1e-3 * largest);
        (beside.fold(f64::INFINITY, f64::min), widest)
    }

    /// Offset and response, each over its standard uncertainty and free of correlation; what is known of the slope is one
    /// more row.
    fn design(&self, d: impl Fn(f64) -> f64) -> DMatrix<f64> {
        let n = self.x.len();
        let a = DMatrix::from_fn(n, 2, |i, j| if j == 0 { 1.0 } else { d(self.x[i]) });
        let mut w = (&self.whitening * a).insert_row(n, 0.0);
        w[(n, 1)] = self.slope_known.map_or(0.0, |u| 1.0 / u);
        w
    }

    fn data(&self) -> DVector<f64> {
        self.of_y.push(self.slope_known.map_or(0.0, |u| 1.0 / u))
    }

    /// −2 ln L, slope and offset of a response given up to slope and offset.
    pub fn cost(&self, d: impl Fn(f64) -> f64) -> (f64, f64, f64) {
        let w = &self.whitening * DVector::from_iterator(self.x.len(), self.x.iter().map(|x| d(*x)));
        let known = self.slope_known.map_or(0.0, |u| u.powi(-2));
        let (aa, ad) = (self.of_one.norm_squared(), self.of_one.dot(&w));
        let dd = w.norm_squared() + known;
        let (ay, dy) = (self.of_one.dot(&self.of_y), w.dot(&self.of_y) + known);
        let determinant = aa * dd - ad * ad;
        if determinant.is_nan() || determinant <= 1e-12 * aa * dd {
            return (f64::INFINITY, 0.0, 0.0);
        }
        let offset = (dd * ay - ad * dy) / determinant;
        let slope = (aa * dy - ad * ay) / determinant;
        let left: f64 =
            (0..w.len()).map(|i| (self.of_y[i] - offset * self.of_one[i] - slope * w[i]).powi(2)).sum();
        (left + known * (1.0 - slope).powi(2), slope, offset)
    }

    /// A zone at the centre that suits it best, sought where the inner half of the rates lies.
    pub fn at_any_centre(&self, shape: Shape) -> Left {
        let (middle, largest) = self.range();
        let at = |c: f64| {
            let (cost, slope, offset) = self.cost(|x| shape.of(x - c));
            (cost, c, slope, offset)
        };
        let mut tried: Vec<(f64, f64, f64, f64)> = (0..CENTRE_COUNT)
            .map(|i| at(middle + 0.5 * largest * (2.0 * i as f64 / (CENTRE_COUNT - 1) as f64 - 1.0)))
            .collect();
        let least = |t: &[(f64, f64, f64, f64)]| {
            t.iter().copied().fold((f64::INFINITY, 0.0, 0.0, 0.0), |m, v| if v.0 < m.0 { v } else { m })
        };
        let mut step = 0.5 * largest / (CENTRE_COUNT - 1) as f64;
        for _ in 0..6 {
            let middle = least(&tried).1;
            tried.extend([middle - step, middle + step].map(at));
            step *= 0.5;
        }
        let best = least(&tried);
        let place = self.place();
        tried.sort_ascending_by(|a| a.1);
        let weight = |v: &(f64, f64, f64, f64)| (-0.5 * (v.0 - best.0)).exp() * place.density(v.1);
        let mean: f64 =
            tried.windows(2).map(|p| 0.5 * (weight(&p[0]) + weight(&p[1])) * (p[1].1 - p[0].1)).sum();
        let over_centres = best.0 - 2.0 * mean.max(f64::MIN_POSITIVE).ln();
        Left { shape, least: best.0, centre: best.1, slope: best.2, offset: best.3, over_centres }
    }

    /// A gap of a half width at the centre that suits it best. Which rates lie inside is all that the outputs tell of it:
    /// centres between which none changes sides are one stretch, and every stretch is searched, however narrow.
    pub fn gap(&self, half_width: f64) -> Left {
        let mut found = self.at_any_centre(Shape::clean(Kind::Gap, half_width));
        let (middle, largest) = self.range();
        let (low, high) = (middle - 0.5 * largest, middle + 0.5 * largest);
        let sides = self.x.iter().flat_map(|x| [x - half_width, x + half_width]);
        let mut ends: Vec<f64> = sides.filter(|c| (low..high).contains(c)).chain([low, high]).collect();
        ends.sort_ascending();
        let shape = found.shape;
        let at = |centre: f64| {
            let (cost, slope, offset) = self.cost(|x| shape.of(x - centre));
            Tried { cost, slope, offset, centre }
        };
        let stretches: Vec<[Tried; 3]> = ends
            .windows(2)
            .filter(|w| w[1] - w[0] > 1e-9 * largest)
            .map(|w| [0.5, 1e-6, 1.0 - 1e-6].map(|part| at(w[0] + part * (w[1] - w[0]))))
            .collect();
        let least_of = |s: &[Tried; 3]| s.iter().map(|t| t.cost).fold(f64::INFINITY, f64::min);
        let near = stretches.iter().map(least_of).fold(found.least, f64::min) + MAX_COST_EXCESS;
        for s in stretches.iter().filter(|s| least_of(s) <= near) {
            // The cost is that of a straight line outside, smooth over a stretch: thirds close in on its least.
            let (mut a, mut b) = (s[1].centre, s[2].centre);
            let mut tried = s.to_vec();
            for _ in 0..CENTRE_DIVISIONS {
                let (c, d) = (at(a + (b - a) / 3.0), at(b - (b - a) / 3.0));
                if c.cost <= d.cost {
                    b = d.centre
                } else {
                    a = c.centre
                }
                tried.extend([c, d]);
            }
            for t in tried {
                if t.cost < found.least {
                    found =
                        Left { least: t.cost, centre: t.centre, slope: t.slope, offset: t.offset, ..found };
                }
            }
        }
        found
    }

    /// The line that fits best, over the standard uncertainties.
    pub fn line(&self) -> Option<DVector<f64>> {
        let (line, data) = (self.design(|x| x), self.data());
        let normal = Cholesky::new(line.transpose() * &line)?;
        Some(&line * normal.solve(&(line.transpose() * data)))
    }

    /// Outputs over their standard uncertainty and free of correlation, with what is known of the slope.
    pub fn whitened(&self, outputs: &DVector<f64>, of_slope: f64) -> DVector<f64> {
        (&self.whitening * outputs).push(of_slope)
    }

    /// What a line and zones of all kinds, half widths and places explain of data.
    pub fn ratios(&self, widths: &[f64]) -> Option<Ratios> {
        let (middle, largest) = self.range();
        let basis = |a: DMatrix<f64>| -> Option<[DVector<f64>; 2]> {
            let first = a.column(0).clone_owned().try_normalize(0.0)?;
            let rest = a.column(1) - &first * first.dot(&a.column(1));
            Some([first, rest.try_normalize(1e-12)?])
        };
        let fine = CENTRE_COUNT - 1;
        let centre = |i: usize| middle + 0.5 * largest * (2.0 * i as f64 / fine as f64 - 1.0);
        // Tried half widths grow with the square of their number.
        let place = self.place();
        let (weights, columns): (Vec<f64>, Vec<[DVector<f64>; 2]>) = Kind::NOISE_FREE
            .into_iter()
            .flat_map(|k| {
                widths.iter().enumerate().skip(1).step_by(8).map(move |(i, w)| (k, *w, 1.0 / i as f64))
            })
            .flat_map(|(k, w, weight)| (0..=fine).map(move |i| (k, w, weight, centre(i))))
            .filter_map(|(k, w, weight, c)| {
                Some((weight * place.density(c), basis(self.design(|x| Shape::clean(k, w).of(x - c)))?))
            })
            .unzip();
        Some(Ratios {
            line: DMatrix::from_columns(&basis(self.design(|x| x))?),
            zones: DMatrix::from_columns(&columns.into_iter().flatten().collect::<Vec<_>>()),
            weights,
        })
    }
}

/// Directions in which a line and zones lie.
pub struct Ratios {
    line: DMatrix<f64>,
    /// Two columns a zone.
    zones: DMatrix<f64>,
    weights: Vec<f64>,
}

impl Ratios {
    /// The mean ratio of the likelihood of zones to that of the line, over kinds, the logarithm of the half width and the
    /// places where a zone may lie. The ratio at the best of them rests on how many were tried, and finds fewer zones.
    pub fn mean(&self, data: &DVector<f64>) -> f64 {
        let line = self.line.tr_mul(data).norm_squared();
        let zones = self.zones.tr_mul(data);
        let explained = zones.as_slice().chunks_exact(2).map(|p| p[0] * p[0] + p[1] * p[1]);
        explained.zip(&self.weights).map(|(of, weight)| weight * (0.5 * (of - line)).exp()).sum()
    }
}

/// Standard deviation of what a place is known to, in distances of neighbouring rates.
const OF_SPACING: f64 = 0.25;

/// Density of the centre of a zone over the rates.
#[derive(Debug, Clone, Copy)]
pub struct Place {
    /// Middle of the rates and the rate at which the output is none, deg/h.
    pub at_rest: [f64; 2],
    /// Uncertainties of these two, deg/h.
    pub standard: f64,
    /// Half of the rates that the centre is sought in, deg/h.
    pub half: f64,
}

impl Place {
    /// `middle` of the rates and `half` the range of what is searched, with the noise of a mean, the distance of
    /// neighbouring rates and that of the centres tried.
    pub fn new(middle: f64, half: f64, output_null: f64, noise: f64, apart: f64, tried: f64) -> Place {
        Place { at_rest: [middle, output_null], standard: (OF_SPACING * apart).hypot(noise).max(tried), half }
    }

    /// Density at a centre, 1/(deg/h).
    pub fn density(&self, centre: f64) -> f64 {
        let normal = |at: f64| {
            let z = (centre - at) / self.standard;
            (-0.5 * z * z).exp() / (self.standard * std::f64::consts::TAU.sqrt())
        };
        let [input, output] = self.at_rest;
        (normal(input) + normal(output) + 0.5 / self.half) / 3.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_places_together_are_certain() {
        let place = Place::new(-12.0, 0.6, -12.1, 0.01, 0.1, 0.02);
        let step = 1e-4;
        let sum: f64 = (-6000..=6000).map(|i| place.density(-12.0 + step * f64::from(i)) * step).sum();
        assert!((sum - 1.0).abs() < 1e-3, "{sum}");
        assert!(place.density(-12.0) > 4.0 * place.density(-11.5));
    }
}
