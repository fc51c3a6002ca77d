//! Small rates about the Earth's rotation: dead zones of every form, with edges anywhere between the rates.
//!
//! The unit is a staircase of input and output: an input follows from the table and the Earth, passes a response that is
//! written down here by cases, and noise is added behind it.

use super::case::{Case, Edge, Exemption, Family, Simulated, Truth};
use super::on_table::{Column, column, procedure};
use crate::noise_source::{NoiseSource, csv};

/// Earth rate along the vertical at the latitude of the procedure, deg/h.
fn vertical() -> f64 {
    15.041_067 * 55.98f64.to_radians().sin()
}

/// What lies between input and output.
#[derive(Debug, Clone, Copy)]
enum Form {
    /// Output is input.
    Line,
    /// Play: what is lost stays lost.
    Play(f64),
    /// All or nothing.
    Jump(f64),
    /// Beams that lock.
    Lock(f64),
    /// Play, with normal noise on the input.
    Shaken(f64, f64),
    /// Nothing inside, and outside half of the half width is lost: no zone that the program knows.
    Stick(f64),
    /// A part of every rate is lost inside, and what is lost stays lost outside.
    Weak { half_width: f64, share: f64 },
    /// Steps of a read-out.
    Stairs(f64),
}

impl Form {
    fn of(self, x: f64, jitter: &[f64]) -> f64 {
        match self {
            Form::Line => x,
            Form::Play(d) => x - x.clamp(-d, d),
            Form::Jump(d) if x.abs() <= d => 0.0,
            Form::Jump(_) => x,
            Form::Lock(l) if x.abs() <= l => 0.0,
            Form::Lock(l) => x * (1.0 - (l / x).powi(2)).sqrt(),
            Form::Shaken(d, s) => {
                let sum: f64 = jitter.iter().map(|z| x + s * z).map(|v| v - v.clamp(-d, d)).sum();
                sum / jitter.len() as f64
            }
            Form::Stick(d) if x.abs() <= d => 0.0,
            Form::Stick(d) => x - x.clamp(-0.5 * d, 0.5 * d),
            Form::Weak { half_width: d, share } => x - (1.0 - share) * x.clamp(-d, d),
            Form::Stairs(q) => q * (x / q).round(),
        }
    }
}

/// One test.
struct Sweep {
    form: Form,
    spacing: f64,
    each_side: i32,
    dwell_s: usize,
    back: bool,
    n: f64,
    bias: f64,
    /// Linear change of the bias over the test, deg/h.
    drift: f64,
    /// Distance of the middle of the rates from where the input is none, deg/h.
    off: f64,
}

impl Sweep {
    fn of(form: Form) -> Sweep {
        Sweep {
            form,
            spacing: 0.125,
            each_side: 10,
            dwell_s: 66,
            back: true,
            n: 0.0025,
            bias: 0.11,
            drift: 0.0,
            off: 0.0,
        }
    }

    /// Standard deviation of the mean of a step, deg/h, by the white noise alone.
    fn of_step(&self) -> f64 {
        60.0 * self.n / ((self.dwell_s - 4) as f64).sqrt()
    }

    fn steps(&self) -> Vec<f64> {
        let up: Vec<f64> = (-self.each_side..=self.each_side).map(|i| f64::from(i) * self.spacing).collect();
        let down = up.iter().rev().skip(1).copied().take(if self.back { up.len() } else { 0 });
        up.iter().copied().chain(down).collect()
    }

    /// Half width of the 95 % interval of a bias, all else given.
    fn bias_oracle(&self) -> f64 {
        1.96 * self.of_step() / (self.steps().len() as f64).sqrt()
    }

