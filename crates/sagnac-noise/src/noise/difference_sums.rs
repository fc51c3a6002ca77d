//! Sums of squared second and third differences of phase: the inner loops of the Allan family.

use super::phase::Compensated;
use crate::numeric::parallel;

const SIMD_LANES: usize = 8;
/// Starting points taken through every averaging factor before the next are fetched from memory.
const CHUNK_POINTS: usize = 2048;
/// Starting points in one parallel task. Fixed, so that sums do not depend on the number of threads.
const TASK_POINTS: usize = 8 * CHUNK_POINTS;
/// Tasks of running windows that one thread takes side by side.
const SIDE_BY_SIDE: usize = 4;

/// Σ (c − 2b + a)² over the common length.
pub(crate) fn second(a: &[f64], b: &[f64], c: &[f64]) -> f64 {
    let n = a.len().min(b.len()).min(c.len());
    let (a, b, c) = (&a[..n], &b[..n], &c[..n]);
    let mut sums = [0.0; SIMD_LANES];
    let mut chunks = (a.chunks_exact(SIMD_LANES), b.chunks_exact(SIMD_LANES), c.chunks_exact(SIMD_LANES));
    for ((a, b), c) in (&mut chunks.0).zip(&mut chunks.1).zip(&mut chunks.2) {
        for k in 0..SIMD_LANES {
            let d = (c[k] - b[k]) - (b[k] - a[k]);
            sums[k] += d * d;
        }
    }
    let rest = chunks.0.remainder().iter().zip(chunks.1.remainder()).zip(chunks.2.remainder());
    sums.iter().sum::<f64>()
        + rest
            .map(|((a, b), c)| {
                let d = (c - b) - (b - a);
                d * d
            })
            .sum::<f64>()
}

/// Σ (d − 3c + 3b − a)² over the common length.
pub(crate) fn third(a: &[f64], b: &[f64], c: &[f64], d: &[f64]) -> f64 {
    let n = a.len().min(b.len()).min(c.len()).min(d.len());
    let (a, b, c, d) = (&a[..n], &b[..n], &c[..n], &d[..n]);
    let square = |a: f64, b: f64, c: f64, d: f64| {
        let e = ((d - c) - (c - b)) - ((c - b) - (b - a));
        e * e
    };
    let mut sums = [0.0; SIMD_LANES];
    let mut chunks = (
        a.chunks_exact(SIMD_LANES),
        b.chunks_exact(SIMD_LANES),
        c.chunks_exact(SIMD_LANES),
        d.chunks_exact(SIMD_LANES),
    );
    for (((a, b), c), d) in (&mut chunks.0).zip(&mut chunks.1).zip(&mut chunks.2).zip(&mut chunks.3) {
        for k in 0..SIMD_LANES {
            sums[k] += square(a[k], b[k], c[k], d[k]);
        }
    }
    let rest = chunks.0.remainder().iter().zip(chunks.1.remainder());
    let rest = rest.zip(chunks.2.remainder()).zip(chunks.3.remainder());
    sums.iter().sum::<f64>() + rest.map(|(((a, b), c), d)| square(*a, *b, *c, *d)).sum::<f64>()
}

/// Σ of squared differences of order `order` (2 or 3) at `lag` whose last point is at `from_end` or later,
/// and their number.
pub(crate) fn ending_from(x: &[f64], lag: usize, order: usize, from_end: usize) -> (f64, u64) {
    let start = from_end.saturating_sub(order * lag);
    let Some(count) = x.len().checked_sub(start + order * lag) else { return (0.0, 0) };
    let at = |k: usize| &x[start + k * lag..start + k * lag + count];
    let sum = if order == 2 { second(at(0), at(1), at(2)) } else { third(at(0), at(1), at(2), at(3)) };
    (sum, count as u64)
}

