//! One curve for a quantity whose form is not known: it holds what each of the forms that fit holds.

/// Normal score up to which curves are put together.
const MAX_SCORE: f64 = 4.0;
/// Number of scores at which they are.
const SCORE_COUNT: usize = 81;

/// The value at a normal score of (normal score, value), ascending; beyond the ends the ends.
fn at(curve: &[(f64, f64)], z: f64) -> f64 {
    let (Some(first), Some(last)) = (curve.first(), curve.last()) else { return 0.0 };
    if z <= first.0 {
        return first.1;
    }
    if z >= last.0 {
        return last.1;
    }
    let i = curve.partition_point(|p| p.0 <= z);
    let (a, b) = (curve[i - 1], curve[i]);
    a.1 + (b.1 - a.1) * (z - a.0) / (b.0 - a.0).max(f64::MIN_POSITIVE)
}

/// The curve that at every confidence reaches as far as that of any form does, about the value of the first form.
pub fn covering(curves: &[Vec<(f64, f64)>]) -> Vec<(f64, f64)> {
    let Some(first) = curves.first() else { return vec![] };
    if curves.len() == 1 {
        return first.clone();
    }
    let middle = at(first, 0.0);
    (0..SCORE_COUNT)
        .map(|i| MAX_SCORE * (2.0 * i as f64 / (SCORE_COUNT - 1) as f64 - 1.0))
        .map(|z| {
            let values = curves.iter().map(|c| at(c, z));
            // A hair apart, for no stretch of a curve is level.
            let hair = 1e-9 * z * middle;
            if z < 0.0 {
                (z, values.fold(middle, f64::min) + hair)
            } else {
                (z, values.fold(middle, f64::max) + hair)
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::Spread;

    #[test]
    fn a_curve_over_forms_reaches_as_far_as_each() {
        let normal = |middle: f64, u: f64| -> Vec<(f64, f64)> {
            (-40..=40).map(|i| (0.1 * f64::from(i), middle + 0.1 * u * f64::from(i))).collect()
        };
        let both = Spread::Curve(covering(&[normal(1.0, 0.1), normal(1.5, 0.2)]));
        let ends = |p: f64| both.bound(0.0, p).unwrap();
        assert!((ends(0.025) - 0.804).abs() < 1e-2 && (ends(0.975) - 1.892).abs() < 1e-2);
        assert!((ends(0.95) - 1.829).abs() < 1e-2);
        assert_eq!(covering(&[normal(1.0, 0.1)]), normal(1.0, 0.1));
    }
}
