//! The words: what each gyro channel shows, and the temperatures and table channels beside it.

use super::collect::{DrivenChannel, Gyro, Inspection};
use super::layout::{NO_LABEL, Page, word};
use super::quantity::{plain, rate, rates, time};
use crate::i18n::{Arg, Note, note};
use crate::measurand::ANGLE_RANDOM_WALK;
use crate::noise::family::Estimator;
use crate::noise::lines::SpectralLine;
use crate::noise::motion::Motion;
use crate::recording::Role;

/// Lines named for a channel.
const MAX_LINES: usize = 3;

/// Every gyro channel; a statement of its own where there is none.
pub(super) fn gyros(page: &mut Page, found: &Inspection) {
    let channels = || found.channels.iter().filter(|c| c.role.is_gyro());
    if channels().next().is_none() {
        page.heading(word("inspect.gyro"));
        let key = if found.listed.iter().any(|c| c.counts_of_a_gyro()) {
            "inspect.gyro_only_counts"
        } else if !found.time.is_known() && found.listed.iter().any(|c| c.guess.role == Role::AngleIncrement)
        {
            "inspect.gyro_needs_rate"
        } else {
            "inspect.gyro_none"
        };
        page.row(word("inspect.found"), Note::new(key));
        return;
    }
    if found.gyros.is_empty() {
        page.heading(word("inspect.gyro"));
        page.row(word("inspect.found"), note!("inspect.gyro_needs_rate"));
    }
    for gyro in &found.gyros {
        page.heading(note!("inspect.gyro_channel", name = gyro.name.as_str()));
        one(page, found, gyro);
    }
}

fn one(page: &mut Page, found: &Inspection, gyro: &Gyro) {
    if gyro.digest.samples < 2 {
        page.row(word("inspect.found"), note!("inspect.gyro_no_value"));
        return;
    }
    let key = match gyro.motion {
        Motion::Slow { .. } => "inspect.mean_slow",
        m if m.is_motion() => "inspect.mean_moving",
        _ => "inspect.mean_of",
    };
    let still = !gyro.motion.is_motion();
    page.row(word("inspect.mean"), Note::new(key).with("mean", rate(gyro.digest.mean)));
    if mean_taken_out(gyro) {
        page.row(NO_LABEL, note!("inspect.mean_taken_out"));
    }
    page.row(word("inspect.motion"), motion(gyro));
    if still {
        let note = match contradicted(gyro, ANGLE_RANDOM_WALK.id) {
            _ if !described(gyro) => allan(found, gyro),
            Some(contradicted) => contradicted,
            None => noise(found, gyro),
        };
        page.row(word("inspect.noise"), note);
    } else if let Some(quiet) = gyro.quietest_deg_h {
        let note = note!("inspect.noise_quietest", sigma = rate(quiet));
        page.row(word("inspect.noise"), note);
    }
    let sample_noise = if still { sample_deviation(gyro) } else { gyro.quietest_deg_h.unwrap_or(0.0) };
    let step = found.report.channels.get(gyro.slot).and_then(|c| c.values.quantization_step);
    if let Some(step) = step.filter(|s| *s > 1e-3 * sample_noise) {
        let note = note!("inspect.step_is", step = rate(step));
        let mut told = vec![Arg::from(note)];
        if sample_noise > 0.0 {
            let ratio = plain(step / sample_noise, 2);
            told.push(note!("inspect.step_ratio", ratio).into());
        }
        page.row(word("inspect.step"), Arg::Several(told, " ".into()));
    }
    page.row(word("inspect.lines"), lines(gyro));
    let swing = gyro.angle.max_deg - gyro.angle.min_deg;
    if let Motion::Moved { .. } = gyro.motion {
        let note = note!(
            "inspect.angle_is",
            end = plain(gyro.angle.end_deg, 4),
            low = plain(gyro.angle.min_deg, 4),
            high = plain(gyro.angle.max_deg, 4),
            swing = plain(swing, 4)
        );
        page.row(word("inspect.angle"), note);
    }
}

