//! The catalogue of effects: forward models, searches and detectors on the truths of its own tests.

use crate::stored::Figures;
use crate::truths::{drivers, noise, true_values, truth};
use sagnac_core::effect::{
    Background, Detector, Drivers, EFFECTS, Effect, FlatResidual, Later, MeanModel, ModeBin, Model, Rows,
    SearchContext, SpectralContext, Spectrum, SpectrumAct, Value, Values, find,
};
use sagnac_core::noise::composite::{Composite, Damped};
use sagnac_core::noise::model::NoiseModel;
use sagnac_core::numeric::cosine::dct2;

/// A course on its truth with white noise: what a search finds, and what every part of the model gives there.
fn mean(figures: &mut Figures, effect: &dyn Effect, course: &dyn MeanModel) {
    let kind = effect.kind();
    let (drivers, numbers) = truth(kind);
    let stated = true_values(effect, &numbers);
    let truth = course.course(&stated, &drivers).unwrap();
    figures.add(format!("{kind} course"), &truth);
    let sigma = 0.05;
    let residual: Vec<f64> =
        noise(11, drivers.samples, sigma).iter().zip(&truth).map(|(e, t)| e + t).collect();
    let mean = residual.iter().sum::<f64>() / residual.len() as f64;
    let score: Vec<f64> = residual.iter().map(|r| (r - mean) / (sigma * sigma)).collect();
    let modes = dct2(&residual);
    let mut powers = vec![sigma * sigma; residual.len()];
    powers[0] = f64::INFINITY;
    let context = SearchContext { score: &score, modes: &modes, powers: &powers };
    let starts = course.starts(&drivers, &context);
    let properties = (
        course.resolution(),
        course.replaces(),
        course.whole(),
        course.steps(&drivers),
        course.bic_parameters(3),
    );
    figures.add(format!("{kind} search"), &(&starts, course.bounds(&drivers), properties));
    for (at, point) in starts.points.iter().enumerate().take(2) {
        let parts = course.regressors(point, &drivers);
        let coefficients: Vec<f64> = (0..parts.columns.len()).map(|k| 0.7 - 0.4 * k as f64).collect();
        let numbers = course.parameters(point, &coefficients, &drivers);
        let bends = course.curvature_within_average(&numbers, &drivers);
        let told = (
            course.lists(point, &coefficients, &drivers),
            course.texts(point, &drivers),
            course.formula(point, &coefficients, &drivers),
            course.places(point, &coefficients, &drivers),
            course.odds(point, &drivers),
            course.modes(point, &drivers),
        );
        let gains: Vec<f64> = parts.columns.iter().map(|c| context.gain(c)).collect();
        figures.add(format!("{kind} regressors {at}"), &(&parts, gains));
        figures.add(format!("{kind} parameters {at}"), &(numbers, bends, told));
        let earlier = starts.points.iter().map(|p| course.same_cause(p, point)).collect::<Vec<_>>();
        let coarse = drivers.averages(8);
        let coarse = (course.applies(&coarse), course.regressors(point, &coarse));
        figures.add(format!("{kind} averages {at}"), &(earlier, coarse));
    }
    let sizings = course.sizings(&drivers);
    let sized = |s: &sagnac_core::effect::Sizing| course.sized_course(s, &stated, 0.5, &drivers);
    let sized: Vec<_> = sizings.iter().map(sized).collect();
    figures.add(format!("{kind} sizes"), &(sizings, sized, course.nuisance_columns(&stated, &drivers)));
    let bare = Drivers { claim: drivers.claim, ..drivers.bare() };
    let without = |d: &Drivers| (course.applies(d), course.bounds(d), course.course(&stated, d));
    figures.add(format!("{kind} without columns"), &without(&bare));
    let still = |column: &Option<Vec<f64>>| column.as_ref().map(|c| vec![c[0]; c.len()]);
    let resting = Drivers {
        temperature: still(&drivers.temperature),
        table_rate: still(&drivers.table_rate),
        supply: still(&drivers.supply),
        ..drivers
    };
    figures.add(format!("{kind} at rest"), &without(&resting));
}

