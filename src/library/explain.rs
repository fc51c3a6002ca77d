//! Why a recording differs from its simulation.

use super::{Error, Recording, files};
use crate::claim::Claim;
use crate::config::model::{self, DEFAULT_SEED, ModelFile, Profile, SimulationPlan};
use crate::i18n::{Lang, Note};
use crate::mismatch::{self, Options, Outcome, Progress};
use crate::moment;
use crate::record::explanation::{self, MismatchVerdict};
use crate::report::explain::{Context, on_terminal};
use crate::report::export::Exporter;
use crate::report::terminal::Terminal;
use crate::report::{ExplanationResults, Results, page};
use crate::simulate::{Order, Over, Rows, SimulateError, Simulation};
use chrono::SecondsFormat;
use std::path::Path;

/// A simulation as its author believes it: noise, mean, sensitivities and effects, each with its uncertainty.
#[derive(Clone)]
pub struct Model {
    claim: Claim,
    plan: SimulationPlan,
    drivers: Vec<Profile>,
    name: String,
}

impl Model {
    /// Reads a model (TOML).
    ///
    /// # Errors
    /// [`Error::is_configuration`] with every problem of the file.
    pub fn load(path: impl AsRef<Path>) -> Result<Model, Error> {
        let path = path.as_ref();
        Ok(Model::of(model::load_model(path)?, path.display().to_string()))
    }

    /// Reads a model from the text of a file; `name` stands for the file in diagnostics.
    ///
    /// # Errors
    /// As [`Model::load`].
    pub fn parse(name: &str, text: &str) -> Result<Model, Error> {
        Ok(Model::of(model::parse(name, text.as_bytes())?, name.to_owned()))
    }

    fn of(file: ModelFile, name: String) -> Model {
        let ModelFile { claim, simulation, drivers } = file;
        Model { claim, plan: simulation, drivers, name }
    }

    /// The same model, simulated over another length.
    #[must_use]
    pub fn lasting(mut self, duration_s: f64) -> Model {
        self.plan.duration_s = Some(duration_s);
        self
    }

    /// The seed that the file states, else that of the program.
    pub fn seed(&self) -> u64 {
        self.plan.seed.unwrap_or(DEFAULT_SEED)
    }

    /// Makes a recording from the model, over the length that its file states. Equal seeds give equal recordings.
    ///
    /// # Errors
    /// [`Error::is_argument`] when the file states no length, or when an effect lacks a parameter or a column.
    pub fn simulate(&self, seed: u64) -> Result<Recording, Error> {
        Recording::from_columns(self.simulate_columns(seed, &mut |_, _| {})?)
    }

    /// The columns of such a recording, by name; `progress` gets rows made and rows in all.
    ///
    /// # Errors
    /// As [`Model::simulate`].
    pub fn simulate_columns(
        &self,
        seed: u64,
        progress: &mut dyn FnMut(u64, u64),
    ) -> Result<Vec<(String, Vec<f64>)>, Error> {
        let Some(duration_s) = self.plan.duration_s else {
            return Err(Error::argument("simulate.no_duration"));
        };
        let over = Over::Duration { duration_s, start_s: self.plan.start_s, drivers: &self.drivers };
        let failed = |e: SimulateError| Error::argument(e.note().clone());
        let mut simulation = Simulation::begin(Order { claim: &self.claim, seed, over }).map_err(failed)?;
        let rows_in_all = (duration_s * self.claim.sample_rate_hz).max(0.0) as u64;
        let mut all = Rows::default();
        while let Some(rows) = simulation.next_rows().map_err(failed)? {
            all.time_s.extend(rows.time_s);
            all.rate_deg_h.extend(rows.rate_deg_h);
            for (column, values) in rows.columns {
                all.columns.entry(column).or_default().extend(values);
            }
            progress((all.time_s.len() as u64).min(rows_in_all), rows_in_all);
        }
        let columns = [("time_s", all.time_s), ("rate_deg_h", all.rate_deg_h)];
        let columns = columns.into_iter().map(|(name, values)| (name.to_owned(), values));
        Ok(columns.chain(all.columns.into_iter().map(|(c, v)| (c.name().to_owned(), v))).collect())
    }

