//! An effect, and how it is made as strong as asked: an oracle gains a drawn number of nats from knowing it.

use super::bench::Bench;
use super::dice::Dice;
use super::noise::Levels;
use super::oracle::{Density, Oracle};
use super::truth::{Concealed, Place};
use std::collections::BTreeMap;

/// Less than this part of the variance counts as nothing that could be predicted.
const PREDICTABLE: f64 = 0.3;

/// Something that depends on the bench and on the size of an effect.
pub type OfSize<T> = Box<dyn Fn(&Bench, f64) -> T>;

/// Density of a random process.
pub struct Law {
    /// Levels of the three terms.
    pub levels: Levels,
    /// Factor on them at a frequency in Hz.
    pub factor: Box<dyn Fn(f64) -> f64>,
    /// Added after the factor, (deg/h)²/Hz.
    pub added: Box<dyn Fn(f64) -> f64>,
}

/// How an effect comes into the rate.
pub enum Shape {
    /// This course times its size.
    Course(Vec<f64>),
    /// A course that does not grow in proportion to its size.
    Bend(OfSize<Vec<f64>>),
    /// A random process, told apart by its density alone.
    Process(OfSize<Vec<f64>>, OfSize<Law>),
    /// The level of the white noise, row by row.
    Spread(OfSize<Vec<f64>>),
}

/// Parameters and places of an effect of a size.
#[derive(Debug, Clone, Default)]
pub struct Facts {
    /// Parameters by the definitions of the contract.
    pub parameters: BTreeMap<String, f64>,
    /// Places that show it.
    pub places: Vec<Place>,
}

impl Facts {
    /// Adds a parameter.
    pub fn with(mut self, name: &str, value: f64) -> Facts {
        self.parameters.insert(name.to_owned(), value);
        self
    }

    /// Adds a place.
    pub fn at(mut self, domain: &str, from: f64, to: f64) -> Facts {
        self.places.push(Place::new(domain, from, to));
        self
    }
}

/// An effect of its size.
pub struct Hidden {
    /// What is known of it.
    pub told: Concealed,
    /// What it adds to the rate, deg/h; of a level of noise too, which nobody can predict.
    pub added_deg_h: Vec<f64>,
}

/// An effect without its size.
pub struct Effect {
    /// Kind of the contract.
    pub kind: &'static str,
    /// What it is in the laboratory.
    pub subject: &'static str,
    /// Kinds that describe it as well.
    pub same: Vec<&'static str>,
    /// Kinds of a second entry that the same physics shows.
    pub beside: Vec<&'static str>,
    /// Column that drives it.
    pub column: Option<String>,
    /// Law of a driver.
    pub law: Option<&'static str>,
    /// Whether the course is random or hidden, so that it is estimated and not computed.
    pub latent: bool,
    /// How much of its size is a temperature coefficient that the claim states; 0 or ±1.
    pub claimed: f64,
    /// How it comes into the rate.
    pub shape: Shape,
    /// Parameters and places, from bench and size.
    pub facts: OfSize<Facts>,
}

impl Effect {
    /// An effect of a kind.
    pub fn new(kind: &'static str, shape: Shape, facts: impl Fn(&Bench, f64) -> Facts + 'static) -> Effect {
        Effect {
            kind,
            subject: kind,
            same: vec![],
            beside: vec![],
            column: None,
            law: None,
            latent: false,
            claimed: 0.0,
            shape,
            facts: Box::new(facts),
        }
    }

    /// Names what it is in the laboratory.
    pub fn of(mut self, subject: &'static str) -> Effect {
        self.subject = subject;
        self
    }

