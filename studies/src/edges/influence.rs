//! Influences and repeatability at their edges: nothing at all, below the noise, beside drifts, with a temperature that goes
//! with the levels or the order of the runs, and the shortest tests that `check` accepts.

use super::case::{Case, Edge, Exemption, Family, Simulated, Truth};
use crate::noise_source::{NoiseSource, add, csv};

/// deg/sqrt(h)
const N: f64 = 0.002;

/// What is changed on purpose.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Field,
    Supply,
    Shaker,
}

/// A comparison with intervals in turns.
struct Turns {
    kind: Kind,
    /// Levels without the reference, one an interval between two without.
    levels: &'static [f64],
    interval_s: f64,
    /// Change of the bias per drive.
    per_unit: f64,
    /// deg/h over the test.
    drift: f64,
    /// Flicker, deg/h.
    flicker: f64,
    /// Growth of N per unit of the level.
    louder: f64,
    /// degC per unit of the level, and deg/h/degC.
    warms: (f64, f64),
    /// Coefficient that the procedure allows for, deg/h/degC.
    allowed: Option<f64>,
    /// Limit on the magnitude of the sensitivity, and on the change of N.
    limits: (Option<f64>, Option<f64>),
}

impl Turns {
    const fn of(kind: Kind) -> Turns {
        Turns {
            kind,
            levels: match kind {
                Kind::Shaker => &[2.0, 4.0, 2.0, 4.0],
                _ => &[0.5, -0.5, 0.5, -0.5],
            },
            interval_s: 75.0,
            per_unit: 0.0,
            drift: 0.05,
            flicker: 0.0,
            louder: 0.0,
            warms: (0.0, 0.0),
            allowed: None,
            limits: (None, None),
        }
    }

    fn ids(&self) -> (&'static str, &'static str, &'static str, &'static str, f64, &'static str) {
        match self.kind {
            Kind::Field => ("magnetic_sensitivity", "magnetic_test", "magnetic_field", "mT", 0.0, "deg/h/mT"),
            Kind::Supply => ("supply_sensitivity", "supply_test", "supply", "V", 5.0, "deg/h/V"),
            Kind::Shaker => ("vibration_sensitivity", "vibration_test", "vibration", "g", 0.0, "deg/h/g^2"),
        }
    }

    fn drive(&self, level: f64) -> f64 {
        if self.kind == Kind::Shaker { level * level } else { level }
    }

    fn simulated(&self, seed: u64) -> Simulated {
        let mut source = NoiseSource::new(seed);
        let dt = if self.kind == Kind::Shaker { 0.2 } else { 1.0 };
        let each = (self.interval_s / dt).round() as usize;
        let count = each * (2 * self.levels.len() + 1);
        let (id, table, role, unit, reference, _) = self.ids();
        let level = |i: usize| {
            let interval = i / each;
            if interval % 2 == 1 { self.levels[interval / 2] } else { 0.0 }
        };
        let mut rate = source.white(N, dt, count);
        for (i, r) in rate.iter_mut().enumerate() {
            *r *= 1.0 + self.louder * level(i).abs();
        }
        if self.flicker > 0.0 {
            add(&mut rate, &source.flicker(self.flicker, dt, count));
        }
        let temperature: Vec<f64> =
            (0..count).map(|i| 20.0 + self.warms.0 * level(i) + 0.003 * source.normal()).collect();
        for (i, r) in rate.iter_mut().enumerate() {
            *r += 12.5
                + self.drift * i as f64 / count as f64
                + self.per_unit * self.drive(level(i))
                + self.warms.1 * self.warms.0 * level(i);
        }
        let time: Vec<f64> = (0..count).map(|i| i as f64 * dt).collect();
        let told: Vec<f64> = (0..count).map(|i| reference + level(i)).collect();
        // White noise and a line, the mean and the drift free: what an oracle of the noise is left with.
        let drives: Vec<f64> = (0..count).map(|i| self.drive(level(i))).collect();
        let half = 1.96 * 60.0 * N / dt.sqrt() / free(&drives).sqrt();
        let sensitivity = Truth::new(id, self.per_unit);
        let mut truths = vec![match self.limits.0 {
            Some(limit) => sensitivity.max_abs(limit),
            None => sensitivity,
        }];
        if self.louder == 0.0 && self.flicker == 0.0 && self.allowed.is_none() {
            truths[0] = truths[0].clone().oracle(half);
        }
        let mut seen: Vec<f64> = vec![];
        for l in self.levels {
            if seen.contains(l) {
                continue;
            }
            seen.push(*l);
            let name: &'static str = match (self.kind, *l) {
                (Kind::Supply, l) if l > 0.0 => "rate@5.5",
                (Kind::Supply, _) => "rate@4.5",
                (Kind::Field, l) if l > 0.0 => "rate@0.5",
                (Kind::Field, _) => "rate@-0.5",
                (Kind::Shaker, l) if l > 3.0 => "rate@4",
                (Kind::Shaker, _) => "rate@2",
            };
            truths.push(Truth::new("bias_shift", self.per_unit * self.drive(*l)).on(name));
            if self.kind == Kind::Shaker {
                truths.push(Truth::new("angle_random_walk_shift", N * self.louder * l).on(name));
            }
        }
        if let (Some(limit), [.., last]) = (self.limits.1, truths.as_mut_slice()) {
            *last = last.clone().max(limit);
        }
        let more =
            if self.kind == Kind::Shaker { "[[measurand]]\nid = \"angle_random_walk_shift\"\n" } else { "" };
        let allowed =
            self.allowed.map_or(String::new(), |a| format!("temperature_coefficient = \"{a} deg/h/degC\"\n"));
        let own = format!(
            "[[channel]]\nid = \"level\"\ncolumn = \"level\"\nrole = \"{role}\"\nunit = \"{unit}\"\n\
             [{table}]\nreference = \"{reference} {unit}\"\nsettling = \"0 s\"\nminimum_interval = \"20 s\"\n\
             alternations = 1\n{allowed}[[measurand]]\nid = \"{id}\"\n[[measurand]]\nid = \"bias_shift\"\n{more}"
        );
        Simulated {
            csv: csv("time_s,rate_deg_h,temp_degC,level", &[&time, &rate, &temperature, &told]),
            procedure: procedure(&own),
            truths,
        }
    }
}

