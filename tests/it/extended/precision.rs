//! Every estimator against a slow reference of 704 bits on records that spoil careless sums.

use crate::extended::exact::arithmetic::{X, sum};
use crate::extended::exact::records::{Record, hard_records};
use crate::extended::exact::reference as slow;
use crate::extended::exact::worst::{ALLOWED, FLOOR, Worst};
use sagnac::noise::autocorrelation::{of_series, of_spectrum};
use sagnac::noise::block_series::BlockSeriesAccumulator;
use sagnac::noise::data::NoiseType;
use sagnac::noise::digest::{DigestPlan, RateAccumulator, RateDigest};
use sagnac::noise::evidence::Evidence;
use sagnac::noise::family::Estimator;
use sagnac::noise::identification::linear_fit::{Likelihood, SPECTRAL_TERM_COUNT};
use sagnac::noise::model::TERMS;

const WINDOWS: [u64; 2] = [8, 100];

fn digest(record: &Record) -> RateDigest {
    let plan = DigestPlan {
        estimators: Estimator::ALL.to_vec(),
        window_lengths_s: WINDOWS.iter().map(|w| *w as f64).collect(),
        ..DigestPlan::new(1.0)
    };
    let mut a = RateAccumulator::new(plan);
    for (first, samples) in &record.stretches {
        // In pieces of odd length, as a file delivers them.
        for (k, part) in samples.chunks(777).enumerate() {
            a.push(part, first + 777 * k as u64, k > 0);
        }
    }
    a.finish()
}

fn slices(record: &Record) -> Vec<&[f64]> {
    record.stretches.iter().map(|s| s.1.as_slice()).collect()
}

#[test]
fn the_allan_family_is_right_on_hard_records() {
    let mut worst = Worst::default();
    for record in hard_records() {
        let found = digest(&record);
        let phases: Vec<Vec<X>> = slices(&record).into_iter().map(slow::phase).collect();
        let longest = phases.iter().rev().max_by_key(|x| x.len()).unwrap();
        for curve in &found.deviations.curves {
            let reference = |m: usize| match curve.estimator {
                Estimator::Allan => slow::overlapping_allan(&phases, m),
                Estimator::Modified => slow::modified_allan(&phases, m),
                Estimator::Hadamard => slow::overlapping_hadamard(&phases, m),
                Estimator::Total => slow::total(longest, m),
            };
            for point in &curve.points {
                let m = point.m as usize;
                let expected = reference(m).expect("a term");
                let what = format!("m = {m}");
                worst.compare(
                    curve.estimator.id(),
                    record.name,
                    &what,
                    point.deviation,
                    expected,
                    record.range(),
                );
            }
            let beyond = curve.points.last().map_or(1, |p| 2 * p.m as usize);
            assert!(
                matches!(curve.estimator, Estimator::Total | Estimator::Modified)
                    || reference(beyond).is_none(),
                "{} stops at {beyond} on {}",
                curve.estimator.id(),
                record.name
            );
        }
    }
    worst.print();
    worst.assert_none_wrong();
}

#[test]
fn means_windows_and_envelopes_are_right_on_hard_records() {
    let mut worst = Worst::default();
    for record in hard_records() {
        let found = digest(&record);
        let all: Vec<f64> = record.samples().collect();
        let largest = all.iter().fold(0.0f64, |m, v| m.max(v.abs()));
        // A mean is a double itself: it is known to the rounding of the values.
        worst.compare("mean", record.name, "mean", found.mean, slow::mean(&all).to_f64(), largest);
        for (w, got) in WINDOWS.iter().zip(&found.windows) {
            let means: Vec<X> = slices(&record)
                .into_iter()
                .flat_map(|y| y.chunks_exact(*w as usize).map(slow::mean).collect::<Vec<_>>())
                .collect();
            assert_eq!(got.n, means.len() as u64, "{}", record.name);
            if means.len() < 2 {
                assert!(got.standard_deviation.is_nan(), "{}", record.name);
                continue;
            }
            let expected = slow::standard_deviation(&means);
            let what = format!("means over {w}");
            worst.compare(
                "window deviation",
                record.name,
                &what,
                got.standard_deviation,
                expected,
                record.range(),
            );
        }
        for bin in found.envelope.bins.iter().enumerate().filter(|(_, b)| b.count > 0).step_by(97) {
            let from = found.envelope.first_index + bin.0 as u64 * found.envelope.bin_len;
            let inside: Vec<f64> = record
                .stretches
                .iter()
                .flat_map(|(first, y)| y.iter().enumerate().map(move |(i, v)| (first + i as u64, *v)))
                .filter(|(i, _)| (from..from + found.envelope.bin_len).contains(i))
                .map(|p| p.1)
                .collect();
            assert_eq!(bin.1.count, inside.len() as u64);
            worst.compare("envelope", record.name, "mean", bin.1.mean, slow::mean(&inside).to_f64(), largest);
            assert_eq!(bin.1.min, inside.iter().copied().fold(f64::INFINITY, f64::min));
            assert_eq!(bin.1.max, inside.iter().copied().fold(f64::NEG_INFINITY, f64::max));
        }
    }
    worst.print();
    worst.assert_none_wrong();
}

