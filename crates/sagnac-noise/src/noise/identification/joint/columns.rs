//! Expected band powers of each part for a coefficient of 1.

use super::model::BASE_TERMS;
use crate::noise::composite::{
    Bandwidth, Composite, Damped, Densities, FlickerAliases, Sampling, averaged_white_mode, filtered_white,
    sampled_density,
};
use crate::noise::data::NoiseType;
use crate::noise::evidence::{Evidence, Places, Transform};
use crate::noise::model::{Bin, Spectral, bin_ratio};
use std::cell::RefCell;
use std::f64::consts::PI;
use std::sync::Arc;

/// A term of coefficient 1 behind no filter, by how its samples were taken.
struct Sampled {
    term: NoiseType,
    tau0_s: f64,
    sampling: Sampling,
}

impl Spectral for Sampled {
    fn density(&self, bin: &Bin) -> f64 {
        let sampling = sampling_of_means(bin.tau_s, self.tau0_s, self.sampling);
        sampled_density(self.term, bin.frequency_hz, bin.tau_s, sampling) * bin_ratio(self.term, bin)
    }
}

/// Means over blocks of instantaneous samples are averages to a good approximation.
fn sampling_of_means(tau_s: f64, tau0_s: f64, sampling: Sampling) -> Sampling {
    if tau_s > 1.5 * tau0_s { Sampling::Averaging } else { sampling }
}

/// The columns of N, B, K and Q without a filter.
pub(super) fn base(evidence: &Evidence, sampling: Sampling) -> Vec<Vec<f64>> {
    BASE_TERMS
        .iter()
        .map(|term| match sampling {
            Sampling::Averaging => evidence.expectation(term),
            Sampling::Instantaneous => {
                evidence.expectation(&Sampled { term: *term, tau0_s: evidence.tau0_s, sampling })
            }
        })
        .collect()
}

/// The terms that a filter acts on: N, B and K. Rounding comes after it.
const FILTERED_TERMS: usize = 3;

/// What filters of N, B and K have in common at one bin.
struct FilteredBin {
    bin: Bin,
    sampling: Sampling,
    /// Densities without a filter.
    density: [f64; FILTERED_TERMS],
    /// What bins show of a density.
    ratio: [f64; FILTERED_TERMS],
    flicker: FlickerAliases,
}

/// All bins that an expectation asks for, in the order in which it does, with all that no filter enters. A search tries some hundred
/// filters of one evidence.
pub(super) struct FilteredBins {
    bins: Vec<FilteredBin>,
}

/// Keeps the bins that it is asked for.
struct Asked(RefCell<Vec<Bin>>);

impl Spectral for Asked {
    fn density(&self, bin: &Bin) -> f64 {
        self.0.borrow_mut().push(*bin);
        0.0
    }
}

/// Answers with given densities, in the order of the bins of [`Asked`].
struct Answers<'a>(RefCell<std::slice::Iter<'a, f64>>);

impl Spectral for Answers<'_> {
    fn density(&self, _: &Bin) -> f64 {
        self.0.borrow_mut().next().copied().unwrap_or(0.0)
    }
}

impl FilteredBins {
    pub(super) fn new(evidence: &Evidence, sampling: Sampling) -> FilteredBins {
        let asked = Asked(RefCell::default());
        evidence.expectation(&asked);
        let terms: [NoiseType; FILTERED_TERMS] =
            [NoiseType::AngleRandomWalk, NoiseType::Flicker, NoiseType::RateRandomWalk];
        let filtered = |bin: Bin| {
            let sampling = sampling_of_means(bin.tau_s, evidence.tau0_s, sampling);
            let (f, tau) = (bin.frequency_hz, bin.tau_s);
            FilteredBin {
                bin,
                sampling,
                density: terms.map(|term| sampled_density(term, f, tau, sampling)),
                ratio: terms.map(|term| bin_ratio(term, &bin)),
                flicker: FlickerAliases::new(f, tau, sampling),
            }
        };
        FilteredBins { bins: asked.0.into_inner().into_iter().map(filtered).collect() }
    }

    /// The columns of N, B and K behind a filter.
    pub(super) fn columns(&self, evidence: &Evidence, filter: Bandwidth) -> Vec<Vec<f64>> {
        let mut values: [Vec<f64>; FILTERED_TERMS] =
            std::array::from_fn(|_| Vec::with_capacity(self.bins.len()));
        let mut law = Law::of(filter, evidence.tau0_s);
        for bin in &self.bins {
            for ((values, density), ratio) in values.iter_mut().zip(law.densities(bin)).zip(bin.ratio) {
                values.push(density * ratio);
            }
        }
        values.iter().map(|v| evidence.expectation(&Answers(RefCell::new(v.iter())))).collect()
    }
}

