//! Limits on N, B and K as lines on σ(τ), each where its term acts, and the limit on the standard deviation of 100-s means
//! as a mark.

use super::draw;
use crate::figure::{Layer, Style};
use crate::i18n::{Arg, Note};
use crate::measurand::{self, allan_minimum::FLICKER_FLOOR};

/// Averaging times between which limits are drawn, s: the first shown, that of the lowest σ(τ), the last shown.
#[derive(Debug, Clone, Copy)]
pub struct Span {
    /// First averaging time shown.
    pub first_s: f64,
    /// Where σ(τ) of the record is lowest.
    pub lowest_s: f64,
    /// Last averaging time shown.
    pub last_s: f64,
}

/// Least length of a line, as a ratio of its averaging times.
const MIN_LINE_TAU_RATIO: f64 = 3.0;

/// One limit as a line: σ(τ) of a gyro that has the term at its limit and nothing else.
struct Line {
    /// Quantities with this limit; the first that has one is drawn.
    ids: &'static [&'static str],
    /// Key of the words at the line.
    label: &'static str,
    /// σ in deg/h at an averaging time in s, for a limit in the unit of the quantity.
    sigma: fn(f64, f64) -> f64,
    /// Averaging times over which it is drawn, s; the second argument is that of [`corner_s`].
    acts: fn(Span, f64) -> (f64, f64),
}

/// Angle random walk acts at the short averaging times, σ = N/√τ: N is its value at 1 h. The line ends where the limit on
/// the bias instability takes over.
fn short(s: Span, corner_s: f64) -> (f64, f64) {
    (s.first_s, corner_s.max(MIN_LINE_TAU_RATIO * s.first_s).min(s.last_s))
}

/// Bias instability acts from there, and about the lowest point.
fn flat(s: Span, corner_s: f64) -> (f64, f64) {
    (
        corner_s.min(s.lowest_s / MIN_LINE_TAU_RATIO).max(s.first_s),
        (s.lowest_s * MIN_LINE_TAU_RATIO).min(s.last_s),
    )
}

/// Rate random walk acts at the long averaging times, σ = K·√(τ/3): K is its value at 3 h.
fn long(s: Span, _: f64) -> (f64, f64) {
    (s.lowest_s.min(s.last_s / MIN_LINE_TAU_RATIO).max(s.first_s), s.last_s)
}

/// Averaging time at which a gyro at both limits passes from angle random walk to bias instability; where σ(τ) is lowest
/// without both limits, or where that comes first.
fn corner_s(span: Span, highest: &dyn Fn(&str) -> Option<f64>) -> f64 {
    let at = |line: &Line, tau_s: f64| {
        line.ids.iter().find_map(|id| highest(id)).map(|limit| (line.sigma)(limit, tau_s))
    };
    let [n, b, minimum, _] = &LIMIT_LINES;
    let floor = at(b, 3600.0).or_else(|| at(minimum, 3600.0));
    match (at(n, 3600.0), floor) {
        (Some(n), Some(floor)) if n > 0.0 && floor > 0.0 => (3600.0 * (n / floor).powi(2)).min(span.lowest_s),
        _ => span.lowest_s,
    }
}

const LIMIT_LINES: [Line; 4] = [
    Line {
        ids: &[measurand::ANGLE_RANDOM_WALK.id, measurand::ANGLE_RANDOM_WALK_READOUT.id],
        label: "figure_label.limit_n",
        sigma: |n, tau_s| n / (tau_s / 3600.0).sqrt(),
        acts: short,
    },
    Line {
        ids: &[measurand::BIAS_INSTABILITY.id, measurand::BIAS_INSTABILITY_MINIMUM_SCALED.id],
        label: "figure_label.limit_b",
        sigma: |b, _| FLICKER_FLOOR * b,
        acts: flat,
    },
    Line {
        ids: &[measurand::BIAS_INSTABILITY_MINIMUM.id],
        label: "figure_label.limit_minimum",
        sigma: |minimum, _| minimum,
        acts: flat,
    },
    Line {
        ids: &[measurand::RATE_RANDOM_WALK.id, measurand::RATE_RANDOM_WALK_READOUT.id],
        label: "figure_label.limit_k",
        sigma: |k, tau_s| k * (tau_s / 3600.0 / 3.0).sqrt(),
        acts: long,
    },
];

