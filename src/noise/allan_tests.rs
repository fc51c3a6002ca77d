use super::super::family::non_overlapping;
use super::*;

fn plan(grid: TauGrid) -> AllanPlan {
    AllanPlan { tau0_s: 1.0, grid, exact: false, estimators: Estimator::ALL.to_vec() }
}

fn analyse(samples: &[f64], grid: TauGrid) -> DeviationSet {
    let mut allan = AllanAccumulator::new(plan(grid));
    allan.push(samples, 0, false);
    allan.finish()
}

fn value(set: &DeviationSet, estimator: Estimator, m: u64) -> f64 {
    set.curve(estimator).unwrap().points.iter().find(|p| p.m == m).unwrap().deviation
}

/// The thousand-point set of SP 1065 section 12.4.
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

fn white(count: usize, seed: u64) -> Vec<f64> {
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};
    let mut rng = rand_xoshiro::Xoshiro256PlusPlus::seed_from_u64(seed);
    (0..count).map(|_| StandardNormal.sample(&mut rng)).collect()
}

#[test]
fn nine_points_of_sp1065() {
    let y = [892.0, 809.0, 823.0, 798.0, 671.0, 644.0, 883.0, 903.0, 677.0];
    let set = analyse(&y, TauGrid::All);
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
    let set = analyse(&y, TauGrid::All);
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
fn a_large_offset_costs_no_digits_that_the_samples_hold() {
    let y = suite();
    // 2^20 and multiples of 2^-30 add without rounding: both records hold the same noise exactly.
    let plain: Vec<f64> = y.iter().map(|v| (v * 1_073_741_824.0).round() / 1_073_741_824.0).collect();
    let offset: Vec<f64> = plain.iter().map(|v| v + 1_048_576.0).collect();
    let (a, b) = (analyse(&plain, TauGrid::All), analyse(&offset, TauGrid::All));
    for (a, b) in a.curves.iter().zip(&b.curves) {
        for (p, q) in a.points.iter().zip(&b.points) {
            assert!((p.deviation / q.deviation - 1.0).abs() < 1e-9, "{:?} {p:?} {q:?}", a.estimator);
        }
    }
}

/// The definitions, term by term on the rate.
fn slow(stretches: &[&[f64]], m: usize, estimator: Estimator) -> Option<f64> {
    let (mut sum, mut terms) = (0.0, 0u64);
    for y in stretches {
        let mean = |i: usize| y[i..i + m].iter().sum::<f64>() / m as f64;
        match estimator {
            Estimator::Allan if y.len() >= 2 * m => {
                for i in 0..=y.len() - 2 * m {
                    sum += (mean(i + m) - mean(i)).powi(2) / 2.0;
                    terms += 1;
                }
            }
            Estimator::Hadamard if y.len() >= 3 * m => {
                for i in 0..=y.len() - 3 * m {
                    sum += (mean(i + 2 * m) - 2.0 * mean(i + m) + mean(i)).powi(2) / 6.0;
                    terms += 1;
                }
            }
            Estimator::Modified if y.len() + 1 >= 3 * m => {
                for j in 0..=y.len() + 1 - 3 * m {
                    let inner: f64 = (j..j + m).map(|i| mean(i + m) - mean(i)).sum::<f64>() / m as f64;
                    sum += inner * inner / 2.0;
                    terms += 1;
                }
            }
            _ => {}
        }
    }
    (terms > 0).then(|| (sum / terms as f64).sqrt())
}

#[test]
fn gaps_split_and_blocks_do_not_matter() {
    let y = white(6000, 3);
    let parts = [&y[..37], &y[40..2000], &y[2001..2004], &y[2500..6000]];
    let mut allan = AllanAccumulator::new(plan(TauGrid::Decade));
    allan.push(parts[0], 0, false);
    allan.push(&parts[1][..700], 40, true);
    allan.push(&parts[1][700..], 740, true);
    allan.push(parts[2], 2001, false);
    for (k, block) in parts[3].chunks(111).enumerate() {
        allan.push(block, 2500 + 111 * k as u64, k > 0);
    }
    let set = allan.finish();
    assert_eq!((set.stretches.count(), set.stretches.samples(), set.stretches.longest()), (4, 5500, 3500));
    for estimator in [Estimator::Allan, Estimator::Modified, Estimator::Hadamard] {
        let curve = set.curve(estimator).unwrap();
        assert!(curve.points.last().unwrap().m * estimator.span() > 2800);
        for p in curve.points.iter().filter(|p| p.m < 200) {
            let expected = slow(&parts, p.m as usize, estimator).unwrap();
            assert!((p.deviation / expected - 1.0).abs() < 1e-11, "{estimator:?} {p:?} {expected}");
        }
    }
    assert_eq!(set.curve(Estimator::Total).unwrap().stretches, StretchLengths::of(3500));
}

#[test]
fn strided_sums_are_the_strided_textbook_sums() {
    let y = white(8_000, 4);
    let parts = [&y[..2999], &y[3001..]];
    let factors = [1, 7, 64, 127, 128, 200, 251, 512];
    let kinds = [Estimator::Allan, Estimator::Modified, Estimator::Hadamard];
    for dense in [0, 300] {
        let mut sums = StridedSums::new(&kinds, &factors, dense);
        for part in parts {
            let mut phase = vec![0.0];
            part.iter().for_each(|v| phase.push(phase[phase.len() - 1] + v));
            phase.chunks(777).for_each(|block| sums.push(block));
            sums.end_stretch();
        }
        for estimator in kinds {
            let points = sums.points(estimator);
            assert_eq!(points.len(), factors.len());
            for p in points {
                let (m, s) = (p.m as usize, p.stride as usize);
                assert!(s == 1 || (p.m >= dense && s * 64 <= m));
                let (mut expected, mut terms) = (0.0, 0);
                for part in parts {
                    let windows = estimator.terms(part.len() as u64, p.m, 1) as usize;
                    for from in (0..windows).step_by(s) {
                        let to = (from + estimator.span() as usize * m
                            - usize::from(estimator == Estimator::Modified))
                        .min(part.len());
                        let one = slow(&[&part[from..to]], m, estimator).unwrap();
                        expected += one * one;
                        terms += 1;
                    }
                }
                assert_eq!(p.terms, terms as u64, "{estimator:?} {m}");
                let expected = (expected / terms as f64).sqrt();
                assert!((p.deviation / expected - 1.0).abs() < 1e-9, "{estimator:?} {p:?} {expected}");
            }
        }
    }
}

#[test]
fn a_long_record_goes_on_strided_and_stays_close() {
    let count = KEPT_SAMPLES as usize + 500_000;
    let y = white(count, 5);
    let run = |exact| {
        let estimators = vec![Estimator::Allan, Estimator::Total];
        let mut allan = AllanAccumulator::new(AllanPlan { exact, estimators, ..plan(TauGrid::Octave) });
        for (k, block) in y.chunks(100_000).enumerate() {
            allan.push(block, 100_000 * k as u64, k > 0);
        }
        allan.finish()
    };
    let (strided, exact) = (run(false), run(true));
    assert!(strided.curve(Estimator::Total).is_none() && exact.curve(Estimator::Total).is_some());
    let (strided, exact) = (&strided.curves[0].points, &exact.curves[0].points);
    assert_eq!(strided.len(), exact.len());
    for (s, e) in strided.iter().zip(exact) {
        assert_eq!(s.m, e.m);
        let tolerance = if s.stride == 1 { 1e-10 } else { 3e-2 };
        assert!((s.deviation / e.deviation - 1.0).abs() < tolerance, "{s:?} {e:?}");
    }
    assert!(strided.iter().any(|p| p.stride > 1000));
}

#[test]
fn white_angle_noise_keeps_every_term() {
    let angle = white(KEPT_SAMPLES as usize + 300_001, 6);
    let y: Vec<f64> = angle.windows(2).map(|w| w[1] - w[0]).collect();
    let mut allan =
        AllanAccumulator::new(AllanPlan { estimators: vec![Estimator::Allan], ..plan(TauGrid::Octave) });
    allan.push(&y, 0, false);
    let set = allan.finish();
    for p in set.curves[0].points.iter().filter(|p| p.m <= 1024) {
        assert_eq!(p.stride, 1);
        let expected = 3f64.sqrt() / p.m as f64;
        assert!((p.deviation / expected - 1.0).abs() < 5e-3, "{p:?} {expected}");
    }
}

#[test]
fn nothing_gives_nothing_and_constants_give_zero() {
    let empty = AllanAccumulator::new(plan(TauGrid::Octave)).finish();
    assert!(empty.curves.iter().all(|c| c.points.is_empty()));
    let flat = analyse(&[5.0; 100], TauGrid::Octave);
    assert!(flat.curves.iter().all(|c| !c.points.is_empty() && c.points.iter().all(|p| p.deviation == 0.0)));
}