/// A filter on its way through the bins.
enum Law {
    FirstOrder {
        time_constant_s: f64,
        /// White noise over the interval of the last bin.
        white: Option<(f64, Densities)>,
    },
    MovingAverage {
        samples: u32,
        tau0_s: f64,
    },
}

impl Law {
    fn of(filter: Bandwidth, tau0_s: f64) -> Law {
        match filter {
            Bandwidth::FirstOrder { time_constant_s } => Law::FirstOrder { time_constant_s, white: None },
            Bandwidth::MovingAverage { samples } => Law::MovingAverage { samples, tau0_s },
        }
    }

    /// Densities of N, B and K at a bin, for coefficients of 1.
    fn densities(&mut self, at: &FilteredBin) -> [f64; FILTERED_TERMS] {
        let (bin, [n, b, k]) = (&at.bin, at.density);
        match self {
            Law::FirstOrder { time_constant_s, white } => {
                let densities = match white {
                    Some((tau_s, densities)) if *tau_s == bin.tau_s => *densities,
                    _ => filtered_white(*time_constant_s).densities(bin.tau_s, at.sampling),
                };
                *white = Some((bin.tau_s, densities));
                [
                    densities.at(bin.frequency_hz),
                    at.flicker.behind(*time_constant_s),
                    k / (1.0 + (2.0 * PI * bin.frequency_hz * *time_constant_s).powi(2)),
                ]
            }
            Law::MovingAverage { samples, tau0_s } => {
                let count = f64::from((*samples).max(1));
                let x = PI * bin.frequency_hz * *tau0_s;
                let sin = x.sin();
                let gain = if sin.abs() < 1e-12 { 1.0 } else { (count * x).sin() / (count * sin) };
                let white = if bin.mode > 0 && bin.tau_s <= 1.5 * *tau0_s {
                    n * averaged_white_mode(*samples, bin.mode as f64, bin.blocks)
                } else {
                    gain * gain * n
                };
                [white, gain * gain * b, gain * gain * k]
            }
        }
    }
}

/// The column of one process of standard deviation 1 at places of an evidence with samples over `tau0_s`.
pub(super) fn process(places: &Places, tau0_s: f64, process: &Damped, sampling: Sampling) -> Vec<f64> {
    let unit = Damped { rms_deg_h: 1.0, ..*process };
    places.expectation(|transform, tau_s, turns, out| {
        let sampling = sampling_of_means(tau_s, tau0_s, sampling);
        match transform {
            Transform::Modes(blocks) => unit.modes(blocks, tau_s, sampling).powers(turns, out),
            Transform::Segments(length) => unit.windowed(length, tau_s, sampling).densities(turns, out),
        }
    })
}

/// The columns of N, B, K and Q, shared by all shapes behind the same filter.
pub(super) type Base = Arc<Vec<Vec<f64>>>;

/// All columns of a shape.
#[derive(Debug, Clone)]
pub(super) struct Columns {
    pub(super) base: Base,
    pub(super) damped: Vec<Arc<Vec<f64>>>,
}

impl Columns {
    pub(super) fn all(&self) -> impl Iterator<Item = &Vec<f64>> {
        self.base.iter().chain(self.damped.iter().map(Arc::as_ref))
    }
}

/// Expected power of each band under a model, (deg/h)²/Hz, without its ramp and lines.
pub fn expected_power(evidence: &Evidence, model: &Composite) -> Vec<f64> {
    let coefficients = BASE_TERMS.iter().map(|t| model.terms.coefficient(*t).powi(2));
    let mut base = base(evidence, model.sampling);
    if let Some(filter) = model.bandwidth {
        let filtered = FilteredBins::new(evidence, model.sampling).columns(evidence, filter);
        base.splice(..FILTERED_TERMS, filtered);
    }
    let base = base.into_iter().zip(coefficients);
    let damped = model.markov.iter().chain(&model.quasi_periodic);
    let places = evidence.places();
    let damped = damped.map(|d| (process(&places, evidence.tau0_s, d, model.sampling), d.rms_deg_h.powi(2)));
    let mut out = vec![0.0; evidence.bands.len()];
    for (column, square) in base.chain(damped).filter(|(_, square)| *square > 0.0) {
        for (o, c) in out.iter_mut().zip(column) {
            *o += square * c;
        }
    }
    out
}
