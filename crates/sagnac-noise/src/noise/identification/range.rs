//! Entrance: identification by the method that the options ask for, over all frequencies or those that a model describes.
//!
//! Real outputs are filtered, and noise near the Nyquist frequency can have a shape that no term has. Fitted over all
//! frequencies, such a record gives a wrong N with a tiny interval. Where the model fails its misfit test it is fitted
//! up to the highest frequency, by octaves, at which it passes, where the failure lies above; that part is left out and
//! said so. A departure elsewhere costs no octave. Where no range passes, the intervals are widened by the
//! root of the misfit (Birge ratio), and that is said too.
//!
//! Where even the lowest frequencies are far from any model, the record is no noise, such as a ramp: the ranges between are not
//! tried. In a range whose powers do not scatter, no process is searched for: a smooth curve is the leakage of a drift.
//!
//! What bends beyond the edge of a cut range begins within it, too weak to be seen there. The white level of the lower half of the
//! range knows less of it: the interval of N holds that as well.

use super::claims::{LIMIT_COVERAGE, WHITTLE_METHOD};
use super::joint::{Plateau, expected_power, identify_joint};
use super::misfit::{Misfit, WhitenedBand};
use super::options::Options;
use super::profile::wider;
use super::result::Identification;
use super::standard::identify_standard;
use crate::estimate::{Estimate, Spread, UpperLimit, normal_probability};
use crate::message::note;
use crate::noise::composite::Part;
use crate::noise::data::NoiseType;
use crate::noise::evidence::Evidence;

/// Probability of a larger misfit below which a range does not pass.
const MIN_PROBABILITY: f64 = 0.02;
/// Probability below which the model of all frequencies fails above a range.
const FAILURE_PROBABILITY: f64 = 1e-5;
/// Departure of the worst band that does no harm, whatever its significance: 2 % in power is 1 % in N.
const HARMLESS_EXCESS: f64 = 0.02;
/// Octaves that may be given up.
const MAX_OCTAVES: u32 = 8;
/// Degrees of freedom that a range must keep.
const MIN_DOF: f64 = 200.0;
/// Misfit from which a model says nothing of a record. That of noise whose model lacks something is some units in the narrowest range.
const GROSS_MISFIT: f64 = 10.0;

/// An identification and the range it rests on.
#[derive(Debug, Clone, PartialEq)]
pub struct RangedIdentification {
    /// The identified model.
    pub identification: Identification,
    /// Highest frequency used, Hz; `None`: all.
    pub highest_hz: Option<f64>,
    /// Highest frequency at which coarse rounding lets the noise be seen, Hz; `None`: all.
    pub rounded_above_hz: Option<f64>,
    /// Factor by which intervals were widened; 1 where the model fits.
    pub widened: f64,
}

impl RangedIdentification {
    /// True where the model is so far from the record that its parts say nothing.
    pub(in crate::noise) fn is_void(&self) -> bool {
        self.widened * self.widened > GROSS_MISFIT
    }
}

/// Identifies over the widest range of frequencies in which the model holds.
pub fn identify_in_range(
    channel: &str,
    evidence: &Evidence,
    nyquist_hz: f64,
    options: &Options,
) -> RangedIdentification {
    identify_over(channel, evidence, options, &describe_in_range(channel, evidence, nyquist_hz, options))
}

