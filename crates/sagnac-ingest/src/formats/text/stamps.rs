//! Time stamps as text: dates, clock times, and both together.

/// In which order a date is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(clippy::enum_variant_names, reason = "what stands first is the whole difference")]
pub(super) enum Order {
    /// `2026-03-01`, `2026/03/01`, `20260301`.
    YearFirst,
    /// `01.03.2026`, as in Russia.
    DayFirst,
    /// `03/01/2026`, as in the United States.
    MonthFirst,
}

/// How the stamps of a column are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Shape {
    /// Date and clock time.
    DateTime(Order),
    /// Date alone.
    Date(Order),
    /// Clock time alone.
    Clock,
    /// Minutes and seconds of the hour, `57:20.5`, as spreadsheets leave clock times.
    MinuteClock,
}

impl Shape {
    /// True when the stamps tell the day.
    pub(super) fn is_dated(self) -> bool {
        !matches!(self, Shape::Clock | Shape::MinuteClock)
    }

    /// Period after which the stamps start again, s.
    pub(super) fn rollover_s(self) -> Option<f64> {
        match self {
            Shape::Clock => Some(DAY_S as f64),
            Shape::MinuteClock => Some(3600.0),
            Shape::DateTime(_) | Shape::Date(_) => None,
        }
    }
}

/// A stamp: whole seconds and a decimal fraction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Stamp {
    /// Seconds from 1970 UTC, or from midnight for a clock time.
    pub seconds: i64,
    /// Digits of the fraction.
    fraction: u64,
    /// Number of digits of the fraction.
    places: usize,
    /// True when the stamp tells its zone.
    pub zoned: bool,
}

/// Seconds of a day.
pub(super) const DAY_S: i64 = 86_400;

/// Most digits of a fraction that count: attoseconds.
const PLACES: usize = 18;

const POWERS: [u64; PLACES + 1] = {
    let mut powers = [1; PLACES + 1];
    let mut i = 1;
    while i <= PLACES {
        powers[i] = powers[i - 1] * 10;
        i += 1;
    }
    powers
};

impl Stamp {
    /// Seconds after `base_s`, rounded once wherever a double can hold all digits.
    #[inline]
    pub(super) fn after(self, base_s: i64) -> f64 {
        let whole = self.seconds.saturating_sub(base_s);
        let power = POWERS.get(self.places).copied().unwrap_or(1);
        let all = i64::try_from(power)
            .ok()
            .and_then(|p| whole.checked_mul(p))
            .and_then(|w| w.checked_add_unsigned(self.fraction))
            .filter(|all| all.unsigned_abs() < 1 << 53);
        match all {
            Some(all) => all as f64 / power as f64,
            None => whole as f64 + self.fraction as f64 / power as f64,
        }
    }
}

struct Scan<'a> {
    text: &'a [u8],
    at: usize,
}

