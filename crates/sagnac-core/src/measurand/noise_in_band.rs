//! Output noise: rms over the whole band, density in bands, largest ratio to a mask.

use super::descriptor::Measurand;
use super::evidence::GyroEvidence;
use crate::estimate::{Estimate, LowerLimit, Spread};
use crate::message::{Arg, Note, note};
use crate::noise::histogram::Histogram;
use crate::noise::in_band::{Band, NoiseTest, OutputSpectrum, rms_dof};

/// Standard deviation of the samples about their means over 1024 samples.
pub static OUTPUT_NOISE_RMS: Measurand = Measurand::of_noise_test(
    "output_noise_rms",
    "deg/h",
    "rms of the output noise over the whole band of the recording",
    |m, gyro, _| vec![rms(m, gyro)],
)
.also_called(&["output_noise", "rms_noise", "noise_rms"])
.needs_stillness()
.formulas(
    &["σ² = Σ (y − ȳ_b)² / (n − n_b)", "ν = 2σ⁴ / var(σ²)", "var(σ²) = (2/T) ∫ S(f)² df"],
    "Bendat, Piersol, Random Data, 2010",
);

/// One-sided density in a band.
pub static RATE_NOISE_DENSITY: Measurand = Measurand::of_noise_test(
    "rate_noise_density",
    "deg/h/sqrt(Hz)",
    "one-sided rate noise density in a band, lines left out",
    |m, gyro, test| test.bands.iter().map(|band| density(m, gyro, *band, test.bands.len() > 1)).collect(),
)
.also_called(&["noise_density", "rnd"])
.needs_stillness()
.formulas(
    &[
        "G(f) = 2 S(f), f > 0",
        "g² = (1/m) Σ G(f_k), f₁ ≤ f_k ≤ f₂",
        "ν = 2M m² / (m + 2c (m − 1))",
        "g = 60·√2·N",
    ],
    "Welch, IEEE Trans. Audio Electroacoust. 15 (1967) 70",
);

/// Largest ratio of the density to a mask.
pub static SPECTRAL_MASK: Measurand = Measurand::of_noise_test(
    "spectral_mask",
    "1",
    "largest ratio of the one-sided noise density to the mask",
    |m, gyro, test| if test.mask.is_empty() { vec![] } else { vec![mask(m, gyro, test)] },
)
.also_called(&["noise_mask", "mask_ratio"])
.needs_stillness()
.formulas(
    &["r² = (1/m) Σ G(f_k) / g(f_k)²", "max L(p/K) ≤ max r ≤ max U(p)"],
    "Bonferroni; Berger, Technometrics 24 (1982) 295",
);

const RMS_METHOD: &str = "about_block_means";
const DENSITY_METHOD: &str = "welch_band";
const MASK_METHOD: &str = "welch_mask";
/// Confidence of a bound from below.
const LOWER_BOUND_CONFIDENCE: f64 = 0.95;
/// Standard deviations between the quartiles of a normal law.
const QUARTILE_DISTANCE_SIGMAS: f64 = 1.348_979_500_392_163_5;

fn rms(m: &Measurand, gyro: &GyroEvidence) -> Estimate {
    let histogram = &gyro.digest.histogram;
    let Some(dof) = rms_dof(&gyro.digest, &gyro.lines) else {
        return m.not_identifiable(&gyro.channel, None, RMS_METHOD).note(note!("in_band.no_scatter"));
    };
    let row = m.measured(&gyro.channel, histogram.standard_deviation, Spread::ChiSquare { dof }, RMS_METHOD);
    let band = note!("in_band.whole_band", highest_hz = 0.5 / gyro.tau0_s, rate_hz = 1.0 / gyro.tau0_s);
    let robust = robust_deviation(histogram).map(|robust| note!("in_band.robust", robust));
    robust.into_iter().chain(of_lines(gyro, None, "in_band.lines_in")).fold(row.note(band), Estimate::note)
}

