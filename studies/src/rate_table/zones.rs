//! Dead zones, with and without noise inside the loop that rounds them off.

use super::evaluation::run_of;
use super::power::{power_told, power_told_but_the_centre};
use crate::bench::small_rates::SmallRates;
use crate::coverage::{Coverage, over_seeds};
use crate::study::{Asked, Case, Row, Study};
use sagnac::estimate::Estimate;
use sagnac::measurand::{DEAD_ZONE, DEAD_ZONE_NOISE, Measurand, THRESHOLD, TableEvidence};
use sagnac::rate_table::dead_zone::{self, DeadZone};
use sagnac::rate_table::{Setup, TableRun, scale_factor};
use sagnac::recording::Role;

/// Dead zones without noise in the loop.
pub static DEAD_ZONES: Study = Study {
    id: "dead-zones",
    title: "Dead zones",
    method: "Rates 0.125 °/h apart about the rate at which the input is none, there and back, 2 min each, N = 0.003 °/√h. The \
             response is a zone of which the output is short outside it (subtractive), or a gap. Of white noise a step has \
             0.0166 °/h. The power is that of a likelihood-ratio test at one false claim in a hundred that knows the zone, and \
             of one that knows all but its centre. The scale factor is known to 500 ppm, or free. False zones may be one in \
             four hundred where it is known and one in a hundred where it is free, as means over noises.",
    records: 1000,
    cases: dead_zone_cases,
};

/// Dead zones that noise in the loop rounds off.
pub static ROUNDED: Study = Study {
    id: "rounded-dead-zones",
    title: "Dead zones rounded off by noise",
    method: "The same rates; the input of every sample is moved 200 times by noise inside the loop.",
    records: 40,
    cases: rounded_cases,
};

/// A tested response, with the dead zone that was found in it.
struct Tested {
    run: TableRun,
    setup: Setup,
    zone: DeadZone,
}

impl Tested {
    fn estimate(&self, m: &Measurand) -> Estimate {
        let dead_zone = Some(self.zone.clone());
        let evidence =
            TableEvidence { dead_zone, ..TableEvidence::new(0, "rate", &self.setup, &self.run.steps) };
        m.evaluate_steps(&evidence).remove(0)
    }
}

fn found(bench: &SmallRates, known: Option<f64>) -> Tested {
    let r = bench.record();
    let setup = Setup {
        settling_s: 2.0,
        minimum_step_s: 60.0,
        by_angle: true,
        whole_turns: false,
        scale_factor_uncertainty: known,
        angle_uncertainty_arcsec: bench.reading_arcsec,
        ..Setup::default()
    };
    let channels = [
        (Role::Rate, r.rate_deg_h),
        (Role::TableRate, r.table_rate_deg_h),
        (Role::TableAngle, r.table_angle_arcsec),
    ];
    let run = run_of(&channels, 1.0 / bench.hz, &setup);
    let line = scale_factor::evaluate(&run, 0, &setup, &[]).expect("a line");
    let zone = dead_zone::evaluate(&run.steps, 0, &line.response, "rate", &setup).expect("enough rates");
    Tested { run, setup, zone }
}

/// Half width, noise inside the loop and threshold of many tests; `known` is the relative standard uncertainty of a known
/// scale factor.
pub fn counted(bench: &SmallRates, known: Option<f64>, runs: u64, first: u64) -> [Coverage; 3] {
    let threshold = threshold_of(bench);
    over_seeds(first, runs, |seed| {
        let zone = found(&SmallRates { seed, ..bench.clone() }, known);
        let [width, noise, half] = [&DEAD_ZONE, &DEAD_ZONE_NOISE, &THRESHOLD].map(|m| zone.estimate(m));
        // Without a zone there is no noise in one.
        let of_noise = width.value.map(|_| Coverage::of(Some(&noise), bench.loop_noise, None));
        [
            Coverage::of(Some(&width), bench.half_width, None),
            of_noise.unwrap_or_default(),
            Coverage::of(Some(&half), threshold, None),
        ]
    })
}

