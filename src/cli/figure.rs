//! `sagnac figure`: a figure of results for a paper.

use super::{exit, place, stdout};
use crate::figure::Figure;
use crate::i18n::{Lang, Localize, Note, note};
use crate::output::StagedFile;
use crate::report::StoredResults;
use crate::report::paper::{self, FORMATS, Format, LAYERS, LayerKind, Source};
use crate::report::svg::{self, Canvas};
use crate::units::Unit;
use clap::builder::PossibleValuesParser;
use clap::{Args, ValueEnum};
use std::ffi::OsStr;
use std::path::{Path, PathBuf};

/// Figures that reports draw: one more is one more line here, named as its title is in the texts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum FigureName {
    SigmaTau,
    Spectrum,
    AllanFamily,
    TimeSeries,
    Histogram,
    Autocorrelation,
    Residual,
    OverTemperature,
    TemperatureSchedule,
    TemperatureResidual,
    TemperatureSensitivity,
    WarmUp,
    ScaleFactorResidual,
    ScaleOverTemperature,
    TableSteps,
    TablePolar,
    DeadZone,
    Positions,
    Gravity,
    Bode,
    BiasOfRuns,
    Influence,
    Against,
    Time,
    Level,
    Ratios,
    Octaves,
    Units,
    Prove,
}

impl FigureName {
    /// As it is written on the command line.
    fn id(self) -> String {
        self.to_possible_value().map(|v| v.get_name().to_owned()).unwrap_or_default()
    }

    fn is_of(self, figure: &Figure) -> bool {
        self.id().replace('-', "_") == paper::name(figure)
    }
}

#[derive(Debug, Args)]
pub struct FigureArgs {
    /// Results, record files such as result.json or the folders that hold one; the last word is the figure, such as sigma-tau
    #[arg(value_names = ["RESULT", "FIGURE"], required = true, num_args = 1..)]
    given: Vec<PathBuf>,
    /// File to write [default: standard output]
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Format [default: that of the ending of the file, else svg]
    #[arg(long, value_name = "FORM", value_parser = PossibleValuesParser::new(FORMATS.iter().map(|f| f.0)))]
    format: Option<String>,
    /// Width with its unit, mm, cm or in; words keep their size
    #[arg(long, value_name = "WIDTH", default_value = "85mm")]
    width: String,
    /// Unit of the ordinate; sigma-tau in deg/sqrt(h) is σ(τ)·√τ [default: that of the report]
    #[arg(long, value_name = "UNIT")]
    unit: Option<String>,
    /// Channels, separated by commas [default: all]
    #[arg(long, value_name = "CHANNELS", value_delimiter = ',')]
    channels: Vec<String>,
    /// Layers to draw, separated by commas [default: data, intervals, model of a single record, limits]
    #[arg(long, value_name = "LAYERS", value_delimiter = ',', value_parser = PossibleValuesParser::new(LAYERS.iter().map(|l| l.0)))]
    layers: Vec<String>,
    /// Entry in the legend, for each record or channel in its order; several by repeating the option
    #[arg(long, value_name = "TEXT")]
    label: Vec<String>,
    /// Replace an existing file with different content
    #[arg(long)]
    force: bool,
    /// Print only errors and the path of the file
    #[arg(long, short)]
    quiet: bool,
}

/// Widths of paper that a figure may have, mm: of a narrow column, and of a poster.
const MIN_WIDTH_MM: f64 = 40.0;
const MAX_WIDTH_MM: f64 = 1000.0;

pub fn main(args: &FigureArgs, lang: Lang) -> Result<u8, String> {
    let say = |note: Note| place::error(&note, lang);
    let width_mm = millimetres(&args.width).map_err(say)?;
    let unit = args.unit.as_deref().map(Unit::parse).transpose();
    let unit = unit.map_err(|e| say(note!("cli.of_option", option = "--unit", what = e.note())))?;
    let format = args.format();
    let (figure_name, results) = args.asked().map_err(say)?;
    let record = |path: &PathBuf| if path.is_dir() { path.join("result.json") } else { path.clone() };
    let read: Vec<PathBuf> = results.iter().map(record).collect();
    let begin = |out: &Path| StagedFile::begin(out, &read, args.force).map_err(|e| say(e.note()));
    let staged = args.out.as_deref().map(begin).transpose()?;

    let mut sources = vec![];
    for path in results {
        sources.extend(args.sources_of(path, figure_name, lang).map_err(say)?);
    }
    args.label_all(&mut sources).map_err(say)?;
    let figure = args.figure_of(sources, unit.as_ref()).map_err(say)?;
    let drawing = svg::draw(&figure, Canvas::Paper { width_mm }, lang);
    let caption = paper::caption(&figure, lang);
    let bytes = format.written(&drawing, &caption).map_err(|e| say(e.note()))?;
    let Some(staged) = staged else {
        stdout::write(&bytes);
        return Ok(exit::PASS);
    };
    let path = staged.publish_with(&bytes).map_err(|e| say(e.note()))?;
    place::print(&format!("{}\n", place::shown(&path)));
    if !args.quiet {
        // The words below a figure are set by the paper.
        place::print(&format!("{caption}\n"));
    }
    Ok(exit::PASS)
}

