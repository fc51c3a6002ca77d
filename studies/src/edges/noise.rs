//! Noise of a unit at rest, beside its bias.

use super::case::{Case, Edge, Exemption, Family, Simulated, Truth};
use crate::noise_source::{NoiseSource, add, csv};
use std::f64::consts::{PI, TAU};

/// N of every unit, deg/√h.
const N: f64 = 0.002;
/// Interval of the slow records, s.
const DT_S: f64 = 1.0;
/// Earth rate, deg/h.
const EARTH: f64 = 15.041_067;

const WHITE: &[&str] = &[
    "angle_random_walk",
    "angle_random_walk_white",
    "angle_random_walk_readout",
    "russian_drift_100s",
    "russian_drift_100s_3sigma",
    "russian_sigma_10s",
    "russian_arw_10s",
    "russian_drift_100s_predicted",
    "ratio_russian_to_allan_arw",
];
/// Noise slower than white, and quantisation.
pub const SLOW: &[&str] = &["bias_instability", "rate_random_walk", "rate_ramp", "quantization"];
const READ: &[&str] = &["rate_random_walk_readout", "rate_ramp_readout", "quantization_readout"];
const LINE: &[&str] = &["line_frequency", "line_amplitude"];
const MARKOV: &[&str] = &["markov_sigma", "markov_correlation_time"];
const PERIODIC: &[&str] =
    &["quasi_periodic_amplitude", "quasi_periodic_frequency", "quasi_periodic_coherence_time"];
const MINIMUM: &[&str] =
    &["bias_instability_minimum", "bias_instability_minimum_scaled", "ratio_russian_to_allan_bias"];

const IDS: &[&str] = &[
    "static_bias",
    "earth_rate_component",
    "angle_random_walk",
    "angle_random_walk_white",
    "angle_random_walk_readout",
    "russian_drift_100s",
    "russian_drift_100s_3sigma",
    "russian_sigma_10s",
    "russian_arw_10s",
    "russian_drift_100s_predicted",
    "ratio_russian_to_allan_arw",
    "bias_instability",
    "rate_random_walk",
    "rate_ramp",
    "quantization",
    "rate_random_walk_readout",
    "rate_ramp_readout",
    "quantization_readout",
    "line_frequency",
    "line_amplitude",
    "markov_sigma",
    "markov_correlation_time",
    "quasi_periodic_amplitude",
    "quasi_periodic_frequency",
    "quasi_periodic_coherence_time",
    "bias_instability_minimum",
    "bias_instability_minimum_scaled",
    "ratio_russian_to_allan_bias",
];

fn procedure(dt_s: f64, elevation_deg: f64, ids: &[&str]) -> String {
    let mut text = format!(
        "format = \"procedure/1\"\n[procedure]\nid = \"p\"\ntitle = \"P\"\nrevision = \"A\"\n\
         [recording]\nsample_rate = \"{} Hz\"\n\
         [[channel]]\nid = \"rate\"\ncolumn = \"rate_deg_h\"\nrole = \"rate\"\nunit = \"deg/h\"\n\
         [site]\nlatitude = \"56 deg\"\nlatitude_uncertainty = \"10 arcsec\"\nelevation = \"{elevation_deg} deg\"\n\
         elevation_uncertainty = \"30 arcsec\"\nheading = \"0 deg\"\nheading_uncertainty = \"30 arcsec\"\n",
        1.0 / dt_s
    );
    for id in ids {
        text += &format!("[[measurand]]\nid = \"{id}\"\n");
        if *id == "static_bias" {
            text += "options.earth_rate = \"remove\"\n";
        }
    }
    text
}

/// A unit with a bias on a vertical axis, its noise and what else is true of it.
struct Unit {
    source: NoiseSource,
    values: Vec<f64>,
    dt_s: f64,
    truths: Vec<Truth>,
}

impl Unit {
    fn new(seed: u64, len: usize, dt_s: f64) -> Unit {
        let mut source = NoiseSource::new(seed);
        let values = source.white(N, dt_s, len);
        Unit { source, values, dt_s, truths: vec![] }
    }

