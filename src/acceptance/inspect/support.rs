//! Tests that a recording can support, each statement with its reason. Nothing is promised that the data cannot give.

use super::clock_check::{ClockRemark, clock_remark, earth, is_mains};
use super::collect::{DrivenChannel, Gyro, Inspection, Temperature};
use super::layout::{NO_LABEL, Page, word};
use super::quantity::{count, names, plain, rates, time, time_both};
use super::show_gyro::{contradicted, described, strongest};
use crate::criticism::temperature::MIN_RANGE_DEG_C;
use crate::i18n::{Arg, Note, note};
use crate::measurand::{BIAS_INSTABILITY, STATIC_BIAS};
use crate::noise::data::NoiseType;
use crate::noise::expected::{expected_upper_limit, resolving_duration};
use crate::noise::motion::Motion;
use crate::recording::Role;

/// Usable time that the programme for random drift asks for, s.
const STATIC_TEST_S: f64 = 36_000.0;
/// Levels of a table rate that a straight line with a judgement of its linearity needs.
const MIN_LEVELS: usize = 5;
/// Lines of a channel that are held against the mains.
const MAX_MAINS_LINES: usize = 3;

/// The last section.
pub(super) fn statements(page: &mut Page, found: &Inspection) {
    page.heading(word("inspect.support"));
    let gyro = found.channels.iter().any(|c| c.role.is_gyro());
    let counts = found.listed.iter().any(|c| c.counts_of_a_gyro());
    if !gyro && !counts {
        page.row(word("inspect.tests"), note!("inspect.no_gyro_no_test"));
        return;
    }
    assumed(page, found);
    page.row(word("inspect.static_test"), static_test(found));
    averaging(page, found);
    flicker(page, found);
    lengths(page, found);
    page.row(word("inspect.temperature_test"), temperature(found));
    page.row(word("inspect.scale_factor"), scale_factor(found));
    known_angle(page, found);
    clock(page, found);
    earth_rate(page, found);
}

/// Units that were assumed carry through everything.
fn assumed(page: &mut Page, found: &Inspection) {
    let of = |c: &&super::columns::Listed| c.guess.role.is_gyro() && !c.guess.unit_is_named;
    let list = names(found.listed.iter().filter(of).map(|c| c.name.as_str()));
    if !list.is_empty() {
        page.row(word("inspect.unit"), note!("inspect.unit_assumed", columns = list));
    }
}

fn usable_s(found: &Inspection, gyro: &Gyro) -> f64 {
    gyro.digest.samples as f64 * found.tau0_s
}

fn table_moves(found: &Inspection) -> Option<&DrivenChannel> {
    let moving = |d: &&DrivenChannel| d.role != Role::TableAngle && d.facts.max - d.facts.min > 360.0;
    found.driven.iter().find(moving)
}

fn static_test(found: &Inspection) -> Note {
    if let Some(table) = table_moves(found) {
        return note!("inspect.static_table", name = table.name.as_str());
    }
    if !found.time.is_known() {
        return note!("inspect.static_no_time");
    }
    if found.gyros.is_empty() {
        return note!("inspect.static_counts");
    }
    let of = |wanted: fn(&Motion) -> bool| {
        names(found.gyros.iter().filter(|g| wanted(&g.motion)).map(|g| g.name.as_str()))
    };
    let moved = of(|m| matches!(m, Motion::Moved { .. }));
    if !moved.is_empty() {
        return note!("inspect.static_moved", channels = moved);
    }
    let slow = of(|m| matches!(m, Motion::Slow { .. }));
    if !slow.is_empty() {
        return note!("inspect.static_slow", channels = slow);
    }
    if found.gyros.iter().any(|g| g.motion == Motion::Unknown) {
        return note!("inspect.static_too_few");
    }
    if let Some(contradicted) = found.gyros.iter().find_map(|g| contradicted(g, STATIC_BIAS.id)) {
        return note!("inspect.static_contradicted", why = contradicted);
    }
    let length = found.gyros.iter().map(|g| usable_s(found, g)).fold(f64::INFINITY, f64::min);
    let key = if length >= STATIC_TEST_S { "inspect.static_yes" } else { "inspect.static_short" };
    Note::new(key).with("length", time(length))
}

/// Channels that stood still, with enough samples for their noise.
fn resting(found: &Inspection) -> impl Iterator<Item = &Gyro> {
    let still = table_moves(found).is_none();
    found.gyros.iter().filter(move |g| still && g.motion.is_rest() && g.digest.samples >= 64)
}

fn averaging(page: &mut Page, found: &Inspection) {
    let Some(shortest) = resting(found).min_by(|a, b| a.digest.samples.cmp(&b.digest.samples)) else {
        return;
    };
    let stretches = &shortest.digest.deviations.stretches;
    let longest_s = stretches.longest() as f64 * found.tau0_s;
    let label = word("inspect.averaging");
    let note =
        note!("inspect.averaging_is", floor = time_both(longest_s / 10.0), fit = time_both(longest_s / 5.0));
    page.row(label, note);
    if stretches.count() > 1 {
        let note = note!("inspect.averaging_broken", n = count(stretches.count()), longest = time(longest_s));
        page.row(NO_LABEL, note);
    }
}

