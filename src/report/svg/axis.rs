//! Axes: the range that is shown, where the ticks are, what is written at them.

use super::write::{FONT, width};
use crate::figure::Scale;
use crate::i18n::{Lang, lookup};
use crate::report::number::{limit_digits, typographic};
use crate::report::unit::{self, superscript};

/// Largest magnitude an axis reaches; differences of such values are still finite.
const HUGE: f64 = 1e300;

/// A mark on an axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Tick {
    /// Value, in the unit of the data.
    pub at: f64,
    /// Label, `None` for a minor mark.
    pub label: Option<String>,
}

/// An axis with its range and marks settled.
#[derive(Debug, Clone, PartialEq)]
pub struct Ruled {
    scale: Scale,
    low: f64,
    high: f64,
    /// Marks in ascending order.
    pub ticks: Vec<Tick>,
    /// Label with unit.
    pub title: String,
    /// The unit in which values are read off.
    pub reading: Reading,
}

/// How values of an axis are read off: name, unit, and how much of the unit of the data one of it is.
#[derive(Debug, Clone, PartialEq)]
pub struct Reading {
    /// Name, in words.
    pub name: String,
    /// Unit, printed.
    pub unit: String,
    /// Size of the unit, in the unit of the data.
    pub per: f64,
}

/// Direction of an axis: decides how much room a mark needs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Direction {
    /// Words stand side by side.
    Across,
    /// Words stand one above the other.
    Up,
}

impl Ruled {
    /// The range shown.
    pub fn range(&self) -> (f64, f64) {
        (self.low, self.high)
    }

    /// Settles an axis.
    ///
    /// `data` is the extent of what is to be shown (`None`: nothing); `length` the size on paper, px.
    pub fn new(
        axis: &crate::figure::Axis,
        data: Option<(f64, f64)>,
        direction: Direction,
        length: f64,
        lang: Lang,
    ) -> Ruled {
        // A series over time fills its frame; what is measured keeps some distance from it, and a polar plot has its
        // angles there.
        let room = match direction {
            Direction::Across => 0.01,
            Direction::Up if axis.scale == Scale::Polar => 0.2,
            Direction::Up => 0.08,
        };
        let (low, high) = range(axis.scale, axis.range, data, room);
        let words = lookup(lang, &axis.label).unwrap_or(&axis.label);
        let timed = axis.scale == Scale::Linear && direction == Direction::Across && axis.unit == "s";
        let reading = Reading { name: words.to_owned(), unit: unit::pretty(&axis.unit, lang), per: 1.0 };
        let mut ruled = Ruled { scale: axis.scale, low, high, ticks: vec![], title: String::new(), reading };
        let (prefix, unit_text) = match axis.scale {
            Scale::Log => {
                ruled.ticks = log_ticks(low, high, direction, length, lang);
                (String::new(), unit::pretty(&axis.unit, lang))
            }
            Scale::Linear => ruled.rule_linearly(timed, &axis.unit, direction, length, lang),
            Scale::Polar => return ruled,
        };
        ruled.title = format!("{words}{prefix}");
        if !unit_text.is_empty() {
            ruled.title.push_str(", ");
            ruled.title.push_str(&unit_text);
        }
        ruled
    }

    /// Position of a value along the axis, 0 at the low end and 1 at the high end; `None` where it has none.
    pub fn place(&self, value: f64) -> Option<f64> {
        let at = match self.scale {
            Scale::Linear | Scale::Polar => (value.clamp(-HUGE, HUGE) - self.low) / (self.high - self.low),
            Scale::Log if value > 0.0 => (value / self.low).log10() / (self.high / self.low).log10(),
            Scale::Log => return None,
        };
        (!value.is_nan() && at.is_finite()).then_some(at.clamp(-50.0, 50.0))
    }

    /// As [`Ruled::place`], with what has no place on a logarithmic axis put below its low end.
    pub fn place_or_below(&self, value: f64) -> Option<f64> {
        if self.scale == Scale::Log && value <= 0.0 { Some(-1.0) } else { self.place(value) }
    }

    /// True for an axis of decades.
    pub fn is_log(&self) -> bool {
        self.scale == Scale::Log
    }

    /// True for an axis of a polar plot.
    pub fn is_polar(&self) -> bool {
        self.scale == Scale::Polar
    }

    /// True when the value lies on the axis.
    pub fn holds(&self, value: f64) -> bool {
        value >= self.low && value <= self.high
    }

