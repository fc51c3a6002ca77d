//! Physics of no catalogue: things that happen now and then, that wander, or that follow what no simple law follows.

use super::event::{averaged, some_instants};
use crate::laboratory::bench::Bench;
use crate::laboratory::effect::{Effect, Facts, Shape};
use crate::laboratory::environment::weather;
use crate::laboratory::motion::Programme;
use crate::laboratory::noise::flicker;
use crate::laboratory::process::{relaxation, resonance};
use crate::laboratory::unit::body::Pace;
use crate::laboratory::unit::response::late;
use std::f64::consts::{PI, TAU};

/// A unit at rest with some decoys.
pub fn at_rest(bench: &mut Bench) {
    let count = bench.dice.count(0, 3);
    bench.record_others(count);
}

/// An unknown course; where it lives in time, s, and in frequency, Hz.
fn unknown(
    subject: &'static str,
    course: Vec<f64>,
    time_s: Vec<[f64; 2]>,
    band_hz: Option<[f64; 2]>,
) -> Effect {
    Effect::new("unknown", Shape::Course(course), move |bench, _| {
        let mut facts = Facts::default();
        for [from, to] in &time_s {
            facts = facts.at("time", *from, *to);
        }
        let first = time_s.iter().map(|t| t[0]).fold(f64::MAX, f64::min);
        let last = time_s.iter().map(|t| t[1]).fold(f64::MIN, f64::max);
        facts = facts.at("time", first.max(0.0), last.min(bench.duration_s()));
        match band_hz {
            Some([from, to]) => facts.at("frequency", from.max(0.0), to.min(0.5 * bench.rate_hz)),
            None => facts,
        }
    })
    .of(subject)
    .latent()
}

fn always(bench: &Bench) -> Vec<[f64; 2]> {
    vec![[0.0, bench.duration_s()]]
}

/// Pulses that set each other off and die away exponentially; few are large.
pub fn avalanches(bench: &mut Bench) -> Effect {
    let tail_s = bench.dice.decades(4.0, 60.0) / bench.rate_hz.min(2.0);
    let starts = some_instants(bench, 8.0, 40.0);
    let mut dice = bench.dice.fork();
    let mut course = vec![0.0; bench.rows];
    let mut places = vec![];
    for start in starts {
        let (mut at, mut size) = (start, dice.decades(0.05, 1.0).powf(-0.8));
        loop {
            let first = (at * bench.rate_hz) as usize;
            let tail = (8.0 * tail_s * bench.rate_hz) as usize;
            let last = (first + tail).min(bench.rows);
            for (i, c) in course[first.min(last)..last].iter_mut().enumerate() {
                *c += size * (-(i as f64) / bench.rate_hz / tail_s).exp();
            }
            if !dice.chance(0.45) {
                break;
            }
            at += dice.waiting(2.0 * tail_s);
            size *= dice.uniform(0.4, 1.1);
        }
        places.push([start, at + 3.0 * tail_s]);
    }
    unknown("avalanches", course, places, None)
}

/// A strain that grows and slips by some of it, at irregular intervals.
pub fn stick_slip(bench: &mut Bench) -> Effect {
    let mut dice = bench.dice.fork();
    let mean_s = bench.duration_s() / dice.decades(12.0, 80.0);
    let (mut strain, mut strength) = (0.0, dice.uniform(0.6, 1.4));
    let course = (0..bench.rows)
        .map(|_| {
            strain += 1.0 / (mean_s * bench.rate_hz);
            if strain > strength {
                strain -= strength * dice.uniform(0.7, 1.0);
                strength = dice.uniform(0.5, 1.5);
            }
            strain
        })
        .collect();
    let places = always(bench);
    unknown("stick_slip", course, places, None)
}