/// Distance of the quartiles as that of a normal law; `None` where they lie in one bin.
fn robust_deviation(histogram: &Histogram) -> Option<f64> {
    let quantile = |share: f64| {
        let wanted = share * histogram.samples as f64;
        let mut before = histogram.below as f64;
        for (bin, count) in histogram.counts.iter().enumerate() {
            let count = *count as f64;
            if before + count >= wanted && count > 0.0 {
                return Some((
                    bin,
                    histogram.from + (bin as f64 + (wanted - before) / count) * histogram.bin_width,
                ));
            }
            before += count;
        }
        None
    };
    let (low, high) = (quantile(0.25)?, quantile(0.75)?);
    (low.0 < high.0).then(|| (high.1 - low.1) / QUARTILE_DISTANCE_SIGMAS)
}

fn density(m: &Measurand, gyro: &GyroEvidence, band: Band, several: bool) -> Estimate {
    let channel = match several {
        true => format!("{}@{}", gyro.channel, band.name()),
        false => gyro.channel.clone(),
    };
    let withheld = |why: Note| m.not_identifiable(&channel, None, DENSITY_METHOD).note(why);
    let Some(spectrum) = spectrum(gyro) else { return withheld(note!("in_band.too_short")) };
    if !spectrum.shows(band) {
        return withheld(not_shown(&spectrum));
    }
    let Some(mean) = spectrum.mean(band, |_| 1.0) else { return withheld(note!("in_band.no_bin")) };
    let row = m.measured(&channel, mean.power.sqrt(), Spread::ChiSquare { dof: mean.dof }, DENSITY_METHOD);
    let told =
        note!("in_band.band", from_hz = band.from_hz, to_hz = band.to_hz, dof = Arg::figures(mean.dof, 3));
    of_lines(gyro, Some(band), "in_band.lines_out").into_iter().fold(row.note(told), Estimate::note)
}

fn mask(m: &Measurand, gyro: &GyroEvidence, test: &NoiseTest) -> Estimate {
    let withheld = |why: Note| m.not_identifiable(&gyro.channel, None, MASK_METHOD).note(why);
    let Some(spectrum) = spectrum(gyro) else { return withheld(note!("in_band.too_short")) };
    let Some((first, last)) = test.mask.first().zip(test.mask.last()) else {
        return withheld(note!("in_band.too_short"));
    };
    let whole = Band { from_hz: first.frequency_hz, to_hz: last.frequency_hz };
    let Some(found) = spectrum.mask_ratio(&test.mask) else { return withheld(not_shown(&spectrum)) };
    let worst = note!(
        "in_band.worst",
        from_hz = Arg::figures(found.section.from_hz, 3),
        to_hz = Arg::figures(found.section.to_hz, 3),
        sections = found.sections
    );
    let row = match spectrum.shows(whole) {
        true => m.measured(&gyro.channel, found.ratio, found.spread, MASK_METHOD),
        false => {
            let least = found.spread.bound(found.ratio, 1.0 - LOWER_BOUND_CONFIDENCE);
            let least = least.map(|value| LowerLimit { value, coverage: LOWER_BOUND_CONFIDENCE });
            withheld(not_shown(&spectrum)).at_least(least)
        }
    };
    of_lines(gyro, Some(whole), "in_band.lines_out").into_iter().fold(row.note(worst), Estimate::note)
}

fn spectrum(gyro: &GyroEvidence) -> Option<OutputSpectrum> {
    OutputSpectrum::of(&gyro.digest.welch, gyro.tau0_s, &gyro.lines)
}

/// Says which frequencies the record shows.
fn not_shown(spectrum: &OutputSpectrum) -> Note {
    let range = spectrum.range();
    note!("in_band.not_shown", from_hz = Arg::figures(range.from_hz, 3), to_hz = Arg::figures(range.to_hz, 4))
}

/// A note on the lines in a band (`None`: anywhere), with the strongest.
fn of_lines(gyro: &GyroEvidence, band: Option<Band>, key: &'static str) -> Option<Note> {
    let within = |hz: f64| band.is_none_or(|b| (b.from_hz..=b.to_hz).contains(&hz));
    let lines = || gyro.lines.iter().filter(|l| within(l.frequency_hz));
    let strongest = lines().max_by(|a, b| a.amplitude_deg_h.total_cmp(&b.amplitude_deg_h))?;
    let note = Note::new(key).with("lines", lines().count());
    Some(
        note.with("frequency_hz", Arg::figures(strongest.frequency_hz, 4))
            .with("amplitude", Arg::figures(strongest.amplitude_deg_h, 3)),
    )
}

