//! What each kind of test leaves behind, for its measurands and for the checks of them.

mod course;
#[cfg(test)]
pub(crate) mod test_evidence;

pub use course::{Course, Pair};

use crate::estimate::Objection;
use crate::influence::comparison::{Comparison, NoiseChange};
use crate::influence::over_frequency::OverFrequency;
use crate::message::Note;
use crate::noise::allan::{DeviationCurve, DeviationSet};
use crate::noise::coarse::RateRounding;
use crate::noise::composite::Composite;
use crate::noise::data::{BlockSeries, WelchSpectrum};
use crate::noise::digest::RateDigest;
use crate::noise::family::Estimator;
use crate::noise::identification::Identification;
use crate::noise::in_band::NoiseTest;
use crate::noise::intervals::{BoundedPoint, bounded};
use crate::noise::lines::SpectralLine;
use crate::noise::motion::Motion;
use crate::noise::residual::GoodnessOfFit;
use crate::noise::spectral_record::{RecordNoise, SpectralRecord, identify_digest, identify_terms};
use crate::noise::whole::Whole;
use crate::noise::windows::WindowStatistics;
use crate::rate_table::Setup;
use crate::rate_table::alignment::Alignment;
use crate::rate_table::dead_zone::DeadZone;
use crate::rate_table::known::Positions;
use crate::rate_table::overload::Overload;
use crate::rate_table::scale_factor::ScaleFactor;
use crate::rate_table::scale_over_temperature::ScaleOverTemperature;
use crate::rate_table::sine::Sine;
use crate::rate_table::steps::Steps;
use crate::rate_table::turns::Turns;
use crate::temperature::findings::Findings;
use crate::temperature::warm_up::WarmUpFindings;
use std::sync::OnceLock;

/// Earth rate along an input axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Earth {
    /// Component along the axis, deg/h.
    pub rate_deg_h: f64,
    /// Its standard uncertainty, deg/h.
    pub uncertainty_deg_h: f64,
}

/// Evidence that one pass over a recording at rest gives about a gyro channel, with its identified noise.
#[derive(Debug)]
pub struct GyroEvidence {
    /// Channel id.
    pub channel: String,
    /// True when the run has more than one gyro channel, so that figures and files need the name.
    pub several: bool,
    /// Measured mean sample interval, s.
    pub tau0_s: f64,
    /// Longest stretch without a gap, s.
    pub longest_stretch_s: f64,
    /// What the accumulators left.
    pub digest: RateDigest,
    /// σ(τ) of the overlapping Allan deviation on the grid asked for.
    pub sigma_tau: Vec<BoundedPoint>,
    /// σ(τ) at octaves, whatever the grid.
    pub octaves: Vec<BoundedPoint>,
    /// The noise model.
    pub identification: Identification,
    /// How well the model fits.
    pub goodness: GoodnessOfFit,
    /// Spectral lines.
    pub lines: Vec<SpectralLine>,
    /// The strongest line that was found and is more than the record can hold.
    pub withheld_line: Option<Note>,
    /// Whether the unit stood still.
    pub motion: Motion,
    /// Earth rate along the axis, where the site is known.
    pub earth: Option<Earth>,
    /// Bands and mask in which the procedure asks for the noise.
    pub noise_test: Option<NoiseTest>,
    /// What a test over temperature showed, where the procedure asks for one.
    pub over_temperature: Option<Findings>,
    /// What a test of the warm-up showed, where the procedure asks for one.
    pub warm_up: Option<WarmUpFindings>,
    /// The rate and the temperatures over the whole recording, for the caller to add.
    pub course: Option<Course>,
    /// Whether rounding of the rate hides what the unit does.
    pub rounding: RateRounding,
    /// Objections of the checks, empty until they are asked for (`criticism::of_gyro`).
    pub objections: OnceLock<Vec<Objection>>,
}

impl GyroEvidence {
    /// What the digest of a channel shows: lines, noise with what the record cannot hold withheld, deviations with
    /// intervals, goodness of fit. `tau0_s` is the measured sample interval, `line_false_alarm` the probability that noise
    /// alone shows a line, `step_deg_h` the step of a rounded output. Whether the unit stood still, the Earth rate and
    /// tests over temperature are for the caller to add.
    pub fn identify(
        channel: String,
        digest: RateDigest,
        tau0_s: f64,
        line_false_alarm: f64,
        step_deg_h: Option<f64>,
    ) -> GyroEvidence {
        let noise = identify_digest(&channel, &digest, tau0_s, line_false_alarm, step_deg_h);
        GyroEvidence::of(channel, digest, tau0_s, noise, step_deg_h)
    }

