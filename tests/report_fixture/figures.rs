//! Figures with invented numbers: a white-noise gyro of N = 0.0023 deg/sqrt(h) over ten hours.

use sagnac::figure::{Axis, Figure, Layer, Panel, Scale, Style};

const N: f64 = 0.0023;

/// Noise that is the same everywhere and every time.
fn noise(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    move || {
        let mut sum = 0.0;
        for _ in 0..12 {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            sum += (state >> 11) as f64 / (1u64 << 53) as f64;
        }
        sum - 6.0
    }
}

fn axis(label: &'static str, unit: &str, scale: Scale) -> Axis {
    Axis { label, unit: unit.into(), scale, range: None }
}

fn line(points: Vec<(f64, f64)>, style: Style, legend: &str) -> Layer {
    Layer::Line { points, style, legend: legend.into() }
}

pub fn all() -> Vec<Figure> {
    vec![time_series(), sigma_tau(), spectrum(), autocorrelation(), histogram()]
}

pub fn time_series() -> Figure {
    let mut g = noise(1);
    let rate: Vec<(f64, f64)> = (0..1200)
        .map(|i| {
            let t = 30.0 * f64::from(i);
            let v = -0.0123 + 0.05 * (-t / 700.0).exp() + 0.025 * g();
            (t, if (22_000.0..22_600.0).contains(&t) { f64::NAN } else { v })
        })
        .collect();
    let temperature: Vec<(f64, f64)> = (0..1200)
        .map(|i| 30.0 * f64::from(i))
        .map(|t| (t, 20.0 + 0.12 * (t / 5000.0).sin() - 0.3 * (-t / 900.0).exp()))
        .collect();
    let spans = || {
        [(0.0, 1800.0), (22_000.0, 22_600.0)].map(|(from, to)| Layer::Span {
            from,
            to,
            style: Style::Muted,
            legend: "figure.legend.left_out".into(),
        })
    };
    let x = axis("axis.time", "s", Scale::Linear);
    let mut upper: Vec<Layer> = spans().into();
    upper.push(line(rate, Style::Data, "figure.legend.rate"));
    let mut lower: Vec<Layer> = spans().into();
    lower.push(line(temperature, Style::SecondData, "figure.legend.temperature"));
    for at in [19.6, 20.4] {
        lower.push(Layer::Horizontal { at, style: Style::Limit, legend: "figure.legend.limit".into() });
    }
    Figure {
        id: "time_series".into(),
        title: "figure.title.time_series",
        channel: String::new(),
        panels: vec![
            Panel { x: x.clone(), y: axis("axis.rate", "deg/h", Scale::Linear), layers: upper },
            Panel { x, y: axis("axis.temperature", "degC", Scale::Linear), layers: lower },
        ],
        remarks: vec![],
    }
}

pub fn sigma_tau() -> Figure {
    let mut g = noise(7);
    let white = |tau: f64| N / (tau / 3600.0).sqrt();
    let total = |tau: f64| {
        (white(tau).powi(2) + (0.664 * 0.0012f64).powi(2) + 2.0e-4f64.powi(2) * tau / 10_800.0).sqrt()
    };
    let points: Vec<(f64, f64)> = (0..14)
        .map(|k| {
            let tau = 2f64.powi(k);
            (tau, total(tau) * (1.0 + 0.35 * (tau / 36_000.0).sqrt() * g()))
        })
        .collect();
    let (good, poor): (Vec<_>, Vec<_>) = points.iter().copied().partition(|p| p.0 <= 7200.0);
    let band = points
        .iter()
        .map(|(t, s)| {
            let u = 0.9 * (t / 36_000.0).sqrt();
            (*t, s / (1.0 + u), s * (1.0 + 2.0 * u))
        })
        .collect();
    let grid: Vec<f64> = (0..60).map(|i| 10f64.powf(f64::from(i) * 4.0 / 59.0)).collect();
    let term = |f: &dyn Fn(f64) -> f64| grid.iter().map(|t| (*t, f(*t))).collect::<Vec<_>>();
    let layers = vec![
        Layer::Band { points: band, style: Style::Data, legend: "figure.legend.band95".into() },
        line(term(&|t| white(t)), Style::Term(0), "figure.legend.angle_random_walk"),
        line(term(&|_| 0.664 * 0.0012), Style::Term(1), "figure.legend.bias_instability"),
        line(term(&|t| 2.0e-4 * (t / 10_800.0).sqrt()), Style::Term(2), "figure.legend.rate_random_walk"),
        line(term(&total), Style::Model, "figure.legend.model"),
        line(good.clone(), Style::Data, "figure.legend.allan"),
        Layer::Points { points: good, style: Style::Data, legend: "figure.legend.allan".into() },
        line(poor.clone(), Style::Muted, "figure.legend.unreliable"),
        Layer::Points { points: poor, style: Style::Muted, legend: "figure.legend.unreliable".into() },
        Layer::Horizontal { at: 0.0015, style: Style::Limit, legend: "figure.legend.limit".into() },
        Layer::Points {
            points: vec![(100.0, 0.0139)],
            style: Style::Reference,
            legend: "figure.legend.russian".into(),
        },
        Layer::Label { at: (100.0, 0.0139), text: "σ₁₀₀ = 0.0139 °/h".into() },
        Layer::Label { at: (3600.0, N), text: "N = 0.00231 °/√h".into() },
    ];
    Figure {
        id: "sigma_tau".into(),
        title: "figure.title.sigma_tau",
        channel: String::new(),
        panels: vec![Panel {
            x: axis("axis.averaging_time", "s", Scale::Log),
            y: axis("axis.allan_deviation", "deg/h", Scale::Log),
            layers,
        }],
        remarks: vec![],
    }
}

