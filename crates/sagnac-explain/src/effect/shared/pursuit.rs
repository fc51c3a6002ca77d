//! Terms chosen one by one by their gain (orthogonal matching pursuit: Pati, Rezaiifar and Krishnaprasad, Asilomar 1993).

/// Least share of a term that is independent of the terms before it.
const MIN_INDEPENDENT_SHARE: f64 = 1e-4;

/// Choice of a matching pursuit.
#[derive(Debug, Clone, PartialEq, Default)]
pub(in crate::effect) struct Pursuit {
    /// Positions of the terms, in the order of their choice.
    pub terms: Vec<usize>,
    /// Gain of log-likelihood of all of them, nats.
    pub gain: f64,
}

/// Chooses among terms those that gain at least `price` each beside the ones before, at most `most`. Terms and residual in
/// whitened modes; a term of no modes is not chosen.
pub(in crate::effect) fn matching_pursuit(
    terms: &[Vec<f64>],
    allowed: impl Fn(usize) -> bool,
    residual: &[f64],
    most: usize,
    price: f64,
) -> Pursuit {
    let sizes: Vec<f64> = terms.iter().map(|m| dot(m, m)).collect();
    let mut left: Vec<Option<Vec<f64>>> =
        terms.iter().enumerate().map(|(i, m)| allowed(i).then(|| m.clone())).collect();
    let mut residual = residual.to_vec();
    let mut out = Pursuit::default();
    for _ in 0..most {
        let gain = |(i, m): (usize, &Option<Vec<f64>>)| {
            let m = m.as_ref()?;
            let size = dot(m, m);
            if !(size > MIN_INDEPENDENT_SHARE * sizes[i] && size > 0.0) {
                return None;
            }
            Some((i, 0.5 * dot(m, &residual).powi(2) / size))
        };
        let best = left.iter().enumerate().filter_map(gain).max_by(|a, b| a.1.total_cmp(&b.1));
        let Some((i, gained)) = best.filter(|(_, g)| *g >= price) else { break };
        let Some(chosen) = left[i].take() else { break };
        let direction = unit(chosen);
        remove(&mut residual, &direction);
        left.iter_mut().flatten().for_each(|m| remove(m, &direction));
        out.terms.push(i);
        out.gain += gained;
    }
    out
}

/// Choices of `chosen` terms out of `all`.
pub(in crate::effect) fn choices(all: usize, chosen: usize) -> f64 {
    (0..chosen).map(|i| (all - i) as f64 / (i + 1) as f64).product()
}

/// Scalar product.
pub(in crate::effect) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// A vector of length 1 in the same direction; that of none is left.
pub(in crate::effect) fn unit(mut v: Vec<f64>) -> Vec<f64> {
    let size = dot(&v, &v).sqrt();
    if size > 0.0 {
        v.iter_mut().for_each(|x| *x /= size);
    }
    v
}

/// Takes the part along a unit vector out.
pub(in crate::effect) fn remove(v: &mut [f64], direction: &[f64]) {
    let share = dot(v, direction);
    v.iter_mut().zip(direction).for_each(|(x, d)| *x -= share * d);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_terms_of_a_sum_are_chosen_by_size_and_others_are_not() {
        let axis = |i: usize| (0..6).map(|k| f64::from(u8::from(k == i))).collect::<Vec<f64>>();
        let mut oblique = axis(2);
        oblique[3] = 1.0;
        let terms = [axis(0), axis(1), axis(2), oblique, vec![]];
        let residual = [1.0, 0.0, 6.0, 4.0, 0.0, 0.0];
        // Of (6, 4) the oblique term gains 25, the rest of the third axis 1.
        let chosen = matching_pursuit(&terms, |_| true, &residual, 3, 0.4);
        assert_eq!(chosen.terms, [3, 2, 0]);
        assert!((chosen.gain - 0.5 * 53.0).abs() < 1e-9, "{chosen:?}");
        assert_eq!(matching_pursuit(&terms, |_| true, &residual, 3, 2.0).terms, [3]);
        assert_eq!(matching_pursuit(&terms, |i| i != 3, &residual, 1, 2.0).terms, [2]);
        assert_eq!(choices(20, 3), 1140.0);
    }
}
