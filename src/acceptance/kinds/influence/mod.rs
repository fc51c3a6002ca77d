//! The output without and with an influence: a magnetic field, another supply voltage, vibration, or one that the procedure
//! declares.

mod acted;
mod by_frequency;
mod noise;

use super::stretch_facts::{RestMean, Stretches, range};
use crate::acceptance::condition::GyroFact;
use crate::acceptance::condition::influence::{Acted, ComparedFacts, judge_compared};
use crate::acceptance::request::{Request, Table};
use crate::acceptance::test_kind::{Evidence, Progress, Reading, RestFacts, Run, TestKind, TestOption};
use crate::acceptance::{figures, interval_means};
use crate::config::procedure::Procedure;
use crate::config::procedure::model::MeasurandSpec;
use crate::estimate::Estimate;
use crate::figure::Figure;
use crate::influence::comparison::{self, Beside, Comparison, NoiseChange};
use crate::influence::intervals::{self, Intervals};
use crate::influence::nuisance::{Following, Nuisance};
use crate::influence::over_frequency::OverFrequency;
use crate::influence::{ComparisonTest, Influence, scale_factor};
use crate::ingest::Pauses;
use crate::measurand::{ANGLE_RANDOM_WALK_SHIFT, ComparisonEvidence, NOISE_DENSITY_RATIO};
use crate::rate_table::blocks::Collector;
use crate::record::{ConditionRecord, RunRecord};
use crate::recording::{Channel, Role};
use std::collections::BTreeMap;

/// A comparison without and with an influence.
pub struct UnderInfluence {
    test: ComparisonTest,
}

/// What the recording shows.
pub struct InfluenceEvidence {
    test: ComparisonTest,
    series: Intervals,
    channels: Vec<Comparison>,
    /// The channels at rest without the influence.
    rest: Vec<GyroFact>,
    /// Rates of a table that differ within the intervals.
    rates: usize,
    /// Whether the influence acted as stated.
    acted: Acted,
    /// How the angle random walk changed, where that is asked for.
    noise: BTreeMap<String, Vec<NoiseChange>>,
    /// Vibration by frequency, a channel each, where that is asked for.
    by_frequency: Vec<OverFrequency>,
}