    fn length_h(&self) -> f64 {
        self.values.len() as f64 * self.dt_s / 3600.0
    }

    fn with(mut self, what: Vec<f64>, truths: Vec<Truth>) -> Unit {
        add(&mut self.values, &what);
        self.truths.extend(truths);
        self
    }

    fn truly(mut self, truths: Vec<Truth>) -> Unit {
        self.truths.extend(truths);
        self
    }

    fn walk(mut self, k: f64, truths: Vec<Truth>) -> Unit {
        let walk = self.source.walk(k, self.dt_s, self.values.len());
        self.with(walk, truths)
    }

    /// Flicker from the interval to the length of the record: what is slower belongs to the bias.
    fn flicker(mut self, b: f64, truths: Vec<Truth>) -> Unit {
        let (len, step) = (self.values.len(), 2f64.ln() / 4.0);
        let sigma = b * (step / PI).sqrt();
        let (mut sum, mut tau_s) = (vec![0.0; len], 0.5 * self.dt_s);
        while tau_s < self.dt_s * len as f64 {
            add(&mut sum, &self.source.markov(sigma, tau_s, self.dt_s, len));
            tau_s *= step.exp();
        }
        self.with(sum, truths)
    }

    fn markov(mut self, sigma: f64, tau_s: f64, truths: Vec<Truth>) -> Unit {
        const FINE: usize = 16;
        let fine = self.source.markov(sigma, tau_s, self.dt_s / FINE as f64, FINE * self.values.len());
        let x: Vec<f64> = fine.chunks_exact(FINE).map(|c| c.iter().sum::<f64>() / FINE as f64).collect();
        self.with(x, truths)
    }

    fn periodic(mut self, rms: f64, hz: f64, decay_s: f64, truths: Vec<Truth>) -> Unit {
        let len = self.values.len();
        let (a, b) = (
            self.source.markov(rms, decay_s, self.dt_s, len),
            self.source.markov(rms, decay_s, self.dt_s, len),
        );
        let at = |i: usize| TAU * hz * self.dt_s * i as f64;
        let x = (0..len).map(|i| a[i] * at(i).cos() + b[i] * at(i).sin()).collect();
        self.with(x, truths)
    }

    /// A line whose amplitude after averaging over the interval is `amplitude`.
    fn line(mut self, amplitude: f64, hz: f64, truths: Vec<Truth>) -> Unit {
        let phase = self.source.uniform(0.0, TAU);
        let of = |i: usize| amplitude * (TAU * hz * self.dt_s * i as f64 + phase).sin();
        let x = (0..self.values.len()).map(of).collect();
        self.with(x, truths)
    }

    fn ramp(self, r: f64, truths: Vec<Truth>) -> Unit {
        let middle = 0.5 * self.length_h();
        let x = (0..self.values.len()).map(|i| r * (i as f64 * self.dt_s / 3600.0 - middle)).collect();
        self.with(x, truths)
    }

    /// Angle noise of `q` arcsec: the difference of neighbouring errors of angle.
    fn quantized(mut self, q: f64, truths: Vec<Truth>) -> Unit {
        let errors: Vec<f64> = (0..=self.values.len()).map(|_| q * self.source.normal()).collect();
        let x = errors.windows(2).map(|w| (w[1] - w[0]) / self.dt_s).collect();
        self.with(x, truths)
    }

    /// Puts a bias and the Earth rate on it.
    fn at_rest(mut self, bias: f64, ids: &[&str]) -> Simulated {
        // The site is declared with its uncertainty; the unit stands where it stands.
        let arcsec = PI / 180.0 / 3600.0;
        let (latitude, elevation) = (
            56f64.to_radians() + 10.0 * arcsec * self.source.normal(),
            60f64.to_radians() + 30.0 * arcsec * self.source.normal(),
        );
        // An axis towards north, raised by the elevation.
        let earth = EARTH * (latitude.cos() * elevation.cos() + latitude.sin() * elevation.sin());
        self.values.iter_mut().for_each(|v| *v += bias + earth);
        if ids.contains(&"earth_rate_component") {
            self.truths.push(Truth::new("earth_rate_component", earth));
        }
        self.truths.retain(|t| ids.contains(&t.id));
        Simulated {
            csv: csv("rate_deg_h", &[&self.values]),
            procedure: procedure(self.dt_s, 60.0, ids),
            truths: self.truths,
        }
    }
}