/// Sum of squares of a course that a constant and a line leave.
fn free(course: &[f64]) -> f64 {
    let n = course.len() as f64;
    let mean = course.iter().sum::<f64>() / n;
    let t = |i: usize| i as f64 - 0.5 * (n - 1.0);
    let (mut tt, mut tx, mut xx) = (0.0, 0.0, 0.0);
    for (i, x) in course.iter().enumerate() {
        tt += t(i) * t(i);
        tx += t(i) * (x - mean);
        xx += (x - mean).powi(2);
    }
    xx - tx * tx / tt
}

fn procedure(own: &str) -> String {
    format!(
        "format = \"procedure/1\"\n[procedure]\nid = \"edges-influence\"\ntitle = \"Edges\"\nrevision = \"A\"\n\
         [[channel]]\nid = \"time\"\ncolumn = \"time_s\"\nrole = \"time\"\nunit = \"s\"\n\
         [[channel]]\nid = \"rate\"\ncolumn = \"rate_deg_h\"\nrole = \"rate\"\nunit = \"deg/h\"\n\
         [[channel]]\nid = \"temp\"\ncolumn = \"temp_degC\"\nrole = \"temperature\"\nunit = \"degC\"\n{own}"
    )
}

/// A series of switching off and on.
struct Series {
    runs: usize,
    run_s: f64,
    /// Standard deviation between runs, deg/h.
    between: f64,
    /// deg/h from the first to the last.
    trend: f64,
    /// deg/h/degC.
    per_deg_c: f64,
    /// degC: from the first run to the last, and at random.
    warms: (f64, f64),
    /// True: the limits stand at the truths of the spread and of the range.
    at_limits: bool,
}

impl Series {
    const NONE: Series = Series {
        runs: 8,
        run_s: 150.0,
        between: 0.0,
        trend: 0.0,
        per_deg_c: 0.0,
        warms: (0.0, 0.3),
        at_limits: false,
    };