/// The limits of a channel. `highest` gives the upper limit of a measurand by its id, in its own unit.
pub fn layers(span: Span, highest: &dyn Fn(&str) -> Option<f64>) -> Vec<Layer> {
    let mut out = vec![];
    let mut words = vec![];
    let legend = "figure.legend.limit";
    let corner_s = corner_s(span, highest);
    let label = |at: (f64, f64), key: &'static str, limit: f64| {
        draw::label(at, Note::new(key).with("value", Arg::Stated(limit)))
    };
    for line in &LIMIT_LINES {
        let Some(limit) = line.ids.iter().find_map(|id| highest(id)).filter(|l| *l > 0.0) else { continue };
        let (from, to) = (line.acts)(span, corner_s);
        if !(from > 0.0 && to > from) {
            continue;
        }
        let at = |tau_s: f64| (tau_s, (line.sigma)(limit, tau_s));
        out.push(draw::line(vec![at(from), at(to)], Style::Limit, legend));
        words.push(label(at((from * to).sqrt()), line.label, limit));
    }
    if let Some(limit) = highest(measurand::RUSSIAN_DRIFT_100S.id).filter(|l| *l > 0.0) {
        out.push(draw::points(vec![(100.0, limit)], Style::Limit, "figure.legend.limit_drift"));
        words.push(label((100.0, limit), "figure_label.limit_drift", limit));
    }
    out.extend(words);
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(layers: &[Layer]) -> Vec<&[(f64, f64)]> {
        layers
            .iter()
            .filter_map(|l| match l {
                Layer::Line { points, style: Style::Limit, .. } => Some(points.as_slice()),
                _ => None,
            })
            .collect()
    }

    fn slope(line: &[(f64, f64)]) -> f64 {
        (line[1].1 / line[0].1).ln() / (line[1].0 / line[0].0).ln()
    }

    #[test]
    fn limits_have_the_slopes_and_the_readings_of_their_terms() {
        let span = Span { first_s: 10.0, lowest_s: 3600.0, last_s: 100_000.0 };
        let limits = |id: &str| match id {
            "angle_random_walk" => Some(0.003),
            "bias_instability" => Some(0.005),
            "rate_random_walk" => Some(0.004),
            "russian_drift_100s" => Some(0.017),
            _ => None,
        };
        let layers = layers(span, &limits);
        let drawn = lines(&layers);
        let [n, b, k] = drawn.as_slice() else { panic!("{drawn:?}") };
        // N is σ at 1 h, K is σ at 3 h, the floor of B is 0.664 B.
        let at_one_hour = n[0].1 * (n[0].0 / 3600.0).sqrt();
        assert!((slope(n) + 0.5).abs() < 1e-12 && (at_one_hour - 0.003).abs() < 1e-12, "{n:?}");
        // The two lines meet.
        assert!((n[1].1 - b[0].1).abs() < 1e-12, "{n:?} {b:?}");
        assert!(slope(b).abs() < 1e-12 && (b[0].1 - 0.003_321_4).abs() < 1e-7, "{b:?}");
        assert!((slope(k) - 0.5).abs() < 1e-12, "{k:?}");
        assert!((k[0].1 - 0.004 * (1.0f64 / 3.0).sqrt()).abs() < 1e-12, "{k:?}");
        assert_eq!((n[0].0, k[1].0), (10.0, 100_000.0));
        assert!(b[0].0 < 3600.0 && b[1].0 > 3600.0, "the level passes its reading: {b:?}");
        let mark = layers.iter().find_map(|l| match l {
            Layer::Points { points, style: Style::Limit, .. } => Some(points[0]),
            _ => None,
        });
        assert_eq!(mark, Some((100.0, 0.017)));
        assert_eq!(layers.iter().filter(|l| matches!(l, Layer::Label { .. })).count(), 4);
    }

    #[test]
    fn without_limits_nothing_is_drawn_and_a_short_curve_is_no_trouble() {
        let span = Span { first_s: 1.0, lowest_s: 1.0, last_s: 1.0 };
        assert!(layers(span, &|_| None).is_empty());
        assert!(lines(&layers(span, &|id| (id == "angle_random_walk").then_some(1.0))).is_empty());
    }
}
