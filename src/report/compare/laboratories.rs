//! Two results of one unit on pages, on a terminal, and as a table for programs.

use super::columns::of_record;
use crate::acceptance::compare::laboratories::{Agreement, Laboratories, PairedRow, Reason, Score, Side};
use crate::i18n::Note;
use crate::record::MeasurandRecord;
use crate::report::number::{decimals, digits, duration, limit_digits};
use crate::report::page::{Block, Column, Joined, OnTerminal, Quantity, Table, Value};
use crate::report::translator::Translator;

/// Digits of an uncertainty and of a difference.
const UNCERTAINTY_DIGITS: usize = 2;
/// Decimals of E_n.
const SCORE_DECIMALS: usize = 2;
/// Name in tables of a reason that is only possible.
const POSSIBLE: &str = "?";

/// The columns of pages and of a terminal.
const SHOWN: [&str; 7] =
    ["quantity", "first_printed", "second_printed", "difference", "expanded_uncertainty", "en", "agreement"];

/// The rows with all columns: pages and a terminal pick some.
pub(super) fn table(labs: &Laboratories, words: Translator) -> Table {
    let rows = &labs.rows;
    let lang = words.lang;
    let text = |of: &dyn Fn(&PairedRow) -> String| rows.iter().map(of).collect::<Vec<_>>();
    let number = |of: &dyn Fn(&PairedRow) -> Option<f64>| rows.iter().map(of).collect::<Vec<_>>();
    let shown = |of: &dyn Fn(&PairedRow) -> Value| rows.iter().map(of).collect::<Vec<_>>();
    let printed = |number: Option<f64>, printed: String| Quantity { number, printed, unit: String::new() };
    let several = rows.iter().any(|r| r.first.channel != rows[0].first.channel);
    let quantity = |row: &PairedRow| {
        let (name, unit) = (words.name("measurand", &row.first.id), words.unit(&row.first.unit));
        let name = if unit.is_empty() { name } else { format!("{name}, {unit}") };
        if several { words.in_channel(name, &row.first.channel, &row.first.id) } else { name }
    };
    let value = |of: &MeasurandRecord| of_record(of, words).value();
    let of_score = |row: &PairedRow, of: fn(&Score) -> f64| {
        let number = row.score.as_ref().map(of);
        Value::from(printed(number, number.map(|v| digits(v, UNCERTAINTY_DIGITS, lang)).unwrap_or_default()))
    };
    // Of one recording there is a difference and no score.
    let difference = |row: &PairedRow| {
        let number = row.score.map(|s| s.difference).or(row.by_procedures.filter(|_| labs.same_recording));
        Value::from(printed(number, number.map(|v| digits(v, UNCERTAINTY_DIGITS, lang)).unwrap_or_default()))
    };
    let en = |score: Option<Score>| {
        let number = score.map(|s| s.en);
        Value::from(printed(
            number,
            number.map(|v| decimals(v, SCORE_DECIMALS, true, lang)).unwrap_or_default(),
        ))
    };
    let agreement = |row: &PairedRow| {
        let state = match row.agreement {
            Agreement::Agrees => "ok",
            Agreement::Differs => "fail",
            Agreement::Undecided => "none",
        };
        let reasons: Vec<String> = row.reasons.iter().map(|r| short(r, words)).collect();
        let word = words.name("laboratories.agreement", row.agreement.id());
        Value::state(state, word).detail(Joined::Remark, reasons.join(", "))
    };
    let head = |key: &str| words.t(key);
    let [first, second] = &labs.sides;
    Table::new("cards", rows.len())
        .column(Column::text("id", ""), text(&|r| r.first.id.clone()))
        .column(Column::text("channel", ""), text(&|r| r.first.channel.clone()))
        .column(Column::text("unit", ""), text(&|r| r.first.unit.clone()))
        .column(Column::number("first", ""), number(&|r| r.first.value))
        .column(Column::number("second", ""), number(&|r| r.second.value))
        .column(Column::text("quantity", head("report.quantity")).for_pages(), text(&quantity))
        .column(Column::number("first_printed", first.name.clone()).for_pages(), shown(&|r| value(&r.first)))
        .column(
            Column::number("second_printed", second.name.clone()).for_pages(),
            shown(&|r| value(&r.second)),
        )
        .column(
            Column::number("difference", head("laboratories.difference")).on_terminal(OnTerminal::Optional),
            shown(&difference),
        )
        .column(
            Column::number("expanded_uncertainty", head("laboratories.expanded"))
                .on_terminal(OnTerminal::Optional),
            shown(&|r| of_score(r, |s| s.expanded)),
        )
        .column(Column::number("common_standard_uncertainty", ""), number(&|r| Some(r.score?.common)))
        .column(Column::number("en", head("laboratories.en")), shown(&|r| en(r.score)))
        .column(Column::number("en_by_first", ""), shown(&|r| en(r.by_first)))
        .column(Column::number("en_by_second", ""), shown(&|r| en(r.by_second)))
        .column(Column::number("by_procedures", ""), number(&|r| r.by_procedures))
        .column(Column::text("agreement_id", ""), text(&|r| r.agreement.id().to_owned()))
        .column(Column::text("reasons", ""), text(&reasons_for_programs))
        .column(Column::text("agreement", head("laboratories.verdict")).for_pages(), shown(&agreement))
}