impl FigureArgs {
    /// The figure and the results. Options may stand between them, so that the last word alone tells the figure.
    fn asked(&self) -> Result<(FigureName, &[PathBuf]), Note> {
        let all: Vec<String> = FigureName::value_variants().iter().map(|f| f.id()).collect();
        let refused = |key: &'static str, given: String| {
            Note::new(key).with("given", given).with("known", all.join(", "))
        };
        let Some((last, results)) = self.given.split_last() else {
            return Err(refused("figure_paper.no_figure", String::new()));
        };
        let named = FigureName::from_str(&last.to_string_lossy(), false);
        let figure = named.map_err(|_| refused("figure_paper.no_figure", place::shown(last)))?;
        if results.is_empty() {
            return Err(refused("figure_paper.no_result", figure.id()));
        }
        Ok((figure, results))
    }

    /// The format that is named, or that of the ending of the file.
    fn format(&self) -> Format {
        let ending = || self.out.as_ref()?.extension().and_then(OsStr::to_str).map(str::to_lowercase);
        let named = self.format.clone().or_else(ending);
        named.as_deref().and_then(Format::named).unwrap_or(Format::Svg)
    }

    /// The figures of this name that a record holds, each with an entry for a legend.
    fn sources_of(&self, path: &Path, name: FigureName, lang: Lang) -> Result<Vec<Source>, Note> {
        let stored = StoredResults::open(path)?;
        let all = paper::figures(&stored.results, lang);
        let mut known: Vec<String> = all.iter().map(|f| paper::name(f).replace('_', "-")).collect();
        known.sort_unstable();
        known.dedup();
        let of_name: Vec<Figure> = all.into_iter().filter(|f| name.is_of(f)).collect();
        let shown = place::shown(path);
        if of_name.is_empty() {
            let missing = stored.missing.first().map(|n| n.say(lang)).unwrap_or_default();
            let key = if missing.is_empty() { "figure_paper.none" } else { "figure_paper.not_kept" };
            let note = Note::new(key).with("path", shown).with("figure", name.id());
            return Err(if missing.is_empty() {
                note.with("known", known.join(", "))
            } else {
                note.with("why", missing)
            });
        }
        let channels: Vec<String> = of_name.iter().map(|f| f.channel.clone()).collect();
        let chosen = |f: &Figure| self.channels.is_empty() || self.channels.contains(&f.channel);
        // A record of one channel does not name it.
        let figures: Vec<Figure> =
            if of_name.len() == 1 { of_name } else { of_name.into_iter().filter(chosen).collect() };
        if figures.is_empty() {
            return Err(note!("figure_paper.no_channel", path = shown, known = channels.join(", ")));
        }
        let subject = stored.results.subject().map_or(shown, str::to_owned);
        let of_one_record = self.given.len() == 2;
        let label = |figure: &Figure| match figure.channel.as_str() {
            "" => subject.clone(),
            channel if of_one_record => channel.to_owned(),
            channel => format!("{subject} · {channel}"),
        };
        Ok(figures.into_iter().map(|figure| Source { label: label(&figure), figure }).collect())
    }

    /// Gives the sources the entries that are named.
    fn label_all(&self, sources: &mut [Source]) -> Result<(), Note> {
        // The legend of one record names its layers.
        let needed = if sources.len() > 1 { sources.len() } else { 0 };
        if self.label.len() > needed {
            return Err(note!("figure_paper.labels", given = self.label.len(), needed));
        }
        for (source, label) in sources.iter_mut().zip(&self.label) {
            source.label.clone_from(label);
        }
        Ok(())
    }

    /// The figure of all sources, with the layers that are chosen, in the unit.
    fn figure_of(&self, mut sources: Vec<Source>, unit: Option<&Unit>) -> Result<Figure, Note> {
        let named: Vec<LayerKind> = self.layers.iter().filter_map(|l| LayerKind::named(l)).collect();
        // Models of several records would cover their data.
        let unasked =
            LayerKind::OF_A_PAPER.iter().copied().filter(|l| sources.len() < 2 || *l != LayerKind::Model);
        let chosen = if named.is_empty() { unasked.collect() } else { named };
        for source in &mut sources {
            paper::with_layers(&mut source.figure, &chosen)?;
            if let Some(unit) = unit {
                paper::in_unit(&mut source.figure, unit)?;
            }
        }
        let none = || note!("figure_paper.no_layers", known = "");
        paper::overlay(sources)?.ok_or_else(none)
    }
}

/// A width as the command line has it, mm.
fn millimetres(width: &str) -> Result<f64, Note> {
    let refused = || note!("figure_paper.width", given = width, least = MIN_WIDTH_MM, most = MAX_WIDTH_MM);
    let trimmed = width.trim();
    let end = trimmed.find(|c: char| c.is_alphabetic()).unwrap_or(trimmed.len());
    let (number, unit) = trimmed.split_at(end);
    let per = match unit {
        "mm" => 1.0,
        "cm" => 10.0,
        "in" => 25.4,
        _ => return Err(refused()),
    };
    let width_mm = number.trim().parse::<f64>().map_err(|_| refused())? * per;
    if (MIN_WIDTH_MM..=MAX_WIDTH_MM).contains(&width_mm) { Ok(width_mm) } else { Err(refused()) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::i18n::table;

    #[test]
    fn widths_have_their_unit() {
        assert_eq!(millimetres("85mm").unwrap(), 85.0);
        assert_eq!(millimetres(" 8.5 cm").unwrap(), 85.0);
        assert_eq!(millimetres("4in").unwrap(), 101.6);
        for wrong in ["85", "mm", "1e9mm", "-85mm", "NaNmm", "10mm", "85px"] {
            assert_eq!(millimetres(wrong).unwrap_err().id, "figure_paper.width", "{wrong}");
        }
    }

    #[test]
    fn every_figure_of_a_report_has_a_name() {
        let titles = table(Lang::En).keys().filter(|k| k.starts_with("figure.title."));
        let mut seen = 0;
        for title in titles {
            let name = title.trim_start_matches("figure.title.").replace('_', "-");
            assert!(FigureName::from_str(&name, false).is_ok(), "{title} has no line in FigureName");
            seen += 1;
        }
        assert!(seen > 10);
    }
}