/// The range and the model in it, without intervals.
pub fn describe_in_range(
    channel: &str,
    evidence: &Evidence,
    nyquist_hz: f64,
    options: &Options,
) -> RangedIdentification {
    let mut best: Option<RangedIdentification> = None;
    let mut hidden: Option<RangedIdentification> = None;
    let mut whole: Option<Identification> = None;
    for octave in 0..=MAX_OCTAVES {
        let highest_hz = nyquist_hz / f64::from(1u32 << octave);
        let restricted = (octave > 0).then(|| evidence.up_to(highest_hz));
        let used = restricted.as_ref().unwrap_or(evidence);
        if octave > 0 && used.dof() < MIN_DOF {
            break;
        }
        let justified =
            hidden.is_some() || whole.as_ref().is_none_or(|whole| fails_above(evidence, whole, highest_hz));
        if !justified {
            continue;
        }
        let identification = describe(channel, used, options);
        whole.get_or_insert_with(|| identification.clone());
        let fits = identification.misfit.probability >= MIN_PROBABILITY
            || (identification.misfit.worst_excess - 1.0).abs() <= HARMLESS_EXCESS;
        let highest_hz = (octave > 0).then_some(highest_hz);
        let candidate =
            RangedIdentification { identification, highest_hz, rounded_above_hz: None, widened: 1.0 };
        if fits {
            if !is_white_hidden(&candidate.identification, evidence) {
                return candidate;
            }
            hidden.get_or_insert(candidate);
            continue;
        }
        let is_gross = octave == 0 && candidate.identification.misfit.per_dof > GROSS_MISFIT;
        if is_gross
            && options.processes
            && let Some(void) =
                described_nowhere(channel, evidence, nyquist_hz, options, &candidate.identification)
        {
            return void;
        }
        let misfit = |r: &RangedIdentification| r.identification.misfit.per_dof;
        if hidden.is_none() && best.as_ref().is_none_or(|b| misfit(&candidate) < misfit(b)) {
            best = Some(candidate);
        }
    }
    if let Some(hidden) = hidden {
        return hidden;
    }
    let mut best = best.unwrap_or_else(|| RangedIdentification {
        identification: describe(channel, evidence, options),
        highest_hz: None,
        rounded_above_hz: None,
        widened: 1.0,
    });
    best.widened = best.identification.misfit.per_dof.sqrt().max(1.0);
    best
}

/// The better of the descriptions of all frequencies and of the narrowest range, where neither describes anything: every wider range holds
/// the narrowest one.
fn described_nowhere(
    channel: &str,
    evidence: &Evidence,
    nyquist_hz: f64,
    options: &Options,
    whole: &Identification,
) -> Option<RangedIdentification> {
    let ranges = (1..=MAX_OCTAVES).map(|octave| nyquist_hz / f64::from(1u32 << octave));
    let (highest_hz, narrowest) =
        ranges.map(|hz| (hz, evidence.up_to(hz))).take_while(|(_, e)| e.dof() >= MIN_DOF).last()?;
    let is_gross = |found: &Identification| found.misfit.per_dof > GROSS_MISFIT;
    let low = describe(channel, &narrowest, options);
    // What bends within a wider range may lie at the edge of this one.
    let with_edge = Options { parts_at_edge: true, ..*options };
    if !is_gross(&low) || !is_gross(&describe(channel, &narrowest, &with_edge)) {
        return None;
    }
    let (identification, highest_hz) = if low.misfit.per_dof < whole.misfit.per_dof {
        (low, Some(highest_hz))
    } else {
        (whole.clone(), None)
    };
    let widened = identification.misfit.per_dof.sqrt();
    Some(RangedIdentification { identification, highest_hz, rounded_above_hz: None, widened })
}

/// True where a model has its white noise beneath processes or a filter that stand for it, and no level that is read.
/// The white level of lower frequencies is then that of a narrower range.
fn is_white_hidden(found: &Identification, evidence: &Evidence) -> bool {
    let model = &found.described.model;
    let shaped = model.bandwidth.is_some() || !model.markov.is_empty() || !model.quasi_periodic.is_empty();
    let read = Plateau::of(model, evidence.tau0_s, evidence.span_s).is_some();
    shaped && !read && !found.claims(NoiseType::AngleRandomWalk)
}

/// Identifies over a range that was found, with intervals.
pub fn identify_over(
    channel: &str,
    evidence: &Evidence,
    options: &Options,
    range: &RangedIdentification,
) -> RangedIdentification {
    let mut identification = match range.highest_hz {
        Some(highest_hz) => complete(channel, &evidence.up_to(highest_hz), options, &range.identification),
        None => complete(channel, evidence, options, &range.identification),
    };
    identification.highest_hz = range.highest_hz;
    if let Some(highest_hz) = range.highest_hz {
        hold_level_of_half(channel, &evidence.up_to(0.5 * highest_hz), options, &mut identification);
    }
    with_notes(without_unseen(RangedIdentification { identification, ..*range }, evidence.tau0_s))
}

