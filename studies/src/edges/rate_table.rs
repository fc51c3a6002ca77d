//! Scale factor and what belongs to it, from rates of a table that are known exactly.
//!
//! The output of every step is a polynomial of its rate with its own terms beside; the truths are sums over the same rates,
//! with equal weights.

use super::case::{Case, Edge, Exemption, Family, Simulated, Truth};
use super::on_table::{Column, column, procedure};
use crate::noise_source::{NoiseSource, csv};

/// Full scale, deg/h.
const FULL: f64 = 360_000.0;

/// Samples a second, and seconds at one rate.
const HZ: usize = 4;
const DWELL: usize = 26;
const SETTLING: usize = 2;

#[derive(Clone)]
struct Unit {
    /// Rates gone through in one cycle, deg/s, and cycles.
    rates: Vec<f64>,
    cycles: usize,
    error_ppm: f64,
    odd_ppm: f64,
    even_ppm: f64,
    asymmetry_ppm: f64,
    hysteresis_ppm: f64,
    per_degree_ppm: f64,
    harmonics: [f64; 2],
    cycle_ppm: f64,
    n: f64,
    drift: f64,
    /// Temperature follows the square of the rate, by so many degrees at full scale, late by a minute.
    heated: f64,
}

impl Unit {
    fn perfect() -> Unit {
        let up = [-100.0, -60.0, -30.0, -10.0, -2.0, 0.0, 2.0, 10.0, 30.0, 60.0, 100.0];
        let rates = up.iter().chain(up.iter().rev().skip(1).take(9)).copied().collect();
        Unit {
            rates,
            cycles: 3,
            error_ppm: 0.0,
            odd_ppm: 0.0,
            even_ppm: 0.0,
            asymmetry_ppm: 0.0,
            hysteresis_ppm: 0.0,
            per_degree_ppm: 0.0,
            harmonics: [0.0; 2],
            cycle_ppm: 0.0,
            n: 0.02,
            drift: 0.0,
            heated: 0.0,
        }
    }

    /// Output at a rate in deg/h, all but what changes with time.
    fn of(&self, x: f64) -> f64 {
        let u = x / FULL;
        let bent = 1e-6 * FULL * (self.odd_ppm * u.powi(3) + self.even_ppm * u * u);
        x * (1.0 + 1e-6 * self.error_ppm) + bent + 0.5e-6 * self.asymmetry_ppm * x.abs()
    }

    fn levels(&self) -> Vec<f64> {
        let mut levels: Vec<f64> = self.rates.iter().map(|r| 3600.0 * r).collect();
        levels.sort_by(f64::total_cmp);
        levels.dedup();
        levels
    }

    fn of_step(&self) -> f64 {
        60.0 * self.n / ((DWELL - SETTLING) as f64).sqrt()
    }

    /// Slope of the line of least squares through the levels, and what it leaves of each.
    fn line(&self) -> (f64, Vec<f64>) {
        let x = self.levels();
        let n = x.len() as f64;
        let y: Vec<f64> = x.iter().map(|x| self.of(*x)).collect();
        let (mx, my) = (x.iter().sum::<f64>() / n, y.iter().sum::<f64>() / n);
        let sxx: f64 = x.iter().map(|x| (x - mx).powi(2)).sum();
        let slope = x.iter().zip(&y).map(|(x, y)| (x - mx) * (y - my)).sum::<f64>() / sxx;
        let left = x.iter().zip(&y).map(|(x, y)| y - my - slope * (x - mx)).collect();
        (slope, left)
    }

