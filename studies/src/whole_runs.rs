//! Whole runs against simulated truth: coverage of intervals, verdicts of units exactly at their limit, lines.
//!
//! Every record goes through `run::execute`, as a file would.

use crate::study::{Asked, Case, Row, Study};
use rayon::prelude::*;
use sagnac_fft::{real_forward, real_inverse};

use sagnac::acceptance::{Request, analysis, execute};
use sagnac::config::procedure::EffectiveLimits;
use sagnac::config::procedure::limits::LimitSpec;
use sagnac::estimate::{Limit, Rule, Verdict};
use sagnac::ingest::{MemoryColumn, Source};
use sagnac::measurand;
use sagnac::noise::model::NoiseModel;
use sagnac::noise::russian::predict;
use sagnac::noise::simulate::{Setup, Simulator};
use sagnac::noise::static_bias::BiasUncertainty;
use sagnac::record::{MeasurandRecord, RunRecord, UnitUnderTest};
use sagnac::recording::{Channel, ColumnRef, Role};
use sagnac::units::Unit;
use std::f64::consts::PI;

/// Static bias, Russian and Allan measurands.
pub static INTERVALS: Study = Study {
    id: "whole-runs",
    title: "Intervals and verdicts of whole runs",
    method: "Records of 10 and 100 h, one sample in 10 s, of four mixes of noise. Each has a limit exactly at its truth for every \
             measurand, judged with a guard band at a risk of 5 %. The bias that is asked for is the mean over the record of what \
             is slower than the record. Where no interval is given, the upper limit must lie above the truth.",
    records: 1000,
    cases: interval_cases,
};

/// Frequency and amplitude of a line.
pub static LINES: Study = Study {
    id: "lines",
    title: "Frequency and amplitude of a line",
    method: "White noise with a sinusoid of known frequency and amplitude. The excess is its peak over the floor of a Hann \
             periodogram when it lies on a bin. Shares are of the records in which a line is found.",
    records: 1000,
    cases: line_cases,
};

/// Mixes of noise of the study of intervals.
pub fn mixes() -> [Mix; 4] {
    let model = |n, b, k| NoiseModel { n, b, k, ..Default::default() };
    [
        Mix { name: "N", model: model(0.0023, 0.0, 0.0) },
        Mix { name: "N+B", model: model(0.002, 0.006, 0.0) },
        Mix { name: "N+K", model: model(0.0023, 0.0, 0.006) },
        Mix { name: "N+B+K", model: model(0.002, 0.004, 0.006) },
    ]
}

fn interval_cases() -> Vec<Case> {
    let mut cases = vec![];
    for hours in [10.0, 100.0] {
        for (i, mix) in (0u64..).zip(mixes()) {
            let first = 7_500_000 + 100_000 * i + 1_000_000 * hours as u64;
            cases.push(Case::new(format!("{}, {hours} h", mix.name), move |records, seed| {
                study(&mix, hours, 10.0, records, first + 200_000_000 * (seed - 1)).rows()
            }));
        }
    }
    cases
}

fn line_cases() -> Vec<Case> {
    let mut cases = vec![];
    for (j, samples) in (0u64..).zip([9_000, 36_000, 360_000]) {
        for (i, excess) in (0u64..).zip([5.0, 10.0, 30.0, 100.0, 1000.0]) {
            let first = 8_000_000 + 100_000 * i + 1_000_000 * j;
            cases.push(Case::new(format!("{samples} samples, excess {excess}"), move |records, seed| {
                let records = records.min(36_000_000 / samples as u64 * 4);
                line_study(excess, samples, records, first + 200_000_000 * (seed - 1)).rows()
            }));
        }
    }
    cases
}

/// A noise model with a name.
pub struct Mix {
    /// Letters of its terms.
    pub name: &'static str,
    /// Its terms.
    pub model: NoiseModel,
}

