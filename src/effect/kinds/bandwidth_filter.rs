//! The output is low-pass filtered.

use super::search::log_grid;
use crate::effect::{
    Both, Doc, Domain, ModeBin, Param, Place, SpectralLook, Spectrum, SpectrumAct, Values, number,
};
use crate::noise::composite::{Bandwidth, Composite, Sampling};
use crate::noise::data::NoiseType;
use std::f64::consts::PI;

pub struct BandwidthFilter;

static DOC: Doc = Doc {
    title: Both { en: "bandwidth of the output", ru: "полоса пропускания выхода" },
    mechanism: Both {
        en: "A loop or an output filter of the instrument passes slow rates and damps fast ones.",
        ru: "Контур обратной связи или выходной фильтр прибора пропускает медленные изменения и подавляет быстрые.",
    },
    formula: "|H|² = 1/(1 + (f/f_c)²) before sampling",
    signature: Both {
        en: "The spectrum falls towards the Nyquist frequency below the claimed level; neighbouring samples correlate positively.",
        ru: "Спектр спадает к частоте Найквиста ниже заявленного уровня; соседние отсчёты коррелируют положительно.",
    },
    told_by: Both {
        en: "A short Markov process adds power at low frequencies instead of taking it from high ones; less white noise lowers all frequencies alike.",
        ru: "Короткий марковский процесс добавляет мощность внизу, а не отнимает её вверху; уменьшение белого шума опускает все частоты одинаково.",
    },
    confirm: Both {
        en: "Response to a step of the table's rate, recorded at the full output rate.",
        ru: "Реакция на скачок скорости стола, записанная с полной частотой выдачи.",
    },
    source: "First-order low-pass filter before averaging over the sample interval",
};

static PARAMS: [Param; 1] = [Param::reported("cutoff_hz", "Hz", 1e-9, 1e9)];

describe! {
    BandwidthFilter, "bandwidth_filter", Spectrum in Frequency, needs [],
    confusers ["markov_short", "excess_arw", "time_offset"]
}

fn filter(fitted: &[f64]) -> Bandwidth {
    let cutoff = fitted.first().copied().unwrap_or(1e9).max(1e-12);
    Bandwidth::FirstOrder { time_constant_s: 1.0 / (2.0 * PI * cutoff) }
}

impl Spectrum for BandwidthFilter {
    fn act(&self) -> SpectrumAct {
        SpectrumAct::Filters
    }

    /// What the filter leaves of white noise: slower noise lies where it leaves everything.
    fn density(&self, fitted: &[f64], bin: &ModeBin) -> f64 {
        let white = |f: Bandwidth| {
            f.unit_density(NoiseType::AngleRandomWalk, bin.frequency_hz, bin.dt_s, Sampling::Averaging)
        };
        white(filter(fitted)) / 3600.0
    }

    fn starts(&self, look: &SpectralLook<'_>) -> Vec<Vec<f64>> {
        let (low, high) = self.bounds(look)[0];
        let fit = |cutoff: f64| {
            let terms = look.bins.iter().enumerate().map(|(i, bin)| {
                let s = (look.expected[i] * self.density(&[cutoff], bin)).max(1e-300);
                bin.modes as f64 * (s.ln() + look.observed[i] / s)
            });
            terms.sum::<f64>()
        };
        let mut rated: Vec<(f64, f64)> =
            log_grid(2.0 * low, 0.7 * high, 16).into_iter().map(|c| (fit(c), c)).collect();
        rated.sort_by(|a, b| a.0.total_cmp(&b.0));
        rated.into_iter().take(2).map(|(_, c)| vec![c]).collect()
    }

    fn bounds(&self, look: &SpectralLook<'_>) -> Vec<(f64, f64)> {
        let (dt, n) = look.bins.first().map_or((1.0, 64), |b| (b.dt_s, b.samples));
        vec![((10.0 / (n as f64 * dt)).min(0.1 / dt), 3.0 / dt)]
    }

    fn looked(&self, look: &SpectralLook<'_>) -> f64 {
        let (low, high) = self.bounds(look)[0];
        (high / low).ln().max(1.0)
    }

    fn parameters(&self, fitted: &[f64]) -> Vec<f64> {
        fitted.to_vec()
    }

    fn stated(&self, values: &Values) -> Option<Vec<f64>> {
        number(values, PARAMS[0].name).filter(|c| *c > 0.0).map(|c| vec![c])
    }

    fn compose(&self, fitted: &[f64], noise: &mut Composite) {
        noise.bandwidth = Some(filter(fitted));
    }

    fn places(&self, fitted: &[f64], look: &SpectralLook<'_>) -> Vec<Place> {
        let (Some(cutoff), Some(bin)) = (fitted.first(), look.bins.first()) else { return vec![] };
        let nyquist = 0.5 / bin.dt_s;
        vec![Place { domain: Domain::Frequency, from: (0.5 * cutoff).min(0.5 * nyquist), to: nyquist }]
    }
}