#[test]
fn the_histogram_is_right_on_hard_records() {
    let mut worst = Worst::default();
    for record in hard_records() {
        let found = digest(&record).histogram;
        let blocks: Vec<&[f64]> =
            slices(&record).into_iter().flat_map(|y| y.chunks(1024)).filter(|b| b.len() >= 64).collect();
        let counted: u64 = found.counts.iter().sum::<u64>() + found.below + found.above;
        assert_eq!(counted, blocks.iter().map(|b| b.len() as u64).sum::<u64>(), "{}", record.name);
        if blocks.is_empty() {
            assert_eq!(found.standard_deviation, 0.0);
            continue;
        }
        let (sigma, skewness, kurtosis) = slow::moments(&blocks);
        worst.compare(
            "histogram deviation",
            record.name,
            "",
            found.standard_deviation,
            sigma,
            record.range(),
        );
        worst.compare("histogram skewness", record.name, "", found.skewness, skewness, 1.0);
        worst.compare("histogram kurtosis", record.name, "", found.excess_kurtosis, kurtosis, 1.0);
    }
    worst.print();
    worst.assert_none_wrong();
}

#[test]
fn spectrum_and_autocorrelation_are_right_on_hard_records() {
    let mut worst = Worst::default();
    for record in hard_records() {
        let found = digest(&record);
        let spectrum = &found.welch.spectrum;
        if spectrum.segments > 0 {
            let peak = spectrum.density.iter().copied().fold(0.0, f64::max);
            let last = spectrum.segment_len / 2;
            let bins = [0, 1, 2, 5, 13, last / 2, last];
            let expected = slow::welch(&slices(&record), spectrum.segment_len, &bins);
            for (k, expected) in bins.iter().zip(expected) {
                // A transform is known to the rounding of its largest values (Higham 2002, theorem 24.2).
                let leaked = 16.0 * f64::EPSILON;
                let known_to = leaked * (expected * peak).sqrt() + leaked * leaked * peak;
                let (got, what) = (spectrum.density[*k], format!("bin {k}"));
                worst.compare("welch", record.name, &what, got, expected, known_to / (ALLOWED * FLOOR));
            }
            match of_spectrum(spectrum, 4) {
                Some(found) => assert!(found.coefficients.iter().all(|c| c.is_finite()), "{}", record.name),
                None => assert_eq!(record.range(), 0.0, "{}", record.name),
            }
        } else {
            assert!(record.samples().count() < 64, "{}", record.name);
            assert!(of_spectrum(spectrum, 4).is_none());
        }
        let series = found.blocks.about_first();
        match of_series(&series, 5) {
            Some(found) => {
                let mut original = vec![f64::NAN; series.len()];
                for (first, y) in &record.stretches {
                    y.iter().enumerate().for_each(|(i, v)| original[*first as usize + i] = *v);
                }
                for lag in [1, 2, 5] {
                    let Some(got) = found.coefficients.get(lag) else { continue };
                    let expected = slow::autocorrelation(&original, lag);
                    worst.compare("autocorrelation", record.name, &format!("lag {lag}"), *got, expected, 1.0);
                }
            }
            None => assert!(record.range() == 0.0 || record.samples().count() < 2, "{}", record.name),
        }
    }
    worst.print();
    worst.assert_none_wrong();
}

