//! Which bands of a vibration are told apart: a band that was excited only in step with others says nothing of its own.
//!
//! The mean squares of the bands are columns of one regression with a constant and a drift. Bands are taken in the order of their size;
//! one of which the others leave too little is not taken. What such a band does to the bias goes into the coefficients of
//! those that it is in step with, as its mean square per theirs: that share widens them, or withholds them where it is large.

use crate::noise::in_band::Band;
use nalgebra::{Cholesky, DMatrix, DVector};

/// Share of the largest mean square below which a band counts as not excited.
const LEAST_EXCITED_SHARE: f64 = 0.01;

/// Share of a column, as a root of a sum of squares, that the others must leave of it.
const LEAST_OWN_SHARE: f64 = 0.2;

/// Mean square in step with a band elsewhere, per that of the band, up to which the band has a value.
const LARGEST_SHARE_ELSEWHERE: f64 = 0.1;

/// Excitation of one band, as the recording shows it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Excitation {
    /// It is told apart; with the mean square in step with it at other frequencies, per its own.
    Apart {
        /// That share.
        elsewhere: f64,
    },
    /// It was hardly excited.
    None,
    /// It was excited in step with another band, or, where that is `None`, with frequencies beyond all bands.
    InStep {
        /// The other band.
        with: Option<Band>,
    },
    /// The intervals are too short to resolve it.
    Unresolved,
}

/// A column of the regression: the mean square in every interval less that without vibration.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    /// Its band; `None` beyond all bands.
    pub band: Option<Band>,
    /// g², an interval each.
    pub drive: Vec<f64>,
}

/// Columns of the regression, and which of them have an estimate of their own.
#[derive(Debug, Clone, PartialEq)]
pub struct Excited {
    /// Excitation of every column.
    pub shown: Vec<Excitation>,
    /// Positions of the columns that belong into the regression.
    pub regressed: Vec<usize>,
}

/// Judges columns. `weights` and `times` are length and middle of every interval; `drift`: a drift is taken out beside.
pub fn judge(columns: &[Column], weights: &[f64], times: &[f64], drift: bool) -> Excited {
    let largest = columns.iter().map(|c| size(&c.drive)).fold(0.0, f64::max);
    let time_scale = size(times).max(f64::MIN_POSITIVE);
    let root: Vec<f64> = weights.iter().map(|w| w.sqrt()).collect();
    let weighted = |values: &dyn Fn(usize) -> f64| DVector::from_fn(root.len(), |k, _| root[k] * values(k));
    let mut base = vec![weighted(&|_| 1.0)];
    if drift {
        base.push(weighted(&|k| times[k] / time_scale));
    }
    let first = base.len();
    let mut order: Vec<usize> = (0..columns.len()).collect();
    let energy = |c: usize| columns[c].drive.iter().zip(weights).map(|(d, w)| w * d * d).sum::<f64>();
    order.sort_by(|a, b| energy(*b).total_cmp(&energy(*a)));
    let mut regressed: Vec<usize> = vec![];
    let mut shown = vec![Excitation::None; columns.len()];
    // Mean square in step with a column, per its own, and the column that has most of it.
    let mut elsewhere: Vec<(f64, Option<usize>, f64)> = vec![(0.0, None, 0.0); columns.len()];
    for at in order {
        let own = weighted(&|k| columns[at].drive[k]);
        let alone = left(&base[..first], &own).map_or(0.0, |(rest, _)| rest.norm());
        let Some((rest, coefficients)) = left(&base, &own) else { continue };
        let is_excited = size(&columns[at].drive) >= LEAST_EXCITED_SHARE * largest && alone > 0.0;
        if is_excited && rest.norm() >= LEAST_OWN_SHARE * alone {
            base.push(own);
            regressed.push(at);
            shown[at] = Excitation::Apart { elsewhere: 0.0 };
            continue;
        }
        let shares = coefficients.iter().skip(first).zip(&regressed);
        let mut strongest = (0.0, None);
        for (share, with) in shares {
            let most = &mut elsewhere[*with];
            most.0 += share.abs();
            if share.abs() > most.2 {
                (most.1, most.2) = (Some(at), share.abs());
            }
            let of_it = share.abs() * energy(*with).sqrt();
            if of_it > strongest.0 {
                strongest = (of_it, Some(*with));
            }
        }
        if is_excited && let Some(with) = strongest.1 {
            shown[at] = Excitation::InStep { with: columns[with].band };
        }
    }
    for at in &regressed {
        let (share, most, _) = elsewhere[*at];
        shown[*at] = match most {
            Some(with) if share > LARGEST_SHARE_ELSEWHERE => Excitation::InStep { with: columns[with].band },
            _ => Excitation::Apart { elsewhere: share },
        };
    }
    Excited { shown, regressed }
}

