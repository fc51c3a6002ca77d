//! What a claim leaves out, as the generator carries it.

use super::setting::Setting;

/// An interval in which an effect may rightly be located.
#[derive(Clone, Debug)]
pub struct Where {
    /// Domain: `time`, `frequency`, ... as in the contract.
    pub domain: &'static str,
    /// Its lower end, in the unit of the domain.
    pub from: f64,
    /// Its upper end.
    pub to: f64,
    /// An instant or a short stretch: a report may be at most four times as wide.
    pub local: bool,
}

/// A Gaussian process that is added.
#[derive(Clone, Debug)]
pub enum Process {
    /// A Markov process.
    Markov {
        /// Standard deviation, deg/h.
        sigma: f64,
        /// Correlation time, s.
        time_s: f64,
    },
    /// A damped oscillation.
    Resonance {
        /// Standard deviation, deg/h.
        sigma: f64,
        /// Frequency, Hz.
        frequency_hz: f64,
        /// Coherence time, s.
        time_s: f64,
    },
    /// More white noise, flicker and random walk, as coefficients of their own.
    Terms {
        /// N, deg/√h.
        n: f64,
        /// B, deg/h.
        b: f64,
        /// K, deg/h/√h.
        k: f64,
    },
    /// Two-sided density `at_1_hz` f^−½.
    HalfPower {
        /// (deg/h)²/Hz at 1 Hz.
        at_1_hz: f64,
    },
}

/// A low-pass through which all noise goes.
#[derive(Clone, Copy, Debug)]
pub enum Filter {
    /// First order, cutoff in Hz.
    OnePole(f64),
    /// Second order (Butterworth), cutoff in Hz.
    TwoPole(f64),
    /// Means over so many samples.
    Boxcar(usize),
    /// Exponential smoothing of the samples, half the power at a cutoff, Hz.
    Smoothing(f64),
    /// First order by the bilinear transform, cutoff in Hz.
    Bilinear(f64),
}

/// What happens to the white noise.
#[derive(Clone, Debug)]
pub enum White {
    /// Scaled sample by sample.
    Level(Vec<f64>),
    /// Scaled as a whole.
    Factor(f64),
    /// A copy `gain` times as large comes `lag` samples later.
    Echo {
        /// Size of the copy over the original.
        gain: f64,
        /// Samples by which it is late.
        lag: usize,
    },
    /// Student's t of so many degrees of freedom, same variance.
    Tails(f64),
    /// Chi-squared of so many degrees of freedom, same variance, mean zero.
    Skew(f64),
}

/// One thing left out.
#[derive(Clone, Debug, Default)]
pub struct Effect {
    /// Id of its kind.
    pub kind: String,
    /// Its parameters by their names in the contract.
    pub parameters: Vec<(&'static str, f64)>,
    /// Intervals in which it may be located.
    pub wheres: Vec<Where>,
    /// What it adds to each row, deg/h; empty when it adds nothing predetermined.
    pub course: Vec<f64>,
    /// A process that it adds.
    pub process: Option<Process>,
    /// What it does to the white noise.
    pub white: Option<White>,
    /// A filter through which all noise goes.
    pub filter: Option<Filter>,
    /// Step of the angle that it adds, arcsec.
    pub lsb_arcsec: f64,
    /// Rows taken out.
    pub dropped: Vec<usize>,
    /// Log-likelihood that the search for instants costs at least.
    pub cost: f64,
    /// Gain from a formula of its own, when the general one does not hold.
    pub own_gain: Option<f64>,
    /// The claim must state this temperature coefficient.
    pub coefficient: Option<f64>,
}

impl Effect {
    /// An effect of a kind.
    pub fn of(kind: &str) -> Effect {
        Effect { kind: kind.to_string(), ..Effect::default() }
    }

    /// With a parameter.
    pub fn with(mut self, name: &'static str, value: f64) -> Effect {
        self.parameters.push((name, value));
        self
    }

    /// With what it adds to each row.
    pub fn adding(mut self, course: Vec<f64>) -> Effect {
        self.course = course;
        self
    }

    /// To be found in an interval.
    pub fn found(mut self, domain: &'static str, from: f64, to: f64) -> Effect {
        self.wheres.push(Where { domain, from, to, local: false });
        self
    }

    /// To be found in a short interval.
    pub fn found_at(mut self, domain: &'static str, from: f64, to: f64) -> Effect {
        self.wheres.push(Where { domain, from, to, local: true });
        self
    }

    /// To be found anywhere in the record.
    pub fn found_in_time(self, s: &Setting) -> Effect {
        let end = s.duration_s();
        self.found("time", 0.0, end)
    }
}

/// Size of an addition that white noise alone would show with a gain of about 100, deg/h rms.
pub fn unit(s: &Setting) -> f64 {
    s.claim.white_sigma() * (200.0 / s.rows as f64).sqrt()
}

/// Means over the sampling intervals of a function of time, from eight points of each.
pub fn means(s: &Setting, f: impl Fn(f64) -> f64) -> Vec<f64> {
    let h = s.interval_s() / 8.0;
    s.time_s.iter().map(|t| (0..8).map(|p| f(t + h * (f64::from(p) - 3.5))).sum::<f64>() / 8.0).collect()
}
