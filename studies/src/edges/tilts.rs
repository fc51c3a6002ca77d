//! Tilts of the input axis by turns of the outer axis at several inner angles.
//!
//! The outer axis stands vertical, the inner one lies in the horizontal plane and the input axis nearly along it. With the
//! outer rate Ω, the inner angle β and the angle ε that the axes of the table lack of a right one, the input is
//! (Ω + Ω_up)(ε + θ_y cos β + θ_x sin β) beside the northern rotation, which turns with the table.

use super::case::{Case, Edge, Exemption, Family, Simulated, Truth};
use super::on_table::{Column, column, procedure};
use crate::noise_source::{NoiseSource, csv};

/// Earth rate, deg/h, and the latitude.
const EARTH: f64 = 15.041_067;
const LATITUDE_DEG: f64 = 55.98;

/// Seconds at rest before a turn, of a change of rate, and of a turn.
const REST: usize = 10;
const TURN: usize = 42;

/// Samples a second, and outer rate, deg/s.
const HZ: usize = 5;
const OUTER: f64 = 20.0;

const IDS: &[&str] = &["misalignment_x", "misalignment_y"];

struct Bench {
    tilt_mrad: (f64, f64),
    squareness_mrad: f64,
    inner_deg: Vec<f64>,
    n: f64,
    drift: f64,
}

impl Bench {
    fn four(tilt_mrad: (f64, f64), seed: u64) -> Bench {
        let mut source = NoiseSource::new(seed ^ 0x717);
        Bench {
            tilt_mrad,
            squareness_mrad: 0.02 * source.normal(),
            inner_deg: vec![0.0, 90.0, 180.0, 270.0],
            n: 0.004,
            drift: 0.0,
        }
    }

    /// Half width of the 95 % interval of a tilt in mrad, everything else given: half of the rows show it whole, or all by
    /// their sines.
    fn oracle(&self) -> f64 {
        // 42 s less the settling of 4 s: two turns of 18 s.
        let of_turn = 60.0 * self.n / 36f64.sqrt();
        let rows = 2.0 * self.inner_deg.iter().map(|b| b.to_radians().sin().powi(2)).sum::<f64>();
        1e3 * 1.96 * of_turn / (3600.0 * OUTER * rows.sqrt())
    }

    fn truths(&self, limited: bool) -> Vec<Truth> {
        let (x, y) = self.tilt_mrad;
        [("misalignment_x", x), ("misalignment_y", y)]
            .map(|(id, value)| {
                let t = Truth::new(id, value);
                if limited { t.max_abs(value.abs()) } else { t }
            })
            .to_vec()
    }

    fn simulated(&self, seed: u64, truths: Vec<Truth>) -> Simulated {
        let mut source = NoiseSource::new(seed);
        let dt = 1.0 / HZ as f64;
        let up = EARTH * LATITUDE_DEG.to_radians().sin();
        let north = EARTH * LATITUDE_DEG.to_radians().cos();
        let (mut outer, mut inner, mut inner_rate) = (vec![], vec![], vec![]);
        let mut at = self.inner_deg[0];
        for target in &self.inner_deg {
            // To the angle at 30 deg/s, then turns to both sides between rests.
            while (target - at).abs() > 1e-9 {
                let step = (target - at).clamp(-30.0 * dt, 30.0 * dt);
                outer.push(0.0);
                inner.push(at);
                inner_rate.push(step / dt);
                at += step;
            }
            for (rate, seconds) in [(0.0, REST), (OUTER, TURN), (0.0, REST), (-OUTER, TURN)] {
                for _ in 0..seconds * HZ {
                    outer.push(rate);
                    inner.push(at);
                    inner_rate.push(0.0);
                }
            }
        }
        let rows = outer.len();
        let white = source.white(self.n, dt, rows);
        let (mut azimuth, mut time, mut output) = (0.4f64, vec![], vec![]);
        for row in 0..rows {
            let beta = inner[row].to_radians();
            let lean =
                1e-3 * (self.squareness_mrad + self.tilt_mrad.1 * beta.cos() + self.tilt_mrad.0 * beta.sin());
            let through = 3600.0 * outer[row] + up;
            let middle = azimuth + (0.5 * outer[row] * dt).to_radians();
            azimuth += (outer[row] * dt).to_radians();
            time.push(row as f64 * dt);
            output.push(
                through * lean
                    + north * middle.cos()
                    + 3600.0 * inner_rate[row]
                    + 0.3
                    + self.drift * row as f64 / rows as f64
                    + white[row],
            );
        }
        Simulated {
            csv: csv(
                "time_s,rate_deg_h,inner_rate_deg_s,inner_angle_deg,outer_rate_deg_s",
                &[&time, &output, &inner_rate, &inner, &outer],
            ),
            procedure: procedure("Tilts", &COLUMNS, SECTIONS, IDS),
            truths,
        }
    }
}

