//! The bench of a rehearsal: simulated units and their recordings with the columns of the procedure.

use crate::acceptance::power::Situation;
use crate::claim::{Claim, Uncertainty};
use crate::config::model::{ModelFile, Profile};
use crate::config::procedure::limit_set::LimitSpec;
use crate::config::procedure::model::{EarthRate, MeasurandSpec};
use crate::config::procedure::power::typical_noise;
use crate::config::procedure::{EffectiveLimits, Procedure};
use crate::effect::{ClaimedMean, Column};
use crate::estimate::normal_quantile;
use crate::i18n::{LocalText, Note, note};
use crate::ingest::{MemoryColumn, ReadOptions, Source};
use crate::measurand::{self, Measurand, PowerModel};
use crate::noise::data::NoiseType;
use crate::noise::model::NoiseModel;
use crate::record::{NominalSource, NominalValue};
use crate::recording::{ColumnRef, Role};
use crate::simulate::{Order, Over, Simulation, stream};
use crate::units::Unit;
use std::collections::BTreeMap;

/// Share of its limit that a coefficient of a nominal unit has where no typical value is stated.
const NOMINAL_SHARE_OF_LIMIT: f64 = 0.5;

/// Noise of a simulated thermometer, degC, and of a simulated supply, V: far within any tolerance.
const SENSOR_NOISE: f64 = 0.002;

/// Tag of the stream that draws how far the Earth rate of a unit's position is from the stated one.
const ORIENTATION_STREAM: u64 = u64::MAX;

/// Rows that are handed on at a time.
const BLOCK_ROWS: usize = 1 << 14;

/// Arc seconds in the least step of the output for one of quantisation: a rounding is even over a step.
const STEPS_PER_DEVIATION: f64 = 3.464_101_615_137_754_6;

/// A unit that differs from a nominal one in one quantity.
pub struct Level {
    /// The quantity.
    pub measurand: &'static Measurand,
    /// Its channel.
    pub channel: String,
    /// Size as a multiple of the limit.
    pub factor: f64,
    /// Size in the unit of the measurand.
    pub value: f64,
}

/// What the units of a rehearsal are made of.
pub struct Bench<'a> {
    /// The procedure with the columns that a simulation writes.
    procedure: Procedure,
    model: Option<&'a ModelFile>,
    noise: NoiseModel,
    nominal: Vec<NominalValue>,
    drivers: Vec<Profile>,
    sample_rate_hz: f64,
    at_rest: bool,
}