fn bins() -> Vec<ModeBin> {
    let (n, dt_s) = (8192usize, 0.1);
    let (mut bins, mut low) = (vec![], 1usize);
    while low < n {
        let modes = (low / 12).max(1).min(n - low);
        let frequency_hz = (low as f64 + 0.5 * (modes as f64 - 1.0)) / (2.0 * n as f64 * dt_s);
        bins.push(ModeBin { frequency_hz, mode: low, modes, samples: n, dt_s, even_ends: low % 2 == 0 });
        low += modes;
    }
    bins
}

/// Fitted parameters of a spectrum that a record of [`bins`] resolves.
fn fitted(kind: &str) -> Vec<f64> {
    match kind {
        "markov_short" => vec![0.4, 0.3],
        "markov_long" => vec![40.0, 0.2],
        "quasi_periodic" => vec![0.9, 0.2, 30.0],
        "quantization" => vec![0.1],
        "bandwidth_filter" => vec![1.5],
        "unobserved_driver" => vec![0.3, 200.0],
        "power_law_noise" => vec![0.3, 0.6, 0.05],
        _ => vec![0.2],
    }
}

/// A change of the spectrum: density, simulation, and the search in a spectrum that scatters.
fn spectrum(figures: &mut Figures, kind: &str, spectrum: &dyn Spectrum) {
    let (fitted, bins) = (fitted(kind), bins());
    let white = 3600.0 * 0.003f64.powi(2);
    figures.add(format!("{kind} density"), &(spectrum.act(), spectrum.densities(&fitted, &bins)));
    let density = |b: &ModeBin| match spectrum.act() {
        SpectrumAct::Filters => white * spectrum.density(&fitted, b),
        SpectrumAct::Unconstrains(_) => 2.0 * white,
        SpectrumAct::Adds => white + spectrum.density(&fitted, b),
    };
    let scatter = noise(5, bins.len(), 0.5);
    let observed: Vec<f64> =
        bins.iter().zip(&scatter).map(|(b, e)| density(b) * (e / (b.modes as f64).sqrt()).exp()).collect();
    let expected = vec![white; bins.len()];
    for (name, step) in [("search", None), ("search in steps", Some(0.5))] {
        let context =
            SpectralContext { bins: &bins, observed: &observed, expected: &expected, grid_step_arcsec: step };
        let searched = (spectrum.starts(&context), spectrum.bounds(&context), spectrum.trials(&context));
        let told = (spectrum.places(&fitted, &context), spectrum.sizing(&context));
        figures.add(format!("{kind} {name}"), &(searched, told));
    }
    let mut composite = Composite::from(NoiseModel { n: 0.01, b: 0.02, k: 0.03, ..NoiseModel::default() });
    spectrum.compose(&fitted, 0.1, &mut composite);
    figures.add(format!("{kind} model"), &(composite, spectrum.low_pass(&fitted, 0.1)));
    let parameters = spectrum.parameters(&fitted);
    let of: Vec<_> =
        (0..fitted.len()).map(|p| (spectrum.scales_with(p), spectrum.is_refined(&fitted, p))).collect();
    let ends = (spectrum.edge_effect(&fitted, 0.1), spectrum.zeros_hz(&fitted, 0.1));
    let flags =
        (spectrum.repeats(), spectrum.is_relaxation(), spectrum.has_course(), spectrum.plausible(&fitted));
    let damped = |frequency_hz: f64, decay_time_s: f64| Damped { rms_deg_h: 0.2, frequency_hz, decay_time_s };
    let processes = [damped(0.0, 0.2), damped(0.0, 50.0), damped(0.3, 100.0)];
    let values: Vec<_> = processes.iter().map(|p| spectrum.values_of(p, 0.1)).collect();
    let extremes: Vec<_> = [0.02, 30.0]
        .iter()
        .map(|f| {
            let scaled: Vec<f64> = fitted.iter().map(|x| x * f).collect();
            (spectrum.plausible(&scaled), spectrum.densities(&scaled, &bins))
        })
        .collect();
    figures.add(format!("{kind} properties"), &(parameters, of, ends, flags, values, extremes));
}

