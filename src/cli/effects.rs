//! `sagnac effects`: the catalogue, and the page of one effect.

use super::{exit, place};
use crate::effect::{EFFECTS, Effect, Param, find};
use crate::i18n::{Arg, EffectText, Lang, Localize, Note, decimal, effect_text, note};
use crate::report::unit::pretty;
use clap::{Args, ValueEnum};
use sagnac_core::spelling::nearest;
use serde_json::{Value, json};

/// Width of the text of a page, characters.
const PAGE_WIDTH: usize = 76;

#[derive(Debug, Args)]
pub struct EffectsArgs {
    /// Effect to describe [default: list all]
    #[arg(value_name = "NAME")]
    effect: Option<String>,
    /// Form of the answer
    #[arg(long, value_name = "FORM", default_value = "text")]
    format: EffectsFormat,
}

/// Form of the catalogue.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum EffectsFormat {
    /// Text
    Text,
    /// Everything
    Json,
}

pub fn main(args: &EffectsArgs, lang: Lang) -> Result<u8, String> {
    let json = args.format == EffectsFormat::Json;
    let text = match &args.effect {
        None if json => {
            format!("{:#}\n", Value::Array(EFFECTS.iter().map(|e| value(*e, lang)).collect()))
        }
        None => list(lang),
        Some(name) => match find(name) {
            Some(effect) if json => format!("{:#}\n", value(effect, lang)),
            Some(effect) => page(effect, lang),
            None => return Err(unknown(name, lang)),
        },
    };
    place::print(&text);
    Ok(exit::PASS)
}

fn unknown(name: &str, lang: Lang) -> String {
    let shown: String = name.chars().take(60).collect();
    let help = match nearest(name, EFFECTS.iter().map(|e| e.kind())) {
        Some(near) => note!("keyed.help.did_you_mean", name = near),
        None => note!("model_file.help.kinds"),
    };
    let said = place::error(&note!("model_file.no_kind", kind = shown), lang);
    format!("{said}  {}: {}\n", note!("diagnostic.help").say(lang), help.say(lang))
}

fn view(effect: &dyn Effect, lang: Lang) -> String {
    Arg::key("effect_view", effect.domain().id()).say(lang)
}

/// Columns that an effect needs.
fn needs(effect: &dyn Effect) -> String {
    effect.needs().iter().map(|c| c.name()).collect::<Vec<_>>().join(", ")
}

/// One line an effect, in columns.
fn list(lang: Lang) -> String {
    let head = |key: &'static str| Note::new(key).say(lang);
    let mut rows =
        vec![[head("effects.kind"), head("effects.title"), head("effects.shows_in"), head("effects.needs")]];
    for effect in EFFECTS {
        rows.push([
            effect.kind().to_owned(),
            effect_text(effect.kind(), EffectText::Title, lang).to_owned(),
            view(*effect, lang),
            needs(*effect),
        ]);
    }
    let widths: Vec<usize> =
        (0..3).map(|c| rows.iter().map(|r| r[c].chars().count()).max().unwrap_or(0)).collect();
    let mut out = String::new();
    for row in rows {
        let mut line = String::new();
        for (cell, width) in row.iter().zip(&widths) {
            line.push_str(cell);
            line.extend(std::iter::repeat_n(' ', width + 2 - cell.chars().count()));
        }
        line.push_str(&row[3]);
        out.push_str(line.trim_end());
        out.push('\n');
    }
    out.push_str(&format!("\n{}\n", note!("effects.more").say(lang)));
    out
}