impl<'a> Bench<'a> {
    /// The bench of a procedure.
    ///
    /// # Errors
    /// A note that names what a simulation lacks.
    pub fn new(
        procedure: &Procedure,
        effective: &EffectiveLimits,
        model: Option<&'a ModelFile>,
        sample_rate_hz: f64,
    ) -> Result<Bench<'a>, Note> {
        let at_rest = rests(procedure);
        if !at_rest && model.is_none() {
            return Err(note!("rehearse.needs_model", id = procedure.id.as_str()));
        }
        let (noise, nominal) = nominal(effective, model);
        let mut drivers = model.map_or(vec![], |m| m.drivers.clone());
        if at_rest {
            drivers.extend(constants(procedure, &drivers));
        }
        let simulated = of_simulation(procedure, &drivers)?;
        Ok(Bench { procedure: simulated, model, noise, nominal, drivers, sample_rate_hz, at_rest })
    }

    /// The procedure with the columns that a simulation writes.
    pub fn procedure(&self) -> &Procedure {
        &self.procedure
    }

    /// True for a test of a unit at rest, whose units can be set below, at and above limits.
    pub fn is_at_rest(&self) -> bool {
        self.at_rest
    }

    /// The coefficients of a nominal unit.
    pub fn nominal_values(&self) -> Vec<NominalValue> {
        self.nominal.clone()
    }

    /// The first gyro channel that a limit judges and the procedure measures.
    pub fn channel_of(&self, spec: &LimitSpec, effective: &EffectiveLimits) -> Option<&str> {
        let id = spec.measurand.id;
        let judged = |channel: &str| effective.limit(id, channel) == Some(spec);
        let gyros = self.procedure.gyro_channels().map(|c| c.channel.id.as_str());
        gyros.into_iter().find(|c| self.procedure.measures(id, Some(c)) && judged(c))
    }

    /// The limit by which a coefficient of a simulated unit is set; `None` where none sets the quantity of this limit.
    pub fn varied(&self, spec: &LimitSpec) -> Option<f64> {
        let set = matches!(spec.measurand.power?, PowerModel::NoiseTerm(_) | PowerModel::Mean);
        spec.limit.max.filter(|max| set && *max > 0.0)
    }

    /// Ids of the limits whose quantity follows from the others and is not set by itself.
    pub fn unvaried<'l>(&self, effective: &'l EffectiveLimits) -> impl Iterator<Item = &'l str> {
        let measured = |s: &&LimitSpec| self.channel_of(s, effective).is_some();
        let limits: Vec<&LimitSpec> = effective.set.limits.iter().filter(measured).collect();
        limits
            .into_iter()
            .filter(|s| self.varied(s).is_none())
            .map(|s| s.measurand.id)
            .collect::<Vec<_>>()
            .into_iter()
    }

    /// What the power of a limit is asked with.
    pub fn situation(&self, channel: &str) -> Situation {
        let conditions = &self.procedure.conditions;
        let earth = self.procedure.site.as_ref().map_or(0.0, |s| s.earth_rate_along(channel).uncertainty);
        Situation {
            background: self.noise,
            duration_s: conditions.planned_duration_s.or(conditions.minimum_duration_s).unwrap_or(36_000.0),
            tau0_s: 1.0 / self.sample_rate_hz,
            earth_uncertainty_deg_h: earth,
        }
    }

    /// The recording of a unit over a usable length after the warm-up.
    ///
    /// # Errors
    /// A note that says what the simulation lacks.
    pub fn recording(&self, length_s: f64, level: Option<&Level>, seed: u64) -> Result<Source, Note> {
        let duration_s = length_s + self.procedure.conditions.warm_up_s + 1.0 / self.sample_rate_hz;
        let mut columns: Vec<MemoryColumn> = vec![];
        for (place, spec) in self.procedure.gyro_channels().enumerate() {
            let channel = spec.channel.id.as_str();
            let own = level.filter(|l| l.channel == channel);
            let own_seed = stream(seed, place as u64);
            let claim = self.claim(channel, own, normal_deviate(stream(own_seed, ORIENTATION_STREAM)));
            let over = Over::Duration { duration_s, start_s: 0.0, drivers: &self.drivers };
            let order = Order { claim: &claim, seed: own_seed, over };
            let rows = Simulation::begin(order).and_then(Simulation::all).map_err(|e| e.note().clone())?;
            let mut rate = rows.rate_deg_h;
            let ramp = self.ramp(own);
            let middle_s = 0.5 * duration_s;
            for (y, t) in rate.iter_mut().zip(&rows.time_s) {
                *y += ramp * (t - middle_s) / 3600.0;
            }
            if columns.is_empty() {
                columns.push(MemoryColumn::new("time_s", rows.time_s));
                for (column, values) in rows.columns {
                    columns.push(MemoryColumn::new(column.name(), values));
                }
            }
            columns.push(MemoryColumn::new(rate_column(place), rate));
        }
        Source::from_columns("rehearsal", columns, BLOCK_ROWS).map_err(|e| e.note())
    }

    /// Rate ramp of a unit, deg/h/h. The simulation of noise has none.
    fn ramp(&self, level: Option<&Level>) -> f64 {
        let of_level =
            level.filter(|l| l.measurand.power == Some(PowerModel::NoiseTerm(NoiseType::RateRamp)));
        of_level.map_or(self.noise.r, |l| l.value)
    }

    /// The claim of a unit. `off` is how far the Earth rate of its position is from the stated one, in standard uncertainties.
    fn claim(&self, channel: &str, level: Option<&Level>, off: f64) -> Claim {
        let mut noise = self.noise;
        let mut bias = 0.0;
        match level.and_then(|l| Some((l.measurand.power?, l.value))) {
            Some((PowerModel::NoiseTerm(term), value)) => noise = noise.with(term, value),
            Some((PowerModel::Mean, value)) => bias = value,
            _ => {}
        }
        noise.r = 0.0;
        let removed =
            |m: &MeasurandSpec| m.measurand == &measurand::STATIC_BIAS && m.earth_rate == EarthRate::Remove;
        let site = self.procedure.site.as_ref().filter(|_| self.procedure.measurands.iter().any(removed));
        let earth = site.map_or(0.0, |s| {
            let earth = s.earth_rate_along(channel);
            earth.value + off * earth.uncertainty
        });
        let quantization_lsb_arcsec = STEPS_PER_DEVIATION * noise.q;
        match self.model {
            Some(model) => {
                let mut claim = model.claim.clone();
                let of_model = model.claim.mean.bias_deg_h;
                let sets_bias = level.is_some_and(|l| l.measurand.power == Some(PowerModel::Mean));
                claim.mean.bias_deg_h = if sets_bias { bias + earth } else { of_model };
                Claim { sample_rate_hz: self.sample_rate_hz, noise, quantization_lsb_arcsec, ..claim }
            }
            None => Claim {
                case: String::new(),
                description: LocalText::default(),
                sample_rate_hz: self.sample_rate_hz,
                columns: None,
                noise,
                quantization_lsb_arcsec,
                mean: ClaimedMean { bias_deg_h: bias + earth, ..ClaimedMean::default() },
                uncertainty: Uncertainty::default(),
                effects: vec![],
            },
        }
    }
}

