//! Classical read-outs against published ones: InterSense NavChip gyros, 250 Hz, 3,105,250 samples (documentation of the
//! R package avar, Allan deviations and the linear regression on them; slopes fixed, octaves chosen by hand).

use sagnac::noise::data::NoiseType;
use sagnac::noise::slope::{SlopePoint, read, through};

/// Deviations of X, Y, Z at m = 2, 4, 8, …; the unit of the file.
const PUBLISHED: [[f64; 20]; 3] = [
    [
        1.302559e-3,
        6.999357e-4,
        3.814539e-4,
        2.187542e-4,
        1.383604e-4,
        9.665264e-5,
        7.402666e-5,
        6.336985e-5,
        5.927880e-5,
        5.787133e-5,
        5.966039e-5,
        6.697211e-5,
        7.823331e-5,
        9.730243e-5,
        1.443146e-4,
        2.360392e-4,
        4.132691e-4,
        8.013283e-4,
        1.616463e-3,
        3.007625e-3,
    ],
    [
        1.442757e-3,
        7.837054e-4,
        4.391445e-4,
        2.671158e-4,
        1.742997e-4,
        1.220895e-4,
        9.128055e-5,
        7.358403e-5,
        6.447022e-5,
        6.031602e-5,
        5.730421e-5,
        5.706751e-5,
        5.843705e-5,
        6.236035e-5,
        6.968539e-5,
        7.372194e-5,
        7.799599e-5,
        8.646323e-5,
        1.001156e-4,
        1.153775e-4,
    ],
    [
        1.275965e-3,
        7.115635e-4,
        3.858389e-4,
        2.253820e-4,
        1.424188e-4,
        1.001571e-4,
        7.764734e-5,
        6.532741e-5,
        6.023074e-5,
        5.763151e-5,
        5.522639e-5,
        5.605713e-5,
        6.063841e-5,
        6.476953e-5,
        7.312631e-5,
        8.390866e-5,
        1.006368e-4,
        1.381148e-4,
        2.247197e-4,
        3.637988e-4,
    ],
];

/// The published coefficients are in units of the second; read-outs are at 1 h and 3 h.
const SECONDS: f64 = 3600.0;

fn points(axis: usize) -> Vec<SlopePoint> {
    PUBLISHED[axis]
        .iter()
        .enumerate()
        .map(|(i, d)| {
            let m = f64::from(2u32 << i);
            SlopePoint { tau_s: m / 250.0, deviation: *d, edf: 3_105_250.0 / m }
        })
        .collect()
}

/// Octaves `from` to `to`, counted from 1 at m = 2.
fn octaves(axis: usize, from: usize, to: usize) -> Vec<SlopePoint> {
    points(axis)[from - 1..to].to_vec()
}

#[test]
fn lines_through_the_octaves_of_the_publication_give_its_coefficients() {
    // (term, octaves, published for all three axes together, re-derived for each).
    type Row = (NoiseType, (usize, usize), f64, [f64; 3]);
    let rows: [Row; 3] = [
        (NoiseType::AngleRandomWalk, (6, 8), 5.945877e-5, [5.497052e-5, 6.697536e-5, 5.709563e-5]),
        (NoiseType::Quantization, (1, 4), 7.208553e-6, [6.861007e-6, 7.883837e-6, 6.924984e-6]),
        (NoiseType::RateRandomWalk, (10, 13), 3.062325e-5, [3.318692e-5, 2.965052e-5, 2.918465e-5]),
    ];
    for (term, (from, to), together, each) in rows {
        let in_seconds = |value: f64| match term {
            NoiseType::AngleRandomWalk => value * SECONDS.sqrt(),
            NoiseType::RateRandomWalk => value / SECONDS.sqrt(),
            _ => value,
        };
        let mut product = 1.0;
        for (axis, expected) in each.into_iter().enumerate() {
            let got = in_seconds(through(&octaves(axis, from, to), term).unwrap().value);
            assert!((got / expected - 1.0).abs() < 1e-6, "{term:?} {axis}: {got} {expected}");
            product *= got;
        }
        assert!((product.cbrt() / together - 1.0).abs() < 1e-6, "{term:?}: {}", product.cbrt());
    }
}

#[test]
fn octaves_that_have_the_slope_are_found_and_others_are_not_read() {
    for axis in 0..3 {
        let all = points(axis);
        let n = read(&all, NoiseType::AngleRandomWalk).unwrap();
        // Between the published octaves and those before them, where quantisation still counts.
        assert!(n.from_s >= 0.064 && n.to_s <= 1.024, "{axis}: {n:?}");
        let by_hand = through(&octaves(axis, 6, 8), NoiseType::AngleRandomWalk).unwrap().value;
        assert!((n.value / by_hand - 1.0).abs() < 0.12, "{axis}: {n:?} {by_hand}");
        let q = read(&all, NoiseType::Quantization).unwrap();
        assert!(q.from_s <= 0.016 && q.to_s <= 0.064, "{axis}: {q:?}");
        let by_hand = through(&octaves(axis, 1, 4), NoiseType::Quantization).unwrap().value;
        assert!((q.value / by_hand - 1.0).abs() < 0.12, "{axis}: {q:?} {by_hand}");
        // The published K was read where the curve is flat: no octave there has the slope of a random walk.
        assert_eq!(read(&octaves(axis, 10, 13), NoiseType::RateRandomWalk), None, "{axis}");
    }
    // Axis X climbs in proportion to τ beyond 250 s.
    let ramp = read(&points(0), NoiseType::RateRamp).unwrap();
    assert!(ramp.from_s > 200.0 && ramp.points >= 3, "{ramp:?}");
}