/// Allan deviation at one sample, deg/h; 0 where there is none.
fn sample_deviation(gyro: &Gyro) -> f64 {
    let curve = gyro.digest.deviations.curve(Estimator::Allan);
    curve.and_then(|c| c.points.first()).filter(|p| p.m == 1).map_or(0.0, |p| p.deviation)
}

/// A mean that is zero to a millionth of the range is none of a gyro: it was taken out.
fn mean_taken_out(gyro: &Gyro) -> bool {
    let digest = &gyro.digest;
    digest.samples > 1000 && digest.mean.abs() < 1e-6 * (digest.max - digest.min)
}

fn motion(gyro: &Gyro) -> Note {
    match gyro.motion {
        Motion::Rest { scatter_deg_h, beyond_noise } if beyond_noise > 3.0 => {
            note!("inspect.at_rest_drifting", scatter = rate(scatter_deg_h), ratio = plain(beyond_noise, 2))
        }
        Motion::Rest { .. } => note!("inspect.at_rest"),
        Motion::Carried => note!("inspect.carried"),
        Motion::Slow { scatter_deg_h } => note!("inspect.slow", scatter = rate(scatter_deg_h)),
        Motion::Moved { scatter_deg_h, farthest_deg_h } => {
            note!("inspect.moved", scatter = rate(scatter_deg_h), farthest = rate(farthest_deg_h))
        }
        Motion::Unknown => note!("inspect.motion_unknown"),
    }
}

/// Misfit from which the terms of the noise model say nothing.
const MAX_MISFIT: f64 = 3.0;

/// True where the noise model describes the spectrum well enough for its terms to mean something.
pub(super) fn described(gyro: &Gyro) -> bool {
    gyro.identification.misfit.per_dof < MAX_MISFIT
}

/// What a check contradicts of a quantity.
pub(super) fn contradicted(gyro: &Gyro, measurand: &str) -> Option<Note> {
    let objection = gyro.objections.iter().find(|o| o.finding.measurands.contains(&measurand))?;
    Some(note!(
        "inspect.contradicted",
        check = Arg::key("criticism", objection.check),
        found = objection.finding.found.clone(),
        advice = objection.finding.advice.clone()
    ))
}

/// What the Allan deviation reads where no model holds: at one sample, 1, 10 and 100 s, as far as T/5.
fn allan(found: &Inspection, gyro: &Gyro) -> Note {
    let deviations = &gyro.digest.deviations;
    let longest_s = deviations.stretches.longest() as f64 * found.tau0_s / 5.0;
    let points = deviations.curve(Estimator::Allan).map(|c| c.points.as_slice()).unwrap_or_default();
    let mut shown: Vec<Arg> = Vec::new();
    let mut last = 0;
    for tau_s in [found.tau0_s, 1.0, 10.0, 100.0] {
        let off = |m: u64| (m as f64 * found.tau0_s / tau_s).ln().abs();
        let nearest = points.iter().min_by(|a, b| off(a.m).total_cmp(&off(b.m)));
        let Some(p) = nearest.filter(|p| p.m > last && p.m as f64 * found.tau0_s <= longest_s) else {
            continue;
        };
        last = p.m;
        let note =
            note!("inspect.allan_at", sigma = rate(p.deviation), tau = time(p.m as f64 * found.tau0_s));
        shown.push(note.into());
    }
    note!(
        "inspect.noise_undescribed",
        misfit = plain(gyro.identification.misfit.per_dof, 2),
        points = if shown.is_empty() { "-".into() } else { Arg::Several(shown, ", ".into()) }
    )
}

fn noise(found: &Inspection, gyro: &Gyro) -> Note {
    let estimate = gyro.identification.read_angle_random_walk();
    let length = time(gyro.digest.samples as f64 * found.tau0_s);
    match (estimate.value, estimate.interval95(), &estimate.upper_limit) {
        (Some(n), Some(interval), _) => note!(
            "inspect.noise_is",
            n = plain(n, 3),
            low = plain(interval.low, 3),
            high = plain(interval.high, 3),
            length
        ),
        (Some(n), None, _) => note!("inspect.noise_about", n = plain(n, 3), length),
        (None, _, Some(limit)) => {
            note!("inspect.noise_below", limit = plain(limit.value, 3), length)
        }
        (None, _, None) => note!("inspect.noise_unknown", length),
    }
}