/// Everything that is known of an effect.
fn page(effect: &dyn Effect, lang: Lang) -> String {
    let text = |part| effect_text(effect.kind(), part, lang);
    let mut out = format!("{} ({})\n", text(EffectText::Title), effect.kind());
    let mut part = |key: &'static str, text: &str| {
        if !text.is_empty() {
            out.push_str(&format!("\n{}\n{}", Note::new(key).say(lang), wrapped(text)));
        }
    };
    part("effects.mechanism", text(EffectText::Mechanism));
    part("effects.formula", text(EffectText::Formula));
    let numbers = effect.params().iter().map(|p| parameter(p, None, lang));
    let lists = effect.list_params().iter().map(|p| parameter(p, Some("effects.list"), lang));
    let parameters: Vec<String> = numbers.chain(lists).collect();
    part("effects.parameters", &parameters.join("\n"));
    part("effects.shows_in", &view(effect, lang));
    part("effects.needs", &needs(effect));
    part("effects.signature", text(EffectText::Signature));
    part("effects.confusers", &confusers(effect, lang).join("\n"));
    part("effects.told_by", text(EffectText::Distinguishing));
    part("effects.confirm", text(EffectText::Confirm));
    part("effects.source", text(EffectText::Source));
    out
}

fn confusers(effect: &dyn Effect, lang: Lang) -> Vec<String> {
    let named = |other: &&dyn Effect| {
        format!("{}: {}", other.kind(), effect_text(other.kind(), EffectText::Title, lang))
    };
    effect.confusers().iter().map(named).collect()
}

/// A parameter with its unit and bounds; a list is said to be one.
fn parameter(p: &Param, what: Option<&'static str>, lang: Lang) -> String {
    let unit = pretty(p.unit, lang);
    let number = |v: f64| {
        let plain =
            if v != 0.0 && !(1e-3..1e5).contains(&v.abs()) { format!("{v:e}") } else { v.to_string() };
        decimal(&plain, lang)
    };
    let bounds = match (bounded(p.lower), bounded(p.upper)) {
        (Some(low), Some(high)) => {
            note!("effects.between", low = number(low), high = number(high))
        }
        (Some(low), None) => note!("effects.at_least", low = number(low)),
        (None, Some(high)) => note!("effects.at_most", high = number(high)),
        (None, None) => note!("effects.any"),
    };
    let name = if unit.is_empty() { p.name.to_owned() } else { format!("{}, {unit}", p.name) };
    let what = what.or((!p.reported).then_some("effects.inner"));
    let inner = what.map_or_else(String::new, |key| format!(" ({})", Note::new(key).say(lang)));
    format!("{name}: {}{inner}", bounds.say(lang))
}

fn bounded(value: f64) -> Option<f64> {
    (value.abs() < 1e300).then_some(value)
}

/// Lines of at most [`PAGE_WIDTH`] characters, set in.
fn wrapped(text: &str) -> String {
    let mut out = String::new();
    for paragraph in text.lines() {
        let mut line = String::new();
        for word in paragraph.split_whitespace() {
            if !line.is_empty() && line.chars().count() + 1 + word.chars().count() > PAGE_WIDTH {
                out.push_str(&format!("  {line}\n"));
                line.clear();
            }
            if !line.is_empty() {
                line.push(' ');
            }
            line.push_str(word);
        }
        out.push_str(&format!("  {line}\n"));
    }
    out
}

/// An effect for programs; words in a language.
fn value(effect: &dyn Effect, lang: Lang) -> Value {
    let text = |part| effect_text(effect.kind(), part, lang);
    let params = |list: &'static [Param]| -> Vec<Value> {
        list.iter()
            .map(|p| {
                json!({
                    "name": p.name,
                    "unit": p.unit,
                    "lower": bounded(p.lower),
                    "upper": bounded(p.upper),
                    "reported": p.reported,
                })
            })
            .collect()
    };
    json!({
        "kind": effect.kind(),
        "title": text(EffectText::Title),
        "domain": effect.domain().id(),
        "needs": effect.needs().iter().map(|c| c.name()).collect::<Vec<_>>(),
        "mechanism": text(EffectText::Mechanism),
        "formula": text(EffectText::Formula),
        "parameters": params(effect.params()),
        "lists": params(effect.list_params()),
        "signature": text(EffectText::Signature),
        "confusers": effect.confusers().iter().map(|e| e.kind()).collect::<Vec<_>>(),
        "told_by": text(EffectText::Distinguishing),
        "confirm": text(EffectText::Confirm),
        "source": text(EffectText::Source),
    })
}
