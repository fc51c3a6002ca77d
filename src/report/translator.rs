//! Keys, ids, notes and units in the words of a language, numbers printed as a report prints them.

use super::page::{Align, Column, joined};
use super::{number, unit};
use crate::estimate::Verdict;
use crate::i18n;
use crate::i18n::{Arg, Lang, LocalText, Localize, Note, fill, lookup};
use crate::measurand::{self, Test};

/// Gives keys, ids, notes and units the words of a language.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Translator {
    /// The language.
    pub lang: Lang,
}

impl Translator {
    /// The text of a key; the key itself, so that it is noticed, when the table lacks it.
    pub fn t(self, key: &str) -> String {
        lookup(self.lang, key).unwrap_or(key).to_owned()
    }

    /// The text of `prefix.id`; a readable form of the id when the table lacks it. The change of a quantity is named by it.
    pub fn name(self, prefix: &str, id: &str) -> String {
        if let Some(of) = id.strip_suffix("_change")
            && let Some(name) = lookup(self.lang, &format!("{prefix}.{of}"))
        {
            return self.with("compare_phases.change_of", &[("name", name)]);
        }
        lookup(self.lang, &format!("{prefix}.{id}")).map_or_else(|| id.replace('_', " "), str::to_owned)
    }

    /// The text of a key with its places filled.
    pub fn with(self, key: &str, args: &[(&str, &str)]) -> String {
        fill(lookup(self.lang, key).unwrap_or(key), |name| {
            args.iter().find(|a| a.0 == name).map(|a| a.1.to_owned())
        })
    }

    /// A note with printed numbers.
    pub fn say(self, note: &Note) -> String {
        fill(lookup(self.lang, &note.id).unwrap_or(&note.id), |name| {
            note.args.get(name).map(|arg| self.argument(arg))
        })
    }

    /// An argument of a note as a report prints it.
    fn argument(self, arg: &Arg) -> String {
        match arg {
            Arg::Number(v) => number::limit_digits(*v, 4, self.lang),
            Arg::Stated(v) => number::limit(*v, self.lang),
            Arg::Count(v) => number::count(*v, self.lang),
            Arg::Text(t) => t.clone(),
            Arg::Local(t) => self.local(t),
            Arg::Key(k) => i18n::words(k, self.lang),
            Arg::Note(n) => self.say(n),
            Arg::Several(list, between) => {
                list.iter().map(|a| self.argument(a)).collect::<Vec<_>>().join(between)
            }
            Arg::Figures { value, digits, zeros: true } => number::digits(*value, *digits, self.lang),
            Arg::Figures { value, digits, zeros: false } => number::limit_digits(*value, *digits, self.lang),
            Arg::Decimals { value, digits, zeros } => number::decimals(*value, *digits, *zeros, self.lang),
        }
    }

    /// A column of text whose head has a key; the last part of the key is its name.
    pub fn column(self, key: &str) -> Column {
        Column::text(key.rsplit('.').next().unwrap_or(key), self.t(key))
    }

    /// The same of numbers.
    pub fn number_column(self, key: &str) -> Column {
        Column { align: Align::Right, ..self.column(key) }
    }

    /// A text of a user.
    pub fn local(self, text: &LocalText) -> String {
        text.say(self.lang)
    }

    /// A source as it is cited; the part of a standard that has a name of its own by that of the language.
    pub fn citation(self, source: &str) -> String {
        fill(source, |name| (name == "annex").then(|| self.t("report.annex")))
    }

    /// A formula with the decimal mark of the language.
    pub fn formula(self, text: &str) -> String {
        let mark = lookup(self.lang, "number.decimal").unwrap_or(".");
        let chars: Vec<char> = text.chars().collect();
        let mut out = String::with_capacity(text.len());
        for (i, c) in chars.iter().enumerate() {
            let figure = |at: Option<usize>| at.and_then(|i| chars.get(i)).is_some_and(char::is_ascii_digit);
            if *c == '.' && figure(i.checked_sub(1)) && figure(Some(i + 1)) {
                out.push_str(mark);
            } else {
                out.push(*c);
            }
        }
        out
    }

    /// A unit in print.
    pub fn unit(self, text: &str) -> String {
        unit::pretty(text, self.lang)
    }

    /// A printed number with its unit.
    pub fn quantity(self, number: &str, unit: &str) -> String {
        self.joined(number, &self.unit(unit))
    }

    /// A printed number with its printed unit.
    pub fn joined(self, number: &str, unit: &str) -> String {
        joined(number, unit)
    }

    /// A name with the channel behind it, where there is one: rows of a formula or of a program have none.
    pub fn in_channel(self, name: String, channel: &str, measurand: &str) -> String {
        let channel = self.channel(channel, measurand);
        if channel.is_empty() { name } else { format!("{name} · {channel}") }
    }

    /// A channel as it is read. Rows of a test with several temperatures, ramps or levels name theirs behind the channel,
    /// as limits do: `rate@-40`.
    pub fn channel(self, channel: &str, measurand: &str) -> String {
        let Some((base, place)) = channel.split_once('@') else { return channel.to_owned() };
        if let Some(number) = place.strip_prefix("ramp") {
            return self.with("report.at_ramp", &[("channel", base), ("number", number)]);
        }
        match place {
            "positive" => return self.with("report.positive_rates", &[("channel", base)]),
            "negative" => return self.with("report.negative_rates", &[("channel", base)]),
            _ => {}
        }
        let band = place.strip_suffix("Hz").and_then(|band| band.split_once('-'));
        if let Some((from, to)) = band {
            let shown =
                |hz: &str| hz.parse().map_or_else(|_| hz.to_owned(), |hz| number::limit(hz, self.lang));
            let (from, to) = (shown(from), self.quantity(&shown(to), "Hz"));
            return self.with("report.in_band", &[("channel", base), ("from", &from), ("to", &to)]);
        }
        let (axis, level) = place.rsplit_once(':').unwrap_or(("", place));
        let stated: Option<f64> = level.parse().ok();
        let level = stated.map_or_else(|| level.to_owned(), |l| number::limit(l, self.lang));
        let by_temperature = [Test::Temperature, Test::StartUp];
        if measurand::find(measurand).is_some_and(|m| by_temperature.contains(&m.test())) {
            let level = self.quantity(&level, "degC");
            return self.with("report.at_temperature", &[("channel", base), ("temperature", &level)]);
        }
        if axis.is_empty() && stated.is_none() {
            return self.with("report.of_channel", &[("channel", base), ("other", place)]);
        }
        let level = if axis.is_empty() { level } else { format!("{axis} {level}") };
        self.with("report.at_level", &[("channel", base), ("level", &level)])
    }

    /// The word of a verdict.
    pub fn verdict(self, verdict: Verdict) -> String {
        self.name("verdict", verdict.id())
    }
}