/// One measurand over many records.
#[derive(Debug, Clone)]
pub struct Count {
    /// Id of the measurand.
    pub id: &'static str,
    /// Records.
    pub records: usize,
    /// Records with a value and its interval.
    pub stated: usize,
    /// Intervals that hold the truth.
    pub covered: usize,
    /// Upper limits, where there is no interval, that lie above the truth.
    pub limits_hold: usize,
    /// Units passed.
    pub passed: usize,
    /// Units failed.
    pub failed: usize,
    /// Half widths of the intervals over that of an estimate that knows the noise, ascending.
    pub widths: Vec<f64>,
}

impl Count {
    /// Records in which the interval, or the upper limit, holds the truth.
    pub fn holds(&self) -> usize {
        self.covered + self.limits_hold
    }

    fn rows(&self) -> [Row; 5] {
        let of = self.records as u64;
        let share = |claim: &str, asked, hits: usize| Row::share(self.id, claim, asked, hits as u64, of);
        let median = self.widths.get(self.widths.len() / 2).copied().unwrap_or(f64::NAN);
        [
            share("95 % interval or limit holds the truth", Asked::AtLeast(0.93), self.holds()),
            share("a unit at its limit passes", Asked::AtMost(0.05), self.passed),
            share("a unit at its limit fails", Asked::AtMost(0.05), self.failed),
            share("a value is stated", Asked::Nothing, self.stated),
            Row::number(
                self.id,
                "median half width over a reference (bias: known noise; others: the truth)",
                Asked::Nothing,
                median,
                self.widths.len() as u64,
            ),
        ]
    }
}

/// What a study gave.
pub struct Tally {
    /// Name of the mix.
    pub name: &'static str,
    /// Length of a record.
    pub hours: f64,
    /// A count for each measurand.
    pub counts: Vec<Count>,
    /// Records in which a line was found though there is none.
    pub false_lines: usize,
}

impl Tally {
    fn rows(&self) -> Vec<Row> {
        let of = self.counts.first().map_or(0, |c| c.records) as u64;
        let lines = Row::share(
            "line_frequency",
            "a line is found where there is none",
            Asked::AtMost(0.015),
            self.false_lines as u64,
            of,
        );
        self.counts.iter().flat_map(Count::rows).chain([lines]).collect()
    }
}

const IDS: [&str; 5] =
    ["static_bias", "russian_drift_100s", "russian_sigma_10s", "angle_random_walk", "bias_instability"];