    /// Kinds that describe it as well.
    pub fn same(mut self, kinds: &[&'static str]) -> Effect {
        self.same = kinds.to_vec();
        self
    }

    /// Kinds that may stand beside it.
    pub fn beside(mut self, kinds: &[&'static str]) -> Effect {
        self.beside = kinds.to_vec();
        self
    }

    /// Marks a random or hidden course.
    pub fn latent(mut self) -> Effect {
        self.latent = true;
        self
    }

    fn contribution(&self, bench: &Bench, size: f64) -> Vec<f64> {
        match &self.shape {
            Shape::Course(course) => course.iter().map(|c| size * c).collect(),
            Shape::Bend(of) | Shape::Process(of, _) => of(bench, size),
            Shape::Spread(of) => {
                of(bench, size).iter().zip(&bench.parts.white).map(|(g, w)| (g - 1.0) * w).collect()
            }
        }
    }

    /// Gain of the oracle at a size. The modes of a course are given, so that they are made once.
    fn gain(&self, bench: &Bench, oracle: &Oracle, course: &[f64], size: f64) -> f64 {
        match &self.shape {
            Shape::Course(_) => oracle.course_gain(&course.iter().map(|c| size * c).collect::<Vec<f64>>()),
            Shape::Bend(of) => oracle.course_gain(&oracle.modes(&of(bench, size))),
            Shape::Process(of, law) => {
                let law = law(bench, size);
                let density = Density { levels: law.levels, factor: &law.factor, added: &law.added };
                oracle.law_gain(&oracle.modes(&of(bench, size)), &density)
            }
            Shape::Spread(of) => {
                let added = oracle.modes(&self.contribution(bench, size));
                oracle.spread_gain(&added, &of(bench, size))
            }
        }
    }

    /// Finds the size at which the oracle gains what is asked, to a fiftieth; `None` where no size does.
    fn size_for(&self, bench: &Bench, oracle: &Oracle, asked: f64) -> Option<(f64, f64)> {
        let course = match &self.shape {
            Shape::Course(course) => oracle.modes(course),
            _ => vec![],
        };
        let gain = |log: f64| self.gain(bench, oracle, &course, log.exp());
        let (mut low, mut high, mut at) = (f64::NEG_INFINITY, f64::INFINITY, 0.0f64);
        for _ in 0..60 {
            let found = gain(at);
            if (found / asked - 1.0).abs() < 0.02 {
                return Some((at.exp(), found));
            }
            if found < asked {
                low = at;
            } else {
                high = at;
            }
            at = match (low.is_finite(), high.is_finite()) {
                (true, true) => 0.5 * (low + high),
                // Far from the wanted gain, which grows about as the square, the step is long.
                (true, false) => at + (0.5 * (asked / found.max(asked * 1e-4)).ln()).clamp(0.1, 5.0),
                _ => at - (0.5 * (found / asked).ln()).clamp(0.1, 5.0),
            };
            if high - low < 1e-6 || at.abs() > 60.0 {
                return None;
            }
        }
        None
    }

    /// Conceals it in a bench with a gain. `None` where no size gives the gain.
    pub fn conceal(&self, bench: &mut Bench, oracle: &Oracle, asked: f64) -> Option<Hidden> {
        let (size, gain) = self.size_for(bench, oracle, asked)?;
        for claim in [&mut bench.claim, &mut bench.right] {
            claim.temperature =
                claim.temperature.map(|[c, reference, sd]| [c + self.claimed * size, reference, sd]);
        }
        let contribution = self.contribution(bench, size);
        let facts = (self.facts)(bench, size);
        let mut parameters = facts.parameters;
        let adds = !matches!(self.shape, Shape::Spread(_));
        if adds {
            parameters.entry("rms_deg_h".to_owned()).or_insert_with(|| spread_of(&contribution));
        }
        let modes = oracle.modes(&contribution);
        let possible = match (&self.shape, self.latent) {
            (Shape::Spread(_), _) => None,
            (_, true) | (Shape::Process(..), _) => {
                Some(oracle.predictable(&modes)).filter(|p| *p > PREDICTABLE)
            }
            // What one amplitude that is estimated loses.
            _ => Some(1.0 - 1.0 / (2.0 * gain)),
        };
        let owned = |list: &[&str]| list.iter().map(|k| (*k).to_owned()).collect();
        let told = Concealed {
            kind: self.kind.to_owned(),
            subject: self.subject.to_owned(),
            same: owned(&self.same),
            beside: owned(&self.beside),
            column: self.column.clone(),
            law: self.law.map(str::to_owned),
            parameters,
            places: facts.places,
            gain: Some(gain),
            possible,
            contribution_deg_h: if adds { contribution.clone() } else { vec![0.0; bench.rows] },
        };
        Some(Hidden { told, added_deg_h: contribution })
    }
}

/// Standard deviation.
pub fn spread_of(course: &[f64]) -> f64 {
    let n = course.len() as f64;
    let mean = course.iter().sum::<f64>() / n;
    (course.iter().map(|c| (c - mean) * (c - mean)).sum::<f64>() / n).sqrt()
}

/// Smallest and largest value.
pub fn range_of(course: &[f64]) -> [f64; 2] {
    course.iter().fold([f64::MAX, f64::MIN], |[l, h], x| [l.min(*x), h.max(*x)])
}

/// A gain in the range of a strength, evenly in the logarithm.
pub fn asked_gain(dice: &mut Dice, range: [f64; 2]) -> f64 {
    // The found size may be a fiftieth off.
    dice.decades(range[0] * 1.025, range[1] * 0.975)
}