/// What white noise alone makes true.
fn of_white(unit: &Unit, bias: f64) -> Vec<Truth> {
    let samples = unit.values.len() as f64;
    let noise = 1.96 * N / unit.length_h().sqrt();
    let n = 1.96 * N / (2.0 * samples).sqrt();
    vec![
        Truth::new("static_bias", bias).max(bias).oracle(noise),
        Truth::new("angle_random_walk", N).max(N).oracle(n),
        Truth::new("angle_random_walk_white", N).max(N).oracle(n),
        Truth::new("angle_random_walk_readout", N),
        Truth::new("russian_drift_100s", 6.0 * N).max(6.0 * N),
        Truth::new("russian_drift_100s_3sigma", 18.0 * N).max(18.0 * N),
        Truth::new("russian_sigma_10s", 60.0 * N / 10f64.sqrt()),
        Truth::new("russian_arw_10s", N).max(N),
        Truth::new("russian_drift_100s_predicted", 6.0 * N),
        Truth::new("ratio_russian_to_allan_arw", 1.0),
    ]
}

fn slow(b: f64, k: f64, r: f64, q: f64) -> Vec<Truth> {
    vec![
        Truth::new("bias_instability", b),
        Truth::new("rate_random_walk", k),
        Truth::new("rate_ramp", r.abs()),
        Truth::new("quantization", q),
    ]
}

const HOURS_3: usize = 10_800;
const HOURS_10: usize = 36_000;

fn white(seed: u64) -> Simulated {
    let unit = Unit::new(seed, HOURS_3, DT_S);
    let truths = of_white(&unit, 0.0);
    unit.truly(truths).truly(slow(0.0, 0.0, 0.0, 0.0)).at_rest(0.0, IDS)
}

fn shortest(seed: u64) -> Simulated {
    let unit = Unit::new(seed, 1_200, DT_S);
    let mut truths = of_white(&unit, 0.3);
    truths.iter_mut().filter(|t| t.id.starts_with("angle")).for_each(|t| t.oracle = None);
    unit.truly(truths).truly(slow(0.0, 0.0, 0.0, 0.0)).at_rest(0.3, IDS)
}

fn below(seed: u64) -> Simulated {
    let unit = Unit::new(seed, HOURS_3, DT_S);
    let white = of_white(&unit, 0.3);
    let unit = unit
        .truly(white.into_iter().filter(|t| t.id != "static_bias").collect())
        .truly(vec![Truth::new("static_bias", 0.3).max(0.3)])
        .truly(vec![Truth::new("rate_random_walk_readout", 3e-4), Truth::new("quantization_readout", 0.01)])
        .truly(vec![Truth::new("rate_ramp_readout", 1e-5)])
        .truly(vec![Truth::new("line_frequency", 0.123), Truth::new("line_amplitude", 2e-4)])
        .walk(3e-4, slow(5e-4, 3e-4, 1e-5, 0.01))
        .flicker(5e-4, vec![])
        .ramp(1e-5, vec![])
        .quantized(0.01, vec![]);
    unit.line(2e-4, 0.123, vec![]).at_rest(0.3, IDS)
}

/// A walk at the edge of what shows: the mean is moved by it all the same.
fn hidden_walk(seed: u64) -> Simulated {
    let k = 3.0 * N / (HOURS_3 as f64 / 3600.0);
    Unit::new(seed, HOURS_3, DT_S)
        .walk(k, vec![Truth::new("static_bias", 0.3).max(0.3), Truth::new("rate_random_walk", k)])
        .truly(vec![Truth::new("bias_instability", 0.0)])
        .at_rest(0.3, &["static_bias", "rate_random_walk", "bias_instability", "earth_rate_component"])
}