pub fn spectrum() -> Figure {
    let mut g = noise(3);
    let floor = N * N * 3600.0;
    let points: Vec<(f64, f64)> = (1..=2048)
        .map(|k| {
            let f = f64::from(k) / 4096.0;
            let line = if k == 341 { 38.0 } else { 1.0 };
            (f, floor * line * (1.0 + 0.16 * g() + 2e-7 / (f * f)))
        })
        .collect();
    Figure {
        id: "spectrum".into(),
        title: "figure.title.spectrum",
        channel: String::new(),
        panels: vec![Panel {
            x: axis("axis.frequency", "Hz", Scale::Log),
            y: axis("axis.density", "(deg/h)^2/Hz", Scale::Log),
            layers: vec![
                line(points, Style::Data, "figure.legend.spectrum"),
                line(
                    vec![(2.4e-4, floor * 1.3), (2e-3, floor), (0.5, floor)],
                    Style::Model,
                    "figure.legend.model",
                ),
                Layer::Points {
                    points: vec![(341.0 / 4096.0, floor * 38.0)],
                    style: Style::Reference,
                    legend: "figure.legend.line".into(),
                },
                Layer::Label { at: (341.0 / 4096.0, floor * 38.0), text: "0.0833 Hz".into() },
            ],
        }],
        remarks: vec![],
    }
}

pub fn autocorrelation() -> Figure {
    let mut g = noise(5);
    let band = 1.96 / 36_000f64.sqrt();
    let points: Vec<(f64, f64)> = (1..=100).map(|k| (f64::from(k), 0.5 * band * g())).collect();
    Figure {
        id: "autocorrelation".into(),
        title: "figure.title.autocorrelation",
        channel: String::new(),
        panels: vec![Panel {
            x: axis("axis.lag", "s", Scale::Linear),
            y: axis("axis.autocorrelation", "", Scale::Linear),
            layers: vec![
                Layer::Band {
                    points: vec![(1.0, -band, band), (100.0, -band, band)],
                    style: Style::Muted,
                    legend: "figure.legend.white_band".into(),
                },
                line(points.clone(), Style::Data, "figure.legend.data"),
                Layer::Points { points, style: Style::Data, legend: "figure.legend.data".into() },
            ],
        }],
        remarks: vec![],
    }
}

pub fn histogram() -> Figure {
    let mut g = noise(11);
    let sigma = 0.0138;
    let width = 0.25 * sigma;
    let mut counts = [0u32; 32];
    for _ in 0..3600 {
        let k = ((g() * sigma + 16.0 * width) / width).floor();
        if (0.0..32.0).contains(&k) {
            counts[k as usize] += 1;
        }
    }
    let bars = counts
        .iter()
        .enumerate()
        .map(|(i, n)| {
            let from = -0.0123 + (i as f64 - 16.0) * width;
            (from, from + width, f64::from(*n) / 3600.0 / width)
        })
        .collect();
    let normal = (-80..=80)
        .map(|i| f64::from(i) / 20.0)
        .map(|z| (-0.0123 + z * sigma, (-0.5 * z * z).exp() / (sigma * (2.0 * std::f64::consts::PI).sqrt())))
        .collect();
    Figure {
        id: "histogram".into(),
        title: "figure.title.histogram",
        channel: String::new(),
        panels: vec![Panel {
            x: axis("axis.rate", "deg/h", Scale::Linear),
            y: axis("axis.share", "", Scale::Linear),
            layers: vec![
                Layer::Bars { bars, style: Style::Data, legend: "figure.legend.data".into() },
                line(normal, Style::Model, "figure.legend.normal"),
            ],
        }],
        remarks: vec![],
    }
}
