//! Tilts of the input axis on a table of two axes.

use super::evaluation::run_of;
use crate::bench::EARTH;
use crate::bench::two_axes::TwoAxes;
use crate::coverage::{Coverage, over_seeds};
use crate::study::{Asked, Case, Study};
use sagnac::measurand::{MISALIGNMENT_X, MISALIGNMENT_Y, TableEvidence};
use sagnac::rate_table::{Setup, alignment};
use sagnac::recording::Role;

/// Intervals of the tilts.
pub static STUDY: Study = Study {
    id: "misalignment",
    title: "Tilts of the input axis",
    method: "The input axis lies nearly along the inner axis of a table, which turns about the vertical outer one at ±20 °/s at \
             four inner angles.",
    records: 1000,
    cases: || {
        vec![Case::new("four inner angles", |records, seed| {
            let [x, y] = tilts(records, 1_000_000 + 100_000_000 * (seed - 1));
            [x.rows("misalignment_x", Asked::Nothing), y.rows("misalignment_y", Asked::Nothing)].concat()
        })]
    },
};

/// Both tilts over many tests, in mrad.
pub fn tilts(runs: u64, first: u64) -> [Coverage; 2] {
    over_seeds(first, runs, |seed| {
        let bench = TwoAxes { seed, ..TwoAxes::default() };
        let r = bench.record();
        let setup = Setup { settling_s: 4.0, minimum_step_s: 15.0, ..Setup::default() };
        let channels = [
            (Role::Rate, r.rate_deg_h),
            (Role::TableRate, r.inner_rate_deg_h),
            (Role::TableAngle, r.inner_angle_arcsec),
            (Role::OuterRate, r.outer_rate_deg_h),
        ];
        let run = run_of(&channels, 1.0 / bench.hz, &setup);
        let vertical = EARTH * bench.latitude.to_radians().sin();
        let alignment = Some(alignment::evaluate(&run.steps, "rate", 0, vertical, 0.0, false));
        let gain = 1e3 * (1.0 + 1e-6 * bench.error_ppm);
        let evidence = TableEvidence { alignment, ..TableEvidence::new(0, "rate", &setup, &run.steps) };
        [(&MISALIGNMENT_X, bench.tilt.0), (&MISALIGNMENT_Y, bench.tilt.1)]
            .map(|(m, tilt)| Coverage::of(m.evaluate_steps(&evidence).first(), gain * tilt, None))
    })
}
