//! Cases: circumstances, effects brought to the strength asked for, and the recording that comes of them.

use super::claim::Stated;
use super::draw::{Draw, mixed};
use super::effect::{Effect, Process, White};
use super::kinds::{KINDS, Kind, find};
use super::modes::gaussian;
use super::noise::{flicker, markov, quantised, random_walk, resonance, white};
use super::scenario::{ALL, Scenario};
use super::setting::Setting;
use super::stochastic::response;
use super::strength::Spectrum;
use std::f64::consts::TAU;

/// One effect and its strength: expected gain of log-likelihood.
#[derive(Clone, Debug)]
pub struct Left {
    /// The effect.
    pub effect: Effect,
    /// Expected gain of log-likelihood by naming it.
    pub strength: f64,
}

/// A case before noise is drawn.
#[derive(Clone, Debug)]
pub struct Case {
    /// Name of its folder.
    pub name: String,
    /// Seed of the noise.
    pub seed: u64,
    /// Circumstances of the recording.
    pub setting: Setting,
    /// Left out of the claim.
    pub left_out: Vec<Left>,
    /// In the recording and in the claim.
    pub stated: Vec<Left>,
}

/// The recording with what went into it, row by row, before rows are dropped.
pub struct Realisation {
    /// Rate, deg/h.
    pub rate_deg_h: Vec<f64>,
    /// What each effect left out adds; empty where nothing can be predicted.
    pub contributions: Vec<Vec<f64>>,
}

/// Effects whose contract parameters say all, so that a claim may state them.
const STATEABLE: &[&str] = &[
    "markov_long",
    "markov_short",
    "quasi_periodic",
    "rate_ramp",
    "warmup_exponential",
    "bias_step",
    "supply_sensitivity",
    "temp_rate",
    "sf_asymmetry",
    "dropped_samples",
];

/// Families within which two effects would hide each other.
const FAMILIES: &[&[&str]] = &[
    &["temp_linear", "temp_polynomial", "temp_rate", "thermal_lag", "temp_hysteresis"],
    &[
        "warmup_exponential",
        "rate_ramp",
        "diurnal",
        "unobserved_driver",
        "bias_step",
        "random_telegraph",
        "heading_change",
        "excess_rrw",
        "excess_flicker",
        "markov_long",
    ],
    &[
        "excess_arw",
        "markov_short",
        "bandwidth_filter",
        "quantization",
        "noise_variance_time",
        "noise_variance_rate",
        "outlier_bursts",
    ],
    &["line", "quasi_periodic"],
    &[
        "sf_error",
        "sf_asymmetry",
        "sf_nonlinearity",
        "sf_temperature",
        "saturation",
        "time_offset",
        "clock_drift",
        "dead_zone",
        "reset_ripple",
    ],
    &["earth_rate_projection", "table_harmonic"],
    &["cross_axis"],
    &["supply_sensitivity"],
    &["dropped_samples"],
];

fn family(kind: &str) -> usize {
    FAMILIES.iter().position(|f| f.contains(&kind)).unwrap_or(FAMILIES.len())
}

/// Brings an effect to a strength: secant steps in the logarithm, within the bounds of its kind.
fn fitted(setting: &mut Setting, kind: &Kind, seed: u64, target: f64) -> Left {
    let make = |setting: &mut Setting, a: f64| {
        let effect = (kind.make)(&mut Draw::new(seed, kind.name), setting, a);
        if let (Some(value), Some(t)) = (effect.coefficient, &mut setting.claim.temperature) {
            let sigmas = setting.departure.coefficient / setting.claim.uncertainty.coefficient;
            t.0 = value;
            setting.claim.uncertainty.coefficient = 0.02 * value.abs();
            setting.departure.coefficient = sigmas * setting.claim.uncertainty.coefficient;
        }
        effect
    };
    let mut a = 1f64.clamp(kind.bounds.0, kind.bounds.1);
    let mut spectrum = Spectrum::of(setting);
    let mut best: Option<(f64, Left)> = None;
    let mut bracket = kind.bounds;
    for _ in 0..16 {
        let effect = make(setting, a);
        if effect.coefficient.is_some() {
            spectrum = Spectrum::of(setting);
        }
        let strength = spectrum.gain(setting, &effect);
        let off = if strength > 0.0 { (strength / target).ln().abs() } else { f64::MAX };
        if best.as_ref().is_none_or(|(o, _)| off <= *o) {
            best = Some((off, Left { effect, strength }));
        }
        if off < 0.02 || !strength.is_finite() {
            break;
        }
        if strength < target {
            bracket.0 = a
        } else {
            bracket.1 = a
        }
        let guess = if strength > 0.0 { a * (target / strength).sqrt().clamp(0.1, 10.0) } else { 4.0 * a };
        let inside = guess > bracket.0 && guess < bracket.1;
        let next = if inside { guess } else { (bracket.0 * bracket.1).sqrt() };
        let limit = guess.clamp(kind.bounds.0, kind.bounds.1);
        a = if inside || bracket != kind.bounds && limit == guess { next } else { limit };
    }
    let (_, left) = best.expect("at least one size was tried");
    if let Some(value) = left.effect.coefficient {
        // The claim must be that of the size chosen, not of the size tried last.
        let sigmas = setting.departure.coefficient / setting.claim.uncertainty.coefficient;
        setting.claim.temperature.as_mut().expect("a claim about temperature").0 = value;
        setting.claim.uncertainty.coefficient = 0.02 * value.abs();
        setting.departure.coefficient = sigmas * setting.claim.uncertainty.coefficient;
    }
    left
}