/// An oscillation that starts now and then and ends again.
pub fn intermittent(bench: &mut Bench) -> Effect {
    let starts = some_instants(bench, 5.0, 20.0);
    let mut dice = bench.dice.fork();
    let frequency = dice.decades(0.02, 0.3) * bench.rate_hz;
    let mut course = vec![0.0; bench.rows];
    let mut places = vec![];
    for start in starts {
        let length_s = dice.decades(15.0, 60.0) / frequency;
        let phase = dice.uniform(0.0, TAU);
        let size = dice.uniform(0.5, 1.5);
        let rows = (length_s * bench.rate_hz) as usize;
        let first = (start * bench.rate_hz) as usize;
        for j in 0..rows.min(bench.rows.saturating_sub(first)) {
            let window = (PI * j as f64 / rows as f64).sin().powi(2);
            course[first + j] += size * window * (TAU * frequency * j as f64 / bench.rate_hz + phase).sin();
        }
        places.push([start, start + length_s]);
    }
    let band = [frequency * 0.9, frequency * 1.1];
    unknown("intermittent", course, places, Some(band))
}

/// A line whose frequency wanders over a part of a decade.
pub fn wandering_line(bench: &mut Bench) -> Effect {
    let mut dice = bench.dice.fork();
    let middle = dice.decades(0.02, 0.25) * bench.rate_hz;
    let memory_s = bench.duration_s() / dice.uniform(3.0, 15.0);
    let step = 1.0 / bench.rate_hz;
    let width = dice.uniform(0.04, 0.15);
    let wander = relaxation(&mut dice, bench.rows, step, memory_s, width);
    let mut phase = 0.0;
    let (mut least, mut most) = (f64::MAX, f64::MIN);
    let course = wander
        .iter()
        .map(|w| {
            let frequency = (middle * w.exp()).min(0.45 * bench.rate_hz);
            (least, most) = (f64::min(least, frequency), f64::max(most, frequency));
            phase += TAU * frequency * step;
            phase.cos()
        })
        .collect();
    let places = always(bench);
    unknown("wandering_line", course, places, Some([least, most]))
}

/// A tone that rises or falls once, as a fan that runs up.
pub fn chirp(bench: &mut Bench) -> Effect {
    let mut dice = bench.dice.fork();
    let from = dice.decades(0.01, 0.1) * bench.rate_hz;
    let to = from * dice.uniform(1.5, 4.0);
    let (start, end) = (dice.uniform(0.0, 0.4), dice.uniform(0.6, 1.0));
    let [start, end] = [start, end].map(|p| p * bench.duration_s());
    let rising = dice.chance(0.5);
    let length = end - start;
    let course = averaged(bench, |t| {
        if t < start || t > end {
            return 0.0;
        }
        let u = if rising { t - start } else { end - t };
        (TAU * (from * u + 0.5 * (to - from) * u * u / length)).cos()
    });
    unknown("chirp", course, vec![[start, end]], Some([from, to]))
}

/// A line without a carrier: its amplitude swings slowly through zero.
pub fn modulated_line(bench: &mut Bench) -> Effect {
    let mut dice = bench.dice.fork();
    let frequency = dice.decades(0.02, 0.3) * bench.rate_hz;
    let slow = dice.uniform(3.0, 9.0) / bench.duration_s();
    let phase = dice.uniform(0.0, TAU);
    let course = averaged(bench, |t| {
        let envelope = (TAU * slow * t + phase).sin();
        envelope * envelope * envelope * (TAU * frequency * t).cos()
    });
    let places = always(bench);
    unknown("modulated_line", course, places, Some([frequency - 4.0 * slow, frequency + 4.0 * slow]))
}

/// Impulses of single samples: sizes and waits without a typical value.
pub fn heavy_impulses(bench: &mut Bench) -> Effect {
    let mut dice = bench.dice.fork();
    let shortest_s = bench.duration_s() / dice.decades(600.0, 4000.0);
    let mut course = vec![0.0; bench.rows];
    let mut at = dice.waiting(shortest_s);
    while at < bench.duration_s() {
        // Pareto: no mean wait below an exponent of 1, no variance of the size below 2.
        let row = ((at * bench.rate_hz) as usize).min(bench.rows - 1);
        course[row] += dice.sign() * (1.0 - dice.uniform(0.0, 1.0)).powf(-1.0 / 1.7).min(12.0);
        at += shortest_s * (1.0 - dice.uniform(0.0, 1.0)).powf(-1.0 / 1.2).min(300.0);
    }
    let places = always(bench);
    unknown("heavy_impulses", course, places, None).same(&["outlier_bursts"])
}