    /// The same by N, B, K, Q and R alone, without a search for processes and filters, which takes most of the time.
    pub fn first_look(
        channel: String,
        digest: RateDigest,
        tau0_s: f64,
        line_false_alarm: f64,
        step_deg_h: Option<f64>,
    ) -> GyroEvidence {
        let noise = identify_terms(&channel, &digest, tau0_s, line_false_alarm);
        GyroEvidence::of(channel, digest, tau0_s, noise, step_deg_h)
    }

    fn of(
        channel: String,
        digest: RateDigest,
        tau0_s: f64,
        noise: RecordNoise,
        step_deg_h: Option<f64>,
    ) -> GyroEvidence {
        let (mut lines, mut identification) = (noise.lines, noise.ranged.identification);
        let model = &identification.described.model;
        let sigma_tau = allan_points(&digest.deviations, model, tau0_s);
        let octaves =
            digest.octaves.as_ref().map_or_else(|| sigma_tau.clone(), |set| allan_points(set, model, tau0_s));
        let first: Vec<(u64, f64)> = octaves.iter().map(|p| (p.point.m, p.point.deviation)).collect();
        let rounding = RateRounding::of(step_deg_h, &first);
        let whole = Whole::of(&digest, &octaves, identification.highest_hz);
        let withheld_line = whole.lines(&mut lines);
        if withheld_line.is_some() {
            let kept: Vec<f64> = lines.iter().map(|l| l.frequency_hz).collect();
            identification.described.keep_lines(|line| kept.contains(&line.frequency_hz));
        }
        whole.parts(&mut identification);
        let points: Vec<_> = octaves.iter().map(|p| p.point).collect();
        let record = SpectralRecord::of_digest(&digest, &lines, tau0_s);
        let goodness = GoodnessOfFit::of(&record, &identification.described, &points);
        GyroEvidence {
            channel,
            several: false,
            tau0_s,
            longest_stretch_s: digest.deviations.stretches.longest() as f64 * tau0_s,
            digest,
            sigma_tau,
            octaves,
            identification,
            goodness,
            lines,
            withheld_line,
            motion: Motion::Unknown,
            earth: None,
            noise_test: None,
            over_temperature: None,
            warm_up: None,
            course: None,
            rounding,
            objections: OnceLock::new(),
        }
    }

    /// Usable time, s.
    pub fn usable_s(&self) -> f64 {
        self.digest.samples as f64 * self.tau0_s
    }

    /// The window statistics of a window length in s, where the record has two such windows.
    pub fn windows(&self, window_s: f64) -> Option<&WindowStatistics> {
        self.digest.windows.iter().find(|w| w.window_s == window_s && w.n >= 2 && w.fits(self.tau0_s))
    }

    /// Whether whole samples make windows of a length in s.
    pub fn samples_fit(&self, window_s: f64) -> bool {
        self.digest.windows.iter().filter(|w| w.window_s == window_s).all(|w| w.fits(self.tau0_s))
    }

    /// σ of 100-s means, deg/h.
    pub fn drift_100s(&self) -> Option<f64> {
        self.windows(100.0).map(|w| w.standard_deviation).filter(|s| s.is_finite() && *s > 0.0)
    }

    /// The id of a figure of this channel.
    pub fn figure_id(&self, stem: &str) -> String {
        if self.several { format!("{stem}_{}", self.channel) } else { stem.to_owned() }
    }

    /// The channel as a figure shows it: empty when there is only one.
    pub fn figure_channel(&self) -> String {
        if self.several { self.channel.clone() } else { String::new() }
    }

    /// Block means of the record.
    pub fn blocks(&self) -> &BlockSeries {
        &self.digest.blocks
    }

    /// The averaged periodogram.
    pub fn spectrum(&self) -> &WelchSpectrum {
        &self.digest.welch.spectrum
    }
}