#[test]
fn block_means_and_their_modes_are_right_on_hard_records() {
    let mut worst = Worst::default();
    for record in hard_records() {
        let whole = record.stretches.len() == 1;
        let mut a = BlockSeriesAccumulator::with_max_blocks(300);
        for (first, y) in &record.stretches {
            for (k, part) in y.chunks(777).enumerate() {
                a.push(part, first + 777 * k as u64);
            }
        }
        let blocks = a.finish();
        let length = blocks.block_len as usize;
        let first = X::from(blocks.mean[0]);
        let mut means = vec![];
        for (k, got) in blocks.about_first().iter().enumerate() {
            let (from, to) = (k as u64 * blocks.block_len, (k as u64 + 1) * blocks.block_len);
            let inside: Vec<f64> = record
                .stretches
                .iter()
                .flat_map(|(first, y)| y.iter().enumerate().map(move |(i, v)| (first + i as u64, *v)))
                .filter(|(i, _)| (from..to).contains(&(i - blocks.first_index)))
                .map(|p| p.1)
                .collect();
            assert_eq!(blocks.count[k] as usize, inside.len());
            if inside.is_empty() {
                assert!(got.is_nan());
                continue;
            }
            let mean = slow::mean(&inside);
            let about = (&mean - &first).to_f64();
            worst.compare("block mean", record.name, &format!("block {k}"), *got, about, record.range());
            // A block with less than an eighth of its samples counts as empty.
            if 8 * inside.len() >= length {
                means.push(mean);
            }
        }
        // Cosine modes of a record without gaps: the low bands of the evidence are one mode each.
        let evidence = Evidence::new(&blocks, None, 1.0, &[]);
        if means.len() < 16 {
            assert!(evidence.bands.is_empty(), "{}", record.name);
            continue;
        }
        if !whole {
            continue;
        }
        let power = record.range().powi(2) * length as f64;
        for (k, band) in evidence.bands.iter().enumerate().take(24) {
            let expected = slow::squared_mode(&means, k + 1) * X::from(length);
            let what = format!("mode {}", k + 1);
            worst.compare("cosine mode", record.name, &what, band.power, expected.to_f64(), 1e-12 * power);
        }
        likelihood(&mut worst, record.name, &evidence);
    }
    worst.print();
    worst.assert_none_wrong();
}

/// −2 ln L at the point that a fit ends at, summed slowly; and the point must not be beaten by its neighbours.
fn likelihood(worst: &mut Worst, record: &'static str, evidence: &Evidence) {
    let power: f64 = evidence.bands.iter().map(|b| b.power).sum();
    let Some(likelihood) = Likelihood::new(evidence) else {
        assert!(power == 0.0 || evidence.bands.len() < 8, "{record}: no likelihood");
        return;
    };
    let columns: Vec<Vec<f64>> =
        TERMS.iter().take(SPECTRAL_TERM_COUNT).map(|t| evidence.expectation(t)).collect();
    let white = TERMS.iter().position(|t| *t == NoiseType::AngleRandomWalk).unwrap();
    for with_ramp in [false, true] {
        let structure = [true, true, true, true, with_ramp];
        let Some(point) = likelihood.maximise(&structure, None, None) else {
            panic!("{record}: no maximum");
        };
        let slowly = |variance: &[f64; SPECTRAL_TERM_COUNT]| -> X {
            let mut total = X::zero();
            let mut information = X::zero();
            let r = X::from(point.ramp);
            for (i, band) in evidence.bands.iter().enumerate() {
                let s = sum((0..SPECTRAL_TERM_COUNT).map(|t| X::from(columns[t][i]) * X::from(variance[t])));
                let left = X::from(band.power) - X::from(2.0) * &r * X::from(band.cross)
                    + r.square() * X::from(band.ramp);
                let left = if left.is_positive() { left } else { X::zero() };
                information = information + X::from(band.dof) * X::from(band.ramp) / &s;
                total = total + X::from(band.dof) * (s.ln() + left / &s);
            }
            if with_ramp { total + information.ln() } else { total }
        };
        let expected = slowly(&point.variance);
        let size = evidence.dof();
        worst.compare("likelihood", record, "at its maximum", point.deviance, expected.to_f64(), 1e3 * size);
        for factor in [0.9, 1.1] {
            let mut beside = point.variance;
            beside[white] *= factor;
            let higher = slowly(&beside).to_f64() >= expected.to_f64() - 1e-5;
            assert!(higher, "{record}: N² times {factor} is more likely");
        }
    }
}