    fn truths(&self) -> Vec<Truth> {
        let (slope, left) = self.line();
        let ppm = 1e6 / slope;
        let largest = left.iter().fold(0.0, |m: f64, r| m.max(r.abs()));
        let of_rate = self.levels().into_iter().zip(&left).filter(|(x, _)| x.abs() >= 0.0999 * FULL);
        let of_rate = of_rate.fold(0.0, |m: f64, (x, r)| m.max((r / x).abs()));
        let rms = (left.iter().map(|r| r * r).sum::<f64>() / left.len() as f64).sqrt();
        let x: Vec<f64> = self.rates.iter().map(|r| 3600.0 * r).collect();
        let square: f64 = x.iter().map(|x| x * x).sum();
        // One or two cycles leave few degrees of freedom: Student's interval is wide by what the noise is not known to,
        // and its width says nothing of what is lost.
        let told = (self.cycles > 2).then(|| 1.96e6 * self.of_step() / self.left_of_rates().sqrt());
        let of_cycle = 1e6 * self.of_step() / square.sqrt();
        vec![
            Truth { oracle: told.map(|t| 1e-6 * t), ..Truth::new("scale_factor", slope).min(slope) },
            Truth { oracle: told, ..Truth::new("scale_factor_error", 1e6 * (slope - 1.0)) },
            Truth::new("scale_factor_nonlinearity", largest * ppm / FULL).max(largest * ppm / FULL),
            Truth::new("scale_factor_nonlinearity_of_rate", of_rate * ppm).max(of_rate * ppm),
            Truth::new("scale_factor_residual", rms * ppm / FULL).max(rms * ppm / FULL),
            Truth::new("scale_factor_asymmetry", (self.asymmetry_ppm) / slope),
            Truth::new("scale_factor_odd", self.odd_ppm / slope),
            Truth::new("scale_factor_even", self.even_ppm / slope),
            Truth::new("scale_factor_repeatability", of_cycle.hypot(self.cycle_ppm)),
            Truth::new("scale_factor_hysteresis", self.hysteresis_ppm / slope)
                .max_abs((self.hysteresis_ppm / slope).abs()),
            Truth::new("scale_factor_temperature_sensitivity", self.per_degree_ppm / slope)
                .max_abs((self.per_degree_ppm / slope).abs()),
            Truth::new("table_harmonic_1", self.harmonics[0]).max(self.harmonics[0]),
            Truth::new("table_harmonic_2", self.harmonics[1]).max(self.harmonics[1]),
        ]
    }

    /// Square sum of the rates of all steps without what a bias takes of them, and a drift along a line or a sensitivity to
    /// the temperature that follows the rates, where there is one: these are fitted too by one who knows the noise.
    fn left_of_rates(&self) -> f64 {
        let steps: Vec<f64> = (0..self.cycles).flat_map(|_| self.rates.iter().map(|r| 3600.0 * r)).collect();
        let mut others: Vec<Vec<f64>> = vec![vec![1.0; steps.len()]];
        if self.drift != 0.0 {
            others.push((0..steps.len()).map(|i| i as f64).collect());
        }
        if self.heated != 0.0 {
            // Mean over a step of what follows the square of the rate late by a minute.
            let (mut warm, late) = (0.0, 60.0 / DWELL as f64 * (1.0 - (-(DWELL as f64) / 60.0).exp()));
            let column = steps.iter().map(|x| {
                let target = (x / FULL).powi(2);
                let mean = target + (warm - target) * late;
                warm = target + (warm - target) * (-(DWELL as f64) / 60.0).exp();
                x * mean
            });
            others.push(column.collect());
        }
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let mut basis: Vec<Vec<f64>> = Vec::new();
        let without = |mut v: Vec<f64>, basis: &[Vec<f64>]| {
            for b in basis {
                let share = dot(&v, b) / dot(b, b);
                v.iter_mut().zip(b).for_each(|(v, b)| *v -= share * b);
            }
            v
        };
        for column in others {
            basis.push(without(column, &basis));
        }
        let left = without(steps, &basis);
        dot(&left, &left)
    }

    fn of_ids(&self, ids: &[&str]) -> Vec<Truth> {
        // No unit can meet a limit of nothing, and none is written.
        let meant = |t: Truth| match &t.limit {
            Some(limit) if limit.value < 1e-9 => Truth { limit: None, ..t },
            _ => t,
        };
        self.truths().into_iter().filter(|t| ids.contains(&t.id)).map(meant).collect()
    }