/// Sums of all squared differences of order 2 or 3 in one stretch of phase, one for each ascending factor.
///
/// Starting points go outside and factors inside, so that memory is read about once for all small factors; for octaves
/// the point 2m of one factor is the point m of the next.
pub(crate) fn all_overlapping(x: &[f64], factors: &[u64], order: usize) -> Vec<f64> {
    let tasks: Vec<usize> = (0..x.len()).step_by(TASK_POINTS).collect();
    let partial: Vec<Vec<f64>> = parallel::map_items(&tasks, |&task| {
        let mut sums = vec![0.0; factors.len()];
        for from in (task..(task + TASK_POINTS).min(x.len())).step_by(CHUNK_POINTS) {
            for (sum, &m) in sums.iter_mut().zip(factors) {
                let lag = m as usize;
                let Some(end) = x.len().checked_sub(order * lag) else { break };
                let to = (from + CHUNK_POINTS).min(end);
                if to <= from {
                    break;
                }
                let at = |k: usize| &x[from + k * lag..to + k * lag];
                *sum +=
                    if order == 2 { second(at(0), at(1), at(2)) } else { third(at(0), at(1), at(2), at(3)) };
            }
        }
        sums
    });
    (0..factors.len()).map(|k| total(partial.iter().map(|p| p[k]))).collect()
}

/// Sums of squared window sums of second differences in one stretch of phase: the modified Allan variance, one for
/// each factor. A running window: what enters and leaves it are the same numbers, so that it does not drift.
pub(crate) fn all_modified(x: &[f64], factors: &[u64]) -> Vec<f64> {
    parallel::map_items(factors, |&m| {
        let m = m as usize;
        let Some(windows) = (x.len() + 1).checked_sub(3 * m) else { return 0.0 };
        let task = TASK_POINTS.max(4 * m);
        let (tasks, full) = (windows.div_ceil(task), windows / task);
        let sums: Vec<Vec<f64>> = parallel::map(tasks.div_ceil(SIDE_BY_SIDE), |group| {
            let first = group * SIDE_BY_SIDE;
            if first + SIDE_BY_SIDE <= full {
                let from: [usize; SIDE_BY_SIDE] = std::array::from_fn(|k| (first + k) * task);
                return sliding(x, m, from, task).to_vec();
            }
            let one = |k: usize| {
                let [sum] = sliding(x, m, [k * task], task.min(windows - k * task));
                sum
            };
            (first..tasks.min(first + SIDE_BY_SIDE)).map(one).collect()
        });
        total(sums.into_iter().flatten())
    })
}

/// Sums of squared window sums from some windows on, so many each. Each window follows from the one before, so that one series of them
/// waits for every sum: several go side by side, with the sums that each has alone.
fn sliding<const N: usize>(x: &[f64], m: usize, from: [usize; N], windows: usize) -> [f64; N] {
    let difference = |i: usize| (x[i + 2 * m] - x[i + m]) - (x[i + m] - x[i]);
    let mut window: [f64; N] = from.map(|from| (from..from + m).map(difference).sum());
    let mut sums = window.map(|w| {
        let mut sum = Compensated::default();
        sum.add(w * w);
        sum
    });
    let mut moves = [[0.0; CHUNK_POINTS]; N];
    let mut done = 1;
    while done < windows {
        let count = CHUNK_POINTS.min(windows - done);
        for (moves, from) in moves.iter_mut().zip(from) {
            // From the window before to this one the difference at the first point leaves, and that at the one behind the last enters.
            let at = |k: usize| {
                let begin = from + done - 1 + k * m;
                &x[begin..begin + count]
            };
            let points = at(0).iter().zip(at(1)).zip(at(2)).zip(at(3));
            for (out, (((a, b), c), d)) in moves.iter_mut().zip(points) {
                *out = ((d - c) - (c - b)) - ((c - b) - (b - a));
            }
        }
        let mut partial = [0.0; N];
        for k in 0..count {
            for ((window, partial), moves) in window.iter_mut().zip(&mut partial).zip(&moves) {
                *window += moves[k];
                *partial += *window * *window;
            }
        }
        sums.iter_mut().zip(partial).for_each(|(sum, partial)| sum.add(partial));
        done += count;
    }
    sums.map(|sum| sum.value())
}