/// Widens the interval of the white level so that it holds that of half the range, where this is long enough and shows one.
fn hold_level_of_half(channel: &str, half: &Evidence, options: &Options, found: &mut Identification) {
    let level = found.read_angle_random_walk_mut();
    let Some(value) = level.value.filter(|_| half.dof() >= MIN_DOF) else { return };
    let of_half = identify(channel, half, options);
    let other = of_half.read_angle_random_walk();
    let Some(value_of_half) = other.value else { return };
    let by_score = |z: f64| other.spread.bound(value_of_half, normal_probability(z)).unwrap_or(value_of_half);
    level.spread = wider(value, &level.spread, &Spread::by_score(by_score));
}

/// True when a model of the whole evidence fails above a frequency. A departure that chance made at low frequencies is
/// no reason to give up the high ones.
fn fails_above(evidence: &Evidence, found: &Identification, highest_hz: f64) -> bool {
    let expected = expected_power(evidence, &found.described.model);
    let ramp = found.supported.r;
    let (mut above, mut whitened) = (evidence.clone(), vec![]);
    above.bands.clear();
    for (band, power) in
        evidence.bands.iter().zip(expected).filter(|(b, p)| b.high_hz > highest_hz && *p > 0.0)
    {
        whitened.push(WhitenedBand { ratio: band.power_without_ramp(ramp) / power, dof: band.dof });
        above.bands.push(band.clone());
    }
    let misfit = Misfit::of(&above, &whitened, 0);
    misfit.probability < FAILURE_PROBABILITY || misfit.worst_probability < FAILURE_PROBABILITY
}

/// Takes back what a restricted range cannot show: a filter whose cut-off, or quantisation whose rise above the white
/// noise, lies beyond the range.
fn without_unseen(mut ranged: RangedIdentification, tau0_s: f64) -> RangedIdentification {
    let Some(highest_hz) = ranged.highest_hz else { return ranged };
    let found = &mut ranged.identification;
    if found.cutoff.as_ref().is_some_and(|c| c.value.is_none_or(|hz| hz > highest_hz)) {
        found.cutoff = None;
    }
    let density = |term| found.described.model.part_density(Part::Term(term), highest_hz, tau0_s);
    let rises = density(NoiseType::Quantization) >= density(NoiseType::AngleRandomWalk);
    if found.quantization.value.is_some() && !rises {
        let q = &found.quantization;
        let limit = q.interval95().map(|i| UpperLimit { value: i.high, coverage: LIMIT_COVERAGE });
        found.quantization = Estimate::not_identifiable(q.id, &q.channel, limit, q.unit, WHITTLE_METHOD);
        found.claimed.retain(|t| *t != NoiseType::Quantization);
        found.model.q = 0.0;
    }
    ranged
}

/// Puts the notes on the estimates, and the widening on their spreads.
fn with_notes(mut ranged: RangedIdentification) -> RangedIdentification {
    let misfit = ranged.identification.misfit;
    let RangedIdentification { highest_hz, rounded_above_hz, widened, .. } = ranged;
    for row in &mut ranged.identification.described.covariance {
        row.iter_mut().for_each(|c| *c *= widened * widened);
    }
    for estimate in ranged.identification.every_estimate_mut() {
        if let Some(highest_hz) = rounded_above_hz {
            estimate.notes.push(note!("note.fit_coarse", highest_hz));
        }
        if let Some(highest_hz) = highest_hz.filter(|_| highest_hz != rounded_above_hz) {
            estimate.notes.push(note!("note.fit_restricted", highest_hz));
        }
        if widened > 1.0 {
            widen(estimate, widened);
            let [low_hz, high_hz] = misfit.worst_band_hz.unwrap_or([f64::NAN; 2]);
            let note = note!("note.model_misfit", misfit = misfit.per_dof, low_hz, high_hz, factor = widened);
            estimate.notes.push(note);
        }
    }
    ranged
}