/// A standard normal deviate made of random bits.
fn normal_deviate(bits: u64) -> f64 {
    normal_quantile(((bits >> 11) as f64 + 0.5) / (1u64 << 53) as f64)
}

/// True for a procedure of a unit at rest.
fn rests(p: &Procedure) -> bool {
    let special = [
        p.rate_table.is_some(),
        p.temperature_test.is_some(),
        p.warm_up_test.is_some(),
        p.acceleration_test.is_some(),
        p.transfer_test.is_some(),
        p.start_up_test.is_some(),
        p.repeatability_test.is_some(),
        p.comparison_test.is_some(),
    ];
    special.iter().all(|is| !is)
}

/// The noise of a nominal unit: of the model, else typical, else a share of the limit.
fn nominal(effective: &EffectiveLimits, model: Option<&ModelFile>) -> (NoiseModel, Vec<NominalValue>) {
    let typical = typical_noise(effective);
    let terms = [
        (&measurand::ANGLE_RANDOM_WALK, typical.angle_random_walk, NoiseType::AngleRandomWalk),
        (&measurand::BIAS_INSTABILITY, typical.bias_instability, NoiseType::Flicker),
        (&measurand::RATE_RANDOM_WALK, typical.rate_random_walk, NoiseType::RateRandomWalk),
        (&measurand::RATE_RAMP, typical.rate_ramp, NoiseType::RateRamp),
        (&measurand::QUANTIZATION, typical.quantization, NoiseType::Quantization),
    ];
    let mut noise = NoiseModel::default();
    let mut values = vec![];
    for (measurand, expected, term) in terms {
        let limit = effective.set.limits.iter().find(|l| l.measurand.id == measurand.id);
        let of_limit = limit.and_then(|l| l.limit.max).map(|max| NOMINAL_SHARE_OF_LIMIT * max);
        let (value, from) = match (model, expected, of_limit) {
            (Some(m), ..) => (m.claim.noise.coefficient(term), NominalSource::Model),
            (None, Some(value), _) => (value, NominalSource::Expected),
            (None, None, Some(value)) => (value, NominalSource::Limit),
            _ => (0.0, NominalSource::Nothing),
        };
        noise = noise.with(term, value);
        values.push(NominalValue {
            id: measurand.id.to_owned(),
            value,
            unit: measurand.unit.to_owned(),
            from,
        });
    }
    (noise, values)
}

