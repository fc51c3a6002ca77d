use super::*;

fn plan(grid: TauGrid) -> AllanPlan {
    AllanPlan { tau0_s: 1.0, grid, exact: false, estimators: Estimator::ALL.to_vec() }
}

fn analyse(samples: &[f64], grid: TauGrid) -> DeviationSet {
    let mut allan = AllanAccumulator::new(plan(grid));
    allan.push(samples, 0, false);
    allan.finish()
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

#[test]
fn scale_and_direction_of_time_change_nothing_else() {
    let y = suite();
    let forward = analyse(&y, TauGrid::Decade);
    let scaled = analyse(&y.iter().map(|v| -8.0 * v).collect::<Vec<_>>(), TauGrid::Decade);
    let backward = analyse(&y.iter().rev().copied().collect::<Vec<_>>(), TauGrid::Decade);
    for (k, curve) in forward.curves.iter().enumerate() {
        for (i, p) in curve.points.iter().enumerate() {
            assert_eq!(scaled.curves[k].points[i].deviation, 8.0 * p.deviation);
            assert!((backward.curves[k].points[i].deviation / p.deviation - 1.0).abs() < 1e-10);
        }
    }
}

#[test]
fn hadamard_does_not_see_a_drift_and_allan_sees_its_closed_form() {
    let ramp: Vec<f64> = (0..4096).map(|i| 1e-3 * f64::from(i)).collect();
    let set = analyse(&ramp, TauGrid::Octave);
    for p in &set.curve(Estimator::Allan).unwrap().points {
        let expected = 1e-3 * p.m as f64 / 2f64.sqrt();
        assert!((p.deviation / expected - 1.0).abs() < 1e-9, "{p:?}");
    }
    assert!(set.curve(Estimator::Hadamard).unwrap().points.iter().all(|p| p.deviation < 1e-9));
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

/// Variance of strided over full estimates of σ², over simulated records: the loss of degrees of freedom.
fn scatter_of_strided_over_full(walk: bool, records: u64) -> f64 {
    let (count, m, step) = (8192, 256usize, 4);
    let mut pairs = vec![];
    for seed in 0..records {
        let mut y = white(count, 5000 + seed);
        if walk {
            (1..count).for_each(|i| y[i] += y[i - 1]);
        }
        let mut x = vec![0.0];
        y.iter().for_each(|v| x.push(x[x.len() - 1] + v));
        let term = |i: usize| (x[i + 2 * m] - 2.0 * x[i + m] + x[i]).powi(2);
        let mean = |step: usize| {
            let n = (x.len() - 2 * m).div_ceil(step);
            (0..n).map(|k| term(k * step)).sum::<f64>() / n as f64
        };
        pairs.push((mean(1), mean(step)));
    }
    let variance = |pick: fn(&(f64, f64)) -> f64| {
        let mean = pairs.iter().map(pick).sum::<f64>() / pairs.len() as f64;
        pairs.iter().map(|p| (pick(p) - mean).powi(2)).sum::<f64>() / (pairs.len() - 1) as f64
    };
    variance(|p| p.1) / variance(|p| p.0)
}

#[test]
fn a_stride_of_one_sixty_fourth_scatters_no_more() {
    for walk in [false, true] {
        let ratio = scatter_of_strided_over_full(walk, 60);
        assert!((0.99..1.01).contains(&ratio), "walk {walk}: {ratio}");
    }
}

#[test]
fn a_long_record_goes_on_strided_and_stays_close() {
    let count = MAX_KEPT_SAMPLES as usize + 500_000;
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
    let angle = white(MAX_KEPT_SAMPLES as usize + 300_001, 6);
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