fn widen(estimate: &mut Estimate, factor: f64) {
    let Some(value) = estimate.value else {
        // An upper limit moves away from zero, the smallest value it could stand for.
        if let Some(limit) = &mut estimate.upper_limit {
            limit.value *= factor;
        }
        return;
    };
    match &mut estimate.spread {
        Spread::Normal { standard_uncertainty } | Spread::StudentT { standard_uncertainty, .. } => {
            *standard_uncertainty *= factor;
        }
        Spread::Curve(points) => {
            for (_, v) in points {
                // The quantities are sizes: a widened lower end stops at zero.
                *v = if value > 0.0 {
                    (value + (*v - value) * factor).max(0.0)
                } else {
                    value + (*v - value) * factor
                };
            }
        }
        Spread::ChiSquare { .. } | Spread::Unknown => {}
    }
}

/// Identifies the noise of a channel: which terms are claimed, each with its interval or its upper limit, the models
/// they make, and how well those fit.
///
/// `channel` is copied into the estimates. An evidence with too few bands gives an identification that claims nothing and
/// has no limits.
///
/// ```
/// use sagnac_noise::noise::data::NoiseType;
/// use sagnac_noise::noise::evidence::Evidence;
/// use sagnac_noise::noise::identification::{Options, identify};
/// use sagnac_noise::noise::model::NoiseModel;
///
/// // Ten hours at 1 Hz: what a record of 0.002 deg/√h is expected to give.
/// let model = NoiseModel { n: 0.002, ..NoiseModel::default() };
/// let found = identify("rate", &Evidence::expected(&model, 36_000, 1.0), &Options::default());
///
/// assert_eq!(found.claimed, [NoiseType::AngleRandomWalk]);
/// let n = found.angle_random_walk.value.unwrap_or(f64::NAN);
/// assert!((n / 0.002 - 1.0).abs() < 1e-3);
/// assert!(found.bias_instability.upper_limit.is_some());
/// ```
pub fn identify(channel: &str, evidence: &Evidence, options: &Options) -> Identification {
    run(channel, evidence, options, None, true)
}

/// As [`identify`], without intervals and limits, which take most of the time: what is claimed, the models, the misfit.
pub fn describe(channel: &str, evidence: &Evidence, options: &Options) -> Identification {
    run(channel, evidence, options, None, false)
}

/// Intervals and limits for what [`describe`] found in the same evidence with the same options; equal to [`identify`],
/// and faster, since the search has been made.
pub fn complete(
    channel: &str,
    evidence: &Evidence,
    options: &Options,
    described: &Identification,
) -> Identification {
    run(channel, evidence, options, Some(described), true)
}

