//! Lines that a claim states, seen with a clock that runs at another rate.

use super::search::peaks;
use super::sinusoid::{LineGains, columns, polar, wave};
use crate::effect::{Domain, Drivers, Place, SearchContext, StatedLine};
use crate::numeric::cosine::inverse_dct2;
use crate::numeric::order::SortByNumber;

/// Lines that are followed at most, the largest first.
const MAX_LINES: usize = 2;
/// Amplitude over that stated, either way, up to which a line may be the stated one.
const MAX_AMPLITUDE_RATIO: f64 = 2.0;
/// Drift either way up to which a line is sought, ppm: no clock is wrong by more, and other lines are near.
const MAX_DRIFT_PPM: f64 = 5e4;
/// Peaks that are looked at.
const MAX_PEAKS: usize = 4;

/// A frequency as a clock shows it that drifts by so many ppm, Hz: a gyro that is late by a share of the time shows it so much lower.
pub(in crate::effect) fn seen_hz(frequency_hz: f64, drift_ppm: f64) -> f64 {
    frequency_hz * (1.0 - 1e-6 * drift_ppm)
}

/// The lines that the samples of a grid show, the largest first.
fn shown(drivers: &Drivers) -> Vec<StatedLine> {
    let mut lines: Vec<StatedLine> =
        drivers.lines.iter().filter(|l| l.frequency_hz < 0.5 / drivers.dt_s).copied().collect();
    lines.sort_descending_by(|a| a.amplitude_deg_h);
    lines.truncate(MAX_LINES);
    lines
}

/// True where a claim states a line that the samples can show.
pub(in crate::effect) fn any(drivers: &Drivers) -> bool {
    drivers.samples >= 32 && !shown(drivers).is_empty()
}

/// The course of the lines as stated, taken away, deg/h.
pub(in crate::effect) fn taken_away(drivers: &Drivers) -> Vec<f64> {
    let mut out = vec![0.0; drivers.samples];
    for line in shown(drivers) {
        let course = wave(line.amplitude_deg_h, line.phase_deg, &columns(line.frequency_hz, drivers));
        out.iter_mut().zip(course).for_each(|(o, c)| *o -= c);
    }
    out
}

/// Cosine and sine of each line where the drift puts it, deg/h for an amplitude of 1.
pub(in crate::effect) fn drifted(drift_ppm: f64, drivers: &Drivers) -> Vec<Vec<f64>> {
    shown(drivers).iter().flat_map(|line| columns(seen_hz(line.frequency_hz, drift_ppm), drivers)).collect()
}

/// Amplitudes, deg/h, and phases, deg, of the lines, from the coefficients of [`drifted`].
pub(in crate::effect) fn polars(coefficients: &[f64]) -> (Vec<f64>, Vec<f64>) {
    coefficients.chunks(2).map(polar).unzip()
}

/// The course of the lines with a drift instead of that without, deg/h. Of lines whose amplitudes and phases are not given,
/// those stated.
pub(in crate::effect) fn course(
    drift_ppm: f64,
    amplitudes_deg_h: &[f64],
    phases_deg: &[f64],
    drivers: &Drivers,
) -> Vec<f64> {
    let mut out = taken_away(drivers);
    for (i, line) in shown(drivers).iter().enumerate() {
        let amplitude = amplitudes_deg_h.get(i).copied().unwrap_or(line.amplitude_deg_h);
        let phase = phases_deg.get(i).copied().unwrap_or(line.phase_deg);
        let moved = columns(seen_hz(line.frequency_hz, drift_ppm), drivers);
        out.iter_mut().zip(wave(amplitude, phase, &moved)).for_each(|(o, c)| *o += c);
    }
    out
}

/// From where the largest line is stated to where a drift puts it.
pub(in crate::effect) fn place(drift_ppm: f64, drivers: &Drivers) -> Option<Place> {
    let stated = shown(drivers).first()?.frequency_hz;
    let seen = seen_hz(stated, drift_ppm);
    Some(Place { domain: Domain::Frequency, from: seen.min(stated), to: seen.max(stated) })
}