    fn simulated(&self, seed: u64, truths: Vec<Truth>) -> Simulated {
        let mut source = NoiseSource::new(seed);
        let steps = self.steps();
        let rows = steps.len() * self.dwell_s;
        let white = source.white(self.n, 1.0, rows);
        // Normal quantiles in place of draws would follow one another; draws are shared by all samples in turn.
        let jitter: Vec<f64> = (0..4096).map(|_| source.normal()).collect();
        let (mut time, mut output, mut table, mut read) = (vec![], vec![], vec![], vec![]);
        let mut angle = 71.0;
        for row in 0..rows {
            let rate = steps[row / self.dwell_s] + self.off - vertical();
            let some = (row * 64) % 4032;
            let behind = self.form.of(rate + vertical(), &jitter[some..some + 64]);
            time.push(row as f64);
            output.push(behind + self.bias + self.drift * (row as f64 / rows as f64 - 0.5) + white[row]);
            table.push(rate);
            read.push((angle + source.normal() * 0.1 / 3600.0_f64).rem_euclid(360.0));
            angle += rate / 3600.0;
        }
        Simulated {
            csv: csv("time_s,rate_deg_h,table_rate_deg_h,table_angle_deg", &[&time, &output, &table, &read]),
            procedure: procedure("Small rates", &COLUMNS, SECTIONS, ALL),
            truths,
        }
    }
}

const COLUMNS: [Column; 3] = [
    column("rate", "rate_deg_h", "rate", "deg/h"),
    column("table", "table_rate_deg_h", "table_rate", "deg/h"),
    column("angle", "table_angle_deg", "table_angle", "deg"),
];

const SECTIONS: &str = r#"[rate_table]
settling = "2 s"
minimum_step = "60 s"
whole_turns = false
scale_factor_uncertainty = "500 ppm"
angle_uncertainty = "0.1 arcsec"
[conditions]
minimum_duration = "5 min"
[site]
latitude = "55.98 deg"
latitude_uncertainty = "1 arcsec"
elevation = "90 deg"
elevation_uncertainty = "0.1 mrad"
"#;

const ZONE: &[&str] = &["dead_zone", "threshold"];
const ALL: &[&str] = &["dead_zone", "dead_zone_noise", "threshold", "resolution", "scale_factor_bias"];

/// A half width anywhere between two rates, up to the fifth.
fn anywhere(seed: u64, low: f64, high: f64) -> f64 {
    NoiseSource::new(seed ^ 0x5eed).uniform(low, high)
}

fn at_limit(half_width: f64, threshold: f64) -> Vec<Truth> {
    vec![
        Truth::new("dead_zone", half_width).max(half_width),
        Truth::new("threshold", threshold).max(threshold),
    ]
}

fn whole(sweep: &Sweep, half_width: f64, noise: f64, threshold: f64) -> Vec<Truth> {
    vec![
        Truth::new("dead_zone", half_width),
        Truth::new("dead_zone_noise", noise),
        Truth::new("threshold", threshold),
        Truth::new("resolution", 0.0),
        Truth::new("scale_factor_bias", sweep.bias).max_abs(sweep.bias).oracle(sweep.bias_oracle()),
    ]
}

fn jump_anywhere(seed: u64) -> Simulated {
    let d = anywhere(seed, 0.13, 0.6);
    Sweep::of(Form::Jump(d)).simulated(seed, at_limit(d, d))
}

fn small_jump(seed: u64) -> Simulated {
    let d = anywhere(seed, 0.02, 0.125);
    Sweep::of(Form::Jump(d)).simulated(seed, at_limit(d, d))
}

fn jump_off_the_grid(seed: u64) -> Simulated {
    let d = anywhere(seed, 0.2, 0.6);
    let off = anywhere(seed + 77, -0.06, 0.06);
    Sweep { off, ..Sweep::of(Form::Jump(d)) }.simulated(seed, at_limit(d, d))
}

fn play_anywhere(seed: u64) -> Simulated {
    let d = anywhere(seed, 0.13, 0.6);
    Sweep::of(Form::Play(d)).simulated(seed, at_limit(d, 2.0 * d))
}

fn lock_anywhere(seed: u64) -> Simulated {
    let l = anywhere(seed, 0.13, 0.6);
    Sweep::of(Form::Lock(l)).simulated(seed, at_limit(l, 2.0 * l / 3f64.sqrt()))
}

fn none(seed: u64) -> Simulated {
    let sweep = Sweep::of(Form::Line);
    let truths = whole(&sweep, 0.0, 0.0, 0.0);
    sweep.simulated(seed, truths)
}

fn below_noise(seed: u64) -> Simulated {
    let sweep = Sweep::of(Form::Play(0.006));
    let mut truths = whole(&sweep, 0.006, 0.0, 0.012);
    truths[0] = Truth::new("dead_zone", 0.006).max(0.006);
    sweep.simulated(seed, truths)
}