    fn simulated(&self, seed: u64, ids: &[&str]) -> Simulated {
        let mut source = NoiseSource::new(seed);
        let dt = 1.0 / HZ as f64;
        let each = DWELL * HZ;
        let steps: Vec<f64> = (0..self.cycles).flat_map(|_| self.rates.iter().map(|r| 3600.0 * r)).collect();
        let rows = steps.len() * each;
        let white = source.white(self.n, dt, rows);
        let of_cycle: Vec<f64> = (0..self.cycles).map(|_| self.cycle_ppm * source.normal()).collect();
        let mut columns: [Vec<f64>; 5] = Default::default();
        let (mut angle, mut warm) = (12.0f64, 0.0f64);
        for (row, noise) in white.iter().enumerate() {
            let step = row / each;
            let (x, before) = (steps[step], if step == 0 { f64::NAN } else { steps[step - 1] });
            let share = row as f64 / rows as f64;
            warm += (self.heated * (x / FULL).powi(2) - warm) * dt / 60.0;
            let off = if self.heated > 0.0 { warm } else { 1.7 * (9.0 * share).sin() + 0.9 * share };
            // About the mean of the test, near enough: what is left moves the scale factor by far less than the noise.
            let cold = if self.heated > 0.0 { 0.0 } else { 0.9 * 0.5 + 1.7 * (1.0 - 9f64.cos()) / 9.0 };
            let approach = if before < x {
                0.5
            } else if before > x {
                -0.5
            } else {
                0.0
            };
            let psi = (angle + 0.5 * x / 3600.0 * dt).to_radians();
            let y = self.of(x)
                + 1e-6 * x * (self.per_degree_ppm * (off - cold) + of_cycle[step / self.rates.len()])
                + 1e-6 * FULL * self.hysteresis_ppm * approach
                + self.harmonics[0] * (psi - 0.7).cos()
                + self.harmonics[1] * (2.0 * psi + 0.3).cos()
                + 2.0
                + self.drift * share
                + noise;
            let values = [row as f64 * dt, y, x / 3600.0, angle.rem_euclid(360.0), 22.0 + off];
            for (column, value) in columns.iter_mut().zip(values) {
                column.push(value);
            }
            angle += x / 3600.0 * dt;
        }
        let [time, output, table, read, temperature] = &columns;
        Simulated {
            csv: csv(
                "time_s,rate_deg_h,table_rate_deg_s,table_angle_deg,temp_degC",
                &[time, output, table, read, temperature],
            ),
            procedure: rates(LINE, "of_rate_from = \"10 deg/s\""),
            truths: self.of_ids(ids),
        }
    }
}

const COLUMNS: [Column; 4] = [
    column("rate", "rate_deg_h", "rate", "deg/h"),
    column("table", "table_rate_deg_s", "table_rate", "deg/s"),
    column("angle", "table_angle_deg", "table_angle", "deg"),
    column("temp", "temp_degC", "temperature", "degC"),
];

fn rates(ids: &[&str], table: &str) -> String {
    let sections = format!(
        "[rate_table]\nsettling = \"2 s\"\nminimum_step = \"15 s\"\nwhole_turns = false\nfull_scale = \"100 deg/s\"\n\
         {table}\n[conditions]\nminimum_duration = \"1 min\""
    );
    procedure("Rates", &COLUMNS, &sections, ids)
}

const LINE: &[&str] = &[
    "scale_factor",
    "scale_factor_error",
    "scale_factor_nonlinearity",
    "scale_factor_nonlinearity_of_rate",
    "scale_factor_residual",
    "scale_factor_asymmetry",
    "scale_factor_odd",
    "scale_factor_even",
    "scale_factor_repeatability",
    "scale_factor_hysteresis",
    "scale_factor_temperature_sensitivity",
    "table_harmonic_1",
    "table_harmonic_2",
];

/// All of [`LINE`] but the asymmetry, which a bent response has by its definition.
const LINE_WITHOUT_SIDES: &[&str] = &[
    "scale_factor",
    "scale_factor_error",
    "scale_factor_nonlinearity",
    "scale_factor_nonlinearity_of_rate",
    "scale_factor_residual",
    "scale_factor_odd",
    "scale_factor_even",
    "scale_factor_repeatability",
    "scale_factor_hysteresis",
    "scale_factor_temperature_sensitivity",
    "table_harmonic_1",
    "table_harmonic_2",
];

/// All that a unit with a bent response and no asymmetry of its own shows: the first seven.
const BENT: &[&str] = LINE_WITHOUT_SIDES.split_at(7).0;

/// What differs between cycles, temperatures and angles of the table: the others.
const SLOW: &[&str] = LINE_WITHOUT_SIDES.split_at(7).1;

fn perfect(seed: u64) -> Simulated {
    Unit::perfect().simulated(seed, LINE)
}

fn bent(seed: u64) -> Simulated {
    let unit = Unit { error_ppm: 80.0, odd_ppm: 30.0, even_ppm: -6.0, ..Unit::perfect() };
    unit.simulated(seed, BENT)
}