fn size(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |m: f64, v| m.max(v.abs()))
}

/// The part of a column that others do not explain, and the coefficients of these.
fn left(columns: &[DVector<f64>], own: &DVector<f64>) -> Option<(DVector<f64>, DVector<f64>)> {
    let scales: Vec<f64> = columns.iter().map(|c| c.norm().max(f64::MIN_POSITIVE)).collect();
    let scaled: Vec<DVector<f64>> = columns.iter().zip(&scales).map(|(c, s)| c / *s).collect();
    let x = DMatrix::from_columns(&scaled);
    let coefficients = Cholesky::new(x.transpose() * &x)?.solve(&(x.transpose() * own));
    let rest = own - &x * &coefficients;
    Some((rest, DVector::from_fn(scales.len(), |k, _| coefficients[k] / scales[k])))
}

#[cfg(test)]
mod tests {
    use super::*;

    const LOW: Band = Band { from_hz: 10.0, to_hz: 20.0 };
    const HIGH: Band = Band { from_hz: 30.0, to_hz: 50.0 };

    fn judged(columns: &[(Option<Band>, [f64; 9])]) -> Excited {
        let columns: Vec<Column> =
            columns.iter().map(|(band, drive)| Column { band: *band, drive: drive.to_vec() }).collect();
        let times: Vec<f64> = (-4..=4).map(f64::from).collect();
        judge(&columns, &[1.0; 9], &times, true)
    }

    #[test]
    fn bands_excited_in_turns_are_told_apart() {
        let found = judged(&[
            (Some(LOW), [0.0, 4.0, 0.0, 0.0, 0.0, 4.0, 0.0, 0.0, 0.0]),
            (Some(HIGH), [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]),
        ]);
        assert_eq!(found.shown, [Excitation::Apart { elsewhere: 0.0 }; 2]);
        assert_eq!(found.regressed, [0, 1]);
    }

    #[test]
    fn bands_excited_together_are_not() {
        let found = judged(&[
            (Some(LOW), [0.0, 4.0, 0.0, 4.0, 0.0, 4.0, 0.0, 4.0, 0.0]),
            (Some(HIGH), [0.0, 2.0, 0.0, 2.0, 0.0, 2.0, 0.0, 2.0, 0.0]),
            (None, [0.0; 9]),
        ]);
        assert_eq!(found.shown[0], Excitation::InStep { with: Some(HIGH) });
        assert_eq!(found.shown[1], Excitation::InStep { with: Some(LOW) });
        assert_eq!(found.shown[2], Excitation::None);
    }

    #[test]
    fn what_lies_beyond_all_bands_in_step_with_one_widens_it_or_withholds_it() {
        let of = |share: f64| {
            let drive = [0.0, 4.0, 0.0, 4.0, 0.0, 4.0, 0.0, 4.0, 0.0];
            judged(&[(Some(LOW), drive), (None, drive.map(|d| share * d))]).shown[0]
        };
        let Excitation::Apart { elsewhere } = of(0.05) else { panic!() };
        assert!((elsewhere - 0.05).abs() < 1e-9);
        assert_eq!(of(0.3), Excitation::InStep { with: None });
    }

    #[test]
    fn a_band_that_was_hardly_excited_has_no_value() {
        let found = judged(&[
            (Some(LOW), [0.0, 4.0, 0.0, 4.0, 0.0, 4.0, 0.0, 4.0, 0.0]),
            (Some(HIGH), [0.0, 0.001, 0.0, 0.0, 0.001, 0.0, 0.0, 0.001, 0.0]),
        ]);
        assert_eq!(found.shown[1], Excitation::None);
        assert!(matches!(found.shown[0], Excitation::Apart { .. }));
    }
}