fn alone(seed: u64) -> Simulated {
    let sweep = Sweep::of(Form::Play(0.3));
    let outside = sweep.steps().iter().filter(|x| x.abs() > 0.3).count() as f64;
    let mut truths = whole(&sweep, 0.3, 0.0, 0.6);
    truths[0] = Truth::new("dead_zone", 0.3).max(0.3).oracle(1.96 * sweep.of_step() / outside.sqrt());
    truths[2] = Truth::new("threshold", 0.6).max(0.6).oracle(1.96 * 2.0 * sweep.of_step() / outside.sqrt());
    sweep.simulated(seed, truths)
}

/// Half of x comes through noise s at the threshold: by halving, with the closed form of the mean over normal noise.
fn threshold_shaken(d: f64, s: f64) -> f64 {
    let mean = |x: f64| {
        let step = 0.002;
        let (mut sum, mut weight) = (0.0, 0.0);
        for i in -3000..=3000 {
            let z = step * f64::from(i);
            let w = (-0.5 * z * z).exp();
            let v = x + s * z;
            sum += w * (v - v.clamp(-d, d));
            weight += w;
        }
        sum / weight
    };
    if mean(1e-4) > 0.5e-4 {
        return 0.0;
    }
    let (mut low, mut high) = (1e-4, 2.0 * d);
    for _ in 0..40 {
        let x = 0.5 * (low + high);
        if mean(x) < 0.5 * x { low = x } else { high = x }
    }
    0.5 * (low + high)
}

fn shaken(seed: u64) -> Simulated {
    let sweep = Sweep::of(Form::Shaken(0.35, 0.2));
    let mut truths = whole(&sweep, 0.35, 0.2, threshold_shaken(0.35, 0.2));
    truths[0] = Truth::new("dead_zone", 0.35).max(0.35);
    truths[1] = Truth::new("dead_zone_noise", 0.2).max(0.2);
    sweep.simulated(seed, truths)
}

fn stick(seed: u64) -> Simulated {
    let truths = vec![Truth::new("dead_zone", 0.44).max(0.43), Truth::new("threshold", 0.44).max(0.43)];
    Sweep::of(Form::Stick(0.44)).simulated(seed, truths)
}

/// Half of the rate inside: at no rate the output moves by less than a tenth of what is expected, and half is enough for
/// a threshold. So both are none, though a user may read either as the half width.
fn half_inside(seed: u64) -> Simulated {
    let truths = vec![Truth::new("dead_zone", 0.0).max(0.38), Truth::new("threshold", 0.0)];
    Sweep::of(Form::Weak { half_width: 0.4, share: 0.5 }).simulated(seed, truths)
}

/// Two fifths of the rate inside: no dead zone, and a threshold where x − 0.6 δ is half of x.
fn weak_inside(seed: u64) -> Simulated {
    let d = 0.4;
    let truths = vec![Truth::new("dead_zone", 0.0), Truth::new("threshold", 1.2 * d).max(1.2 * d)];
    Sweep::of(Form::Weak { half_width: d, share: 0.4 }).simulated(seed, truths)
}

fn stairs(seed: u64) -> Simulated {
    let q = anywhere(seed, 0.3, 0.5);
    Sweep::of(Form::Stairs(q)).simulated(seed, vec![Truth::new("resolution", q).max(q)])
}

fn drifting(seed: u64) -> Simulated {
    let sweep = Sweep { drift: 0.1, ..Sweep::of(Form::Play(0.25)) };
    let mut truths = whole(&sweep, 0.25, 0.0, 0.5);
    truths[0] = Truth::new("dead_zone", 0.25).max(0.25);
    // A line about its middle takes nothing of a mean: fitted too, it leaves the oracle as it is.
    truths[4] = Truth::new("scale_factor_bias", sweep.bias).oracle(sweep.bias_oracle());
    sweep.simulated(seed, truths)
}

fn drifting_without(seed: u64) -> Simulated {
    let sweep = Sweep { drift: 0.1, ..Sweep::of(Form::Line) };
    let mut truths = whole(&sweep, 0.0, 0.0, 0.0);
    truths[0] = Truth::new("dead_zone", 0.0).max(0.15);
    truths[4] = Truth::new("scale_factor_bias", sweep.bias).oracle(sweep.bias_oracle());
    sweep.simulated(seed, truths)
}

