//! The help and the complaints of the command line in the language of the user.
//!
//! The English texts stand in the derived command and nowhere else. Another language translates each in its table `help_text`, whose keys
//! are the English texts: one that changes has no translation until it is translated anew, and a test says so.

use super::length::LengthError;
use crate::i18n::{Lang, Localize, Note, lookup, note};
use anstream::adapter::strip_str;
use clap::builder::Str;
use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{Arg, ArgAction, Command, Error};
use std::ffi::OsString;

/// Headings of the list of verbs: the first verb below a heading, and the heading. Verbs stand in the order of their declaration.
const VERB_HEADINGS: &[(&str, &str)] = &[
    ("inspect", "Look"),
    ("init", "Test"),
    ("explain", "Understand"),
    ("datasheet", "Lots"),
    ("sign", "Sign"),
    ("demo", "Program"),
];

/// The language that the arguments ask for, or else the locale. It is needed before the arguments are parsed, for the
/// help and for the complaints about them.
pub fn language(arguments: &[OsString]) -> Lang {
    let mut asked = None;
    let mut rest = arguments.iter().filter_map(|a| a.to_str());
    while let Some(argument) = rest.next() {
        match argument.strip_prefix("--lang") {
            _ if argument == "--" => break,
            Some("") => asked = rest.next().and_then(Lang::from_code).or(asked),
            Some(value) => asked = value.strip_prefix('=').and_then(Lang::from_code).or(asked),
            None => {}
        }
    }
    asked.unwrap_or_else(|| Lang::of_locale(|name| std::env::var(name).ok()))
}

/// The command with its texts in a language, its verbs below headings.
pub fn command(command: Command, lang: Lang) -> Command {
    let command = if lang == Lang::En { command } else { translated(command, "sagnac", lang) };
    let style = *command.get_styles().get_header();
    let heading = |text: &str| format!("{style}{}:{style:#}", translation(text, lang));
    let template = format!(
        "{{before-help}}{{about-with-newline}}\n{} {{usage}}\n\n{}\n{}\n{{options}}{{after-help}}",
        heading("Usage"),
        verbs_below_headings(&command, &heading),
        heading("Options"),
    );
    command.help_template(template)
}

/// The list of verbs, a heading above the first of each group.
fn verbs_below_headings(command: &Command, heading: &dyn Fn(&str) -> String) -> String {
    let list = command.clone().help_template("{subcommands}").render_help().ansi().to_string();
    let mut out = String::new();
    for line in list.lines() {
        // A line that goes on with the text of a verb is indented further.
        let plain = strip_str(line).to_string();
        let verb = plain.strip_prefix("  ").and_then(|rest| rest.split(' ').next());
        if let Some((_, text)) = VERB_HEADINGS.iter().find(|(first, _)| verb == Some(first)) {
            let before = if out.is_empty() { "" } else { "\n" };
            out.push_str(&format!("{before}{}\n", heading(text)));
        }
        out.push_str(&format!("{line}\n"));
    }
    out
}

/// The translation of an English text; `None` where the language has none, so that the English text stays.
fn entry(english: &str, lang: Lang) -> Option<&'static str> {
    lookup(lang, &format!("help_text.{english}"))
}

/// An English text in a language.
fn translation(english: &str, lang: Lang) -> String {
    entry(english, lang).unwrap_or(english).to_owned()
}

/// The lines of a text in a language; a command that a line shows has no translation.
fn lines_translated(english: &str, lang: Lang) -> String {
    let line = |line: &str| {
        let text = line.trim_start();
        line.replace(text, &translation(text, lang))
    };
    english.lines().map(line).collect::<Vec<_>>().join("\n")
}

/// A command, called by its name behind those above it, and all below it.
fn translated(command: Command, called: &str, lang: Lang) -> Command {
    let own = |english: &'static str| entry(english, lang).unwrap_or(english);
    let mut command = command
        .help_template(format!(
            "{{before-help}}{{about-with-newline}}\n{}: {{usage}}\n\n{{all-args}}{{after-help}}",
            own("Usage")
        ))
        .subcommand_help_heading(own("Commands"))
        .disable_help_flag(true)
        .disable_help_subcommand(true)
        .mut_args(|arg| argument(arg, lang));
    if let Some(about) = command.get_about().map(ToString::to_string) {
        command = command.about(translation(&about, lang));
    }
    if let Some(after) = command.get_after_help().map(ToString::to_string) {
        command = command.after_help(lines_translated(&after, lang));
    }
    // What the library would add by itself is English.
    let flag = |name: &'static str, short, action, text| {
        let arg = Arg::new(name).short(short).long(name).action(action);
        arg.help(own(text)).help_heading(own("Options"))
    };
    command = command.arg(flag("help", 'h', ArgAction::Help, "Print help"));
    if called == "sagnac" {
        let version = flag("version", 'V', ArgAction::Version, "Print version");
        command = command.disable_version_flag(true).arg(version);
    }
    let usage = usage(&command, called, lang);
    command.override_usage(usage).mut_subcommands(|below| {
        let called = format!("{called} {}", below.get_name());
        translated(below, &called, lang)
    })
}

