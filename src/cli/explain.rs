//! `sagnac explain`: where, and because of what, a recording differs from its simulation.

use super::inputs::{self, Inputs};
use super::progress::Progress;
use super::{ExplainArgs, exit, place, run};
use crate::config::model::{self, Claim};
use crate::effect::{Column, EFFECTS, find};
use crate::i18n::{EffectText, Lang, Localize, Note, effect_text};
use crate::ingest::{ReadOptions, files_read};
use crate::mismatch::{self, Options, Outcome};
use crate::output::{Kind, StagedFolder};
use crate::report::explain::{Context, ExplainView};
use crate::report::{Renderer, svg};
use crate::series::{Series, SeriesOptions, load_series};
use chrono::{SecondsFormat, Utc};
use sagnac_core::spelling::nearest;
use std::fmt::Write;
use std::path::{Path, PathBuf};

pub fn main(args: &ExplainArgs, lang: Lang) -> u8 {
    match attempt(args, lang) {
        Ok(code) => code,
        Err(message) => {
            place::complain(&message);
            exit::ERROR
        }
    }
}

fn attempt(args: &ExplainArgs, lang: Lang) -> Result<u8, String> {
    let say = |note: Note| place::error(&note, lang);
    let options = options(args).map_err(say)?;
    let renderer = run::renderer(args.templates.as_deref(), lang)?;
    // What is wrong with the model is said before a long recording is read.
    let stated = args.model.as_deref().map(model::load).transpose().map_err(|p| p.say(lang))?;
    let now = Utc::now();
    let name = args.recording.first().map(|p| stem(p));
    let out = args.out.clone().unwrap_or_else(|| place::default_folder("explain", name.as_deref(), now));
    let simulation: Vec<PathBuf> = args.simulation.clone().into_iter().collect();
    let folder = Inputs::new(args.force)
        .recording(&args.recording, &args.read.options())
        .file("model", args.model.as_deref())
        .files("simulation", &files_read(&simulation, &ReadOptions::default()))
        .options(&(
            (&args.rate, &args.unit, args.sample_rate, &args.read),
            (&args.hide, &args.without, args.alpha, args.max_effects),
        ))
        .beside(args.templates.as_deref())
        .begin(&out, Kind::Explanation, lang)?;

    let mut progress = Watch::new(lang);
    let recording = read(args, &args.recording, &mut progress, lang)?;
    let mut notes = recording.remarks();
    let (claim, outcome, named, identified) = match (stated, args.simulation.as_deref()) {
        (Some(claim), _) => {
            let path = args.model.as_deref().map(shown).unwrap_or_default();
            let outcome = mismatch::explain(recording, &claim, &options, &mut |p| progress.of(p));
            (claim, outcome.map_err(say)?, path, false)
        }
        (None, Some(simulation)) => {
            let series = read(args, &[simulation.to_owned()], &mut progress, lang)?;
            let taken = mismatch::explain_simulation(&recording, series, &options, &mut |p| progress.of(p));
            let taken = taken.map_err(say)?;
            if taken.same {
                notes.push("explain.note.same_samples".into());
            }
            if !taken.shared.is_empty() {
                let title = |kind| effect_text(kind, EffectText::Title, lang);
                let titles: Vec<&str> = taken.shared.iter().map(|e| title(e.kind())).collect();
                notes.push(Note::new("explain.note.shared").with("effects", titles.join(", ")));
            }
            (taken.claim, taken.outcome, shown(simulation), true)
        }
        (None, None) => return Err(say("explain.error.both".into())),
    };
    progress.finish();

    let context = Context {
        recording: args.recording.iter().map(|p| shown(p)).collect::<Vec<_>>().join(", "),
        claim: named,
        identified,
        description: claim.description.clone(),
        explained_at: now.to_rfc3339_opts(SecondsFormat::Secs, true),
        correction: outcome.correction.is_some(),
        notes,
    };
    let view = ExplainView::new(&outcome.explanation, &outcome.figures, &context, lang);
    write(&outcome, &view, &folder, "", &renderer, lang)?;
    let folder = inputs::publish(folder, &outcome.explanation, lang)?;
    place::print(&format!("{}{}\n", view.summary(), place::shown(&folder.join("report.html"))));
    Ok(match outcome.explanation.verdict.as_str() {
        "consistent" => exit::PASS,
        "mismatch" => exit::FAIL,
        _ => exit::INDETERMINATE,
    })
}

fn shown(path: &Path) -> String {
    path.display().to_string()
}

/// The name of a file without its endings.
fn stem(path: &Path) -> String {
    let name = path.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
    name.split('.').find(|part| !part.is_empty()).unwrap_or_default().to_owned()
}