fn one_sided(seed: u64) -> Simulated {
    Unit { asymmetry_ppm: 12.0, ..Unit::perfect() }.simulated(seed, &["scale_factor_asymmetry"])
}

fn slow(seed: u64) -> Simulated {
    let unit = Unit { hysteresis_ppm: 3.0, per_degree_ppm: 8.0, harmonics: [0.5, 0.3], ..Unit::perfect() };
    unit.simulated(seed, SLOW)
}

fn scattered(seed: u64) -> Simulated {
    let rates = Unit::perfect().rates;
    let unit = Unit { cycle_ppm: 5.0, cycles: 4, rates, ..Unit::perfect() };
    unit.simulated(seed, &["scale_factor_repeatability"])
}

fn small(seed: u64) -> Simulated {
    let unit = Unit {
        error_ppm: 0.005,
        odd_ppm: 0.005,
        even_ppm: 0.005,
        hysteresis_ppm: 0.005,
        per_degree_ppm: 0.004,
        harmonics: [0.004, 0.004],
        ..Unit::perfect()
    };
    unit.simulated(seed, LINE_WITHOUT_SIDES)
}

fn small_asymmetry(seed: u64) -> Simulated {
    Unit { asymmetry_ppm: 0.01, ..Unit::perfect() }.simulated(seed, &["scale_factor_asymmetry"])
}

fn everything(seed: u64) -> Simulated {
    let unit = Unit {
        error_ppm: 5000.0,
        odd_ppm: 60.0,
        even_ppm: 25.0,
        hysteresis_ppm: 9.0,
        per_degree_ppm: 60.0,
        harmonics: [2.0, 1.0],
        ..Unit::perfect()
    };
    // The three-slope line of a bent response has an asymmetry of its own.
    unit.simulated(seed, LINE_WITHOUT_SIDES)
}

fn drifting(seed: u64) -> Simulated {
    Unit { drift: 1.5, ..Unit::perfect() }.simulated(seed, LINE)
}

fn heated(seed: u64) -> Simulated {
    Unit { heated: 3.0, ..Unit::perfect() }.simulated(seed, LINE_WITHOUT_SIDES)
}

fn uneven(seed: u64) -> Simulated {
    let mut source = NoiseSource::new(seed ^ 0x9a9);
    let up: Vec<f64> = [-97.0, -71.0, -33.0, -9.0, 4.0, 22.0, 58.0, 100.0]
        .iter()
        .map(|r| if f64::abs(*r) < 99.0 { r + source.uniform(-0.9, 0.9) } else { *r })
        .collect();
    let rates = up.iter().chain(up.iter().rev().skip(1).take(6)).copied().collect();
    let unit = Unit { rates, odd_ppm: 20.0, hysteresis_ppm: 2.0, per_degree_ppm: 5.0, ..Unit::perfect() };
    unit.simulated(seed, LINE_WITHOUT_SIDES)
}

fn one_way(seed: u64) -> Simulated {
    let rates = vec![-100.0, -50.0, 0.0, 50.0, 100.0];
    Unit { rates, cycles: 1, error_ppm: 30.0, ..Unit::perfect() }.simulated(seed, LINE)
}

fn two_rates(seed: u64) -> Simulated {
    let rates = vec![-100.0, 0.0, 100.0, 0.0];
    Unit { rates, cycles: 2, error_ppm: 30.0, ..Unit::perfect() }.simulated(seed, LINE)
}

/// A response that is a sine: without a loop.
fn sine(kappa_s: f64, seed: u64) -> Simulated {
    let unit = Unit::perfect();
    let mut source = NoiseSource::new(seed);
    let dt = 1.0 / HZ as f64;
    let each = DWELL * HZ;
    let steps: Vec<f64> = (0..unit.cycles).flat_map(|_| unit.rates.iter().copied()).collect();
    let rows = steps.len() * each;
    let white = source.white(unit.n, dt, rows);
    let mut columns: [Vec<f64>; 5] = Default::default();
    let mut angle = 0.0f64;
    for row in 0..rows {
        let rate = steps[row / each];
        let phase = kappa_s * rate.to_radians();
        let whole = if phase == 0.0 { 1.0 } else { phase.sin() / phase };
        let temperature = 22.0 + 1.5 * (8.0 * row as f64 / rows as f64).sin();
        let values = [
            row as f64 * dt,
            3600.0 * rate * whole + 1.0 + white[row],
            rate,
            angle.rem_euclid(360.0),
            temperature,
        ];
        for (column, value) in columns.iter_mut().zip(values) {
            column.push(value);
        }
        angle += rate * dt;
    }
    let [time, output, table, read, temperature] = &columns;
    Simulated {
        csv: csv(
            "time_s,rate_deg_h,table_rate_deg_s,table_angle_deg,temp_degC",
            &[time, output, table, read, temperature],
        ),
        procedure: rates(SINE, "response = \"sine\""),
        truths: vec![Truth::new("sine_response", kappa_s).max(kappa_s)],
    }
}