/// The line that shows how the command is written.
fn usage(command: &Command, called: &str, lang: Lang) -> String {
    let mut out = format!("{called} [{}]", translation("OPTIONS", lang));
    for arg in command.get_positionals() {
        out.push_str(&format!(" {arg}"));
    }
    if command.has_subcommands() {
        out.push_str(&format!(" <{}>", translation("COMMAND", lang)));
    }
    out
}

fn argument(arg: Arg, lang: Lang) -> Arg {
    let default_heading = if arg.is_positional() { "Arguments" } else { "Options" };
    let own_heading = arg.get_help_heading().filter(|_| !arg.is_positional());
    let heading = entry(own_heading.unwrap_or(default_heading), lang).unwrap_or(default_heading);
    let mut help = arg.get_help().map(|text| translation(&text.to_string(), lang)).unwrap_or_default();
    if !arg.get_action().takes_values() {
        return arg.help_heading(heading).help(help);
    }
    let name = |english: &Str| entry(english, lang).map_or_else(|| english.clone(), Str::from);
    let names: Vec<Str> = arg.get_value_names().unwrap_or_default().iter().map(name).collect();
    let values = arg.get_possible_values();
    let values = values.iter().map(|value| match value.get_help() {
        Some(meaning) => format!("{} ({})", value.get_name(), translation(&meaning.to_string(), lang)),
        None => value.get_name().to_owned(),
    });
    let defaults = arg.get_default_values().iter().map(|value| value.to_string_lossy().into_owned());
    let lists: [(&str, Vec<String>); 2] =
        [("possible values", values.collect()), ("default", defaults.collect())];
    for (title, list) in lists.iter().filter(|(_, list)| !list.is_empty()) {
        help.push_str(&format!(" [{}: {}]", translation(title, lang), list.join(", ")));
    }
    arg.help_heading(heading)
        .help(help)
        .value_names(names)
        .hide_possible_values(true)
        .hide_default_value(true)
}

/// Says why the arguments cannot be used, or shows the help that was asked for; gives the exit code.
pub fn refuse(error: &Error, lang: Lang) -> u8 {
    let asked_for = !error.use_stderr();
    if asked_for || error.kind() == ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand {
        super::stdout::check(error.print());
    } else if lang == Lang::En {
        // What was typed stands in it, so that it goes the way of all text from outside.
        super::place::eprint_diagnostic(&error.to_string());
    } else {
        super::place::eprint_diagnostic(&complaint(error, lang));
    }
    super::place::settled(if asked_for { super::exit::PASS } else { super::exit::ERROR }, lang)
}

/// The complaint in a language, for the kinds that the tables know; in the words of the library for others.
fn complaint(error: &Error, lang: Lang) -> String {
    let part = |kind: ContextKind| match error.get(kind) {
        Some(ContextValue::String(text)) => text.clone(),
        Some(ContextValue::Strings(texts)) => texts.join(", "),
        _ => String::new(),
    };
    let key = match error.kind() {
        ErrorKind::UnknownArgument => "help.error.unknown_argument",
        ErrorKind::InvalidSubcommand => "help.error.unknown_verb",
        ErrorKind::MissingRequiredArgument => "help.error.missing",
        ErrorKind::MissingSubcommand => "help.error.no_verb",
        ErrorKind::InvalidValue if part(ContextKind::InvalidValue).is_empty() => "help.error.no_value",
        ErrorKind::InvalidValue | ErrorKind::ValueValidation => "help.error.invalid_value",
        ErrorKind::ArgumentConflict => "help.error.twice",
        ErrorKind::TooManyValues | ErrorKind::WrongNumberOfValues | ErrorKind::TooFewValues => {
            "help.error.number_of_values"
        }
        ErrorKind::InvalidUtf8 => "help.error.not_utf8",
        _ => return error.to_string(),
    };
    let subcommand = part(ContextKind::InvalidSubcommand);
    let given = part(ContextKind::InvalidArg);
    let note = Note::new(key)
        .with("argument", if given.is_empty() { subcommand } else { given })
        .with("value", part(ContextKind::InvalidValue));
    let mut out = super::place::error(&note, lang);
    if let Some(reason) = std::error::Error::source(error).and_then(|e| e.downcast_ref::<LengthError>()) {
        out = format!("{}: {}\n", out.trim_end(), reason.say(lang));
    }
    let near = [ContextKind::SuggestedArg, ContextKind::SuggestedSubcommand, ContextKind::SuggestedValue];
    if let Some(near) = near.into_iter().map(part).find(|text| !text.is_empty()) {
        let hint = note!("keyed.help.did_you_mean", name = near);
        out.push_str(&format!("  {}: {}\n", note!("diagnostic.help").say(lang), hint.say(lang)));
    }
    let valid = part(ContextKind::ValidValue);
    if !valid.is_empty() {
        out.push_str(&format!("  {}\n", note!("help.error.values", values = valid).say(lang)));
    }
    out.push_str(&format!("\n{}\n", note!("help.error.more").say(lang)));
    out
}

#[cfg(test)]
#[path = "help_tests.rs"]
mod tests;
