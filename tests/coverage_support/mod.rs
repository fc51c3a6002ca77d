//! Records with known truth through whole runs.

use realfft::RealFftPlanner;
use sagnac::acceptance::run::{Request, analysis, execute};
use sagnac::config::procedure::EffectiveLimits;
use sagnac::config::procedure::limits::LimitSpec;
use sagnac::estimate::{Limit, Rule, Verdict};
use sagnac::ingest::Source;
use sagnac::measurand::ids;
use sagnac::noise::model::NoiseModel;
use sagnac::noise::russian::predict;
use sagnac::noise::simulate::{Setup, Simulator};
use sagnac::noise::static_bias::BiasUncertainty;
use sagnac::record::{MeasurandRecord, RunRecord, UnitUnderTest};
use sagnac::recording::{Channel, ColumnRef, Role};
use sagnac::units::Unit;
use std::f64::consts::PI;

/// Number of records of a long study.
pub fn records(default: u64) -> u64 {
    std::env::var("RECORDS").ok().and_then(|r| r.parse().ok()).unwrap_or(default)
}

/// A noise model with a name.
pub struct Mix {
    pub name: &'static str,
    pub model: NoiseModel,
}

/// One quantity over many records.
#[derive(Debug, Clone)]
pub struct Row {
    pub id: &'static str,
    pub records: usize,
    pub shown: usize,
    pub covered: usize,
    pub limits_hold: usize,
    pub passed: usize,
    pub failed: usize,
    /// Half widths of the intervals over that of an estimate that knows the noise, ascending.
    pub widths: Vec<f64>,
}

impl Row {
    /// Records in which the interval, or the upper limit, holds the truth.
    pub fn holds(&self) -> usize {
        self.covered + self.limits_hold
    }
}

/// What a study gave.
pub struct Tally {
    pub name: &'static str,
    pub hours: f64,
    pub rows: Vec<Row>,
    /// Records in which a line was found though there is none.
    pub false_lines: usize,
}

impl Tally {
    pub fn print(&self) {
        println!("{:>6} {:>4} h records with a false line: {}", self.name, self.hours, self.false_lines);
        for r in &self.rows {
            let share = |n: usize| n as f64 / r.records as f64;
            let width = |q: f64| {
                let at = (q * r.widths.len() as f64) as usize;
                r.widths.get(at.min(r.widths.len().saturating_sub(1))).copied().unwrap_or(f64::NAN)
            };
            println!(
                "{:>6} {:>4} h {:<20} shown {:.3} holds {:.3} passed {:.3} failed {:.3} half width {:.3e} {:.3e} {:.3e}",
                self.name,
                self.hours,
                r.id,
                share(r.shown),
                share(r.holds()),
                share(r.passed),
                share(r.failed),
                width(0.1),
                width(0.5),
                width(0.9)
            );
        }
    }
}

const IDS: [&str; 5] =
    ["static_bias", "russian_drift_100s", "russian_sigma_10s", "angle_random_walk", "bias_instability"];

fn limits(truths: &[(&'static str, f64)]) -> EffectiveLimits {
    let mut limits = EffectiveLimits::default();
    for (id, truth) in truths {
        limits.set.limits.push(LimitSpec {
            recorded_unit: None,
            measurand: ids::find(id).expect("a measurand"),
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
    let source = Source::from_columns("simulated", vec![("rate".into(), rate)], 8192).expect("a source");
    let unit = Unit::parse("deg/h").expect("a unit");
    let column = ColumnRef::Name("rate".into());
    let channel = Channel { id: "rate".into(), column, role: Role::Rate, unit, scale: 1.0 };
    let mut procedure = analysis::procedure(vec![channel], Some(1.0 / tau0_s), 0.0);
    procedure.report.figures = Some(vec![]);
    let request = Request {
        kind: "analyze",
        procedure: &procedure,
        procedure_record: None,
        limits,
        source: &source,
        use_stamps: false,
        unit: UnitUnderTest::default(),
        operator: None,
        station: None,
        now: chrono::DateTime::UNIX_EPOCH,
        taus: None,
        exact: false,
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
    let mut planner = RealFftPlanner::<f64>::new();
    let (forward, back) = (planner.plan_fft_forward(long), planner.plan_fft_inverse(long));
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
    let blank = |id: &&'static str| Row {
        id,
        records: records as usize,
        shown: 0,
        covered: 0,
        limits_hold: 0,
        passed: 0,
        failed: 0,
        widths: vec![],
    };
    let mut false_lines = 0;
    let mut rows: Vec<Row> = ids.iter().map(blank).collect();
    for run_number in 0..records {
        let seed = seed + run_number;
        let (slow_noise, slow) = flicker(mix.model.b, samples, tau0_s, seed);
        let setup = Setup { bias_deg_h: 7.31, ..Setup::for_record(seed, tau0_s, samples as u64) };
        let mut rate = Simulator::new(&without, &setup).take(samples);
        rate.iter_mut().zip(&slow_noise).for_each(|(r, s)| *r += s);
        let truths = [7.31 + slow, sigma(100.0), sigma(10.0), mix.model.n, mix.model.b];
        let pairs: Vec<(&'static str, f64)> = ids.iter().copied().zip(truths).collect();
        let record = run(rate, tau0_s, &limits(&pairs));
        false_lines += usize::from(!record.lines.is_empty());
        for (row, (id, truth)) in rows.iter_mut().zip(pairs) {
            let found = record.measurands.iter().find(|m| m.id == id).expect("a row");
            tally(row, found, truth, if id == "static_bias" { known } else { truth });
        }
    }
    rows.iter_mut().for_each(|r| r.widths.sort_by(f64::total_cmp));
    Tally { name: mix.name, hours, rows, false_lines }
}

fn tally(row: &mut Row, found: &MeasurandRecord, truth: f64, known: f64) {
    match (found.interval, found.upper_limit) {
        (Some(interval), _) => {
            row.shown += 1;
            row.covered += usize::from(interval.low <= truth && truth <= interval.high);
            row.widths.push(0.5 * (interval.high - interval.low) / known);
        }
        (None, Some(limit)) => row.limits_hold += usize::from(truth <= limit.value),
        (None, None) => {}
    }
    row.passed += usize::from(found.verdict == Verdict::Pass);
    row.failed += usize::from(found.verdict == Verdict::Fail);
}

/// What a study of a line gave. Errors in standard uncertainties.
#[derive(Debug, Clone, Default)]
pub struct LineTally {
    pub records: usize,
    pub found: usize,
    pub frequency_holds: usize,
    pub amplitude_holds: usize,
    pub frequency_rms: f64,
    pub amplitude_rms: f64,
    pub amplitude_bias: f64,
}

impl std::fmt::Display for LineTally {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let share = |n: usize| n as f64 / self.found.max(1) as f64;
        write!(
            f,
            "found {:.3}, frequency holds {:.3} (rms error {:.2} u), amplitude holds {:.3} (rms {:.2} u, mean {:+.2} u)",
            self.found as f64 / self.records as f64,
            share(self.frequency_holds),
            self.frequency_rms,
            share(self.amplitude_holds),
            self.amplitude_rms,
            self.amplitude_bias
        )
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