/// What an effect on samples states.
fn stated(kind: &str) -> Values {
    let number = |name: &str, x: f64| (name.to_owned(), Value::Number(x));
    let list = |name: &str, x: &[f64]| (name.to_owned(), Value::List(x.to_vec()));
    match kind {
        "outlier_bursts" => Values::from([
            list("bursts_time_s", &[1200.0, 2000.5]),
            list("bursts_duration_s", &[1.5, 4.0]),
            list("bursts_size_deg_h", &[0.8, 0.5]),
        ]),
        "random_telegraph" => Values::from([number("amplitude_deg_h", 0.25), number("mean_dwell_s", 90.0)]),
        "dropped_samples" => Values::from([number("missing_rows", 40.0), number("gaps", 5.0)]),
        "repeated_samples" => {
            Values::from([number("repeated_share", 0.05), number("repeated_rows_each", 3.0)])
        }
        "noise_variance_time" => Values::from([
            list("knots_time_s", &[1000.0, 1700.0, 2500.0]),
            list("knots_ratio", &[0.7, 2.0, 0.9]),
        ]),
        "noise_variance_rate" => Values::from([number("ratio", 3.0), number("exponent", 2.0)]),
        "noise_variance_driver" => Values::from([
            ("column".to_owned(), Value::Text("temp_degC".to_owned())),
            list("knots_value", &[10.0, 25.0, 40.0]),
            list("knots_ratio", &[0.6, 1.0, 2.2]),
        ]),
        _ => Values::from([number("ratio", 3.0)]),
    }
}

fn found(
    detector: &Detector,
    drivers: &Drivers,
    rate: &[f64],
    keep: &[bool],
    figures: &mut Figures,
    name: &str,
) {
    let n = rate.len();
    let gaps: Vec<(usize, usize)> = (0..n).filter(|i| !keep[*i]).map(|i| (i, 1usize)).collect();
    let rows = Rows { rate, present: keep, gaps: &gaps, start_s: drivers.start_s, dt_s: drivers.dt_s };
    let flat: Vec<f64> = rate.iter().map(|r| r / 0.05).collect();
    let residual = FlatResidual {
        white: flat.clone(),
        flat,
        per_deg_h: 20.0,
        ends: 4,
        usable: keep,
        drivers,
        rounding_step: 0.0,
    };
    let samples: Vec<usize> = (0..n).filter(|i| residual.counts(*i)).collect();
    match detector {
        Detector::Invalid { test, rows: detector } => figures.add(name, &(test, detector.find(&rows))),
        Detector::Missing(detector) => figures.add(name, &detector.find(&rows)),
        Detector::Outliers(detector) => {
            let outliers = detector.find(&residual);
            let told = outliers.as_ref().and_then(|o| detector.describe(o, rate, drivers));
            figures.add(name, &(outliers, told));
        }
        Detector::Level(detector) => {
            figures
                .add(name, &(detector.laws(&residual, &samples), detector.instants_of_change(samples.len())));
        }
        Detector::Jumps(detector) => {
            let mut powers = vec![0.05f64.powi(2); n];
            powers[0] = f64::INFINITY;
            let background = Background {
                drivers,
                modes: dct2(rate),
                powers,
                columns: vec![],
                lost: 0.0,
                grid_step_arcsec: None,
            };
            let jumps = detector.find(&background, &|| 12.5);
            if let Some(jumps) = &jumps {
                let own = &jumps.detection.stated;
                let process = detector.process(own).map(|(e, p)| (e.kind(), p));
                figures.add(format!("{name} process"), &(process, detector.agrees(own, &jumps.detection)));
            }
            figures.add(name, &jumps);
        }
    }
}