const COLUMNS: [Column; 4] = [
    column("rate", "rate_deg_h", "rate", "deg/h"),
    column("inner_rate", "inner_rate_deg_s", "table_rate", "deg/s"),
    column("inner_angle", "inner_angle_deg", "table_angle", "deg"),
    column("outer", "outer_rate_deg_s", "outer_rate", "deg/s"),
];

const SECTIONS: &str = r#"[rate_table]
settling = "4 s"
minimum_step = "15 s"
whole_turns = true
rate_uncertainty = "10 ppm"
alignment_uncertainty = "0.02 mrad"
[conditions]
minimum_duration = "2 min"
[site]
latitude = "55.98 deg"
latitude_uncertainty = "10 arcsec"
elevation = "90 deg"
elevation_uncertainty = "1 mrad"
"#;

fn told(bench: &Bench) -> Vec<Truth> {
    bench.truths(false).into_iter().map(|t| t.oracle(bench.oracle())).collect()
}

fn none(seed: u64) -> Simulated {
    let bench = Bench::four((0.0, 0.0), seed);
    bench.simulated(seed, told(&bench))
}

fn alone(seed: u64) -> Simulated {
    let bench = Bench::four((0.4, -0.3), seed);
    bench.simulated(seed, bench.truths(true).into_iter().map(|t| t.oracle(bench.oracle())).collect())
}

fn below_noise(seed: u64) -> Simulated {
    let bench = Bench::four((3e-5, -2e-5), seed);
    bench.simulated(seed, told(&bench))
}

fn beside_large(seed: u64) -> Simulated {
    let bench = Bench::four((0.0, 4.0), seed);
    bench.simulated(seed, told(&bench))
}

fn askew(seed: u64) -> Simulated {
    let inner_deg = vec![17.0, 107.0, 197.0, 287.0];
    let bench = Bench { inner_deg, ..Bench::four((0.2, 0.2), seed) };
    bench.simulated(seed, bench.truths(true))
}

fn drifting(seed: u64) -> Simulated {
    let bench = Bench { drift: 0.03, ..Bench::four((0.4, -0.3), seed) };
    // Turns to both sides at angles in order cancel a drift along a line: fitted too, it takes nothing of the tilts.
    bench.simulated(seed, told(&bench))
}

/// No oracle: the squareness of the table, which the procedure bounds, is all of the interval.
fn two_angles(seed: u64) -> Simulated {
    let bench = Bench { inner_deg: vec![0.0, 90.0], ..Bench::four((0.4, -0.3), seed) };
    bench.simulated(seed, bench.truths(true))
}

/// Tilts of the input axis.
pub static FAMILY: Family = Family {
    name: "tilts",
    ids: IDS,
    cases: &[
        Case { name: "no tilt", edges: &[Edge::Zero], ids: IDS, records: 200, draw: none },
        Case { name: "four angles", edges: &[Edge::Alone], ids: IDS, records: 200, draw: alone },
        Case {
            name: "below the noise",
            edges: &[Edge::BelowNoise],
            ids: IDS,
            records: 200,
            draw: below_noise,
        },
        Case {
            name: "beside a large tilt",
            edges: &[Edge::BesideLarge],
            ids: IDS,
            records: 200,
            draw: beside_large,
        },
        Case { name: "angles off the axes", edges: &[Edge::Grid], ids: IDS, records: 200, draw: askew },
        Case { name: "bias that drifts", edges: &[Edge::Nuisance], ids: IDS, records: 200, draw: drifting },
        Case {
            name: "two angles",
            edges: &[Edge::Shortest, Edge::Coarsest],
            ids: IDS,
            records: 200,
            draw: two_angles,
        },
    ],
    exempt: &[] as &[Exemption],
};