fn bending(seed: u64) -> Simulated {
    sine(0.4, seed)
}

fn hardly_bending(seed: u64) -> Simulated {
    sine(2e-4, seed)
}

/// Turns of two axes by hand, forth and back between rests, with the Earth across.
fn turned(cross: f64, back: bool, drift: f64, seed: u64) -> Simulated {
    let mut source = NoiseSource::new(seed);
    let dt = 0.1;
    let (n, rate) = (0.05, 36_000.0);
    // Rest of a minute, a turn of 36 s about x, rest, the turn back or on, rest.
    let spans = [(0.0, 600), (rate, 360), (0.0, 600), (if back { -rate } else { rate }, 360), (0.0, 600)];
    let rows: usize = spans.iter().map(|s| s.1).sum();
    let (wx, wy) = (source.white(n, dt, rows), source.white(n, dt, rows));
    let across = (source.uniform(-10.0, 10.0), source.uniform(-10.0, 10.0));
    let (mut time, mut x, mut y) = (vec![], vec![], vec![]);
    let mut roll = 0.0f64;
    for about in spans.iter().flat_map(|(rate, rows)| std::iter::repeat_n(*rate, *rows)) {
        let row = time.len();
        let share = row as f64 / rows as f64;
        let middle = roll + (0.5 * about * dt / 3600.0).to_radians();
        time.push(row as f64 * dt);
        x.push(about + 3.0 + wx[row]);
        y.push(
            cross * about + across.0 * middle.cos() + across.1 * middle.sin() - 1.0 + drift * share + wy[row],
        );
        roll += (about * dt / 3600.0).to_radians();
    }
    let sign = if back { "-" } else { "" };
    let sections = format!(
        r#"[rate_table]
[[rate_table.rest]]
from = "1 s"
to = "59 s"
[[rate_table.turn]]
channel = "x"
from = "59 s"
to = "97 s"
angle = "360 deg"
angle_uncertainty = "0.001 deg"
[[rate_table.rest]]
from = "97 s"
to = "155 s"
[[rate_table.turn]]
channel = "x"
from = "155 s"
to = "193 s"
angle = "{sign}360 deg"
angle_uncertainty = "0.001 deg"
[[rate_table.rest]]
from = "193 s"
to = "250 s"
[conditions]
minimum_duration = "1 min"
"#
    );
    let procedure = procedure("Turns", &TURNED, &sections, CROSS);
    let truth = Truth::new("cross_axis", cross).on("y<-x");
    Simulated { csv: csv("time_s,x_deg_h,y_deg_h", &[&time, &x, &y]), procedure, truths: vec![truth] }
}

const TURNED: [Column; 2] =
    [column("x", "x_deg_h", "rate", "deg/h"), column("y", "y_deg_h", "rate", "deg/h")];

fn no_cross(seed: u64) -> Simulated {
    turned(0.0, true, 0.0, seed)
}

fn crossed(seed: u64) -> Simulated {
    turned(0.004, true, 0.0, seed)
}

fn hardly_crossed(seed: u64) -> Simulated {
    turned(1e-7, true, 0.0, seed)
}

fn crossed_one_way(seed: u64) -> Simulated {
    turned(0.004, false, 0.0, seed)
}

fn crossed_drifting(seed: u64) -> Simulated {
    turned(0.004, true, 2.0, seed)
}

const SINE: &[&str] = &["sine_response"];
const CROSS: &[&str] = &["cross_axis"];