/// A statement on one channel.
fn of_channel(gyro: &Gyro, statement: Note) -> Note {
    note!("inspect.of_column", column = gyro.name.as_str(), what = statement)
}

fn flicker(page: &mut Page, found: &Inspection) {
    let mut label = word("inspect.flicker");
    for gyro in resting(found) {
        if !described(gyro) {
            let note = note!("inspect.flicker_undescribed");
            page.row(std::mem::replace(&mut label, NO_LABEL.into()), of_channel(gyro, note));
            continue;
        }
        if let Some(note) = contradicted(gyro, BIAS_INSTABILITY.id) {
            page.row(std::mem::replace(&mut label, NO_LABEL.into()), of_channel(gyro, note));
            continue;
        }
        let estimate = &gyro.identification.bias_instability;
        let background = gyro.identification.supported.with(NoiseType::Flicker, 0.0);
        let smallest =
            expected_upper_limit(NoiseType::Flicker, &background, gyro.digest.samples, found.tau0_s);
        let note = match (smallest, estimate.value, estimate.upper_limit) {
            (Some(smallest), Some(b), _) => {
                note!("inspect.flicker_found", b = plain(b, 3), smallest = plain(smallest, 2))
            }
            (Some(smallest), None, Some(limit)) => {
                note!("inspect.flicker_bounded", limit = plain(limit.value, 3), smallest = plain(smallest, 2))
            }
            (Some(smallest), None, None) => {
                note!("inspect.flicker_smallest", smallest = plain(smallest, 2))
            }
            (None, _, _) => note!("inspect.flicker_unknown"),
        };
        page.row(std::mem::replace(&mut label, NO_LABEL.into()), of_channel(gyro, note));
    }
}

/// How long a record must be for B and K, by the noise of this one.
fn lengths(page: &mut Page, found: &Inspection) {
    let mut label = word("inspect.length_of_record");
    let gyros = resting(found).filter(|g| described(g));
    for gyro in gyros {
        let told: Vec<Note> = SLOW_TERMS.iter().filter_map(|term| length(found, gyro, *term)).collect();
        if told.is_empty() {
            continue;
        }
        for note in told {
            page.row(std::mem::replace(&mut label, NO_LABEL.into()), of_channel(gyro, note));
        }
        let n = plain(gyro.identification.supported.n, 3);
        page.row(NO_LABEL, of_channel(gyro, note!("inspect.length_assumes", n)));
    }
}

/// The terms for which the length of a record is asked.
const SLOW_TERMS: [NoiseType; 2] = [NoiseType::Flicker, NoiseType::RateRandomWalk];

/// How long a record must be for a term: for the size found, or, where it is only bounded, for its bound and a half of it.
fn length(found: &Inspection, gyro: &Gyro, term: NoiseType) -> Option<Note> {
    let identification = &gyro.identification;
    let estimate = match term {
        NoiseType::Flicker => &identification.bias_instability,
        _ => &identification.rate_random_walk,
    };
    if contradicted(gyro, estimate.id).is_some() {
        return None;
    }
    let background = identification.supported.with(term, 0.0);
    let hours = |value: f64| -> Arg {
        let hours = resolving_duration(term, value, &background, found.tau0_s);
        let told = hours.map(|hours| note!("amount.h", value = plain(hours, 2)));
        told.unwrap_or_else(|| note!("inspect.length_beyond")).into()
    };
    let size_key = match term {
        NoiseType::Flicker => "inspect.length_of_b",
        _ => "inspect.length_of_k",
    };
    let quantity = |value: f64| Note::new(size_key).with("value", plain(value, 3));
    match (estimate.value, estimate.upper_limit) {
        (Some(value), _) if value > 0.0 => {
            Some(note!("inspect.length_found", size = quantity(value), hours = hours(value)))
        }
        (_, Some(limit)) if limit.value > 0.0 => {
            let (limit, half) = (limit.value, 0.5 * limit.value);
            Some(note!(
                "inspect.length_bounded",
                limit = quantity(limit),
                hours = hours(limit),
                half = hours(half)
            ))
        }
        _ => None,
    }
}

fn temperature(found: &Inspection) -> Note {
    let widest = found.temperatures.iter().max_by(|a, b| a.range().total_cmp(&b.range()));
    let Some(widest) = widest else { return note!("inspect.temperature_none") };
    let about = |key| {
        Note::new(key)
            .with("name", widest.name.as_str())
            .with("low", plain(widest.min_deg_c, 3))
            .with("high", plain(widest.max_deg_c, 3))
            .with("range", plain(widest.range(), 3))
    };
    let Temperature { runs: (up, down), .. } = *widest;
    if widest.range() < 1.0 {
        about("inspect.temperature_constant")
    } else if widest.range() < MIN_RANGE_DEG_C {
        about("inspect.temperature_narrow")
    } else if !found.time.is_known() {
        about("inspect.temperature_untimed")
    } else if table_moves(found).is_some() || found.gyros.iter().any(|g| g.motion.is_motion()) {
        about("inspect.temperature_moving")
    } else if up > 0 && down > 0 {
        about("inspect.temperature_both")
    } else {
        about("inspect.temperature_one_way")
    }
}