impl TestKind for UnderInfluence {
    type Collector = Collector;
    type Evidence = InfluenceEvidence;
    const OWN_CHECKS: &'static [&'static str] =
        &["earth_rate", "noise_level", "temperature_in_step", "distribution"];
    const MISSING_REASON: &'static str = "unshown.no_intervals";

    fn of(procedure: &Procedure) -> Option<UnderInfluence> {
        Some(UnderInfluence { test: procedure.comparison_test.clone()? })
    }

    fn options(&self, _: &Request<'_>) -> Vec<TestOption> {
        let mut options = vec![
            ("influence.settling", format!("{} s", self.test.settling_s)),
            ("influence.minimum", format!("{} s", self.test.minimum_interval_s)),
            ("influence.reference", self.test.reference.to_string()),
        ];
        let setting = &self.test.setting;
        if setting.influence == Influence::Declared {
            options.push(("influence.law", setting.law.id().to_owned()));
        }
        if setting.on_scale_factor {
            options.push(("influence.rate_settling", format!("{} s", self.test.rate_settling_s)));
        }
        options
    }

    fn pauses(&self) -> Pauses {
        Pauses { between_files: true, from_s: None }
    }

    fn collector(&self, _: &Request<'_>, channels: &[Channel], interval_s: f64) -> Run<Collector> {
        let slots = |of: &dyn Fn(&Channel) -> bool| {
            channels.iter().enumerate().filter(|(_, c)| of(c)).map(|(slot, _)| slot).collect::<Vec<usize>>()
        };
        // The channels of the level come first.
        let mut kept = slots(&|c| self.test.setting.tells_level(c));
        kept.extend(slots(&|c| may_disturb(c, &self.test)));
        Ok(Collector::new(channels, interval_s, self.test.temperature.as_deref()).beside(kept))
    }

    fn evaluate(
        self,
        reading: &Reading<'_>,
        collected: Collector,
        progress: Progress<'_>,
    ) -> Run<InfluenceEvidence> {
        let test = &self.test;
        let blocks = collected.finish(reading.report.tau0_measured_s);
        let axes: Vec<String> =
            reading.channels.iter().filter(|c| test.setting.tells_level(c)).map(|c| c.id.clone()).collect();
        let series = intervals::find(&blocks, test, &axes, &reading.file_spans());
        let context = context(&reading.channels, test, axes.len());
        let channels: Vec<Comparison> = (0..blocks.gyros.len())
            .filter_map(|g| comparison::evaluate(&blocks, &series, test, &context, g))
            .collect();
        let off = series.list.iter().filter(|i| series.is_off(i)).map(|i| i.blocks);
        let without = Stretches { blocks: &blocks, spans: off.collect() };
        // Under the rates of a table nothing is at rest.
        let resting = channels.iter().filter(|_| !test.setting.on_scale_factor);
        let rest = resting.filter_map(|c| without.fact(reading, &c.channel, Some(&rest_mean(c)))).collect();
        let rates = scale_factor::rates(&blocks, &series, test.rate_settling_s);
        let vibration = match &test.by_frequency {
            Some(asked) => by_frequency::read(reading, asked, &blocks, &series, progress)?,
            None => None,
        };
        let told = acted::Told { axes: &axes, rms: vibration.as_ref().map(|v| v.shaken.rms_g()) };
        let acted = acted::find(reading, test, &blocks, &series, &told, progress)?;
        let by_frequency = vibration.iter().flat_map(|vibration| {
            let of = |gyro| vibration.evaluate(&blocks, &series, test, &context, gyro);
            (0..blocks.gyros.len()).filter_map(of).collect::<Vec<_>>()
        });
        let by_frequency = by_frequency.collect();
        let of_noise = [ANGLE_RANDOM_WALK_SHIFT.id, NOISE_DENSITY_RATIO.id];
        let noise = match of_noise.iter().any(|id| reading.procedure().measures(id, None)) {
            true => noise::find(reading, &blocks, &series, progress)?,
            false => BTreeMap::new(),
        };
        Ok(InfluenceEvidence { test: self.test, series, channels, rest, rates, acted, noise, by_frequency })
    }
}

impl Evidence for InfluenceEvidence {
    fn conditions(&self, reading: &Reading<'_>) -> Vec<ConditionRecord> {
        let InfluenceEvidence { test, series, channels, acted, rates, .. } = self;
        let lines = |c: &Comparison| [Some(&c.bias), c.scale_factor.as_ref()].map(|e| e.and_then(|e| e.line));
        let temperature = channels.iter().find_map(|c| c.temperature.as_ref());
        match temperature {
            Some(_) => reading.checks.made("temperature_in_step", None, "influence_temperature"),
            None => reading.checks.not_made("temperature_in_step", None, "check_list.no_temperature"),
        }
        judge_compared(&ComparedFacts {
            found: series.list.len(),
            with: series.with(),
            alternations: series.alternations(),
            asked: test.alternations,
            too_short: series.too_short,
            missing: series.missing,
            minimum_interval_s: test.minimum_interval_s,
            recorded: test.intervals.is_empty(),
            level_unit: test.setting.level_unit(),
            table: test.setting.influence.table(),
            rates: test.setting.on_scale_factor.then_some(*rates),
            acted: *acted,
            temperature,
            others: most_disturbing(channels),
            allowed_deg_c: test.temperature_difference_deg_c,
            line: channels.iter().flat_map(lines).flatten().reduce(f64::min),
            law: test.setting.law,
        })
    }

