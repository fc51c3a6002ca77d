//! Published values of the Allan family: the nine-point and the thousand-point set of NIST SP 1065 (tables 30 and 31 in
//! section 12.4), and the confidence limits that Stable32 1.60 prints for the thousand points.

use sagnac::noise::allan::{AllanAccumulator, AllanPlan, DeviationSet};
use sagnac::noise::data::NoiseType;
use sagnac::noise::edf::{PhaseModel, edf};
use sagnac::noise::family::{Estimator, non_overlapping};
use sagnac::noise::intervals::{ONE_SIGMA, deviation_interval};
use sagnac::noise::tau_grid::TauGrid;

fn analyse(samples: &[f64]) -> DeviationSet {
    let mut allan = AllanAccumulator::new(AllanPlan {
        tau0_s: 1.0,
        grid: TauGrid::All,
        exact: false,
        estimators: Estimator::ALL.to_vec(),
    });
    allan.push(samples, 0, false);
    allan.finish()
}

fn value(set: &DeviationSet, estimator: Estimator, m: u64) -> f64 {
    set.curve(estimator).unwrap().points.iter().find(|p| p.m == m).unwrap().deviation
}

/// The generator of section 12.4.
fn suite() -> Vec<f64> {
    let mut n = 1_234_567_890u64;
    (0..1000)
        .map(|_| {
            let y = n as f64 / 2_147_483_647.0;
            n = 16807 * n % 2_147_483_647;
            y
        })
        .collect()
}

#[test]
fn nine_points_of_sp1065() {
    let y = [892.0, 809.0, 823.0, 798.0, 671.0, 644.0, 883.0, 903.0, 677.0];
    let set = analyse(&y);
    for (estimator, one, two) in [
        (Estimator::Allan, 91.22945, 85.95287),
        (Estimator::Modified, 91.22945, 74.78849),
        (Estimator::Hadamard, 70.80607, 85.61487),
        (Estimator::Total, 91.22945, 93.90379),
    ] {
        assert!((value(&set, estimator, 1) - one).abs() < 5.1e-6, "{estimator:?}");
        assert!((value(&set, estimator, 2) - two).abs() < 5.1e-6, "{estimator:?}");
    }
    assert!((non_overlapping(&y, 2, 2).unwrap().deviation - 115.8082).abs() < 5.1e-5);
    assert!((non_overlapping(&y, 2, 3).unwrap().deviation - 116.7980).abs() < 5.1e-5);
}

#[allow(clippy::too_many_lines, reason = "one list of cases or data")]
#[test]
fn thousand_points_to_ten_digits() {
    const TABLE: &[(u64, [f64; 6])] = &[
        (
            1,
            [
                2.922318781e-01,
                2.922318781e-01,
                2.922318781e-01,
                2.943883291e-01,
                2.943883291e-01,
                2.922318781e-01,
            ],
        ),
        (
            2,
            [
                2.051016156e-01,
                2.010160422e-01,
                1.582071983e-01,
                2.071573833e-01,
                2.012483296e-01,
                2.008850881e-01,
            ],
        ),
        (
            4,
            [
                1.494271424e-01,
                1.447913072e-01,
                1.077973745e-01,
                1.488979675e-01,
                1.436803306e-01,
                1.444370325e-01,
            ],
        ),
        (
            8,
            [
                1.101348033e-01,
                1.057038501e-01,
                7.419220013e-02,
                1.164908142e-01,
                1.098722637e-01,
                1.054011888e-01,
            ],
        ),
        (
            10,
            [
                9.965736063e-02,
                9.159953420e-02,
                6.172376382e-02,
                1.052754194e-01,
                9.581083173e-02,
                9.134743262e-02,
            ],
        ),
        (
            16,
            [
                6.238133981e-02,
                6.191477842e-02,
                4.137594628e-02,
                5.958868770e-02,
                6.063762921e-02,
                6.178820111e-02,
            ],
        ),
        (
            32,
            [
                5.623294473e-02,
                4.808214262e-02,
                3.425498087e-02,
                5.469689616e-02,
                4.509503283e-02,
                4.857971734e-02,
            ],
        ),
        (
            64,
            [
                3.254990544e-02,
                3.623721299e-02,
                2.787105115e-02,
                3.056864017e-02,
                3.382370898e-02,
                3.590485890e-02,
            ],
        ),
        (
            100,
            [
                3.897804331e-02,
                3.241343026e-02,
                2.170920914e-02,
                3.910860560e-02,
                3.237638253e-02,
                3.406530252e-02,
            ],
        ),
        (
            128,
            [
                3.385519512e-02,
                2.767385582e-02,
                1.866932874e-02,
                3.805990930e-02,
                2.914663224e-02,
                3.125892485e-02,
            ],
        ),
        (
            256,
            [
                1.079927226e-02,
                1.028221764e-02,
                4.254511495e-03,
                1.088642656e-02,
                1.013781915e-02,
                1.336943867e-02,
            ],
        ),
    ];
    let y = suite();
    let set = analyse(&y);
    for &(m, [allan, overlapping, modified, hadamard, overlapping_hadamard, total]) in TABLE {
        for (got, expected) in [
            (non_overlapping(&y, m as usize, 2).unwrap().deviation, allan),
            (value(&set, Estimator::Allan, m), overlapping),
            (value(&set, Estimator::Modified, m), modified),
            (non_overlapping(&y, m as usize, 3).unwrap().deviation, hadamard),
            (value(&set, Estimator::Hadamard, m), overlapping_hadamard),
            (value(&set, Estimator::Total, m), total),
        ] {
            assert!((got / expected - 1.0).abs() < 6e-10, "m {m}: {got} {expected}");
        }
    }
}