    fn simulated(&self, seed: u64) -> Simulated {
        let mut source = NoiseSource::new(seed);
        let each = self.run_s as usize;
        let mut columns = [vec![], vec![], vec![]];
        let mut biases = vec![];
        for run in 0..self.runs {
            let share = run as f64 / (self.runs - 1) as f64;
            let warm = self.warms.0 * share + self.warms.1 * source.normal();
            let bias = self.between * source.normal() + self.trend * share + self.per_deg_c * warm;
            biases.push(bias);
            let white = source.white(N, 1.0, each);
            for (i, w) in white.iter().enumerate() {
                columns[0].push(run as f64 * 1800.0 + i as f64);
                columns[1].push(12.5 + bias + w);
                columns[2].push(20.0 + warm + 0.003 * source.normal());
            }
        }
        let range = biases.iter().fold(f64::NEG_INFINITY, |m: f64, b| m.max(*b))
            - biases.iter().fold(f64::INFINITY, |m: f64, b| m.min(*b));
        let wide = Truth::new("bias_repeatability_peak_to_peak", range);
        let mut truths = vec![if self.at_limits { wide.max(range) } else { wide }];
        if self.trend == 0.0 && self.per_deg_c == 0.0 {
            let spread = Truth::new("bias_repeatability", self.between);
            truths.push(if self.at_limits { spread.max(self.between) } else { spread });
        }
        truths.push(Truth::new("bias_repeatability_trend", self.trend));
        truths.push(Truth::new("bias_repeatability_temperature", self.per_deg_c));
        let own = "[repeatability_test]\nsettling = \"0 s\"\nminimum_run = \"30 s\"\noff = \"5 min\"\nruns = 2\n\
             [[measurand]]\nid = \"bias_repeatability\"\n[[measurand]]\nid = \"bias_repeatability_peak_to_peak\"\n\
             [[measurand]]\nid = \"bias_repeatability_trend\"\n[[measurand]]\nid = \"bias_repeatability_temperature\"\n";
        let [time, rate, temperature] = &columns;
        Simulated {
            csv: csv("time_s,rate_deg_h,temp_degC", &[time, rate, temperature]),
            procedure: procedure(own),
            truths,
        }
    }
}

const FIELD: &[&str] = &["magnetic_sensitivity", "bias_shift"];
const SUPPLY: &[&str] = &["supply_sensitivity", "bias_shift"];
const SHAKER: &[&str] = &["vibration_sensitivity", "bias_shift", "angle_random_walk_shift"];
const RUNS: &[&str] = &[
    "bias_repeatability",
    "bias_repeatability_peak_to_peak",
    "bias_repeatability_trend",
    "bias_repeatability_temperature",
];
const COURSES: &[&str] =
    &["bias_repeatability_peak_to_peak", "bias_repeatability_trend", "bias_repeatability_temperature"];

const fn case(
    name: &'static str,
    edges: &'static [Edge],
    ids: &'static [&'static str],
    draw: fn(u64) -> Simulated,
) -> Case {
    Case { name, edges, ids, records: 100, draw }
}