/// A reason in one word; with a mark where it is only possible.
fn short(reason: &Reason, words: Translator) -> String {
    let name = words.name("laboratories.kind", reason.kind.id());
    if reason.shown { name } else { format!("{name}{POSSIBLE}") }
}

fn reasons_for_programs(row: &PairedRow) -> String {
    let of = |r: &Reason| if r.shown { r.kind.id().to_owned() } else { format!("{}{POSSIBLE}", r.kind.id()) };
    row.reasons.iter().map(of).collect::<Vec<_>>().join(" ")
}

/// The results beside each other.
fn sides(labs: &Laboratories, words: Translator) -> Table {
    let lang = words.lang;
    let [a, b] = &labs.sides;
    let line = |key: &str, of: &dyn Fn(&Side) -> String| (words.t(key), of(a), of(b));
    let none = || words.t("laboratories.unknown");
    let degrees = |s: &Side| {
        let of = |t: f64| words.quantity(&limit_digits(t, 4, lang), "degC");
        s.temperature_deg_c.map_or_else(none, of)
    };
    let seconds =
        |s: &Side| s.sample_interval_s.map_or_else(none, |t| words.quantity(&limit_digits(t, 4, lang), "s"));
    let listed = |list: &[String]| if list.is_empty() { none() } else { list.join("; ") };
    let rows = [
        line("laboratories.procedure", &|s| s.procedure.clone().unwrap_or_else(none)),
        line("laboratories.length", &|s| duration(s.usable_s, lang)),
        line("laboratories.interval", &seconds),
        line("laboratories.temperature", &degrees),
        line("laboratories.instruments", &|s| listed(&s.instruments)),
    ];
    let column =
        |of: fn(&(String, String, String)) -> &String| rows.iter().map(of).cloned().collect::<Vec<_>>();
    Table::new("cards", rows.len())
        .column(Column::text("what", ""), column(|r| &r.0))
        .column(Column::text("first", a.name.clone()), column(|r| &r.1))
        .column(Column::text("second", b.name.clone()), column(|r| &r.2))
}

/// Why rows differ, a sentence a reason.
fn why(labs: &Laboratories, words: Translator) -> Vec<String> {
    let [first, second] = &labs.sides;
    let of_row = |row: &PairedRow| {
        let name = words.name("measurand", &row.first.id);
        let of = |reason: &Reason| {
            let told = words.say(&reason.why.0);
            let kind = short(reason, words);
            words.with("laboratories.reason", &[("quantity", &name), ("kind", &kind), ("why", &told)])
        };
        row.reasons.iter().map(of).collect::<Vec<_>>()
    };
    let keys = (!labs.differing_keys.is_empty()).then(|| {
        let keys: Vec<String> = labs.differing_keys.iter().map(|k| format!("`{k}`")).collect();
        let args = [("first", first.name.as_str()), ("second", &second.name), ("keys", &keys.join(", "))];
        words.with("laboratories.keys", &args)
    });
    labs.rows.iter().flat_map(of_row).chain(keys).collect()
}

/// Title of what is below.
pub(super) fn title(labs: &Laboratories, words: Translator) -> String {
    words.with("laboratories.title", &[("serial", &labs.serial)])
}

/// Everything on pages.
pub(super) fn blocks(labs: &Laboratories, words: Translator) -> Vec<Block> {
    let say = |notes: &[Note]| Block::remarks(notes.iter().map(|n| words.say(n)));
    let mut below = vec![Block::Hint(words.t("laboratories.hint"))];
    below.extend(say(&labs.summary));
    below.push(Block::Table(sides(labs, words)));
    if !labs.rows.is_empty() {
        below.push(Block::Table(table(labs, words).only(&SHOWN)));
    }
    let mut all = vec![Block::section("", words.t("laboratories.rows"), below)];
    let why = Block::remarks(why(labs, words));
    all.extend(why.map(|list| Block::section("", words.t("laboratories.reasons"), vec![list])));
    let missing = say(&labs.missing);
    all.extend(missing.map(|list| Block::section("", words.t("laboratories.missing"), vec![list])));
    all
}

/// The table, and what is said of it.
pub(super) fn on_terminal(labs: &Laboratories, words: Translator) -> Vec<Block> {
    let said = labs.summary.iter().map(|n| words.say(n));
    let said = said.chain(why(labs, words)).chain(labs.missing.iter().map(|n| words.say(n)));
    let table = (!labs.rows.is_empty()).then(|| Block::Table(table(labs, words).only(&SHOWN)));
    std::iter::once(Block::heading(title(labs, words))).chain(table).chain(Block::remarks(said)).collect()
}
