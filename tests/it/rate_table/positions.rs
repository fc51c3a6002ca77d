//! Positions against the Earth's rotation and turns of a triad by known angles: whether their intervals hold what went in.
//! The study is `cargo xtask validate positions-and-turns`.

use sagnac_studies::bench::chance::Noise;
use sagnac_studies::rate_table::positions::{KINDS, positions_study};
use sagnac_studies::rate_table::triads::{LOUD, Triad, triads};

#[test]
fn positions_and_turns_hold_what_went_in() {
    for (kind, model) in KINDS {
        for count in positions_study(model, 16, 300) {
            // Of 16 at 95 %, fewer than 12 come about less than once in 1000.
            assert!(count.errors.len() == 16 && count.held >= 12, "{kind} {}", count.held);
        }
    }
    let back = Triad { noise: LOUD, back: true, angle: 0.02 };
    let [own, cross] = triads(&back, 12, 300);
    assert!(own.errors.len() == 36 && own.held >= 29, "{}", own.held);
    assert!(cross.errors.len() == 72 && cross.held >= 60, "{}", cross.held);
}

#[test]
fn the_earths_rotation_widens_what_crosses_the_axis_of_a_turn_in_one_sense() {
    let quiet = Noise { n: 0.003, ..LOUD };
    let [own, cross] = triads(&Triad { noise: quiet, back: false, angle: 0.002 }, 20, 300);
    assert!(own.held >= 50 && cross.held >= 110, "{} {}", own.held, cross.held);
    // Forth and back nothing of it is left.
    let [_, both] = triads(&Triad { noise: quiet, back: true, angle: 0.002 }, 4, 300);
    assert!(both.widths.iter().all(|w| *w < 0.1 * cross.widths[0]), "{:?} {}", both.widths, cross.widths[0]);
}