fn scale_factor(found: &Inspection) -> Note {
    let Some(table) = found.driven.iter().find(|d| d.role == Role::TableRate) else {
        return note!("inspect.scale_no_table");
    };
    let facts = &table.facts;
    let (low, high, unit) = rates(facts.min, facts.max);
    let about = |key| {
        Note::new(key)
            .with("name", table.name.as_str())
            .with("low", low.clone())
            .with("high", high.clone())
            .with("unit", unit.clone())
            .with("n", facts.levels.len())
    };
    if facts.max == facts.min {
        return about("inspect.scale_still");
    }
    if facts.levels.is_empty() {
        return about("inspect.scale_sweeps");
    }
    if facts.levels.len() < MIN_LEVELS {
        return about("inspect.scale_few");
    }
    if facts.min < 0.0 && facts.max > 0.0 {
        about("inspect.scale_both_signs")
    } else {
        about("inspect.scale_one_sign")
    }
}

/// Largest angle that a unit is turned by without a table, deg: a hundred turns.
const MAX_TURN_DEG: f64 = 36_000.0;

fn known_angle(page: &mut Page, found: &Inspection) {
    // Numbers that no sensor shows sum up to no angle.
    if found.report.integrity.implausible > 0 {
        return;
    }
    let moved = |g: &&Gyro| matches!(g.motion, Motion::Moved { .. });
    let swing = |g: &Gyro| g.angle.max_deg - g.angle.min_deg;
    let most = found.gyros.iter().filter(moved).max_by(|a, b| swing(a).total_cmp(&swing(b)));
    // Nor does an output that sums up to more than anyone turns a unit by without a table.
    let Some(most) = most.filter(|g| table_moves(found).is_none() && swing(g) <= MAX_TURN_DEG) else {
        return;
    };
    let note = note!("inspect.known_angle_is", name = most.name.as_str(), swing = plain(swing(most), 4));
    page.row(word("inspect.known_angle"), note);
}

/// The strongest remark on the clock, with every channel that bears it out.
fn clock(page: &mut Page, found: &Inspection) {
    // Frequency, excess and channel of each line that says something.
    let mut remarks: Vec<(ClockRemark, f64, f64, String)> = Vec::new();
    // A line where mains is shows the clock to be right, whatever else stands near another mains frequency.
    let right = found.gyros.iter().flat_map(|g| &g.lines).any(is_mains);
    for gyro in &found.gyros {
        for line in strongest(gyro).into_iter().take(MAX_MAINS_LINES) {
            let remark = clock_remark(line, found.tau0_s)
                .filter(|remark| !right || matches!(remark, ClockRemark::AtNyquist { .. }));
            if let Some(remark) = remark {
                remarks.push((remark, line.frequency_hz, line.excess, gyro.name.clone()));
            }
        }
    }
    remarks.sort_by(|a, b| b.2.total_cmp(&a.2));
    let mut label = word("inspect.clock");
    let mut said: Vec<f64> = Vec::new();
    for (remark, line_hz, _, _) in &remarks {
        let near = |f: f64| (f / line_hz - 1.0).abs() < 0.003;
        if said.iter().any(|f| near(*f)) {
            continue;
        }
        said.push(*line_hz);
        let channels = remarks.iter().filter(|r| near(r.1)).map(|r| r.3.as_str());
        let mut unique: Vec<&str> = channels.collect();
        unique.sort_unstable();
        unique.dedup();
        let note = clock_note(remark, found.tau0_s).with("channels", names(unique.into_iter()));
        page.row(std::mem::replace(&mut label, NO_LABEL.into()), note);
    }
}

fn clock_note(remark: &ClockRemark, tau0_s: f64) -> Note {
    match *remark {
        ClockRemark::Off { line_hz, mains_hz, factor } => note!(
            "inspect.clock_off",
            line = plain(line_hz, 5),
            mains = plain(mains_hz, 4),
            percent = plain((factor - 1.0) * 100.0, 2),
            rate = plain(1.0 / (tau0_s * factor), 4),
            shown = plain(1.0 / tau0_s, 5)
        ),
        ClockRemark::AtNyquist { line_hz } => {
            note!("inspect.clock_nyquist", line = plain(line_hz, 5))
        }
        ClockRemark::Alias { line_hz, mains_hz } => {
            note!("inspect.clock_alias", line = plain(line_hz, 5), mains = plain(mains_hz, 4))
        }
    }
}

fn earth_rate(page: &mut Page, found: &Inspection) {
    if !found.gyros.iter().all(|g| g.motion.is_rest()) {
        return;
    }
    let means: Vec<f64> = found.gyros.iter().map(|g| g.digest.mean).collect();
    if let Some(length) = earth(&means) {
        page.row(word("inspect.earth"), note!("inspect.earth_is", length = plain(length, 4)));
    }
}