fn run(
    channel: &str,
    evidence: &Evidence,
    options: &Options,
    described: Option<&Identification>,
    intervals: bool,
) -> Identification {
    if options.processes && evidence.scatters() {
        let searched = described.and_then(|d| d.searched.as_ref());
        identify_joint(channel, evidence, options, searched, intervals)
    } else {
        identify_standard(channel, evidence, &options.standard, intervals)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::noise::data::BlockSeries;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    /// What samples at 1 Hz show.
    fn evidence_of(mean: Vec<f64>) -> Evidence {
        let count = vec![1; mean.len()];
        Evidence::new(
            &BlockSeries { block_len: 1, first_index: 0, count, mean, rounding: vec![] },
            None,
            1.0,
            &[],
        )
    }

    /// White noise of N deg/√h at 1 Hz through a two-sample mean: the spectrum falls to zero at the Nyquist frequency.
    fn smoothed(n: f64, samples: usize) -> Evidence {
        let mut rng = rand_xoshiro::Xoshiro256PlusPlus::seed_from_u64(20_261_121);
        let white: Vec<f64> = (0..=samples)
            .map(|_| 60.0 * n * <StandardNormal as Distribution<f64>>::sample(&StandardNormal, &mut rng))
            .collect();
        let mean: Vec<f64> = white.windows(2).map(|w| 0.5 * (w[0] + w[1])).collect();
        evidence_of(mean)
    }

    #[test]
    fn a_filtered_output_still_gives_its_angle_random_walk() {
        let evidence = smoothed(0.002, 36_000);
        let all = identify("rate", &evidence, &Options::standard_terms());
        let naive = all.angle_random_walk.value.unwrap_or(0.0);
        assert!((naive / 0.002 - 1.0).abs() > 0.1, "fitted over all frequencies N is wrong: {naive}");
        let ranged = identify_in_range("rate", &evidence, 0.5, &Options::standard_terms());
        let estimate = &ranged.identification.angle_random_walk;
        let n = estimate.value.unwrap();
        assert!((n / 0.002 - 1.0).abs() < 0.05, "{n} up to {:?}", ranged.highest_hz);
        assert!(ranged.highest_hz.is_some_and(|f| f < 0.3));
        assert!(estimate.notes.iter().any(|note| note.id == "note.fit_restricted"));
    }

    #[test]
    fn what_is_no_noise_at_any_frequency_is_told_from_its_lowest_ones() {
        let ramp = evidence_of((0..36_000).map(|i| 1e9 * f64::from(i)).collect());
        let found = describe_in_range("rate", &ramp, 0.5, &Options::default());
        assert!(found.is_void(), "{:?}", found.identification.misfit);
        // The narrowest range that is long enough: that of the seventh octave.
        assert!(found.highest_hz.is_none_or(|hz| hz == 0.5 / 128.0), "{:?}", found.highest_hz);
        let noise = describe_in_range("rate", &behind_a_filter(1), 0.5, &Options::default());
        assert!(!noise.is_void() && noise.widened == 1.0, "{:?}", noise.identification.misfit);
    }

    #[test]
    fn no_process_is_found_in_what_does_not_scatter() {
        for course in [|t: f64| (1e-3 * t).sin(), |t: f64| (-t / 500.0).exp()] {
            let evidence = evidence_of((0..36_000).map(|i| course(f64::from(i))).collect());
            let found = describe_in_range("rate", &evidence, 0.5, &Options::default());
            assert!(found.widened > 1.0, "{:?}", found.identification.misfit);
            let model = &found.identification.described.model;
            assert!(model.markov.is_empty() && model.quasi_periodic.is_empty() && model.bandwidth.is_none());
        }
    }

    /// White noise of 0.002 deg/√h at 1 Hz behind a Butterworth filter of second order with its cut-off at 0.2 Hz.
    fn behind_a_filter(seed: u64) -> Evidence {
        let mut rng = rand_xoshiro::Xoshiro256PlusPlus::seed_from_u64(seed);
        let k = (std::f64::consts::PI * 0.2).tan();
        let scale = 1.0 / (1.0 + std::f64::consts::SQRT_2 * k + k * k);
        let a1 = 2.0 * (k * k - 1.0) * scale;
        let a2 = (1.0 - std::f64::consts::SQRT_2 * k + k * k) * scale;
        let ([mut x1, mut x2], [mut y1, mut y2]) = ([0.0; 2], [0.0; 2]);
        let mut next = |_| {
            let x: f64 = 0.12 * <StandardNormal as Distribution<f64>>::sample(&StandardNormal, &mut rng);
            let y = k * k * scale * (x + 2.0 * x1 + x2) - a1 * y1 - a2 * y2;
            (x2, x1, y2, y1) = (x1, x, y1, y);
            y
        };
        evidence_of((0..36_000).map(&mut next).collect())
    }

    #[test]
    fn what_bends_beyond_the_edge_of_a_range_is_in_the_interval() {
        let outside = (0..12).filter(|seed| {
            let ranged = identify_in_range("rate", &behind_a_filter(*seed), 0.5, &Options::default());
            assert!(ranged.highest_hz.is_some(), "{seed}");
            let interval = ranged.identification.read_angle_random_walk().interval95().unwrap();
            interval.low > 0.002 || interval.high < 0.002
        });
        assert!(outside.count() <= 1);
    }

    #[test]
    fn a_model_that_fits_uses_every_frequency() {
        let mut rng = rand_xoshiro::Xoshiro256PlusPlus::seed_from_u64(7);
        let mean: Vec<f64> = (0..36_000)
            .map(|_| 0.12 * <StandardNormal as Distribution<f64>>::sample(&StandardNormal, &mut rng))
            .collect();
        let blocks =
            BlockSeries { block_len: 1, first_index: 0, count: vec![1; mean.len()], mean, rounding: vec![] };
        let evidence = Evidence::new(&blocks, None, 1.0, &[]);
        let ranged = identify_in_range("rate", &evidence, 0.5, &Options::standard_terms());
        assert_eq!((ranged.highest_hz, ranged.widened), (None, 1.0));
    }
}