/// Flicker that is there in episodes.
pub fn uneven_flicker(bench: &mut Bench) -> Effect {
    let mut dice = bench.dice.fork();
    let mut quiet = flicker(&mut dice, 1.0, bench.rows, bench.rate_hz);
    let episodes = dice.count(2, 4);
    let length = bench.rows / (episodes * dice.count(3, 6));
    let mut places = vec![];
    let mut loud = vec![false; bench.rows];
    for episode in 0..episodes {
        let room = bench.rows / episodes;
        let from = episode * room + dice.count(0, room - length - 1);
        loud[from..from + length].fill(true);
        places.push([from as f64 / bench.rate_hz, (from + length) as f64 / bench.rate_hz]);
    }
    let (mut start, mut was) = (0.0, false);
    for (q, l) in quiet.iter_mut().zip(&loud) {
        if *l && !was {
            start = *q;
        }
        was = *l;
        *q = if *l { *q - start } else { 0.0 };
    }
    unknown("uneven_flicker", quiet, places, None)
}

/// Two states whose levels drift, each by itself, as far as they are apart.
pub fn drifting_levels(bench: &mut Bench) -> Effect {
    let mut dice = bench.dice.fork();
    let dwell_s = bench.duration_s() / dice.decades(10.0, 60.0);
    let step = 1.0 / bench.rate_hz;
    let drift_s = bench.duration_s() / dice.uniform(4.0, 10.0);
    let levels = [0.6, -0.6].map(|level: f64| {
        relaxation(&mut dice, bench.rows, step, drift_s, 0.7).iter().map(|d| level + d).collect::<Vec<f64>>()
    });
    let (mut state, mut left) = (0, dice.waiting(dwell_s));
    let course = (0..bench.rows)
        .map(|i| {
            left -= step;
            if left < 0.0 {
                state = 1 - state;
                left = dice.waiting(dwell_s);
            }
            levels[state][i]
        })
        .collect();
    let places = always(bench);
    unknown("drifting_levels", course, places, None)
}

/// A barometer and a thermometer are recorded.
pub fn with_weather(bench: &mut Bench) {
    bench.warm(true, Pace::Quick);
    bench.record("pressure_hPa");
    let count = bench.dice.count(0, 2);
    bench.record_others(count);
}

/// The change of pressure times the temperature: a leak through a gap that opens when it is warm.
pub fn pressure_change_by_temperature(bench: &mut Bench) -> Effect {
    let change = bench.span.per_minute(&late(&bench.span, &bench.surroundings["pressure_hPa"], 120.0));
    let coil = bench.warmth.as_ref().map_or_else(Vec::new, |w| w.coil());
    let low = coil.iter().copied().fold(f64::MAX, f64::min);
    let course: Vec<f64> = change.iter().zip(&coil).map(|(p, t)| p * 60.0 * (t - low)).collect();
    let rows = bench.at_rows(&course);
    let places = always(bench);
    let mut effect = unknown("pressure_change_by_temperature", rows, places, None);
    effect.latent = false;
    effect.column = Some("pressure_hPa".to_owned());
    effect.same(&["column_driver"])
}

/// The field is recorded.
pub fn with_field(bench: &mut Bench) {
    bench.record("field_uT");
    let count = bench.dice.count(0, 2);
    bench.record_others(count);
}

/// A response that begins where a column has been beyond a threshold, and goes on for a while.
pub fn threshold(bench: &mut Bench) -> Effect {
    let mut dice = bench.dice.fork();
    let field = bench.surroundings["field_uT"].clone();
    let mut sorted = field.clone();
    sorted.sort_by(f64::total_cmp);
    let limit = sorted[(dice.uniform(0.8, 0.95) * sorted.len() as f64) as usize];
    let memory_s = dice.decades(60.0, 600.0);
    let beyond: Vec<f64> = field.iter().map(|f| f64::from(*f > limit)).collect();
    let rows = bench.at_rows(&late(&bench.span, &beyond, memory_s));
    let places = always(bench);
    let mut effect = unknown("threshold", rows, places, None);
    effect.latent = false;
    effect.column = Some("field_uT".to_owned());
    effect.same(&["column_driver"])
}