fn target(draw: &mut Draw, strength: (f64, f64)) -> f64 {
    if strength.0 == strength.1 { strength.0 } else { draw.log_uniform(strength.0, strength.1) }
}

/// A case with one effect of a kind.
pub fn single(number: u64, kind: &Kind, strength: (f64, f64)) -> Case {
    let seed = mixed(number, kind.name);
    let mut draw = Draw::new(seed, "case");
    let scenario = *draw.pick(kind.scenarios);
    let mut setting = Setting::drawn(seed, scenario);
    let wanted = target(&mut draw, strength);
    let left = fitted(&mut setting, kind, seed, wanted);
    let name = format!("{}-{number:06}", kind.name);
    Case { name, seed, setting, left_out: vec![left], stated: Vec::new() }.named()
}

/// A case with two effects of different families, one after the other brought to strength.
pub fn pair(number: u64, strength: (f64, f64)) -> Case {
    let seed = mixed(number, "pair");
    let mut draw = Draw::new(seed, "pair");
    loop {
        let (a, b) = (draw.pick(KINDS), draw.pick(KINDS));
        let common: Vec<Scenario> = a.scenarios.iter().filter(|s| b.scenarios.contains(s)).copied().collect();
        // What a filter leaves of a line is not said by the contract.
        let hums = |k: &Kind| matches!(k.name, "line" | "quasi_periodic");
        let filters = |k: &Kind| k.name == "bandwidth_filter";
        let unsaid = filters(a) && hums(b) || hums(a) && filters(b);
        if family(a.name) == family(b.name) || common.is_empty() || unsaid {
            continue;
        }
        let mut setting = Setting::drawn(seed, *draw.pick(&common));
        // The one that changes the claim comes first.
        let (a, b) = if b.name == "thermal_lag" { (b, a) } else { (a, b) };
        let wanted = [target(&mut draw, strength), target(&mut draw, strength)];
        let first = fitted(&mut setting, a, seed, wanted[0]);
        let second = fitted(&mut setting, b, seed, wanted[1]);
        let name = format!("pair-{}-{}-{number:06}", a.name, b.name);
        return Case { name, seed, setting, left_out: vec![first, second], stated: Vec::new() }.named();
    }
}

/// A case in which the claim is right: some state an effect or a quantisation.
pub fn null(number: u64) -> Case {
    let seed = mixed(number, "null");
    let mut draw = Draw::new(seed, "null");
    let mut stated = Vec::new();
    let mut setting = if draw.chance(0.3) {
        let kind = find(STATEABLE[draw.below(STATEABLE.len())]).expect("a kind of the table");
        let mut setting = Setting::drawn(seed, *draw.pick(kind.scenarios));
        let wanted = draw.log_uniform(30.0, 300.0);
        let left = fitted(&mut setting, kind, seed, wanted);
        let parameters = left.effect.parameters.iter().map(|(n, v)| (n.to_string(), *v)).collect();
        setting.claim.stated.push(Stated { kind: kind.name.to_string(), parameters });
        stated.push(left);
        setting
    } else {
        Setting::drawn(seed, *draw.pick(&ALL))
    };
    if draw.chance(0.15) && stated.is_empty() {
        let sigma = setting.claim.white_sigma();
        let lsb = sigma * setting.interval_s() * draw.log_uniform(0.02, 5.0);
        setting.claim.lsb_arcsec = super::claim::rounded(lsb, 2);
    }
    Case { name: format!("null-{number:06}"), seed, setting, left_out: Vec::new(), stated }.named()
}

fn student(draw: &mut Draw, nu: f64) -> f64 {
    // Bailey's polar form: no chi-squared is needed.
    let u = draw.uniform(f64::MIN_POSITIVE, 1.0);
    let t = (nu * (u.powf(-2.0 / nu) - 1.0)).sqrt() * (TAU * draw.uniform(0.0, 1.0)).cos();
    t * ((nu - 2.0) / nu).sqrt()
}