/// The points of the overlapping Allan deviation with their intervals.
fn allan_points(set: &DeviationSet, model: &Composite, tau0_s: f64) -> Vec<BoundedPoint> {
    let model = model.without_lines();
    let bound = |curve: &DeviationCurve| {
        let noise = |m: u64| model.dominant(m as f64 * tau0_s, tau0_s);
        let points = curve.points.iter();
        points.map(|p| bounded(Estimator::Allan, p, &curve.stretches, noise(p.m))).collect()
    };
    set.curve(Estimator::Allan).map(bound).unwrap_or_default()
}

/// What the steps of a rate table showed of one gyro channel.
#[derive(Debug, Clone)]
pub struct TableEvidence<'a> {
    /// Position among the gyro channels of the recording.
    pub gyro: usize,
    /// Channel id.
    pub channel: String,
    /// How the test is evaluated.
    pub setup: &'a Setup,
    /// The steps.
    pub steps: &'a Steps,
    /// Unit of the scale factor as recorded, and output units in one deg/h of input at a scale factor of 1.
    pub as_recorded: (&'static str, f64),
    /// Earth rate along the axis, where the site is known.
    pub earth: Option<Earth>,
    /// The straight line through all rates; `None` where the steps give none.
    pub line: Option<ScaleFactor>,
    /// What rates beyond the range show; `None` where it was not asked for, or too few rates give a line.
    pub overload: Option<Overload>,
    /// Scale factor and bias at every soak, or why the recording does not show them; `None` where it was not asked for.
    pub over_temperature: Option<Result<ScaleOverTemperature, Note>>,
    /// The sine of an open-loop unit; `None` where it was not asked for, or the response does not bend.
    pub sine: Option<Sine>,
    /// The response to rates near zero; `None` where it was not asked for, or there are too few rates.
    pub dead_zone: Option<DeadZone>,
    /// The direction of the input axis; `None` where it was not asked for.
    pub alignment: Option<Alignment>,
}

impl<'a> TableEvidence<'a> {
    /// The gyro channel of this number before any analysis, read in the units of the nominal scale factor.
    pub fn new(gyro: usize, channel: &str, setup: &'a Setup, steps: &'a Steps) -> TableEvidence<'a> {
        TableEvidence {
            gyro,
            channel: channel.to_owned(),
            setup,
            steps,
            as_recorded: ("1", 1.0),
            earth: None,
            line: None,
            overload: None,
            over_temperature: None,
            sine: None,
            dead_zone: None,
            alignment: None,
        }
    }

    /// Full scale, deg/h: as stated, or the largest rate of the test.
    pub fn full_scale_deg_h(&self) -> f64 {
        let highest = self.steps.list.iter().fold(0.0, |m: f64, s| m.max(s.rate.abs()));
        self.setup.full_scale_deg_h.unwrap_or(highest)
    }
}

/// What turns by known angles and positions against the Earth rate showed of all gyro channels.
#[derive(Debug, Clone, Copy)]
pub struct KnownInputEvidence<'a> {
    /// Channels in positions against the Earth rate.
    pub positions: &'a [Positions],
    /// Turns by known angles; `None` without one.
    pub turns: Option<&'a Turns>,
}

/// What a comparison without and with an influence showed of one gyro channel.
#[derive(Debug, Clone, Copy)]
pub struct ComparisonEvidence<'a> {
    /// Change of the bias.
    pub bias: &'a Comparison,
    /// Change of N at every level; empty where it was not asked for.
    pub noise: &'a [NoiseChange],
    /// Vibration by frequency; `None` where it was not asked for.
    pub by_frequency: Option<&'a OverFrequency>,
}

#[cfg(test)]
mod tests {
    use super::test_evidence::{gyro, near, steps, windows};
    use super::*;
    use crate::noise::digest::{DigestPlan, RateAccumulator};
    use crate::noise::tau_grid::TauGrid;