/// Drifts that put every line where the record has one about as large, ppm; and how many independent places were looked at. None
/// where the record has a line at the place that is stated: the clock shows it as it should.
pub(in crate::effect) fn starts(drivers: &Drivers, context: &SearchContext<'_>) -> (Vec<f64>, f64) {
    let lines = shown(drivers);
    let Some(line) = lines.first() else { return (vec![], 0.0) };
    let residual = inverse_dct2(context.modes);
    let amplitude = |f: f64, course: &[f64]| {
        let dot = |c: &Vec<f64>| 2.0 * c.iter().zip(course).map(|(c, r)| c * r).sum::<f64>();
        columns(f, drivers).iter().map(dot).fold(0.0, f64::hypot) / drivers.samples as f64
    };
    let with_lines: Vec<f64> = residual.iter().zip(taken_away(drivers)).map(|(r, t)| r - t).collect();
    let absent =
        |l: &StatedLine| amplitude(l.frequency_hz, &with_lines) < l.amplitude_deg_h / MAX_AMPLITUDE_RATIO;
    if !lines.iter().all(absent) {
        return (vec![], 0.0);
    }
    let LineGains { mut gains, step_hz } = LineGains::of(drivers, context);
    let (low, high) = (seen_hz(line.frequency_hz, MAX_DRIFT_PPM), seen_hz(line.frequency_hz, -MAX_DRIFT_PPM));
    let resolution = 1.0 / drivers.length_s();
    for (j, gain) in gains.iter_mut().enumerate() {
        let f = j as f64 * step_hz;
        let inside = (low..=high.min(0.5 / drivers.dt_s - resolution)).contains(&f);
        // The stated line itself, taken away from a record that does not hold it, is the largest peak.
        if !inside || (f - line.frequency_hz).abs() < resolution {
            *gain = 0.0;
        }
    }
    let apart = (3.0 * resolution / step_hz).ceil() as usize;
    let moved = |drift: &f64| {
        lines.iter().all(|l| {
            let ratio = amplitude(seen_hz(l.frequency_hz, *drift), &residual) / l.amplitude_deg_h;
            (1.0 / MAX_AMPLITUDE_RATIO..=MAX_AMPLITUDE_RATIO).contains(&ratio)
        })
    };
    let found = peaks(&gains, MAX_PEAKS, apart).into_iter();
    let at = |j: usize| (j as f64 + crate::numeric::optimize::parabolic_peak(&gains, j)) * step_hz;
    let drifts = found.map(at).map(|f| 1e6 * (1.0 - f / line.frequency_hz)).filter(moved).collect();
    (drifts, (high - low) / resolution)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numeric::cosine::dct2;

    fn drivers() -> Drivers {
        let line = StatedLine { frequency_hz: 12.0, amplitude_deg_h: 7.0, phase_deg: 0.0 };
        Drivers { dt_s: 0.01, samples: 1600, averaged: 1, lines: vec![line], ..Drivers::default() }
    }

    #[test]
    fn a_late_gyro_shows_a_line_lower() {
        // 4 % later each second: what happened within 1 s is spread over 1.04 s, but for the square of the drift.
        assert_eq!(seen_hz(100.0, 40_000.0), 96.0);
        let Place { from, to, .. } = place(-40_000.0, &drivers()).unwrap();
        assert!(from == 12.0 && (to - 12.48).abs() < 1e-12);
        let above_nyquist = Drivers { dt_s: 0.1, ..drivers() };
        assert!(!any(&above_nyquist) && any(&drivers()) && place(1.0, &above_nyquist).is_none());
    }

    #[test]
    fn all_lines_move_together_and_none_that_is_in_its_place() {
        let second = StatedLine { frequency_hz: 31.0, amplitude_deg_h: 4.0, phase_deg: 0.0 };
        let both = Drivers { lines: [drivers().lines, vec![second]].concat(), ..drivers() };
        // Both taken away; the record has some lines.
        let of = |there: &[(f64, f64)]| {
            let mut residual = taken_away(&both);
            for (f, amplitude) in there {
                let line = wave(*amplitude, 20.0, &columns(*f, &both));
                residual.iter_mut().zip(line).for_each(|(r, l)| *r += l);
            }
            let (modes, powers) = (dct2(&residual), vec![1.0; residual.len()]);
            starts(&both, &SearchContext { score: &residual, modes: &modes, powers: &powers }).0
        };
        assert!(!of(&[(12.36, 7.0), (31.93, 4.0)]).is_empty());
        // The second is elsewhere, or in its place; the first is in its place beside another.
        assert!(of(&[(12.36, 7.0), (30.0, 4.0)]).is_empty());
        assert!(of(&[(12.36, 7.0), (31.0, 4.0)]).is_empty());
        assert!(of(&[(12.0, 7.0), (12.36, 7.0), (31.93, 4.0)]).is_empty());
    }

    #[test]
    fn a_drift_begins_where_a_line_of_the_stated_size_is() {
        let drivers = drivers();
        let of = |amplitude: f64| {
            // Taken away at 12 Hz, and there at 12.48 Hz in another phase.
            let residual = course(-40_000.0, &[amplitude], &[50.0], &drivers);
            let score = residual.clone();
            let (modes, powers) = (dct2(&residual), vec![1.0; residual.len()]);
            let context = SearchContext { score: &score, modes: &modes, powers: &powers };
            starts(&drivers, &context).0
        };
        let found = of(6.0);
        assert!(found.iter().any(|d| (d + 40_000.0).abs() < 500.0), "{found:?}");
        // One a third as large is another line.
        assert!(of(2.0).is_empty());
        let (amplitudes, phases) = polars(&[3.0, 0.0, 0.0, -2.0]);
        assert_eq!((amplitudes, phases), (vec![3.0, 2.0], vec![0.0, 90.0]));
    }
}