    fn rule_linearly(
        &mut self,
        timed: bool,
        unit_text: &str,
        direction: Direction,
        length: f64,
        lang: Lang,
    ) -> (String, String) {
        let span = self.high - self.low;
        let (factor, steps, shown): (f64, &[f64], &str) = match span {
            s if timed && s >= 5.0 * 86_400.0 => (86_400.0, &[0.25, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0], "d"),
            s if timed && s >= 7200.0 => (3600.0, &[0.25, 0.5, 1.0, 2.0, 3.0, 6.0, 12.0, 24.0], "h"),
            s if timed && s >= 180.0 => (60.0, &[0.5, 1.0, 2.0, 5.0, 10.0, 15.0, 20.0, 30.0], "min"),
            _ => (1.0, &[], unit_text),
        };
        self.reading.unit = unit::pretty(shown, lang);
        self.reading.per = factor;
        let (low, high) = (self.low / factor, self.high / factor);
        let mut target = match direction {
            Direction::Across => (length / 55.0).clamp(2.0, 12.0),
            Direction::Up => (length / 34.0).clamp(2.0, 9.0),
        };
        loop {
            let step = step_for((high - low) / target, steps);
            let values = multiples(low, high, step);
            let labels = Labels::choose(low, high, step, lang);
            let fits = direction == Direction::Up || {
                let widest = values.iter().map(|v| width(&labels.write(*v), FONT)).fold(0.0, f64::max);
                widest + 14.0 <= length * step / (high - low)
            };
            if fits || target <= 2.0 {
                self.ticks =
                    values.iter().map(|v| Tick { at: v * factor, label: Some(labels.write(*v)) }).collect();
                let unit_text = labels.unit(&unit::pretty(shown, lang));
                return (labels.prefix(), unit_text);
            }
            target -= 1.0;
        }
    }
}

/// The range of an axis: the fixed one where it makes sense, else the extent of the data with some room.
fn range(scale: Scale, fixed: Option<(f64, f64)>, data: Option<(f64, f64)>, room: f64) -> (f64, f64) {
    let sane = |(a, b): (f64, f64)| {
        a.is_finite()
            && b.is_finite()
            && a < b
            && a.abs().max(b.abs()) <= HUGE
            && (scale != Scale::Log || a > 1e-300)
    };
    if let Some(fixed) = fixed.filter(|f| sane(*f)) {
        return fixed;
    }
    match scale {
        Scale::Linear | Scale::Polar => {
            let (a, b) = data.unwrap_or((0.0, 1.0));
            let (a, b) = (a.clamp(-HUGE, HUGE), b.clamp(-HUGE, HUGE));
            let middle = 0.5 * a + 0.5 * b;
            let half = 0.5 * b - 0.5 * a;
            let least = middle.abs() * 1e-12;
            let half = match half {
                h if h > least && h > 1e-300 => h * (1.0 + room),
                _ if middle == 0.0 => 1.0,
                _ => middle.abs() * 0.05,
            };
            (middle - half, middle + half)
        }
        Scale::Log => {
            let (a, b) = data.unwrap_or((1.0, 10.0));
            let (a, b) = (a.clamp(1e-290, 1e290), b.clamp(1e-290, 1e290));
            if b / a < 1.0 + 1e-9 {
                return (a / 2.0, b * 2.0);
            }
            let room = (b / a).powf(0.04).clamp(1.02, 2.0);
            (a / room, b * room)
        }
    }
}

/// The smallest pleasant step that is not below `least`.
fn step_for(least: f64, preferred: &[f64]) -> f64 {
    if let Some(step) = preferred.iter().find(|s| **s >= least) {
        return *step;
    }
    let decade = 10f64.powf(least.abs().max(1e-305).log10().floor());
    [1.0, 2.0, 5.0, 10.0]
        .iter()
        .map(|m| m * decade)
        .find(|s| *s >= least * (1.0 - 1e-9))
        .unwrap_or(10.0 * decade)
}

fn multiples(low: f64, high: f64, step: f64) -> Vec<f64> {
    let (first, last) = ((low / step - 1e-9).ceil(), (high / step + 1e-9).floor());
    let count = (last - first).clamp(0.0, 60.0) as usize;
    (0..=count)
        .map(|i| (first + i as f64) * step)
        .filter(|v| *v >= low - 1e-6 * step && *v <= high + 1e-6 * step)
        .collect()
}

/// How the marks of a linear axis are written.
struct Labels {
    lang: Lang,
    decimals: usize,
    exponent: i32,
    offset: f64,
    step: f64,
}

impl Labels {
    fn choose(low: f64, high: f64, step: f64, lang: Lang) -> Labels {
        let size = low.abs().max(high.abs());
        // Marks that agree in their first five digits are written as differences from a round value.
        let offset = if size / step > 1e5 {
            let round = 10f64.powi((10.0 * step).log10().ceil() as i32);
            ((0.5 * low + 0.5 * high) / round).round() * round
        } else {
            0.0
        };
        let size = if offset == 0.0 { size } else { (low - offset).abs().max((high - offset).abs()) };
        let top = size.max(1e-300).log10().floor() as i32;
        let place = (step * (1.0 + 1e-9)).log10().floor() as i32;
        let fraction = step / 10f64.powi(place);
        // A step of 0.25 needs one place more than its first digit.
        let place = if (fraction - fraction.round()).abs() > 1e-6 { place - 1 } else { place };
        let exponent = if place < -4 || top >= 5 { top } else { 0 };
        Labels { lang, decimals: (exponent - place).clamp(0, 12) as usize, exponent, offset, step }
    }