    /// The model as the text of a TOML file.
    pub fn to_toml(&self) -> String {
        model::write(&self.claim)
    }

    /// Its values.
    pub fn claim(&self) -> &Claim {
        &self.claim
    }
}

/// Finds where a recording departs from a model, and which effect of the catalogue accounts for it.
///
/// The rate is the only column that looks like a gyro output; a correct model is called a mismatch in one of 100
/// recordings.
///
/// # Errors
/// [`Error::is_recording`] when the recording cannot be read; [`Error::is_argument`] when its rate column cannot be identified,
/// or when recording and model cannot be compared.
pub fn explain(recording: &Recording, model: &Model) -> Result<Explanation, Error> {
    explain_watched(recording, model, &Options::default(), &mut |_| {})
}

/// The same with options; `progress` receives each step of the work.
///
/// # Errors
/// As [`explain`].
pub fn explain_watched(
    recording: &Recording,
    model: &Model,
    options: &Options,
    progress: &mut dyn FnMut(Progress),
) -> Result<Explanation, Error> {
    let series = recording.series(&recording.series_options())?;
    let notes = series.remarks();
    let outcome = mismatch::explain(series, &model.claim, options, progress);
    let outcome = outcome.map_err(Error::argument)?;
    Ok(Explanation { outcome, notes, recording: recording.shown(), model: model.clone() })
}

/// What an explanation found.
pub struct Explanation {
    outcome: Outcome,
    notes: Vec<Note>,
    recording: String,
    model: Model,
}

impl Explanation {
    /// Whether the model explains the recording.
    pub fn verdict(&self) -> MismatchVerdict {
        self.outcome.explanation.verdict
    }

    /// The same as results of any kind.
    pub fn into_results(self) -> Results {
        let context = self.context();
        Results::Explanation(Box::new(ExplanationResults::new(&self.outcome, context)))
    }

    /// The effects found, the principal one first.
    pub fn effects(&self) -> &[explanation::Finding] {
        &self.outcome.explanation.effects
    }

    /// Everything that `explain.json` holds.
    pub fn record(&self) -> &explanation::Explanation {
        &self.outcome.explanation
    }

    /// What the model left out, sample by sample: (time in s, deg/h). `None` where it cannot be predicted.
    pub fn correction(&self) -> Option<&[(f64, f64)]> {
        self.outcome.correction.as_deref()
    }

    /// The model with the effects found added to it.
    pub fn augmented(&self) -> Model {
        Model { claim: self.outcome.augmented.clone(), ..self.model.clone() }
    }

    /// The finding in a few lines.
    pub fn summary(&self, lang: Lang) -> String {
        let blocks = on_terminal(&self.outcome.explanation, &self.context(), lang);
        page::terminal(&blocks, Terminal { width: 100, colour: false })
    }

    fn context(&self) -> Context {
        Context {
            recording: self.recording.clone(),
            claim: self.model.name.clone(),
            identified: false,
            description: Some(self.model.claim.description.clone()),
            explained_at: moment::now().to_rfc3339_opts(SecondsFormat::Secs, true),
            correction: self.outcome.correction.is_some(),
            notes: self.notes.clone(),
        }
    }

    /// Writes the explanation in some forms into a folder, which is created where it is missing. Files of the same names
    /// are replaced. Tables are `correction.csv`, where there is a correction, `augmented.toml`, and `alternatives.toml`, where an
    /// effect has equivalents.
    ///
    /// # Errors
    /// [`Error::is_output`] when a file cannot be written.
    pub fn write(
        &self,
        folder: impl AsRef<Path>,
        exporters: &[&dyn Exporter],
        lang: Lang,
    ) -> Result<(), Error> {
        let results = ExplanationResults::new(&self.outcome, self.context());
        files::write(folder.as_ref(), &results.document(lang), exporters)
    }
}