/// Constant courses of the columns of a test at rest that a model does not drive.
fn constants(procedure: &Procedure, driven: &[Profile]) -> Vec<Profile> {
    let conditions = &procedure.conditions;
    let mut levels: BTreeMap<Column, f64> = BTreeMap::new();
    for spec in &procedure.channels {
        let id = spec.channel.id.as_str();
        match spec.channel.role {
            Role::Temperature => {
                let held = conditions.temperatures.iter().find(|t| t.channel == id);
                let level = held.map_or(20.0, |t| t.nominal_deg_c);
                levels.entry(Column::Temperature).or_insert(level);
            }
            Role::Supply => {
                let held = conditions.supplies.iter().find(|s| s.channel == id);
                levels.entry(Column::Supply).or_insert(held.map_or(5.0, |s| s.nominal_v));
            }
            _ => {}
        }
    }
    let constant = |(column, value)| Profile {
        column,
        time_s: vec![0.0],
        value: vec![value],
        sine_amplitude: 0.0,
        sine_period_s: 1.0,
        sine_phase_deg: 0.0,
        noise: SENSOR_NOISE,
    };
    levels.into_iter().filter(|(c, _)| driven.iter().all(|d| d.column != *c)).map(constant).collect()
}

/// The name of the column of a gyro by its place.
fn rate_column(place: usize) -> String {
    format!("rate{place}_deg_h")
}

/// The procedure as it reads simulated recordings: its channels with the columns and units of a simulation.
fn of_simulation(procedure: &Procedure, drivers: &[Profile]) -> Result<Procedure, Note> {
    let mut simulated = procedure.clone();
    simulated.recording.read = ReadOptions::default();
    simulated.exclusions.clear();
    simulated.explain = None;
    // No simulated unit stands on a bench.
    simulated.bench = None;
    simulated.waivers.clear();
    let mut kept = vec![];
    let mut gyros = 0;
    for mut spec in std::mem::take(&mut simulated.channels) {
        let role = spec.channel.role;
        let (name, unit) = match role {
            Role::Time => ("time_s".to_owned(), "s"),
            Role::Rate | Role::AngleIncrement | Role::AccumulatedAngle => {
                gyros += 1;
                spec.channel.role = Role::Rate;
                (rate_column(gyros - 1), "deg/h")
            }
            Role::Temperature => (Column::Temperature.name().to_owned(), "degC"),
            Role::Supply => (Column::Supply.name().to_owned(), "V"),
            Role::TableRate => (Column::TableRate.name().to_owned(), "deg/s"),
            Role::TableAngle => (Column::TableAngle.name().to_owned(), "deg"),
            Role::OuterRate => (Column::OuterRate.name().to_owned(), "deg/s"),
            _ if !spec.required => continue,
            _ => return Err(note!("rehearse.role", channel = spec.channel.id.as_str())),
        };
        let own = matches!(role, Role::Time) || spec.channel.role == Role::Rate;
        if !own && drivers.iter().all(|d| d.column.name() != name) {
            if !spec.required {
                continue;
            }
            return Err(note!("rehearse.not_driven", channel = spec.channel.id.as_str(), column = name));
        }
        spec.channel.column = ColumnRef::Name(name);
        spec.channel.scale = 1.0;
        spec.channel.unit = Unit::parse(unit).map_err(|e| e.note())?;
        unit.clone_into(&mut spec.unit_in_file);
        spec.rollover = None;
        kept.push(spec);
    }
    if gyros == 0 {
        return Err(note!("rehearse.no_gyro"));
    }
    if kept.iter().all(|c| c.channel.role != Role::Time) {
        return Err(note!("rehearse.no_time"));
    }
    simulated.channels = kept;
    Ok(simulated)
}
