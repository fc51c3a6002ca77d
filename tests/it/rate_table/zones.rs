//! Dead zones, with and without noise inside the loop that rounds them off. The studies are
//! `cargo xtask validate dead-zones rounded-dead-zones`.

use sagnac_studies::bench::small_rates::SmallRates;
use sagnac_studies::rate_table::power::power_told;
use sagnac_studies::rate_table::zones::{counted, rounded, zones};

#[test]
fn a_dead_zone_is_found_with_its_width_and_otherwise_bounded() {
    // The test of its form refuses the true one in a test of a hundred.
    let wide = zones(0.3, true, None, 10, 400);
    assert!(
        wide.errors.len() >= 9 && wide.errors.len() + wide.withheld + wide.bounds.held == 10,
        "{:?}",
        wide.errors
    );
    assert!(wide.held >= 7 && wide.withheld <= 1, "{} {}", wide.held, wide.withheld);
    let none = zones(0.0, true, None, 10, 400);
    assert!(none.errors.is_empty(), "{} zones where none is", none.errors.len());
    assert!(none.withheld <= 1, "{}", none.withheld);
    if !crate::support::long::wanted("a_dead_zone_is_found_with_its_width_and_otherwise_bounded: a gap") {
        return;
    }
    let gap = zones(0.3, false, None, 10, 400);
    assert!(
        gap.errors.len() >= 9 && gap.errors.len() + gap.withheld + gap.bounds.held == 10,
        "{:?}",
        gap.errors
    );
    assert!(gap.held >= 7 && gap.withheld <= 1, "{} {}", gap.held, gap.withheld);
}

#[test]
fn all_of_the_stretch_between_a_silent_rate_and_one_that_answers_belongs_to_the_interval() {
    let mut withheld = 0;
    for (i, share) in [0.03, 0.2, 0.5, 0.8, 0.97].into_iter().enumerate() {
        let half_width = 0.125 * (2.0 + share);
        let count = zones(half_width, false, Some(5e-4), 3, 500 + 10 * i as u64);
        assert_eq!(count.errors.len(), count.held, "{half_width}: {:?}", count.errors);
        withheld += count.withheld;
    }
    // A form that is the true one is refused in one test of a hundred.
    assert!(withheld <= 2, "{withheld}");
    // Smaller than the first rate it is a bound, up to that rate.
    let count = zones(0.11, false, Some(5e-4), 3, 560);
    assert!(count.errors.is_empty() && count.bounds.held + count.withheld == 3, "{:?}", count.bounds);
    assert!(count.withheld <= 1, "{}", count.withheld);
}

#[test]
fn a_zone_as_small_as_the_noise_of_a_step_is_found_where_the_scale_factor_is_known() {
    if !crate::support::long::wanted(
        "a_zone_as_small_as_the_noise_of_a_step_is_found_where_the_scale_factor_is_known",
    ) {
        return;
    }
    let small = zones(0.016, true, Some(5e-4), 12, 400);
    // One form more is sought than before, which a claim has to pay for.
    assert!(small.errors.len() >= 10 && small.held >= 9, "{} {}", small.errors.len(), small.held);
    assert!(small.withheld <= 1, "{}", small.withheld);
    let bench = SmallRates { half_width: 0.016, ..SmallRates::default() };
    assert!(power_told(&bench, Some(5e-4)) > 0.99 && power_told(&bench, None) < 0.75);
}

#[test]
fn a_zone_with_noise_inside_the_loop_has_both_of_them() {
    if !crate::support::long::wanted("a_zone_with_noise_inside_the_loop_has_both_of_them") {
        return;
    }
    let [width, noise, threshold] = counted(&rounded(0.3, 0.15), Some(5e-4), 20, 700);
    // Where chance lets a tenth of the smallest rates through, the zone is bounded.
    assert!(width.errors.len() >= 19 && width.errors.len() + width.bounds.held == 20, "{:?}", width.errors);
    assert!(width.held >= 17, "{} {:?}", width.held, width.errors);
    assert!(noise.errors.len() >= 19 && noise.held >= 17, "{} {:?}", noise.held, noise.errors);
    assert!(threshold.held >= 17, "{} {:?}", threshold.held, threshold.errors);
    assert!(width.withheld == 0 && threshold.withheld <= 1, "{} {}", width.withheld, threshold.withheld);
}

#[test]
fn noise_that_rounds_nothing_off_is_bounded() {
    let [width, noise, _] = counted(&rounded(0.3, 0.0), Some(5e-4), 20, 700);
    assert!(width.held >= 17 && width.withheld <= 1, "{} {}", width.held, width.withheld);
    assert!(noise.errors.len() <= 1, "{:?}", noise.errors);
    assert!(noise.bounds.held >= 17, "{:?}", noise.bounds);
}