fn flicker(seed: u64) -> Simulated {
    let b = 0.006;
    let truths = vec![
        Truth::new("bias_instability", b).max(b),
        Truth::new("rate_random_walk", 0.0),
        Truth::new("static_bias", 0.3).max(0.3),
        Truth::new("angle_random_walk", N).max(N),
        Truth::new("angle_random_walk_white", N).max(N),
    ];
    let ids: Vec<&str> = truths.iter().map(|t| t.id).collect();
    Unit::new(seed, HOURS_10, DT_S).flicker(b, truths).at_rest(0.3, &ids)
}

fn walk(seed: u64) -> Simulated {
    let k: f64 = 0.02;
    let hours = HOURS_10 as f64 / 3600.0;
    // E[s²] of n adjacent means over τ: N²/τ and K² n τ/6.
    let of = |window_s: f64| {
        let n = (HOURS_10 as f64 / window_s).floor();
        let tau_h = window_s / 3600.0;
        (N * N / tau_h + k * k * tau_h * n / 6.0).sqrt()
    };
    let truths = vec![
        Truth::new("rate_random_walk", k).max(k),
        Truth::new("rate_random_walk_readout", k),
        Truth::new("bias_instability", 0.0),
        Truth::new("static_bias", 0.3).max(0.3).oracle(1.96 * (N * N / hours + k * k * hours / 3.0).sqrt()),
        Truth::new("angle_random_walk", N).max(N),
        Truth::new("angle_random_walk_white", N).max(N),
        Truth::new("angle_random_walk_readout", N),
        Truth::new("russian_drift_100s", of(100.0)),
        Truth::new("russian_drift_100s_3sigma", 3.0 * of(100.0)),
        Truth::new("russian_sigma_10s", of(10.0)),
        Truth::new("russian_arw_10s", 10f64.sqrt() / 60.0 * of(10.0)),
        Truth::new("russian_drift_100s_predicted", of(100.0)),
        Truth::new("ratio_russian_to_allan_arw", 10f64.sqrt() / 60.0 * of(10.0) / N),
        Truth::new("quantization", 0.0),
        Truth::new("rate_ramp", 0.0),
        Truth::new("earth_rate_component", 0.0),
    ];
    let ids: Vec<&str> = truths.iter().map(|t| t.id).collect();
    let truths = truths.into_iter().filter(|t| t.id != "earth_rate_component").collect();
    Unit::new(seed, HOURS_10, DT_S).walk(k, truths).at_rest(0.3, &ids)
}

fn ramp(seed: u64) -> Simulated {
    let r = 0.01;
    let truths = vec![Truth::new("rate_ramp", r), Truth::new("rate_ramp_readout", r)];
    Unit::new(seed, HOURS_10, DT_S).ramp(r, truths).at_rest(0.3, &["rate_ramp", "rate_ramp_readout"])
}

fn quantized(seed: u64) -> Simulated {
    // So large that white noise bends the line of slope −1 by a thousandth.
    let (q, dt_s) = (20.0, 0.01);
    let truths = vec![Truth::new("quantization", q).max(q), Truth::new("quantization_readout", q)];
    Unit::new(seed, 20_000, dt_s).quantized(q, truths).at_rest(0.3, &["quantization", "quantization_readout"])
}

fn line_of(unit: Unit, amplitude: f64, hz: f64) -> Unit {
    let samples = unit.values.len() as f64;
    let sigma = 60.0 * N / unit.dt_s.sqrt();
    let of_amplitude = 1.96 * sigma * (2.0 / samples).sqrt();
    let length_s = samples * unit.dt_s;
    let of_frequency = 1.96 * 6f64.sqrt() / (PI * length_s) * sigma / amplitude / samples.sqrt();
    unit.line(
        amplitude,
        hz,
        vec![
            Truth::new("line_amplitude", amplitude).max(amplitude).oracle(of_amplitude),
            Truth::new("line_frequency", hz).oracle(of_frequency),
        ],
    )
}