    #[test]
    fn a_record_leaves_its_lengths_blocks_and_deviations() {
        // −1 and 1 in turns: σ(τ0) = √2, and means of two are all 0. A gap after 600 samples of 0.5 s.
        let samples: Vec<f64> = (0..1000).map(|i| if i % 2 == 0 { -1.0 } else { 1.0 }).collect();
        let of = |taus: TauGrid| {
            let mut accumulator = RateAccumulator::new(DigestPlan { taus, ..DigestPlan::new(0.5) });
            accumulator.push(&samples[..600], 0, false);
            accumulator.push(&samples[600..], 700, false);
            GyroEvidence::identify("g".into(), accumulator.finish(), 0.5, 0.01, None)
        };
        let gyro = of(TauGrid::Octave);
        assert_eq!((gyro.channel.as_str(), gyro.tau0_s, gyro.several), ("g", 0.5, false));
        near(gyro.longest_stretch_s, 300.0);
        near(gyro.usable_s(), 500.0);
        let ms: Vec<u64> = gyro.octaves.iter().map(|p| p.point.m).collect();
        assert_eq!(ms[..4], [1, 2, 4, 8]);
        near(gyro.octaves[0].point.deviation, 2f64.sqrt());
        assert_eq!(gyro.octaves[1].point.deviation, 0.0);
        assert_eq!(gyro.sigma_tau, gyro.octaves);
        assert!(std::ptr::eq(gyro.blocks(), &raw const gyro.digest.blocks));
        assert!(std::ptr::eq(gyro.spectrum(), &raw const gyro.digest.welch.spectrum));
        assert!(!gyro.blocks().mean.is_empty() && !gyro.spectrum().density.is_empty());
        // Octaves are there whatever the grid.
        let other = of(TauGrid::List(vec![1.5]));
        assert_eq!(other.sigma_tau.iter().map(|p| p.point.m).collect::<Vec<_>>(), [3]);
        assert_eq!(other.octaves.len(), gyro.octaves.len());
    }

    #[test]
    fn noise_of_a_point_is_what_rules_at_its_averaging_time() {
        use crate::noise::data::NoiseType;
        use crate::noise::model::NoiseModel;
        let mut accumulator = RateAccumulator::new(DigestPlan::new(0.5));
        accumulator.push(&(0..2000).map(|i| f64::from(i % 7)).collect::<Vec<f64>>(), 0, false);
        let digest = accumulator.finish();
        // 3600 N²/τ = K²τ/10800 at τ = √(3600·10800)·N/K: 100 s.
        let k = (3600.0 * 10_800.0f64).sqrt() * 1e-3 / 100.0;
        let model = Composite::from(NoiseModel { n: 1e-3, k, ..Default::default() });
        for p in allan_points(&digest.deviations, &model, 0.5) {
            let expected = if 0.5 * (p.point.m as f64) < 100.0 {
                NoiseType::AngleRandomWalk
            } else {
                NoiseType::RateRandomWalk
            };
            assert_eq!(p.noise, expected, "{}", p.point.m);
        }
    }

    #[test]
    fn windows_need_two_means_and_whole_samples() {
        let mut gyro = gyro();
        gyro.digest.windows =
            vec![windows(100.0, 200, 2, 0.3), windows(10.0, 20, 1, 0.4), windows(1.0, 3, 9, 0.5)];
        assert_eq!(gyro.windows(100.0).map(|w| w.standard_deviation), Some(0.3));
        assert!(gyro.windows(10.0).is_none() && gyro.windows(1.0).is_none() && gyro.windows(50.0).is_none());
        assert!(gyro.samples_fit(100.0) && gyro.samples_fit(10.0) && !gyro.samples_fit(1.0));
        assert_eq!(gyro.drift_100s(), Some(0.3));
        for (deviation, expected) in [(0.0, None), (f64::NAN, None), (f64::INFINITY, None), (2.5, Some(2.5))]
        {
            gyro.digest.windows[0].standard_deviation = deviation;
            assert_eq!(gyro.drift_100s(), expected);
        }
    }

    #[test]
    fn figures_name_the_channel_where_there_are_several() {
        let mut gyro = gyro();
        assert_eq!((gyro.figure_id("psd"), gyro.figure_channel()), ("psd".into(), String::new()));
        gyro.several = true;
        assert_eq!((gyro.figure_id("psd"), gyro.figure_channel()), ("psd_g".into(), "g".into()));
    }

    #[test]
    fn full_scale_is_stated_or_the_largest_rate() {
        let (mut setup, steps) = (Setup::default(), steps(&[-300.0, 0.0, 200.0], &[0.0; 3], 3));
        assert_eq!(TableEvidence::new(0, "g", &setup, &steps).full_scale_deg_h(), 300.0);
        setup.full_scale_deg_h = Some(500.0);
        assert_eq!(TableEvidence::new(0, "g", &setup, &steps).full_scale_deg_h(), 500.0);
    }
}