#[test]
fn published_digits_of_table_31() {
    let set = analyse(&suite());
    for (estimator, published) in [
        (Estimator::Allan, [2.922319e-01, 9.159953e-02, 3.241343e-02]),
        (Estimator::Modified, [2.922319e-01, 6.172376e-02, 2.170921e-02]),
        (Estimator::Hadamard, [2.943883e-01, 9.581083e-02, 3.237638e-02]),
        (Estimator::Total, [2.922319e-01, 9.134743e-02, 3.406530e-02]),
    ] {
        for (m, expected) in [1, 10, 100].into_iter().zip(published) {
            let got = value(&set, estimator, m);
            assert!((got / expected - 1.0).abs() < 2e-7, "{estimator:?} {m}: {got} {expected}");
        }
    }
}

/// White rate noise, 68.3 %. Degrees of freedom in the clock convention, which Stable32 follows.
#[test]
fn confidence_limits_of_stable32() {
    let set = analyse(&suite());
    for (estimator, m, low, high) in [
        (Estimator::Allan, 1, 2.8515e-01, 2.9987e-01),
        (Estimator::Allan, 2, 1.9520e-01, 2.0738e-01),
        (Estimator::Allan, 4, 1.3931e-01, 1.5098e-01),
        (Estimator::Allan, 8, 1.0038e-01, 1.1198e-01),
        (Estimator::Allan, 16, 5.7696e-02, 6.7217e-02),
        (Estimator::Allan, 32, 4.3654e-02, 5.4202e-02),
        (Estimator::Allan, 64, 3.1755e-02, 4.3377e-02),
        (Estimator::Allan, 128, 2.3045e-02, 3.7027e-02),
        (Estimator::Modified, 2, 1.5336e-01, 1.6355e-01),
        (Estimator::Modified, 16, 3.8022e-02, 4.5809e-02),
        (Estimator::Modified, 128, 1.4874e-02, 2.8584e-02),
        (Estimator::Hadamard, 1, 2.8635e-01, 3.0315e-01),
        (Estimator::Hadamard, 16, 5.6173e-02, 6.6369e-02),
        (Estimator::Hadamard, 128, 2.3761e-02, 4.1367e-02),
        (Estimator::Total, 16, 5.7732e-02, 6.6839e-02),
        (Estimator::Total, 256, 1.0734e-02, 1.9924e-02),
    ] {
        let curve = set.curve(estimator).unwrap();
        let point = curve.points.iter().find(|p| p.m == m).unwrap();
        let edf =
            edf(estimator, point, &curve.stretches, NoiseType::AngleRandomWalk, PhaseModel::BandLimited);
        let got = deviation_interval(point.deviation, edf, ONE_SIGMA).unwrap();
        assert!((got.low / low - 1.0).abs() < 1e-3, "{estimator:?} {m}: {got:?} {low}");
        assert!((got.high / high - 1.0).abs() < 1e-3, "{estimator:?} {m}: {got:?} {high}");
    }
}