impl Scan<'_> {
    #[inline]
    fn peek(&self) -> u8 {
        self.text.get(self.at).copied().unwrap_or(0)
    }

    #[inline]
    fn take(&mut self, c: u8) -> bool {
        let found = self.peek() == c;
        self.at += usize::from(found);
        found
    }

    /// A number of `least` to `most` digits.
    #[inline]
    fn digits(&mut self, least: usize, most: usize) -> Option<i64> {
        let (mut value, mut count) = (0i64, 0);
        while count < most {
            let digit = self.peek().wrapping_sub(b'0');
            if digit > 9 {
                break;
            }
            value = value * 10 + i64::from(digit);
            self.at += 1;
            count += 1;
        }
        (count >= least).then_some(value)
    }

    fn spaces(&mut self) -> bool {
        let start = self.at;
        while self.take(b' ') {}
        self.at > start
    }

    fn ended(&self) -> bool {
        self.at >= self.text.len()
    }

    /// Days from 1970, and whether the date was written without separators.
    #[inline]
    fn date(&mut self, order: Order) -> Option<(i64, bool)> {
        if order == Order::YearFirst {
            let year = self.digits(4, 4)?;
            let separator = self.peek();
            if separator.is_ascii_digit() {
                let (month, day) = (self.digits(2, 2)?, self.digits(2, 2)?);
                return Some((days(year, month, day)?, true));
            }
            if !matches!(separator, b'-' | b'/' | b'.') {
                return None;
            }
            self.at += 1;
            let month = self.digits(1, 2)?;
            let day = self.take(separator).then(|| self.digits(1, 2))??;
            return Some((days(year, month, day)?, false));
        }
        let first = self.digits(1, 2)?;
        let separator = self.peek();
        if !matches!(separator, b'.' | b'/' | b'-' | b' ') {
            return None;
        }
        self.at += 1;
        if order == Order::DayFirst
            && let Some(month) = self.month_by_name()
        {
            let year = self.take(separator).then(|| self.digits(4, 4))??;
            return Some((days(year, month, first)?, false));
        }
        let second = if separator == b' ' { return None } else { self.digits(1, 2)? };
        let year = self.take(separator).then(|| self.digits(4, 4))??;
        let (day, month) = if order == Order::DayFirst { (first, second) } else { (second, first) };
        Some((days(year, month, day)?, false))
    }

    /// A month as its English name begins: `Jul`.
    #[inline]
    fn month_by_name(&mut self) -> Option<i64> {
        const MONTHS: &[u8] = b"janfebmaraprmayjunjulaugsepoctnovdec";
        let name = self.text.get(self.at..self.at + 3).filter(|n| n.iter().all(u8::is_ascii_alphabetic))?;
        let place = MONTHS.chunks(3).position(|m| m.eq_ignore_ascii_case(name))?;
        self.at += 3;
        i64::try_from(place + 1).ok()
    }

    /// Seconds of the day with the fraction; `compact`: written without colons; `short`: seconds may be left out.
    #[inline]
    fn clock(&mut self, compact: bool, short: bool) -> Option<(i64, u64, usize)> {
        let hours = self.digits(if compact { 2 } else { 1 }, 2)?;
        if !compact && !self.take(b':') {
            return None;
        }
        let minutes = self.digits(2, 2)?;
        let seconds = match compact {
            true if self.peek().is_ascii_digit() => self.digits(2, 2)?,
            false if self.take(b':') => self.digits(2, 2)?,
            _ if short => 0,
            _ => return None,
        };
        // A minute may have a 61st second.
        if hours > 23 || minutes > 59 || seconds > 60 {
            return None;
        }
        let (fraction, places) = self.fraction(!compact)?;
        let hours = self.half_of_day(hours)?;
        Some((hours * 3600 + minutes * 60 + seconds, fraction, places))
    }

    /// Seconds of the hour with the fraction.
    fn minutes(&mut self) -> Option<(i64, u64, usize)> {
        let minutes = self.digits(1, 2)?;
        let seconds = self.take(b':').then(|| self.digits(2, 2))??;
        let (fraction, places) = self.fraction(false)?;
        (minutes <= 59 && seconds <= 60).then_some((minutes * 60 + seconds, fraction, places))
    }

    /// Digits of a fraction of a second and their number; none where none is written. `colon`: milliseconds may stand
    /// behind a third colon, as some loggers write them.
    #[inline]
    fn fraction(&mut self, colon: bool) -> Option<(u64, usize)> {
        let (mut fraction, mut places) = (0u64, 0);
        let behind_colon = colon && self.peek() == b':';
        if behind_colon || matches!(self.peek(), b'.' | b',') {
            self.at += 1;
            let start = self.at;
            while self.peek().is_ascii_digit() {
                if places < PLACES {
                    fraction = fraction * 10 + u64::from(self.peek() - b'0');
                    places += 1;
                }
                self.at += 1;
            }
            if self.at == start || (behind_colon && places != 3) {
                return None;
            }
        }
        Some((fraction, places))
    }

    /// Hours of the day where AM or PM follows, else the hours as they are.
    #[inline]
    fn half_of_day(&mut self, hours: i64) -> Option<i64> {
        if self.ended() {
            return Some(hours);
        }
        let rest = self.text.get(self.at..).unwrap_or_default();
        let blanks = rest.iter().take_while(|c| **c == b' ').count();
        let word = rest.get(blanks..).unwrap_or_default();
        let word_end =
            word.iter().position(|c| !(c.is_ascii_alphabetic() || *c == b'.')).unwrap_or(word.len());
        let letters = word.get(..word_end).unwrap_or_default();
        let is = |half: [&[u8]; 2]| half.into_iter().any(|w| letters.eq_ignore_ascii_case(w));
        let afternoon = match () {
            () if is([b"AM", b"a.m."]) => false,
            () if is([b"PM", b"p.m."]) => true,
            () => return Some(hours),
        };
        self.at += blanks + word_end;
        (1..=12).contains(&hours).then_some(hours % 12 + if afternoon { 12 } else { 0 })
    }

    /// Seconds that the zone is ahead of UTC; `None` within where no zone is written.
    #[inline]
    fn zone(&mut self) -> Option<Option<i64>> {
        if self.ended() {
            return Some(None);
        }
        self.spaces();
        let word = self.text.get(self.at..).unwrap_or_default();
        if [&b"Z"[..], b"UTC", b"GMT"].iter().any(|w| word.eq_ignore_ascii_case(w)) {
            self.at = self.text.len();
            return Some(Some(0));
        }
        let sign = if self.take(b'+') {
            1
        } else if self.take(b'-') {
            -1
        } else {
            return None;
        };
        let hours = self.digits(2, 2)?;
        self.take(b':');
        let minutes = if self.ended() { 0 } else { self.digits(2, 2)? };
        (hours <= 18 && minutes <= 59).then_some(Some(sign * (hours * 3600 + minutes * 60)))
    }
}