/// The strongest lines of a channel, strongest first.
pub(super) fn strongest(gyro: &Gyro) -> Vec<&SpectralLine> {
    let mut lines: Vec<_> = gyro.lines.iter().collect();
    lines.sort_by(|a, b| b.amplitude_deg_h.total_cmp(&a.amplitude_deg_h));
    lines
}

fn lines(gyro: &Gyro) -> Arg {
    let all = strongest(gyro);
    if all.is_empty() {
        let key = if gyro.digest.welch.spectrum.segments > 0 {
            "inspect.lines_none"
        } else {
            "inspect.lines_short"
        };
        return word(key);
    }
    let at = |l: &&SpectralLine| {
        Arg::from(note!(
            "inspect.line_at",
            frequency = plain(l.frequency_hz, 5),
            amplitude = rate(l.amplitude_deg_h),
            excess = plain(l.excess, 2)
        ))
    };
    let mut shown: Vec<Arg> = all.iter().take(MAX_LINES).map(at).collect();
    if all.len() > MAX_LINES {
        shown.push(note!("inspect.lines_more", n = all.len() - MAX_LINES).into());
    }
    let shown = Arg::Several(shown, "; ".into());
    if gyro.motion.is_motion() {
        Arg::Several(vec![shown, word("inspect.lines_moving")], ". ".into())
    } else {
        shown
    }
}

/// Temperatures and table channels.
pub(super) fn others(page: &mut Page, found: &Inspection) {
    if found.temperatures.is_empty() && found.driven.is_empty() {
        return;
    }
    page.heading(word("inspect.others"));
    for t in &found.temperatures {
        let (up, down) = t.runs;
        let range = note!(
            "inspect.temperature_is",
            name = t.name.as_str(),
            low = plain(t.min_deg_c, 4),
            high = plain(t.max_deg_c, 4),
            range = plain(t.range(), 3)
        );
        let mut told = vec![Arg::from(range)];
        if let Some(steepest) = t.steepest_deg_c_h {
            let rate = plain(steepest.abs(), 3);
            told.push(note!("inspect.temperature_rate", rate).into());
        }
        if t.range() >= 1.0 && found.time.is_known() {
            let runs = note!("inspect.temperature_runs");
            told.push(runs.with("up", u64::from(up)).with("down", u64::from(down)).into());
        }
        told.push(".".into());
        page.row(word("inspect.temperature"), Arg::Several(told, "".into()));
    }
    for d in &found.driven {
        page.row(word("inspect.table"), driven(d));
    }
    for f in &found.correlated {
        let per_deg_s = f.slope * 3600.0;
        let (slope, unit) = if f.unit == "deg/h" {
            (f.slope, word("amount.unit_deg_s"))
        } else {
            (per_deg_s, f.unit.clone().into())
        };
        let note = note!(
            "inspect.follows",
            name = f.name.as_str(),
            correlation = Arg::figures(f.correlation, 6),
            slope = plain(slope, 5),
            unit
        );
        page.row(NO_LABEL, note);
    }
}

fn driven(d: &DrivenChannel) -> Arg {
    let (low, high, unit) = if d.role == Role::TableAngle {
        (plain(d.facts.min / 3600.0, 5), plain(d.facts.max / 3600.0, 5), word("amount.unit_deg"))
    } else {
        rates(d.facts.min, d.facts.max)
    };
    let range = note!("inspect.table_is", name = d.name.as_str(), low, high, unit);
    let rest = match d.facts.levels.len() {
        _ if d.facts.min == d.facts.max => note!("inspect.table_still"),
        0 => note!("inspect.table_sweeps"),
        n => note!("inspect.table_levels", n),
    };
    Arg::Several(vec![range.into(), rest.into()], " ".into())
}
