//! A gyro at rest at constant conditions: bias and noise of every channel from one digest of its samples.

mod change_detection;
mod evidence;
mod facts;
mod goodness;
mod noise_remarks;
mod records;
mod russian_and_allan;
mod sigma_tau;
mod warm_up_transient;

pub use evidence::{RateDigests, evidence};

use crate::acceptance::compensation_files;
use crate::acceptance::figures;
use crate::acceptance::power;
use crate::acceptance::reading::tidy;
use crate::acceptance::request::{Request, Table};
use crate::acceptance::test_kind::{Evidence, Progress, Reading, RestFacts, Run, TestKind, TestOption};
use crate::config::procedure::Procedure;
use crate::config::procedure::model::MeasurandSpec;
use crate::estimate::{Estimate, Verdict};
use crate::figure::Figure;
use crate::i18n::{Arg, Note, note};
use crate::measurand::{self, GyroEvidence, PowerModel};
use crate::noise::composite::Parameter;
use crate::noise::motion::turned_from_to;
use crate::noise::tails::Deviations;
use crate::noise::tau_grid::TauGrid;
use crate::record::RunRecord;
use crate::recording::Channel;
use crate::temperature::compensation::Compensation;
use crate::temperature::findings::Schedule;
use crate::temperature::start::Start;
use std::collections::BTreeMap;

/// A gyro at rest.
pub struct AtRest;

impl TestKind for AtRest {
    type Collector = RateDigests;
    type Evidence = RestEvidence;
    const OWN_CHECKS: &'static [&'static str] = &["earth_rate", "noise_level", "warm_up", "distribution"];
    const MISSING_REASON: &'static str = "unshown.nothing";

    fn of(_: &Procedure) -> Option<AtRest> {
        Some(AtRest)
    }

    fn options(&self, request: &Request<'_>) -> Vec<TestOption> {
        options(request)
    }

    fn collector(&self, request: &Request<'_>, channels: &[Channel], interval_s: f64) -> Run<RateDigests> {
        RateDigests::new(request, channels, tidy(interval_s))
    }

    fn evaluate(self, reading: &Reading<'_>, collected: RateDigests, _: Progress<'_>) -> Run<RestEvidence> {
        Ok(RestEvidence { gyros: evidence(reading, collected)?, from_lines: BTreeMap::new(), schedule: None })
    }
}

/// The options of a test at rest.
pub fn options(request: &Request<'_>) -> Vec<TestOption> {
    let procedure = request.procedure;
    let grid = match request.tau_grid() {
        TauGrid::Octave => "octave".to_owned(),
        TauGrid::Decade => "decade".to_owned(),
        TauGrid::All => "all".to_owned(),
        TauGrid::List(taus) => taus.iter().map(|t| format!("{t} s")).collect::<Vec<_>>().join(", "),
    };
    vec![
        ("analysis.taus", grid),
        ("analysis.exact", (request.exact || procedure.analysis.exact).to_string()),
        ("analysis.line_false_alarm", procedure.analysis.line_false_alarm.to_string()),
        ("conditions.warm_up", format!("{} s", procedure.conditions.warm_up_s)),
    ]
}

/// What the recording of a gyro at rest shows, over temperature and while it warms up included.
pub struct RestEvidence {
    /// The gyro channels.
    pub gyros: Vec<GyroEvidence>,
    /// Deviations of the samples from straight lines through short blocks, by channel, where the bias follows a course.
    pub from_lines: BTreeMap<String, Deviations>,
    /// The schedule of a test over temperature.
    pub schedule: Option<Schedule>,
}

impl RestEvidence {
    /// True when conditions were constant, so that the noise of the whole recording has a meaning.
    fn is_constant(&self) -> bool {
        self.gyros.iter().all(|g| g.over_temperature.is_none() && g.warm_up.is_none())
    }
}

impl Evidence for RestEvidence {
    fn noise_deg_h(&self) -> Option<f64> {
        self.gyros.iter().map(|g| g.digest.histogram.standard_deviation).reduce(f64::min)
    }