fn line(seed: u64) -> Simulated {
    line_of(Unit::new(seed, HOURS_3, DT_S), 0.06, 0.0837).at_rest(0.3, LINE)
}

fn line_beside_flicker(seed: u64) -> Simulated {
    line_of(Unit::new(seed, HOURS_3, DT_S).flicker(0.02, vec![]), 0.06, 0.0837).at_rest(0.3, LINE)
}

fn short_line(seed: u64) -> Simulated {
    line_of(Unit::new(seed, 1_200, DT_S), 0.2, 0.0837).at_rest(0.3, LINE)
}

fn short_process(seed: u64) -> Simulated {
    let (dt_s, sigma, tau_s) = (0.01, 1.0, 0.015);
    let level = (N * N + 2.0 * sigma * sigma * tau_s / 3600.0).sqrt();
    let truths = vec![
        Truth::new("angle_random_walk", level).max(level),
        Truth::new("angle_random_walk_white", N),
        Truth::new("markov_sigma", sigma),
        Truth::new("markov_correlation_time", tau_s),
    ];
    let ids: Vec<&str> = truths.iter().map(|t| t.id).collect();
    Unit::new(seed, 60_000, dt_s).markov(sigma, tau_s, truths).at_rest(0.3, &ids)
}

fn process(unit: Unit) -> Simulated {
    let (sigma, tau_s) = (0.02, 100.0);
    let truths = vec![Truth::new("markov_sigma", sigma), Truth::new("markov_correlation_time", tau_s)];
    unit.markov(sigma, tau_s, truths).at_rest(0.3, MARKOV)
}

fn process_alone(seed: u64) -> Simulated {
    process(Unit::new(seed, HOURS_10, DT_S))
}

fn process_beside_walk(seed: u64) -> Simulated {
    process(Unit::new(seed, HOURS_10, DT_S).walk(0.05, vec![]))
}

fn periodic(unit: Unit) -> Simulated {
    let (rms, hz, decay_s) = (0.06, 0.08, 60.0);
    let truths = vec![
        Truth::new("quasi_periodic_amplitude", rms),
        Truth::new("quasi_periodic_frequency", hz),
        Truth::new("quasi_periodic_coherence_time", decay_s),
    ];
    unit.periodic(rms, hz, decay_s, truths).at_rest(0.3, PERIODIC)
}

fn periodic_alone(seed: u64) -> Simulated {
    periodic(Unit::new(seed, HOURS_10, DT_S))
}

fn periodic_beside_flicker(seed: u64) -> Simulated {
    periodic(Unit::new(seed, HOURS_10, DT_S).flicker(0.02, vec![]))
}

const fn case(
    name: &'static str,
    edges: &'static [Edge],
    ids: &'static [&'static str],
    draw: fn(u64) -> Simulated,
) -> Case {
    Case { name, edges, ids, records: 100, draw }
}

/// Measurands with a truth in white noise.
pub const OF_WHITE: &[&str] = &[
    "static_bias",
    "earth_rate_component",
    "angle_random_walk",
    "angle_random_walk_white",
    "angle_random_walk_readout",
    "russian_drift_100s",
    "russian_drift_100s_3sigma",
    "russian_sigma_10s",
    "russian_arw_10s",
    "russian_drift_100s_predicted",
    "ratio_russian_to_allan_arw",
    "bias_instability",
    "rate_random_walk",
    "rate_ramp",
    "quantization",
];
/// Measurands with a truth where everything else is too weak to be seen.
pub const OF_BELOW: &[&str] = &[
    "static_bias",
    "bias_instability",
    "rate_random_walk",
    "rate_ramp",
    "quantization",
    "rate_random_walk_readout",
    "rate_ramp_readout",
    "quantization_readout",
    "line_frequency",
    "line_amplitude",
];
const OF_WALK: &[&str] = &[
    "static_bias",
    "earth_rate_component",
    "angle_random_walk",
    "angle_random_walk_white",
    "angle_random_walk_readout",
    "russian_drift_100s",
    "russian_drift_100s_3sigma",
    "russian_sigma_10s",
    "russian_arw_10s",
    "russian_drift_100s_predicted",
    "ratio_russian_to_allan_arw",
    "bias_instability",
    "rate_ramp",
    "quantization",
];