    fn write(&self, value: f64) -> String {
        let value = value - self.offset;
        if value.abs() < 1e-9 * self.step {
            return "0".to_owned();
        }
        typographic(&format!("{:.*}", self.decimals, value / 10f64.powi(self.exponent)), self.lang)
    }

    fn prefix(&self) -> String {
        if self.offset == 0.0 {
            return String::new();
        }
        let sign = if self.offset < 0.0 { '+' } else { '−' };
        format!(" {sign} {}", limit_digits(self.offset.abs(), 12, self.lang))
    }

    fn unit(&self, unit: &str) -> String {
        if self.exponent == 0 {
            return unit.to_owned();
        }
        let power = format!("10{}", superscript(&self.exponent.to_string()));
        if unit.is_empty() { power } else { format!("{power} {unit}") }
    }
}

/// Marks of a logarithmic axis: decades, or 1-2-5, or finer, whichever leaves at least two words.
fn log_ticks(low: f64, high: f64, direction: Direction, length: f64, lang: Lang) -> Vec<Tick> {
    let decades = (high / low).log10();
    let (first, last) = (low.log10().floor() as i32, high.log10().ceil() as i32);
    let power = |e: i32| 10f64.powi(e);
    let inside = |v: f64| v >= low * (1.0 - 1e-9) && v <= high * (1.0 + 1e-9);
    let room = |direction| match direction {
        Direction::Across => 46.0,
        Direction::Up => 20.0,
    };
    let every = ((last - first) as f64 * room(direction) / length).ceil().max(1.0) as i32;
    let whole: Vec<f64> = (first..=last).map(power).filter(|v| inside(*v)).collect();
    let candidates: &[f64] = if whole.len() >= 3 {
        &[1.0]
    } else if decades >= 0.8 {
        &[1.0, 2.0, 5.0]
    } else {
        &[1.0, 1.2, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0]
    };
    let mut labelled: Vec<f64> = (first..=last)
        .filter(|e| every == 1 || e.rem_euclid(every) == 0)
        .flat_map(|e| candidates.iter().map(move |m| m * power(e)))
        .filter(|v| inside(*v))
        .collect();
    if labelled.len() < 2 && every == 1 {
        let step = step_for((high - low) / 4.0, &[]);
        labelled = multiples(low, high, step).into_iter().filter(|v| *v > 0.0).collect();
    }
    let plain = first >= -4 && last <= 5;
    let mut ticks: Vec<Tick> = vec![];
    let mut taken: Vec<(f64, f64)> = vec![];
    // Whole decades are written first, so that nothing finer takes their room.
    let rank = |v: f64| u8::from((v.log10() - v.log10().round()).abs() > 1e-9);
    labelled.sort_by(|a, b| rank(*a).cmp(&rank(*b)).then(a.total_cmp(b)));
    for at in labelled {
        let label = log_label(at, plain, lang);
        let size = match direction {
            Direction::Across => width(&label, FONT) + 10.0,
            Direction::Up => 15.0,
        };
        let centre = (at / low).log10() / decades * length;
        if taken.iter().all(|(c, s)| (c - centre).abs() >= 0.5 * (s + size)) {
            taken.push((centre, size));
            ticks.push(Tick { at, label: Some(label) });
        }
    }
    if decades <= 12.0 {
        for value in (first..=last).flat_map(|e| (1..10).map(move |m| f64::from(m) * power(e))) {
            if inside(value) && !ticks.iter().any(|t| (t.at / value - 1.0).abs() < 1e-6) {
                ticks.push(Tick { at: value, label: None });
            }
        }
    }
    ticks.sort_by(|a, b| a.at.total_cmp(&b.at));
    ticks
}

fn log_label(at: f64, plain: bool, lang: Lang) -> String {
    if plain {
        return limit_digits(at, 6, lang);
    }
    let exponent = (at * (1.0 + 1e-9)).log10().floor();
    let mantissa = at / 10f64.powf(exponent);
    let power = format!("10{}", superscript(&format!("{exponent}")));
    if (mantissa - 1.0).abs() < 1e-6 {
        power
    } else {
        format!("{}·{power}", limit_digits(mantissa, 3, lang))
    }
}

#[cfg(test)]
#[path = "axis_tests.rs"]
mod tests;