fn limits(truths: &[(&'static str, f64)]) -> EffectiveLimits {
    let mut limits = EffectiveLimits::default();
    for (id, truth) in truths {
        limits.set.limits.push(LimitSpec {
            recorded_unit: None,
            measurand: measurand::find(id).expect("a measurand"),
            channel: None,
            limit: Limit {
                min: None,
                max: Some(*truth),
                rule: Rule::GuardBand,
                risk: 0.05,
                source: "simulated truth".into(),
            },
            span: 0..0,
        });
    }
    limits
}

fn run(rate: Vec<f64>, tau0_s: f64, limits: &EffectiveLimits) -> RunRecord {
    let source =
        Source::from_columns("simulated", vec![MemoryColumn::new("rate", rate)], 8192).expect("a source");
    let unit = Unit::parse("deg/h").expect("a unit");
    let column = ColumnRef::Name("rate".into());
    let channel = Channel { id: "rate".into(), column, role: Role::Rate, unit, scale: 1.0 };
    let mut procedure = analysis::procedure(vec![channel], Some(1.0 / tau0_s), 0.0);
    procedure.report.figures = Some(vec![]);
    let request = Request {
        kind: sagnac::record::RunKind::Analyze,
        procedure: &procedure,
        procedure_record: None,
        limits,
        source: &source,
        use_stamps: false,
        unit: UnitUnderTest::default(),
        serial_of_recording: false,
        operator: None,
        station: None,
        now: chrono::DateTime::UNIX_EPOCH,
        taus: None,
        exact: false,
        bench_checks: None,
    };
    execute(&request, &mut |_, _| {}).expect("an outcome").record
}

/// Lengths of record out of the middle of which one is cut: the flicker that is slower than a record is in it too.
const LONGER: usize = 32;

/// Flicker of a record, and its mean over the record below 1/(2πT): the part that a record cannot tell from its bias.
fn flicker(b: f64, samples: usize, tau0_s: f64, seed: u64) -> (Vec<f64>, f64) {
    if b == 0.0 {
        return (vec![0.0; samples], 0.0);
    }
    let long = samples * LONGER;
    let model = NoiseModel { b, ..Default::default() };
    let mut all = Simulator::new(&model, &Setup::for_record(seed, tau0_s, long as u64)).take(long);
    let from = (LONGER / 2) * samples;
    let record = all[from..from + samples].to_vec();
    let (forward, back) = (real_forward(long), real_inverse(long));
    let mut spectrum = forward.make_output_vec();
    forward.process(&mut all, &mut spectrum).expect("a transform");
    // Bin k stands at k/(LONGER·T).
    let cut = (LONGER as f64 / (2.0 * PI)).round() as usize;
    spectrum.iter_mut().skip(cut).for_each(|c| *c *= 0.0);
    back.process(&mut spectrum, &mut all).expect("a transform");
    let slow = all[from..from + samples].iter().sum::<f64>() / (samples * long) as f64;
    (record, slow)
}

/// Many records of a mix, each with limits set exactly at its truth.
pub fn study(mix: &Mix, hours: f64, tau0_s: f64, records: u64, seed: u64) -> Tally {
    let samples = (hours * 3600.0 / tau0_s) as usize;
    let length_s = samples as f64 * tau0_s;
    let without = NoiseModel { b: 0.0, ..mix.model };
    let known = 1.96 * BiasUncertainty::of_mean(&mix.model.into(), length_s, None, &[]).standard();
    let sigma = |window_s: f64| {
        predict(&mix.model, window_s, (length_s / window_s).round() as u64).expect("a prediction").sigma
    };
    let ids = &IDS[..if mix.model.b > 0.0 { 5 } else { 4 }];
    let blank = |id: &&'static str| Count {
        id,
        records: records as usize,
        stated: 0,
        covered: 0,
        limits_hold: 0,
        passed: 0,
        failed: 0,
        widths: vec![],
    };
    let mut false_lines = 0;
    let mut counts: Vec<Count> = ids.iter().map(blank).collect();
    let one = |run_number: u64| {
        let seed = seed + run_number;
        let (slow_noise, slow) = flicker(mix.model.b, samples, tau0_s, seed);
        let setup = Setup { bias_deg_h: 7.31, ..Setup::for_record(seed, tau0_s, samples as u64) };
        let mut rate = Simulator::new(&without, &setup).take(samples);
        rate.iter_mut().zip(&slow_noise).for_each(|(r, s)| *r += s);
        let truths = [7.31 + slow, sigma(100.0), sigma(10.0), mix.model.n, mix.model.b];
        let pairs: Vec<(&'static str, f64)> = ids.iter().copied().zip(truths).collect();
        let record = run(rate, tau0_s, &limits(&pairs));
        (record, pairs)
    };
    // In the order of the records, whichever is finished first.
    let runs: Vec<_> = (0..records).into_par_iter().map(one).collect();
    for (record, pairs) in runs {
        false_lines += usize::from(!record.lines.is_empty());
        for (count, (id, truth)) in counts.iter_mut().zip(pairs) {
            let found = record.measurands.iter().find(|m| m.id == id).expect("a row");
            tally(count, found, truth, if id == "static_bias" { known } else { truth });
        }
    }
    counts.iter_mut().for_each(|c| c.widths.sort_by(f64::total_cmp));
    Tally { name: mix.name, hours, counts, false_lines }
}

fn tally(count: &mut Count, found: &MeasurandRecord, truth: f64, known: f64) {
    match (found.interval, found.upper_limit) {
        (Some(interval), _) => {
            count.stated += 1;
            count.covered += usize::from(interval.low <= truth && truth <= interval.high);
            count.widths.push(0.5 * (interval.high - interval.low) / known);
        }
        (None, Some(limit)) => count.limits_hold += usize::from(truth <= limit.value),
        (None, None) => {}
    }
    count.passed += usize::from(found.verdict == Verdict::Pass);
    count.failed += usize::from(found.verdict == Verdict::Fail);
}

/// What a study of a line gave. Errors in standard uncertainties.
#[derive(Debug, Clone, Default)]
pub struct LineTally {
    /// Records.
    pub records: usize,
    /// Records in which a line is found.
    pub found: usize,
    /// Intervals that hold the frequency.
    pub frequency_holds: usize,
    /// Intervals that hold the amplitude.
    pub amplitude_holds: usize,
    /// Root mean square error of the frequency.
    pub frequency_rms: f64,
    /// Root mean square error of the amplitude.
    pub amplitude_rms: f64,
    /// Mean error of the amplitude.
    pub amplitude_bias: f64,
}

impl LineTally {
    fn rows(&self) -> Vec<Row> {
        let (records, found) = (self.records as u64, self.found as u64);
        let holds = "95 % interval holds the truth";
        let rms = "rms error in standard uncertainties";
        vec![
            Row::share("line_frequency", "found", Asked::Nothing, found, records),
            Row::share("line_frequency", holds, Asked::AtLeast(0.93), self.frequency_holds as u64, found),
            Row::share("line_amplitude", holds, Asked::AtLeast(0.93), self.amplitude_holds as u64, found),
            Row::number("line_frequency", rms, Asked::Nothing, self.frequency_rms, found),
            Row::number("line_amplitude", rms, Asked::Nothing, self.amplitude_rms, found),
        ]
    }
}

/// Records of white noise with a sinusoid whose peak stands `excess` times over the floor when it lies on a bin.
pub fn line_study(excess: f64, samples: usize, records: u64, seed: u64) -> LineTally {
    let model = NoiseModel { n: 0.0023, ..Default::default() };
    let mut segment = 64usize;
    while segment * 2 * 16 <= samples && segment < 1 << 16 {
        segment *= 2;
    }
    // The peak of a Hann periodogram of L samples is A²L/6 over the variance of a sample.
    let variance = model.n * model.n * 3600.0;
    let amplitude = ((excess - 1.0) * 6.0 * variance / segment as f64).sqrt();
    let mut tally = LineTally { records: records as usize, ..Default::default() };
    let z95 = 1.959_964;
    for run_number in 0..records {
        let mut rate =
            Simulator::new(&model, &Setup::for_record(seed + run_number, 1.0, samples as u64)).take(samples);
        // Frequencies and phases that fill their ranges evenly.
        let golden = |k: f64| (run_number as f64 * k).fract();
        let frequency = 0.06 + 0.38 * golden(0.618_033_988_7);
        let phase = 2.0 * PI * golden(0.754_877_666_2);
        for (i, r) in rate.iter_mut().enumerate() {
            *r += amplitude * (2.0 * PI * frequency * i as f64 + phase).sin();
        }
        let record = run(rate, 1.0, &EffectiveLimits::default());
        let row = |id: &str| record.measurands.iter().find(|m| m.id == id).expect("a row");
        let (f, a) = (row("line_frequency"), row("line_amplitude"));
        let (Some(f_value), Some(a_value)) = (f.value, a.value) else { continue };
        let (Some(f_interval), Some(a_interval)) = (f.interval, a.interval) else { continue };
        tally.found += 1;
        tally.frequency_holds += usize::from(f_interval.low <= frequency && frequency <= f_interval.high);
        tally.amplitude_holds += usize::from(a_interval.low <= amplitude && amplitude <= a_interval.high);
        let in_u = |value: f64, truth: f64, high: f64| (value - truth) * z95 / (high - value);
        tally.frequency_rms += in_u(f_value, frequency, f_interval.high).powi(2);
        let error = in_u(a_value, amplitude, a_interval.high);
        tally.amplitude_rms += error * error;
        tally.amplitude_bias += error;
    }
    let found = tally.found.max(1) as f64;
    tally.frequency_rms = (tally.frequency_rms / found).sqrt();
    tally.amplitude_rms = (tally.amplitude_rms / found).sqrt();
    tally.amplitude_bias /= found;
    tally
}