/// The family.
pub static FAMILY: Family = Family {
    name: "noise",
    ids: IDS,
    cases: &[
        case("white noise, bias zero", &[Edge::Zero, Edge::Alone], OF_WHITE, white),
        case("20 min of white noise", &[Edge::Shortest], OF_WHITE, shortest),
        case("everything else too weak to be seen", &[Edge::BelowNoise], OF_BELOW, below),
        case(
            "a walk at the edge of what shows",
            &[Edge::BelowNoise],
            &["static_bias", "rate_random_walk", "bias_instability"],
            hidden_walk,
        ),
        case(
            "flicker beside white noise",
            &[Edge::Alone, Edge::BesideLarge],
            &["bias_instability", "rate_random_walk", "static_bias", "angle_random_walk"],
            flicker,
        ),
        case("beside a random walk", &[Edge::BesideLarge], OF_WALK, walk),
        case("a random walk", &[Edge::Alone], &["rate_random_walk", "rate_random_walk_readout"], walk),
        case("a ramp", &[Edge::Alone], &["rate_ramp", "rate_ramp_readout"], ramp),
        case("quantisation", &[Edge::Alone], &["quantization", "quantization_readout"], quantized),
        case("a line", &[Edge::Alone], LINE, line),
        case("a line beside flicker", &[Edge::BesideLarge], LINE, line_beside_flicker),
        case("a line in 20 min", &[Edge::Shortest], LINE, short_line),
        case(
            "a process of one and a half samples",
            &[Edge::BesideLarge],
            &["angle_random_walk", "angle_random_walk_white", "markov_sigma", "markov_correlation_time"],
            short_process,
        ),
        case("a process of 100 s", &[Edge::Alone], MARKOV, process_alone),
        case("a process of 100 s beside a walk", &[Edge::BesideLarge], MARKOV, process_beside_walk),
        case("a disturbance", &[Edge::Alone], PERIODIC, periodic_alone),
        case("a disturbance beside flicker", &[Edge::BesideLarge], PERIODIC, periodic_beside_flicker),
    ],
    exempt: &[
        Exemption {
            edges: &[Edge::Grid, Edge::Nuisance, Edge::Coarsest],
            ids: IDS,
            reason: "a record at rest has no schedule and no stimulus",
        },
        Exemption {
            edges: &[Edge::Zero, Edge::BelowNoise],
            ids: WHITE,
            reason: "every record has noise, and nothing lies below it",
        },
        Exemption {
            edges: &[Edge::Zero, Edge::BelowNoise],
            ids: &["earth_rate_component"],
            reason: "computed from the site and not from the record",
        },
        Exemption {
            edges: &[Edge::Zero],
            ids: LINE,
            reason: "what is not there has no frequency; false lines are counted in the tests of the search",
        },
        Exemption {
            edges: &[Edge::Zero, Edge::BelowNoise, Edge::Shortest],
            ids: MARKOV,
            reason: "what does not show is not stated; false claims are counted in the identification study",
        },
        Exemption {
            edges: &[Edge::Zero, Edge::BelowNoise, Edge::Shortest],
            ids: PERIODIC,
            reason: "what does not show is not stated; false claims are counted in the identification study",
        },
        Exemption {
            edges: &[Edge::Zero, Edge::Shortest, Edge::BesideLarge],
            ids: READ,
            reason: "a line is read only where the curve has its slope; beside other terms it is too high by its meaning",
        },
        Exemption {
            edges: &[Edge::Zero, Edge::BelowNoise, Edge::Alone, Edge::BesideLarge, Edge::Shortest],
            ids: MINIMUM,
            reason: "the least value of a noisy curve is biased by its meaning, and no truth of the unit",
        },
    ],
};