fn chi_squared_centred(draw: &mut Draw, degrees: f64) -> f64 {
    // Cube of a normal (Wilson and Hilferty), brought to mean 0 and variance 1 by its exact moments.
    let c = 2.0 / (9.0 * degrees);
    let (m, v) = (1.0 - c, c);
    let x = (m + v.sqrt() * draw.normal()).powi(3);
    let mean = m.powi(3) + 3.0 * m * v;
    let variance = 9.0 * m.powi(4) * v + 36.0 * m * m * v * v + 15.0 * v.powi(3);
    (x - mean) / variance.sqrt()
}

impl Case {
    fn named(mut self) -> Case {
        self.setting.claim.case.clone_from(&self.name);
        self
    }

    /// All effects that act.
    fn acting(&self) -> impl Iterator<Item = &Left> {
        self.left_out.iter().chain(&self.stated)
    }

    fn white_noise(&self, draw: &mut Draw) -> Vec<f64> {
        let s = &self.setting;
        let (n, rate, arw) = (s.rows, s.claim.rate_hz, s.claim.n * (1.0 + s.departure.n_rel));
        let sigma = 60.0 * arw * rate.sqrt();
        let mut noise = white(draw, n, rate, arw);
        for left in self.acting() {
            match &left.effect.white {
                None => {}
                Some(White::Factor(factor)) => noise.iter_mut().for_each(|w| *w *= factor),
                Some(White::Level(level)) => noise.iter_mut().zip(level).for_each(|(w, l)| *w *= l),
                Some(White::Tails(nu)) => noise.iter_mut().for_each(|w| *w = sigma * student(draw, *nu)),
                Some(White::Skew(d)) => {
                    noise.iter_mut().for_each(|w| *w = sigma * chi_squared_centred(draw, *d))
                }
                Some(White::Echo { gain, lag }) => {
                    let before: Vec<f64> = (0..*lag).map(|_| sigma * draw.normal()).collect();
                    let source: Vec<f64> = before.into_iter().chain(noise.iter().copied()).collect();
                    noise.iter_mut().zip(&source).for_each(|(w, early)| *w += gain * early);
                }
            }
        }
        noise
    }

    /// The recording, its noise drawn with a seed of its own: another seed is another day with the same effects.
    pub fn realise(&self, noise_seed: u64) -> Realisation {
        let s = &self.setting;
        let (n, rate) = (s.rows, s.claim.rate_hz);
        let mut draw = Draw::new(noise_seed, "noise");
        let b = s.claim.b * (1.0 + s.departure.b_rel);
        let mut y = s.known(|_| 0.0);
        let mut add = |x: &[f64]| y.iter_mut().zip(x).for_each(|(y, x)| *y += x);
        if let Some(filter) = self.acting().find_map(|l| l.effect.filter) {
            let arw = s.claim.n * (1.0 + s.departure.n_rel);
            let density = |f: f64| (3600.0 * arw * arw + b * b / (TAU * f)) * response(filter, f, rate);
            add(&gaussian(&mut draw, n, rate, density));
        } else {
            add(&self.white_noise(&mut draw));
            add(&flicker(&mut draw, n, rate, b));
        }
        add(&random_walk(&mut draw, n, rate, s.claim.k * (1.0 + s.departure.k_rel)));
        let mut contributions = Vec::new();
        for (i, left) in self.acting().enumerate() {
            let e = &left.effect;
            let mut own = if e.course.is_empty() { Vec::new() } else { e.course.clone() };
            let mut draw = Draw::new(noise_seed, &format!("process {i}"));
            match e.process {
                None => {}
                Some(Process::Markov { sigma, time_s }) => own = markov(&mut draw, n, rate, sigma, time_s),
                Some(Process::Resonance { sigma, frequency_hz, time_s }) => {
                    own = resonance(&mut draw, n, rate, sigma, frequency_hz, time_s);
                }
                Some(Process::Terms { n: arw, b, k }) => {
                    own = white(&mut draw, n, rate, arw);
                    let flicker = flicker(&mut draw, n, rate, b);
                    let walk = random_walk(&mut draw, n, rate, k);
                    own.iter_mut().zip(flicker.iter().zip(&walk)).for_each(|(o, (f, w))| *o += f + w);
                }
                Some(Process::HalfPower { at_1_hz }) => {
                    own = gaussian(&mut draw, n, rate, |f| at_1_hz / f.sqrt())
                }
            }
            if !own.is_empty() {
                add(&own);
            }
            if i < self.left_out.len() {
                contributions.push(own);
            }
        }
        let lsb = self.acting().map(|l| l.effect.lsb_arcsec).fold(s.claim.lsb_arcsec, f64::max);
        if lsb > 0.0 {
            y = quantised(&y, rate, lsb, draw.uniform(0.0, 1.0));
        }
        Realisation { rate_deg_h: y, contributions }
    }
}