#[cfg(test)]
mod tests {
    use super::super::Options;
    use super::super::test_evidence::{chi_square, curve, gyro, notes, number, shows, withholds, within};
    use super::*;
    use crate::noise::digest::{DigestPlan, RateAccumulator};
    use crate::noise::in_band::MaskPoint;

    /// 8192 samples of 0.5 s that scatter evenly between −1 and 1 deg/h: a variance of 1/3.
    fn even() -> GyroEvidence {
        let mut state = 1u64;
        let mut next = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            2.0 * (state >> 11) as f64 / (1u64 << 53) as f64 - 1.0
        };
        let samples: Vec<f64> = (0..8192).map(|_| next()).collect();
        let mut accumulator = RateAccumulator::new(DigestPlan::new(0.5));
        accumulator.push(&samples, 0, false);
        let mut gyro = gyro();
        gyro.digest = accumulator.finish();
        gyro.noise_test = Some(NoiseTest::default());
        gyro
    }

    fn row(m: &Measurand, gyro: &GyroEvidence) -> Estimate {
        m.evaluate_gyro(gyro, &Options { remove_earth_rate: false }).remove(0)
    }

    #[test]
    fn the_rms_is_stated_with_its_band_and_a_robust_value() {
        let gyro = even();
        let found = row(&OUTPUT_NOISE_RMS, &gyro);
        within(found.value.unwrap(), (1.0f64 / 3.0).sqrt(), 0.02);
        assert!((chi_square(&found) / 8192.0 - 1.0).abs() < 0.15);
        assert_eq!(number(&found, "in_band.whole_band", "highest_hz"), 1.0);
        // The quartiles of an even law lie 1 apart.
        within(number(&found, "in_band.robust", "robust"), 1.0 / QUARTILE_DISTANCE_SIGMAS, 0.03);
        let mut flat = even();
        flat.digest.histogram.standard_deviation = 0.0;
        withholds(&row(&OUTPUT_NOISE_RMS, &flat), None, RMS_METHOD);
    }

    #[test]
    fn a_density_is_one_sided_and_named_by_its_band_where_there_are_several() {
        let mut gyro = even();
        let band = Band { from_hz: 0.1, to_hz: 0.9 };
        gyro.noise_test = Some(NoiseTest { bands: vec![band], mask: vec![] });
        let found = row(&RATE_NOISE_DENSITY, &gyro);
        // 2·(1/3)·0.5 s.
        within(found.value.unwrap(), (1.0f64 / 3.0).sqrt(), 0.03);
        assert_eq!((found.channel.as_str(), found.unit), ("g", "deg/h/sqrt(Hz)"));
        gyro.noise_test =
            Some(NoiseTest { bands: vec![band, Band { from_hz: 0.5, to_hz: 1.5 }], mask: vec![] });
        let found = RATE_NOISE_DENSITY.evaluate_gyro(&gyro, &Options { remove_earth_rate: false });
        assert_eq!(found[0].channel, "g@0.1-0.9Hz");
        withholds(&found[1], None, DENSITY_METHOD);
        assert_eq!(notes(&found[1]), ["in_band.not_shown"]);
    }

    #[test]
    fn a_mask_gives_its_largest_ratio_or_at_least_so_much() {
        let mut gyro = even();
        let mask = |to_hz: f64| {
            let corner = |frequency_hz| MaskPoint { frequency_hz, density: 0.5 };
            Some(NoiseTest { bands: vec![], mask: vec![corner(0.05), corner(to_hz)] })
        };
        gyro.noise_test = mask(0.95);
        let found = row(&SPECTRAL_MASK, &gyro);
        let ratio = found.value.unwrap();
        shows(&found, ratio, MASK_METHOD);
        // √(1/3)/0.5, and more by the scatter of the sections.
        assert!((1.15..1.45).contains(&ratio), "{ratio}");
        let points = curve(&found);
        assert!(points.windows(2).all(|w| w[0].1 <= w[1].1), "{points:?}");
        gyro.noise_test = mask(3.0);
        let part = row(&SPECTRAL_MASK, &gyro);
        withholds(&part, None, MASK_METHOD);
        let least = part.lower_limit.unwrap().value;
        assert!((1.0..1.2).contains(&least), "{least}");
        assert_eq!(notes(&part), ["in_band.not_shown", "in_band.worst"]);
    }
}