/// Days from 1970-01-01 to a date of the Gregorian calendar (H. Hinnant, chrono-compatible low-level date algorithms).
#[inline]
fn days(year: i64, month: i64, day: i64) -> Option<i64> {
    let leap = year % 4 == 0 && (year % 100 != 0 || year % 400 == 0);
    let longest = match month {
        1 | 3 | 5 | 7 | 8 | 10 | 12 => 31,
        4 | 6 | 9 | 11 => 30,
        2 if leap => 29,
        2 => 28,
        _ => return None,
    };
    if !(1..=longest).contains(&day) {
        return None;
    }
    let y = if month <= 2 { year - 1 } else { year };
    let era = y.div_euclid(400);
    let of_era = y - era * 400;
    let of_year = (153 * ((month + 9) % 12) + 2) / 5 + day - 1;
    Some(era * 146_097 + of_era * 365 + of_era / 4 - of_era / 100 + of_year - 719_468)
}

/// Reads a stamp written in the given way; `None` when it is anything else.
#[inline]
pub(super) fn parse(text: &[u8], shape: Shape) -> Option<Stamp> {
    let mut scan = Scan { text, at: 0 };
    let (day, compact) = match shape {
        Shape::DateTime(order) | Shape::Date(order) => scan.date(order)?,
        Shape::Clock | Shape::MinuteClock => (0, false),
    };
    if shape == Shape::MinuteClock {
        let (seconds, fraction, places) = scan.minutes()?;
        return scan.ended().then_some(Stamp { seconds, fraction, places, zoned: false });
    }
    if let Shape::Date(_) = shape {
        let seconds = day * DAY_S;
        return scan.ended().then_some(Stamp { seconds, fraction: 0, places: 0, zoned: false });
    }
    if shape.is_dated() && !(scan.take(b'T') || scan.take(b't') || scan.spaces()) {
        return None;
    }
    let compact = compact && text.get(scan.at + 2) != Some(&b':');
    let (seconds, fraction, places) = scan.clock(compact, shape.is_dated())?;
    let zone = scan.zone()?;
    let seconds = day * DAY_S + seconds - zone.unwrap_or(0);
    scan.ended().then_some(Stamp { seconds, fraction, places, zoned: zone.is_some() })
}

/// The way a text is written when it is a stamp. Dates with slashes and the year last are left where nobody can tell
/// whether the day or the month stands first: one of them must be beyond 12, or AM or PM follow as where the month goes
/// first. Two numbers with a colon are minutes and seconds where they cannot be hours and minutes.
pub(super) fn detect(text: &[u8]) -> Option<Shape> {
    let number_like = !text.iter().any(|c| matches!(c, b':' | b'/' | b'T' | b't'))
        && text.iter().filter(|c| matches!(c, b'-' | b'.')).count() < 2;
    if number_like || text.len() > 64 {
        return None;
    }
    let candidates = [
        Shape::DateTime(Order::YearFirst),
        Shape::DateTime(Order::DayFirst),
        Shape::Date(Order::YearFirst),
        Shape::Date(Order::DayFirst),
        Shape::DateTime(Order::MonthFirst),
        Shape::Date(Order::MonthFirst),
        Shape::Clock,
        Shape::MinuteClock,
    ];
    let dotted = text.iter().take(3).any(|c| *c == b'.');
    let halved = text.iter().rev().take(4).any(|c| c.eq_ignore_ascii_case(&b'm'));
    let reads = |shape| parse(text, shape).is_some();
    let other_order = |shape| match shape {
        Shape::DateTime(Order::DayFirst) => reads(Shape::DateTime(Order::MonthFirst)),
        Shape::Date(Order::DayFirst) => reads(Shape::Date(Order::MonthFirst)),
        Shape::DateTime(Order::MonthFirst) => reads(Shape::DateTime(Order::DayFirst)) && !halved,
        Shape::Date(Order::MonthFirst) => reads(Shape::Date(Order::DayFirst)),
        _ => false,
    };
    let certain = |shape: &Shape| match shape {
        Shape::DateTime(Order::DayFirst) | Shape::Date(Order::DayFirst) => {
            dotted || !(other_order(*shape) || halved)
        }
        Shape::DateTime(Order::MonthFirst) | Shape::Date(Order::MonthFirst) => {
            !dotted && !other_order(*shape)
        }
        Shape::MinuteClock => {
            let minutes =
                text.iter().take_while(|c| c.is_ascii_digit()).fold(0, |n, c| 10 * n + u32::from(c - b'0'));
            minutes > 23 || text.iter().any(|c| matches!(c, b'.' | b','))
        }
        _ => true,
    };
    candidates.into_iter().find(|s| reads(*s) && certain(s))
}

#[cfg(test)]
#[path = "stamps_tests.rs"]
mod tests;