/// Noise of a band that swells and fades over a large part of the record.
pub fn swelling_noise(bench: &mut Bench) -> Effect {
    let mut dice = bench.dice.fork();
    let middle = dice.decades(0.03, 0.2) * bench.rate_hz;
    let noise = resonance(&mut dice, bench.rows, 1.0 / bench.rate_hz, middle, 3.0 / middle, 1.0);
    let period_s = bench.duration_s() / dice.uniform(1.5, 4.0);
    let phase = dice.uniform(0.0, TAU);
    let course = noise
        .iter()
        .enumerate()
        .map(|(i, n)| n * (PI * i as f64 / bench.rate_hz / period_s + phase).sin().powi(4))
        .collect();
    let places = always(bench);
    unknown("swelling_noise", course, places, Some([middle * 0.8, middle * 1.2]))
}

/// A unit on a rate table.
pub fn on_table(bench: &mut Bench) {
    bench.turn(Programme::Steps);
}

/// A coil that its own motion warms: rates count by how much there was of them lately.
pub fn motion_memory(bench: &mut Bench) -> Effect {
    let mut dice = bench.dice.fork();
    let memory_s = dice.decades(120.0, 900.0);
    let kept = (-1.0 / bench.rate_hz / memory_s).exp();
    let rates = bench.columns["table_rate_deg_s"].clone();
    let most = rates.iter().fold(0.0f64, |m, r| m.max(r.abs()));
    let mut warm = 0.0;
    let course = rates
        .iter()
        .map(|r| {
            warm = kept * warm + (1.0 - kept) * (r / most).powi(2);
            warm * r / most
        })
        .collect();
    let places = always(bench);
    let mut effect = unknown("motion_memory", course, places, None);
    effect.latent = false;
    effect
}

/// Bursts of noise after a shock, ever fewer, as after an earthquake (F. Omori, 1894).
pub fn aftershocks(bench: &mut Bench) -> Effect {
    let mut dice = bench.dice.fork();
    let shock_s = dice.uniform(0.05, 0.5) * bench.duration_s();
    let mut course = vec![0.0; bench.rows];
    let count = dice.count(20, 60);
    let reach = bench.duration_s() - shock_s;
    let first_s = 5.0 / bench.rate_hz;
    let mut last = shock_s;
    for _ in 0..count {
        let after = first_s * ((reach / first_s).ln() * dice.uniform(0.0, 1.0)).exp();
        let at = ((shock_s + after) * bench.rate_hz) as usize;
        let size = dice.decades(0.15, 1.0) * dice.sign();
        let fall = dice.decades(1.5, 10.0);
        let last_row = (at + 40).min(bench.rows);
        for (i, c) in course[at.min(last_row)..last_row].iter_mut().enumerate() {
            *c += size * (-(i as f64) / fall).exp() * (1.9 * i as f64).cos();
        }
        last = f64::max(last, shock_s + after);
    }
    unknown("aftershocks", course, vec![[shock_s, last + 40.0 / bench.rate_hz]], None)
        .same(&["outlier_bursts"])
}

/// Gusts that press on the housing: they come through an opening that gives way only beyond a slope, to one side.
pub fn one_sided_gusts(bench: &mut Bench) -> Effect {
    let mut dice = bench.dice.fork();
    let pressure = weather::weather(&mut dice, &bench.span).pressure_hpa;
    let change = bench.span.per_minute(&late(&bench.span, &pressure, 30.0));
    let mut sorted = change.clone();
    sorted.sort_by(f64::total_cmp);
    let limit = sorted[(0.85 * sorted.len() as f64) as usize];
    let opened: Vec<f64> = change.iter().map(|c| (c - limit).max(0.0)).collect();
    let rows = bench.at_rows(&late(&bench.span, &opened, 60.0));
    let places = always(bench);
    unknown("one_sided_gusts", rows, places, None).same(&["unobserved_driver"])
}