/// Sum of squared second differences of the phase continued by odd reflection beyond both ends, over all inner points
/// (total Allan variance, SP 1065 section 5.2.11). `inside` is the sum over the terms that need no continuation.
pub(crate) fn with_reflection(x: &[f64], m: usize, inside: f64) -> f64 {
    let points = x.len();
    let (Some(&first), Some(&last)) = (x.first(), x.last()) else { return 0.0 };
    if 2 * m >= points {
        return f64::NAN;
    }
    let mut edges = Compensated::default();
    for i in 1..m {
        let left = 2.0 * first - x[m - i];
        let d = (x[i + m] - x[i]) - (x[i] - left);
        edges.add(d * d);
        let j = points - 1 - i;
        let right = 2.0 * last - x[points - 1 - (m - i)];
        let d = (right - x[j]) - (x[j] - x[j - m]);
        edges.add(d * d);
    }
    inside + edges.value()
}

fn total(parts: impl Iterator<Item = f64>) -> f64 {
    let mut sum = Compensated::default();
    parts.for_each(|p| sum.add(p));
    sum.value()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_of_a_short_phase_by_hand() {
        let x = [0.0, 1.0, 4.0, 9.0, 17.0, 25.0];
        // Second differences at lag 1: 2, 2, 3, 0; at lag 2: (17 − 2·4 + 0) = 9 and (25 − 2·9 + 1) = 8.
        assert_eq!(ending_from(&x, 1, 2, 0), (17.0, 4));
        assert_eq!(ending_from(&x, 2, 2, 0), (145.0, 2));
        // Third differences at lag 1: 0, 1, −3.
        assert_eq!(ending_from(&x, 1, 3, 0), (10.0, 3));
        // Terms that end in the last two points.
        assert_eq!(ending_from(&x, 1, 2, 4), (9.0, 2));
        assert_eq!(ending_from(&x, 3, 2, 0), (0.0, 0));
        assert_eq!(all_overlapping(&x, &[1, 2], 2), [17.0, 145.0]);
        // Window sums of two neighbouring differences at lag 2: 9 + 8.
        assert_eq!(all_modified(&x, &[1, 2]), [17.0, 289.0]);
    }

    #[test]
    fn lanes_and_remainders_add_to_the_plain_sum() {
        let x: Vec<f64> = (0..5003u32).map(|i| f64::from(i.wrapping_mul(2_654_435_761) >> 20)).collect();
        let plain = |lag: usize| -> f64 {
            (0..x.len() - 2 * lag).map(|i| (x[i + 2 * lag] - 2.0 * x[i + lag] + x[i]).powi(2)).sum()
        };
        for lag in [1, 7, 64, 2317] {
            let sum = all_overlapping(&x, &[lag as u64], 2)[0];
            assert!(plain(lag) > 0.0 && (sum / plain(lag) - 1.0).abs() < 1e-12, "{lag}");
        }
    }

    #[test]
    fn windows_side_by_side_have_the_sums_that_they_have_alone() {
        let noise = |i: u32| f64::from(i.wrapping_mul(2_654_435_761) >> 20) - 2048.0;
        let x: Vec<f64> = (0..5 * TASK_POINTS as u32).map(noise).collect();
        for m in [1, 5, 900] {
            let from = [0, 17, TASK_POINTS, 2 * TASK_POINTS + 3];
            let alone = from.map(|from| sliding(&x, m, [from], TASK_POINTS)[0]);
            assert_eq!(sliding(&x, m, from, TASK_POINTS), alone);
            let window =
                |j: usize| -> f64 { (j..j + m).map(|i| (x[i + 2 * m] - x[i + m]) - (x[i + m] - x[i])).sum() };
            let plain: f64 = (0..x.len() + 1 - 3 * m).map(|j| window(j).powi(2)).sum();
            let sum = all_modified(&x, &[m as u64])[0];
            assert!((sum / plain - 1.0).abs() < 1e-11, "{m}: {sum} {plain}");
        }
    }

    #[test]
    fn odd_reflection_continues_a_straight_line() {
        let line: Vec<f64> = (0..50).map(|i| 3.0 * f64::from(i) - 7.0).collect();
        assert!(with_reflection(&line, 9, 0.0).abs() < 1e-20);
        assert!(with_reflection(&line, 25, 0.0).is_nan());
        // One raised point, m = 2. Left: the phase before is −1, (0 − 1) − (1 + 1) = −3. Right: (0 − 0) − (0 − 1) = 1.
        assert!((with_reflection(&[0.0, 1.0, 0.0, 0.0, 0.0], 2, 0.0) - 10.0).abs() < 1e-15);
    }
}