/// Rates of a table.
pub static FAMILY: Family = Family {
    name: "rate_table",
    ids: &[
        "scale_factor",
        "scale_factor_error",
        "scale_factor_nonlinearity",
        "scale_factor_nonlinearity_of_rate",
        "scale_factor_residual",
        "scale_factor_asymmetry",
        "scale_factor_odd",
        "scale_factor_even",
        "scale_factor_repeatability",
        "scale_factor_hysteresis",
        "scale_factor_temperature_sensitivity",
        "table_harmonic_1",
        "table_harmonic_2",
        "sine_response",
        "cross_axis",
    ],
    cases: &[
        Case { name: "no error", edges: &[Edge::Zero], ids: LINE, records: 100, draw: perfect },
        Case { name: "bent", edges: &[Edge::Alone], ids: BENT, records: 100, draw: bent },
        Case {
            name: "one side",
            edges: &[Edge::Alone],
            ids: &["scale_factor_asymmetry"],
            records: 100,
            draw: one_sided,
        },
        Case { name: "slow errors", edges: &[Edge::Alone], ids: SLOW, records: 100, draw: slow },
        Case {
            name: "cycles differ",
            edges: &[Edge::Alone],
            ids: &["scale_factor_repeatability"],
            records: 100,
            draw: scattered,
        },
        Case {
            name: "below the noise",
            edges: &[Edge::BelowNoise],
            ids: LINE_WITHOUT_SIDES,
            records: 100,
            draw: small,
        },
        Case {
            name: "one side, below the noise",
            edges: &[Edge::BelowNoise],
            ids: &["scale_factor_asymmetry"],
            records: 100,
            draw: small_asymmetry,
        },
        Case {
            name: "everything large",
            edges: &[Edge::BesideLarge],
            ids: LINE_WITHOUT_SIDES,
            records: 100,
            draw: everything,
        },
        Case { name: "bias that drifts", edges: &[Edge::Nuisance], ids: LINE, records: 100, draw: drifting },
        Case { name: "heated by the rate", edges: &[Edge::Nuisance], ids: SLOW, records: 100, draw: heated },
        Case {
            name: "uneven rates",
            edges: &[Edge::Grid],
            ids: LINE_WITHOUT_SIDES,
            records: 100,
            draw: uneven,
        },
        Case {
            name: "five rates, one way",
            edges: &[Edge::Shortest],
            ids: LINE,
            records: 100,
            draw: one_way,
        },
        Case { name: "three rates", edges: &[Edge::Coarsest], ids: LINE, records: 100, draw: two_rates },
        Case { name: "sine", edges: &[Edge::Alone], ids: SINE, records: 60, draw: bending },
        Case {
            name: "sine that is a line",
            edges: &[Edge::Zero, Edge::BelowNoise],
            ids: SINE,
            records: 60,
            draw: hardly_bending,
        },
        Case { name: "turns, axes square", edges: &[Edge::Zero], ids: CROSS, records: 100, draw: no_cross },
        Case { name: "turns", edges: &[Edge::Alone], ids: CROSS, records: 100, draw: crossed },
        Case {
            name: "turns, below the noise",
            edges: &[Edge::BelowNoise],
            ids: CROSS,
            records: 100,
            draw: hardly_crossed,
        },
        Case {
            name: "turns one way, the Earth across",
            edges: &[Edge::BesideLarge, Edge::Shortest],
            ids: CROSS,
            records: 100,
            draw: crossed_one_way,
        },
        Case {
            name: "turns, bias that drifts",
            edges: &[Edge::Nuisance],
            ids: CROSS,
            records: 100,
            draw: crossed_drifting,
        },
    ],
    exempt: &[
        Exemption {
            edges: &[Edge::BesideLarge, Edge::Grid],
            ids: &["scale_factor_asymmetry"],
            reason: "a bent response has an asymmetry by its definition: there is no truth of one beside the other",
        },
        Exemption {
            edges: &[Edge::Grid, Edge::BesideLarge, Edge::Nuisance, Edge::Shortest, Edge::Coarsest],
            ids: &["sine_response"],
            reason: "one number of the whole response: every rate tells it, and the other errors of a response have no truth beside a sine",
        },
        Exemption {
            edges: &[Edge::Grid, Edge::Coarsest],
            ids: &["cross_axis"],
            reason: "turns by whole angles have no grid, and one turn is the coarsest schedule as it is the shortest",
        },
    ],
};
