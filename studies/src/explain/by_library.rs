//! A case explained by the library, which leaves the files that the program leaves.

use sagnac::config;
use sagnac::effect::find;
use sagnac::i18n::{Lang, Localize};
use sagnac::mismatch::finding::MismatchVerdict;
use sagnac::mismatch::{Options, explain};
use sagnac::series::{SeriesOptions, load_series};
use std::fmt::Write;
use std::path::Path;

/// Explains a recording by a model without some effects of the catalogue; the exit code that the program would give, or
/// `None` where it would fail.
pub(super) fn by_the_library(recording: &Path, model: &Path, out: &Path, without: &[&str]) -> Option<i32> {
    match explained(recording, model, out, without) {
        Ok(verdict) => Some(match verdict {
            MismatchVerdict::Consistent => 0,
            MismatchVerdict::Mismatch => 1,
            MismatchVerdict::UnknownMismatch => 3,
        }),
        Err(error) => {
            eprintln!("{}: {error}", recording.display());
            None
        }
    }
}

fn explained(
    recording: &Path,
    model: &Path,
    out: &Path,
    without: &[&str],
) -> Result<MismatchVerdict, String> {
    let series = load_series(&[recording.to_owned()], &SeriesOptions::default(), &mut |_, _| {});
    let series = series.map_err(|e| e.say(Lang::En))?;
    let claim = config::model::load(model).map_err(|p| p.say(Lang::En))?;
    let without = without.iter().filter_map(|kind| find(kind)).map(|e| e.kind()).collect();
    let options = Options { without, ..Options::default() };
    let outcome = explain(series, &claim, &options, &mut |_| {}).map_err(|note| note.say(Lang::En))?;
    std::fs::create_dir_all(out).map_err(|e| e.to_string())?;
    let write = |name: &str, text: String| std::fs::write(out.join(name), text).map_err(|e| e.to_string());
    write("explain.json", serde_json::to_string(&outcome.explanation).map_err(|e| e.to_string())?)?;
    write("augmented.toml", config::model::write(&outcome.augmented))?;
    if let Some(correction) = &outcome.correction {
        let mut text = String::from("time_s,correction_deg_h\n");
        for (time_s, deg_h) in correction {
            let _ = writeln!(text, "{time_s},{deg_h}");
        }
        write("correction.csv", text)?;
    }
    Ok(outcome.explanation.verdict)
}