/// The input of which half comes through, by quadrature over the noise.
fn threshold_of(bench: &SmallRates) -> f64 {
    if bench.loop_noise == 0.0 {
        return if bench.subtractive { 2.0 } else { 1.0 } * bench.half_width;
    }
    let share = |x: f64| {
        let (mut sum, mut weights) = (0.0, 0.0);
        for i in -600..=600 {
            let z = 0.01 * f64::from(i);
            let (w, input) = ((-0.5 * z * z).exp(), x + bench.loop_noise * z);
            sum += w * input.signum() * (input.abs() - bench.half_width).max(0.0);
            weights += w;
        }
        sum / weights / x
    };
    if share(1e-3 * bench.half_width) >= 0.5 {
        return 0.0;
    }
    let steps = (1..=5000).map(|i| bench.half_width * f64::from(i) / 2000.0);
    steps.into_iter().find(|x| share(*x) >= 0.5).expect("half comes through at twice the half width")
}

/// Half width of a zone of a width in deg/h whose output is short by it outside, or is not, over many tests.
pub fn zones(half_width: f64, subtractive: bool, known: Option<f64>, runs: u64, first: u64) -> Coverage {
    let bench = SmallRates { half_width, subtractive, ..SmallRates::default() };
    let [count, _, _] = counted(&bench, known, runs, first);
    count
}

fn slope(known: Option<f64>) -> &'static str {
    if known.is_some() { "slope known" } else { "slope free" }
}

const KNOWN: Option<f64> = Some(5e-4);

fn dead_zone_cases() -> Vec<Case> {
    let mut cases = vec![];
    let noises = [("", 0.0, 0.0), (", B = 0.01 °/h", 0.01, 0.0), (", K = 0.03 °/h/√h", 0.0, 0.03)];
    for (subtractive, known) in [(true, KNOWN), (true, None), (false, KNOWN)] {
        for half_width in [0.0, 0.008, 0.016, 0.0166, 0.03, 0.06, 0.3] {
            // A gap that no rate but the centre falls into is a line.
            if !subtractive && half_width < 0.125 {
                continue;
            }
            // Drift matters where a zone is claimed that is none, or nearly none.
            for (noise, b, k) in noises.into_iter().filter(|n| n.0.is_empty() || half_width < 0.02) {
                let bench = SmallRates { half_width, b, k, subtractive, ..SmallRates::default() };
                let form = if subtractive { "zone" } else { "gap" };
                let name = format!("{form} of {half_width} °/h, {}{noise}", slope(known));
                cases.push(Case::new(name, move |records, seed| {
                    dead_zone(&bench, known, records, 1_000_000 + 100_000_000 * (seed - 1))
                }));
            }
        }
    }
    cases
}

fn dead_zone(bench: &SmallRates, known: Option<f64>, records: u64, first: u64) -> Vec<Row> {
    let [count, _, _] = counted(bench, known, records, first);
    let mut rows = count.rows("dead_zone", Asked::Nothing);
    if bench.half_width == 0.0 {
        let most = if known.is_some() { 1.0 / 400.0 } else { 1.0 / 100.0 };
        let found = count.stated() as u64;
        rows.push(Row::share(
            "dead_zone",
            "a zone is claimed where there is none",
            Asked::AtMost(most),
            found,
            records,
        ));
        return rows;
    }
    let power = |claim: &str, value| Row::number("dead_zone", claim, Asked::Nothing, value, records);
    rows.push(power("power of a test that knows the zone", power_told(bench, known)));
    if known.is_none() {
        let [average, middle] = power_told_but_the_centre(bench);
        rows.push(power("power of a test that knows all but the centre, mean over centres", average));
        rows.push(power("power of a test that knows all but the centre, at this centre", middle));
    }
    rows
}

/// A zone whose noise is of its size: the closed form is not the truth here, samples that noise moves in and out are.
pub fn rounded(half_width: f64, loop_noise: f64) -> SmallRates {
    SmallRates { half_width, loop_noise, ..SmallRates::default() }
}

fn rounded_cases() -> Vec<Case> {
    let zones = [(0.06, 0.06), (0.12, 0.04), (0.12, 0.12), (0.12, 0.3), (0.3, 0.05), (0.3, 0.1), (0.3, 0.3)];
    let mut cases = vec![];
    for known in [KNOWN, None] {
        for (half_width, noise) in zones {
            let name = format!("zone of {half_width} °/h with noise of {noise} °/h, {}", slope(known));
            cases.push(Case::new(name, move |records, seed| {
                let first = 1_000_000 + 100_000_000 * (seed - 1);
                let counts = counted(&rounded(half_width, noise), known, records, first);
                let ids = ["dead_zone", "dead_zone_noise", "threshold"];
                ids.iter().zip(counts).flat_map(|(id, count)| count.rows(id, Asked::Nothing)).collect()
            }));
        }
    }
    cases
}