fn later(effect: &dyn Effect, values: &Values) -> String {
    match effect.later(values, &drivers().claim) {
        Later::Same => "the same".to_owned(),
        Later::Nothing => "nothing".to_owned(),
        Later::As(other, values) => format!("{} {values:?}", other.kind()),
    }
}

#[test]
fn courses() {
    let mut figures = Figures::default();
    for effect in EFFECTS {
        if let Model::Mean(course) = effect.model() {
            mean(&mut figures, *effect, course);
        }
    }
    figures.check("courses.txt");
}

#[test]
fn spectra() {
    let mut figures = Figures::default();
    for effect in EFFECTS {
        if let Model::Spectrum(model) = effect.model() {
            spectrum(&mut figures, effect.kind(), model);
        }
    }
    figures.check("spectra.txt");
}

/// What simulation does with an effect on samples, and what its detector finds in that and in a record without it.
#[test]
fn samples() {
    let mut figures = Figures::default();
    let mut drivers = drivers();
    drivers.truncate(3000);
    for effect in EFFECTS {
        let Model::Samples(samples) = effect.model() else { continue };
        let kind = effect.kind();
        let even = noise(23, drivers.samples, 0.05);
        let last = even.len() as f64;
        let rising = even.iter().enumerate().map(|(i, e)| e * (0.5 + 2.0 * i as f64 / last)).collect();
        for (level, mut rate) in [("", even), (" in rising noise", rising)] {
            let mut keep = vec![true; rate.len()];
            let name = format!("{kind}{level}");
            found(&samples.detector(), &drivers, &rate, &keep, &mut figures, &format!("{name} not there"));
            samples.apply(&stated(kind), &drivers, 7, &mut rate, &mut keep);
            let dropped = keep.iter().filter(|k| !**k).count();
            figures.add(format!("{name} applied"), &(&rate, dropped));
            found(&samples.detector(), &drivers, &rate, &keep, &mut figures, &name);
        }
    }
    figures.check("samples.txt");
}

/// What every effect says of itself, and what a later record shows of it.
#[test]
fn properties() {
    let mut figures = Figures::default();
    for effect in EFFECTS {
        let other = |e: Option<&'static dyn Effect>| e.map(|e| e.kind());
        let kinds = (effect.kind(), effect.reported_kind(), effect.in_format(), effect.domain());
        let laws: Vec<&str> = effect.named_by_law().iter().map(|e| e.kind()).collect();
        let relations = (effect.needs(), laws, effect.family());
        let others = (other(effect.reversed_pair()), other(effect.if_few_cycles()), effect.is_short_events());
        let names: Vec<_> =
            effect.params().iter().map(|p| (p.name, p.unit, p.lower, p.upper, p.signed, p.whole)).collect();
        let lists: Vec<&str> = effect.list_params().iter().map(|p| p.name).collect();
        let named = (names, lists, effect.text_params(), effect.sets_level(), effect.rounding().is_some());
        figures.add(effect.kind(), &(kinds, relations, others, named));
        let values = match effect.model() {
            Model::Mean(_) => true_values(*effect, &truth(effect.kind()).1),
            _ => stated(effect.kind()),
        };
        figures.add(format!("{} later", effect.kind()), &later(*effect, &values));
        if let Some(by_course) = effect.claimed_by_course() {
            let knots: Vec<sagnac_core::effect::Knot> = (0..12)
                .map(|i| sagnac_core::effect::Knot {
                    at: 1000.0 + 200.0 * f64::from(i),
                    value: f64::from(i % 5),
                })
                .collect();
            let values = by_course.values(&knots);
            let course = effect.claimed_course(&values, &drivers());
            figures.add(format!("{} by course", effect.kind()), &(by_course.process(&values), course));
        }
        if let Some(rounding) = effect.rounding() {
            let stated = Values::from([("q_arcsec".to_owned(), Value::Number(0.2))]);
            let told = (rounding.step_arcsec(&stated), rounding.detection(0.7, 0.01, 0.1));
            figures.add(format!("{} rounding", effect.kind()), &told);
        }
    }
    assert!(find("line").is_some());
    figures.check("properties.txt");
}