/// The decisions of the user.
fn options(args: &ExplainArgs) -> Result<Options, Note> {
    let default = Options::default();
    let alpha = args.alpha.unwrap_or(default.alpha);
    if !(alpha > 0.0 && alpha < 1.0) {
        return Err(Note::new("explain.error.alpha").with("given", alpha.to_string()));
    }
    let max_effects = args.max_effects.unwrap_or(default.max_effects);
    if max_effects == 0 {
        return Err("explain.error.max_effects".into());
    }
    let mut hide = vec![];
    for name in &args.hide {
        let Some(column) = Column::ALL.into_iter().find(|c| c.name() == name) else {
            let known = Column::ALL.map(Column::name).join(", ");
            let note = Note::new("explain.error.column").with("given", name.as_str());
            return Err(note.with("known", known));
        };
        hide.push(column);
    }
    let mut without = vec![];
    for name in &args.without {
        let Some(effect) = find(name) else {
            let note = Note::new("explain.error.effect").with("given", name.as_str());
            return Err(match nearest(name, EFFECTS.iter().map(|e| e.kind())) {
                Some(near) => {
                    Note::new("explain.error.effect_near").with("given", name.as_str()).with("near", near)
                }
                None => note,
            });
        };
        without.push(effect.kind());
    }
    Ok(Options { alpha, hide, max_effects, without })
}

fn read(args: &ExplainArgs, paths: &[PathBuf], progress: &mut Watch, lang: Lang) -> Result<Series, String> {
    let options = SeriesOptions {
        read: args.read.options(),
        rate: args.rate.clone(),
        unit: args.unit.clone(),
        any_rate: false,
        channels: vec![],
        sample_rate_hz: args.sample_rate,
    };
    let series = load_series(paths, &options, &mut |done, total| {
        progress.of(mismatch::Progress { doing: "explain.progress.reading", done, total });
    });
    series.map_err(|e| {
        progress.finish();
        e.say(lang)
    })
}

/// Writes everything of an explanation but its record into a folder, each name with `before` in front.
pub(super) fn write(
    outcome: &Outcome,
    view: &ExplainView,
    folder: &StagedFolder,
    before: &str,
    renderer: &Renderer,
    lang: Lang,
) -> Result<(), String> {
    let say = |note: Note| place::error(&note, lang);
    let html = renderer.render_view("explain.html", view, lang).map_err(|e| say(e.note()))?;
    let markdown = renderer.render_view("explain.md", view, lang).map_err(|e| say(e.note()))?;
    let write =
        |name: &str, bytes: &[u8]| folder.write(&format!("{before}{name}"), bytes).map_err(|e| say(e.note()));
    if let Some(correction) = &outcome.correction {
        write("correction.csv", csv(correction).as_bytes())?;
    }
    write("augmented.toml", augmented(&outcome.augmented).as_bytes())?;
    write("report.html", html.as_bytes())?;
    write("report.md", markdown.as_bytes())?;
    for figure in &outcome.figures {
        write(&format!("figures/{}.svg", figure.id), svg::render(figure, lang).as_bytes())?;
    }
    Ok(())
}

fn augmented(claim: &Claim) -> String {
    model::write(claim)
}

/// `correction.csv`: the shortest digits from which time and correction come back to the bit.
fn csv(correction: &[(f64, f64)]) -> String {
    let mut out = String::with_capacity(24 + 32 * correction.len());
    out.push_str("time_s,correction_deg_h\n");
    for (time, value) in correction {
        let _ = writeln!(out, "{time},{value:e}");
    }
    out
}

/// Progress of several pieces of work, one after the other.
pub(super) struct Watch {
    bar: Progress,
    doing: &'static str,
    said: String,
    lang: Lang,
}

impl Watch {
    pub(super) fn new(lang: Lang) -> Watch {
        Watch { bar: Progress::of_steps(), doing: "", said: String::new(), lang }
    }

    pub(super) fn of(&mut self, p: mismatch::Progress) {
        if p.doing != self.doing {
            self.doing = p.doing;
            self.said = Note::new(p.doing).say(self.lang);
            self.bar.name(&self.said);
        }
        self.bar.update(&self.said, p.done, p.total);
    }

    pub(super) fn finish(&self) {
        self.bar.finish();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_correction_comes_back_to_the_bit() {
        let given = [(0.1 + 0.2, -1.0 / 3.0), (1e6 + 0.1, 2.5e-9), (3.0, 0.0)];
        let text = csv(&given);
        let read: Vec<(f64, f64)> = text
            .lines()
            .skip(1)
            .map(|l| l.split_once(',').unwrap())
            .map(|(a, b)| (a.parse().unwrap(), b.parse().unwrap()))
            .collect();
        assert_eq!(read, given);
        assert_eq!(text.lines().next(), Some("time_s,correction_deg_h"));
    }

    #[test]
    fn a_folder_is_named_after_the_recording() {
        assert_eq!(stem(Path::new("a/unit-7.csv.gz")), "unit-7");
        assert_eq!(stem(Path::new(".hidden")), "hidden");
    }
}