fn shortest(seed: u64) -> Simulated {
    let sweep = Sweep { back: false, each_side: 3, dwell_s: 65, ..Sweep::of(Form::Jump(0.18)) };
    let mut truths = whole(&sweep, 0.18, 0.0, 0.18);
    truths[0] = Truth::new("dead_zone", 0.18).max(0.18);
    truths[4] = Truth::new("scale_factor_bias", sweep.bias);
    sweep.simulated(seed, truths)
}

fn coarsest(seed: u64) -> Simulated {
    // Up to nearly the largest rate.
    let d = anywhere(seed, 0.1, 0.9);
    let sweep = Sweep { each_side: 2, spacing: 0.5, ..Sweep::of(Form::Play(d)) };
    let mut truths = whole(&sweep, d, 0.0, 2.0 * d);
    truths[0] = Truth::new("dead_zone", d).max(d);
    truths[4] = Truth::new("scale_factor_bias", sweep.bias);
    sweep.simulated(seed, truths)
}

/// Small rates.
pub static FAMILY: Family = Family {
    name: "small_rates",
    ids: ALL,
    cases: &[
        Case { name: "no zone", edges: &[Edge::Zero], ids: ALL, records: 100, draw: none },
        Case {
            name: "whole output, edge anywhere",
            edges: &[Edge::Grid],
            ids: ZONE,
            records: 100,
            draw: jump_anywhere,
        },
        Case {
            name: "whole output, below the first rate",
            edges: &[Edge::Grid],
            ids: ZONE,
            records: 60,
            draw: small_jump,
        },
        Case {
            name: "whole output, middle off a rate",
            edges: &[Edge::Grid],
            ids: ZONE,
            records: 100,
            draw: jump_off_the_grid,
        },
        Case {
            name: "play, edge anywhere",
            edges: &[Edge::Grid],
            ids: ZONE,
            records: 100,
            draw: play_anywhere,
        },
        Case {
            name: "locked, edge anywhere",
            edges: &[Edge::Grid],
            ids: ZONE,
            records: 100,
            draw: lock_anywhere,
        },
        Case {
            name: "zone below the noise",
            edges: &[Edge::BelowNoise],
            ids: ALL,
            records: 100,
            draw: below_noise,
        },
        Case { name: "play", edges: &[Edge::Alone], ids: ALL, records: 100, draw: alone },
        Case {
            name: "play with noise in the loop",
            edges: &[Edge::BesideLarge, Edge::Grid],
            ids: ALL,
            records: 100,
            draw: shaken,
        },
        Case {
            name: "zone of no known form",
            edges: &[Edge::BesideLarge],
            ids: ZONE,
            records: 60,
            draw: stick,
        },
        Case {
            name: "half of the rate inside",
            edges: &[Edge::BesideLarge],
            ids: ZONE,
            records: 60,
            draw: half_inside,
        },
        Case {
            name: "two fifths of the rate inside",
            edges: &[Edge::BesideLarge],
            ids: ZONE,
            records: 60,
            draw: weak_inside,
        },
        Case {
            name: "steps of a read-out",
            edges: &[Edge::Grid],
            ids: &["resolution"],
            records: 60,
            draw: stairs,
        },
        Case {
            name: "play, drift over the test",
            edges: &[Edge::Nuisance],
            ids: ALL,
            records: 60,
            draw: drifting,
        },
        Case {
            name: "no zone, drift over the test",
            edges: &[Edge::Nuisance],
            ids: ALL,
            records: 60,
            draw: drifting_without,
        },
        Case {
            name: "seven rates, one way",
            edges: &[Edge::Shortest],
            ids: ALL,
            records: 60,
            draw: shortest,
        },
        Case { name: "five rates", edges: &[Edge::Coarsest], ids: ALL, records: 60, draw: coarsest },
    ],
    exempt: &[Exemption {
        edges: &[Edge::Grid],
        ids: &["scale_factor_bias"],
        reason: "a bias is no place among the rates of a schedule; every case here has one between them",
    }],
};