    fn rest_facts(&self, reading: &Reading<'_>) -> RestFacts<'_> {
        let (warm_up, gyros) = match reading.request.is_run() {
            true => facts::of_gyros(reading, &self.gyros, &self.from_lines, self.is_constant()),
            false => (vec![], vec![]),
        };
        RestFacts { warm_up, gyros, schedule: self.schedule.as_ref() }
    }

    fn estimates(&self, _: &Reading<'_>, spec: &MeasurandSpec) -> Vec<Estimate> {
        let turned = turned(&self.gyros);
        let of = |gyro: &GyroEvidence| {
            let turned = turned.clone();
            let moves = spec.measurand.needs_stillness && self.is_constant() && gyro.motion.is_motion();
            let estimates = spec.measurand.evaluate_gyro(gyro, &spec.options());
            estimates.into_iter().map(move |e| if moves { without_noise(e, spec, turned.clone()) } else { e })
        };
        self.gyros.iter().flat_map(of).collect()
    }

    fn situation(&self, channel: &str) -> Option<power::Situation> {
        let gyro = self.gyros.iter().find(|g| g.channel == channel && !g.motion.is_motion())?;
        self.is_constant().then(|| power::situation(gyro))
    }

    fn correlation(&self, one: &Estimate, other: &Estimate) -> Option<f64> {
        let gyro = self.gyros.iter().find(|g| g.channel == one.channel && g.channel == other.channel)?;
        let fitted = |e: &Estimate| match measurand::find(e.id)?.power? {
            PowerModel::NoiseTerm(term) if e.method == gyro.identification.method => {
                Some(Parameter::Coefficient(term))
            }
            _ => None,
        };
        gyro.identification.described.correlation(fitted(one)?, fitted(other)?)
    }

    fn figures(&self, reading: &Reading<'_>) -> Vec<Figure> {
        self.gyros.iter().flat_map(|gyro| self.figures_of(reading, gyro)).collect()
    }

    /// Adds lines, noise models, deviations and what the limits can decide; gives the tables of σ(τ) and of the compensation.
    fn complete(&self, reading: &Reading<'_>, record: &mut RunRecord) -> Vec<Table> {
        let gyros = &self.gyros;
        let declared = |g: &GyroEvidence| g.warm_up.as_ref().is_some_and(|w| w.start == Start::Declared);
        if record.errors.is_empty() && record.verdict != Verdict::None && gyros.iter().any(declared) {
            record.summary.push(note!("summary.start_declared").into());
        }
        record.power = power::records(reading.request.limits, gyros);
        if !self.is_constant() {
            let serial = reading.request.unit.serial.as_deref();
            return gyros.iter().flat_map(|g| compensation_tables(g, serial)).collect();
        }
        let still = || gyros.iter().filter(|g| !g.motion.is_motion());
        record.lines = gyros.iter().flat_map(records::lines).collect();
        record.noise_models = still().map(records::noise_model).collect();
        record.goodness_of_fit = still().flat_map(goodness::records).collect();
        record.deviations = gyros.iter().flat_map(sigma_tau::records).collect();
        record.comparison = still().filter_map(russian_and_allan::record).collect();
        gyros.iter().map(|g| (g.figure_id("sigma_tau") + ".csv", sigma_tau::csv(g))).collect()
    }
}

impl RestEvidence {
    fn figures_of(&self, reading: &Reading<'_>, gyro: &GyroEvidence) -> Vec<Figure> {
        let wanted = |id: &str| reading.procedure().report.shows(id);
        let mut list: Vec<Figure> =
            figures::time_series::of_channel(reading, &gyro.channel, gyro.several).into_iter().collect();
        list.extend(figures::thermal::figures(gyro, self.schedule.as_ref(), reading.procedure(), &wanted));
        if !self.is_constant() {
            return list;
        }
        if wanted("sigma_tau") {
            let highest =
                |id: &str| reading.request.limits.limit(id, &gyro.channel).and_then(|l| l.limit.max);
            list.push(figures::sigma_tau::figure(gyro, &highest));
        }
        let optional = [
            ("allan_family", figures::allan_family::figure as fn(&GyroEvidence) -> Option<Figure>),
            ("spectrum", figures::spectrum::figure),
            ("autocorrelation", figures::autocorrelation::figure),
            ("histogram", figures::histogram::figure),
            ("residual", figures::residual::figure),
        ];
        list.extend(optional.into_iter().filter(|(id, _)| wanted(id)).filter_map(|(_, f)| f(gyro)));
        list
    }
}

/// In place of the estimate of a noise that a recording with motion does not show.
fn without_noise(estimate: Estimate, spec: &MeasurandSpec, turned: Note) -> Estimate {
    let empty = spec.measurand.not_identifiable(&estimate.channel, None, estimate.method);
    empty.note(turned)
}

/// That the unit turned, and from when to when: over all its axes, which turn together.
fn turned(gyros: &[GyroEvidence]) -> Note {
    let spans = gyros
        .iter()
        .filter(|g| g.motion.is_motion())
        .filter_map(|g| turned_from_to(&g.digest.blocks, g.tau0_s, g.digest.quietest_deg_h));
    match spans.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1))) {
        Some((from_s, to_s)) => {
            note!("note.moving_from_to", from_s = Arg::decimals(from_s, 1), to_s = Arg::decimals(to_s, 1))
        }
        None => note!("note.moving"),
    }
}

/// The compensation table of a channel with a model: TOML, JSON, C header.
fn compensation_tables(gyro: &GyroEvidence, serial: Option<&str>) -> Vec<Table> {
    let Some(analysis) = gyro.over_temperature.as_ref().and_then(|o| o.analysis.as_ref()) else {
        return vec![];
    };
    let made = Compensation::of(analysis, &gyro.channel, serial);
    compensation_files::files(&gyro.figure_id("compensation"), &made, made.header())
}