/// Influences and repeatability.
pub static FAMILY: Family = Family {
    name: "influence",
    ids: &[
        "magnetic_sensitivity",
        "supply_sensitivity",
        "vibration_sensitivity",
        "bias_shift",
        "angle_random_walk_shift",
        "bias_repeatability",
        "bias_repeatability_peak_to_peak",
        "bias_repeatability_trend",
        "bias_repeatability_temperature",
    ],
    cases: &[
        case("field without effect", &[Edge::Zero], FIELD, |s| {
            Turns { limits: (Some(0.1), None), drift: 0.0, ..Turns::of(Kind::Field) }.simulated(s)
        }),
        case("supply without effect", &[Edge::Zero], SUPPLY, |s| {
            Turns { limits: (Some(0.1), None), drift: 0.0, ..Turns::of(Kind::Supply) }.simulated(s)
        }),
        case("shaker without effect", &[Edge::Zero], SHAKER, |s| {
            Turns { limits: (Some(0.1), Some(0.001)), drift: 0.0, ..Turns::of(Kind::Shaker) }.simulated(s)
        }),
        case("field, effect below the noise", &[Edge::BelowNoise], FIELD, |s| {
            Turns { per_unit: 0.005, ..Turns::of(Kind::Field) }.simulated(s)
        }),
        case("supply, effect below the noise", &[Edge::BelowNoise], SUPPLY, |s| {
            Turns { per_unit: -0.005, ..Turns::of(Kind::Supply) }.simulated(s)
        }),
        case("shaker, effects below the noise", &[Edge::BelowNoise], SHAKER, |s| {
            Turns { per_unit: 0.0002, louder: 0.005, ..Turns::of(Kind::Shaker) }.simulated(s)
        }),
        case("field, exactly at the limit", &[Edge::Alone, Edge::Grid], FIELD, |s| {
            Turns { per_unit: 0.2, limits: (Some(0.2), None), ..Turns::of(Kind::Field) }.simulated(s)
        }),
        case("supply, exactly at the limit", &[Edge::Alone, Edge::Grid], SUPPLY, |s| {
            Turns { per_unit: -0.2, limits: (Some(0.2), None), ..Turns::of(Kind::Supply) }.simulated(s)
        }),
        case("shaker, exactly at the limits", &[Edge::Alone, Edge::Grid], SHAKER, |s| {
            Turns {
                per_unit: 0.005,
                louder: 0.1,
                limits: (Some(0.005), Some(0.0008)),
                ..Turns::of(Kind::Shaker)
            }
            .simulated(s)
        }),
        case("field without effect, beside a drift and flicker", &[Edge::BesideLarge], FIELD, |s| {
            Turns { drift: 2.0, flicker: 0.01, limits: (Some(0.1), None), ..Turns::of(Kind::Field) }
                .simulated(s)
        }),
        case("supply without effect, beside a drift and flicker", &[Edge::BesideLarge], SUPPLY, |s| {
            Turns { drift: -2.0, flicker: 0.01, limits: (Some(0.1), None), ..Turns::of(Kind::Supply) }
                .simulated(s)
        }),
        case("shaker: a large bias beside no noise, beside a drift", &[Edge::BesideLarge], SHAKER, |s| {
            Turns { per_unit: 0.05, drift: 1.0, ..Turns::of(Kind::Shaker) }.simulated(s)
        }),
        case("field without effect, temperature in step with it", &[Edge::Nuisance], FIELD, |s| {
            Turns { warms: (8.0, 0.05), limits: (Some(0.1), None), ..Turns::of(Kind::Field) }.simulated(s)
        }),
        case("supply without effect, temperature in step with it", &[Edge::Nuisance], SUPPLY, |s| {
            Turns { warms: (8.0, 0.05), limits: (Some(0.1), None), ..Turns::of(Kind::Supply) }.simulated(s)
        }),
        case("supply, a little temperature in step that is allowed for", &[Edge::Nuisance], SUPPLY, |s| {
            Turns {
                warms: (0.25, 0.05),
                allowed: Some(0.05),
                limits: (Some(0.1), None),
                ..Turns::of(Kind::Supply)
            }
            .simulated(s)
        }),
        case("shaker without effect, temperature in step with it", &[Edge::Nuisance], SHAKER, |s| {
            Turns { warms: (1.0, 0.05), limits: (Some(0.005), None), ..Turns::of(Kind::Shaker) }.simulated(s)
        }),
        case("field, once with and twice without", &[Edge::Shortest, Edge::Coarsest], FIELD, |s| {
            Turns { levels: &[0.5], per_unit: 0.2, interval_s: 40.0, ..Turns::of(Kind::Field) }.simulated(s)
        }),
        case("supply, once with and twice without", &[Edge::Shortest, Edge::Coarsest], SUPPLY, |s| {
            Turns { levels: &[0.5], per_unit: 0.2, interval_s: 40.0, ..Turns::of(Kind::Supply) }.simulated(s)
        }),
        case("shaker, once with and twice without", &[Edge::Shortest, Edge::Coarsest], SHAKER, |s| {
            Turns { levels: &[4.0], per_unit: 0.005, interval_s: 40.0, ..Turns::of(Kind::Shaker) }
                .simulated(s)
        }),
        case("runs exactly equal", &[Edge::Zero], RUNS, |s| Series::NONE.simulated(s)),
        case("runs that differ by less than their noise", &[Edge::BelowNoise], RUNS, |s| {
            Series { between: 0.003, ..Series::NONE }.simulated(s)
        }),
        case("runs exactly at the limits", &[Edge::Alone, Edge::Grid], RUNS, |s| {
            Series { between: 0.03, at_limits: true, ..Series::NONE }.simulated(s)
        }),
        case("runs with a trend alone", &[Edge::Alone], COURSES, |s| {
            Series { between: 0.01, trend: 0.2, ..Series::NONE }.simulated(s)
        }),
        case("runs with a temperature alone", &[Edge::Alone], COURSES, |s| {
            Series { between: 0.01, per_deg_c: 0.2, ..Series::NONE }.simulated(s)
        }),
        case("equal runs beside a large trend and temperature", &[Edge::BesideLarge], COURSES, |s| {
            Series { trend: 1.0, per_deg_c: 1.0, ..Series::NONE }.simulated(s)
        }),
        case("a temperature in step with the order of the runs", &[Edge::Nuisance], COURSES, |s| {
            Series { between: 0.01, per_deg_c: 0.1, warms: (1.0, 0.05), ..Series::NONE }.simulated(s)
        }),
        case("two runs", &[Edge::Shortest, Edge::Coarsest], RUNS, |s| {
            Series { runs: 2, run_s: 60.0, between: 0.05, ..Series::NONE }.simulated(s)
        }),
    ],
    exempt: &[Exemption {
        edges: &[Edge::BesideLarge, Edge::Nuisance],
        ids: &["bias_repeatability"],
        reason: "what a trend or the temperature does between runs is part of their spread by its definition",
    }],
};

/// A supply whose temperature follows the voltage by 8 °C per V, and with it the bias.
pub fn temperature_in_step(seed: u64) -> Simulated {
    Turns { warms: (8.0, 0.05), limits: (Some(0.1), None), ..Turns::of(Kind::Supply) }.simulated(seed)
}
