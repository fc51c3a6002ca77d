//! The typical and the worst of the places at which an effect could have been.

use crate::mismatch::noticeable_record::WorstPlace;
use crate::numeric::order::SortByNumber;
use std::collections::BTreeMap;

/// Parameters of a place, by name.
pub(super) type At = BTreeMap<String, f64>;

/// The size at a place.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Placed {
    pub size: f64,
    pub rms_deg_h: Option<f64>,
    pub at: At,
}

/// Of several places.
pub(super) struct Summary {
    /// The place of the median size, the upper of two.
    pub typical: Placed,
    /// That of the largest; of the smallest where the effect falls with its parameter. `None` for a single place.
    pub worst: Option<WorstPlace>,
}

/// The typical and the worst place; `None` of no place.
pub(super) fn summary(mut placed: Vec<Placed>, falls: bool) -> Option<Summary> {
    placed.sort_ascending_by(|a| a.size);
    if falls {
        placed.reverse();
    }
    let typical = placed.get(placed.len() / 2)?.clone();
    let worst = placed.last().filter(|_| placed.len() > 1);
    let worst = worst.map(|w| WorstPlace { size: w.size, at: w.at.clone() });
    Some(Summary { typical, worst })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_of_the_places_ask_for_less_than_the_typical_one() {
        let placed = |sizes: &[f64]| -> Vec<Placed> {
            sizes.iter().map(|size| Placed { size: *size, rms_deg_h: None, at: At::new() }).collect()
        };
        let of = |sizes: &[f64], falls| {
            summary(placed(sizes), falls).map(|s| (s.typical.size, s.worst.map(|w| w.size)))
        };
        assert_eq!(of(&[3.0, 9.0, 1.0], false), Some((3.0, Some(9.0))));
        assert_eq!(of(&[3.0, 9.0, 1.0, 2.0], true), Some((2.0, Some(1.0))));
        assert_eq!(of(&[3.0], false), Some((3.0, None)));
        assert_eq!(of(&[], false), None);
    }
}