    fn rest_facts(&self, reading: &Reading<'_>) -> RestFacts<'_> {
        RestFacts::of_gyros(reading, &self.rest)
    }

    fn estimates(&self, _: &Reading<'_>, spec: &MeasurandSpec) -> Vec<Estimate> {
        let of = |c: &Comparison| {
            let noise = self.noise.get(&c.channel).map_or(&[][..], Vec::as_slice);
            let by_frequency = self.by_frequency.iter().find(|f| f.channel == c.channel);
            spec.measurand.evaluate_comparison(&ComparisonEvidence { bias: c, noise, by_frequency })
        };
        let remarked = |e: Estimate| self.acted.remark().into_iter().fold(e, Estimate::note);
        self.channels.iter().flat_map(of).map(remarked).collect()
    }

    fn figures(&self, reading: &Reading<'_>) -> Vec<Figure> {
        let wanted = reading.procedure().report.shows("influence");
        let several = self.channels.len() > 1;
        let of_intervals = self.channels.iter().filter(|_| wanted);
        of_intervals
            .map(|c| figures::influence::figure(c, several))
            .chain(figures::time_series::of_every_gyro(reading))
            .collect()
    }

    fn complete(&self, _: &Reading<'_>, record: &mut RunRecord) -> Vec<Table> {
        let of = |c: &Comparison| interval_means::of_intervals(c, self.acted.evidence());
        interval_means::complete(record, self.channels.iter().flat_map(of).collect())
    }
}

/// Mean output without the influence.
fn rest_mean(c: &Comparison) -> RestMean {
    RestMean {
        mean_deg_h: c.without.value,
        uncertainty_deg_h: c.without.standard,
        range_deg_h: range(c.intervals.iter().filter(|i| i.off).map(|i| i.mean.value)),
    }
}

/// True for a channel whose quantity may change the bias beside the influence. The temperature of the unit is judged by itself.
fn may_disturb(c: &Channel, test: &ComparisonTest) -> bool {
    let role = matches!(
        c.role,
        Role::Temperature
            | Role::Supply
            | Role::MagneticField
            | Role::Vibration
            | Role::AccelerationX
            | Role::AccelerationY
            | Role::AccelerationZ
            | Role::Pressure
            | Role::Humidity
            | Role::TableRate
            | Role::OuterRate
    );
    let setting = &test.setting;
    let of_test = setting.tells_level(c) || setting.on_scale_factor && c.role == Role::TableRate;
    let shaken = test.by_frequency.as_ref().is_some_and(|asked| asked.accelerometer == c.id);
    role && !of_test && !shaken
}

/// Channels recorded besides output and level. In the blocks the channels of the level come first.
fn context(channels: &[Channel], test: &ComparisonTest, levels: usize) -> Beside {
    let nuisance = |c: &Channel| Nuisance {
        channel: c.id.clone(),
        unit: c.role.internal_unit().unwrap_or("1"),
        temperature: c.role == Role::Temperature,
    };
    let others: Vec<&Channel> = channels.iter().filter(|c| may_disturb(c, test)).collect();
    let warm = || others.iter().filter(|c| c.role == Role::Temperature);
    let own = warm().find(|c| Some(&c.id) == test.temperature.as_ref()).or_else(|| warm().next());
    Beside {
        temperature: own.map(|c| nuisance(c)),
        others: others
            .iter()
            .enumerate()
            .filter(|(_, c)| own.is_none_or(|o| o.id != c.id))
            .map(|(at, c)| (levels + at, nuisance(c)))
            .collect(),
    }
}

/// The further quantities, each from the gyro channel whose intervals show it most.
fn most_disturbing(evaluated: &[Comparison]) -> Vec<&Following> {
    let mut most: Vec<&Following> = vec![];
    for found in evaluated.iter().flat_map(|e| &e.others) {
        match most.iter_mut().find(|m| m.what.channel == found.what.channel) {
            Some(known) if found.by_chance < known.by_chance => *known = found,
            Some(_) => {}
            None => most.push(found),
        }
    }
    most
}
