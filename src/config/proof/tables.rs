//! The tables of a proof file.

use crate::config::procedure::tables::ChannelKeys;
use crate::config::section::Section;
use crate::config::spec::{Kind, TableSpec, Word};
use crate::config::table::{Table, words};
use crate::effect::Domain;
use crate::i18n::LocalText;
use crate::units::Unit;

/// A proof file as a whole.
pub static PROOF_FILE: TableSpec = *ProofTables::SPEC;

/// A proof: what is concealed of a recording, what is known of it from elsewhere, and the rules by which the answer
/// is judged. The file is written before the first run.
#[derive(Table)]
#[table("", format = "proof/1")]
pub(super) struct ProofTables {
    /// Title of the page.
    #[key(required, example = "Loop ramp of a closed-loop FOG")]
    pub title: Option<LocalText>,
    /// What is asked, in a sentence or two.
    #[key(required, example = "Is the reset of the ramp found?")]
    pub question: Option<LocalText>,
    /// The recording.
    #[key(required)]
    pub recording: Option<RecordingKeys>,
    /// The columns that are used, as in a procedure. Default: as they are found by their names.
    #[key(name = "channel")]
    pub channels: Vec<ChannelKeys>,
    /// What is concealed. Default: nothing.
    #[key(optional)]
    pub conceal: ConcealKeys,
    /// Columns that drive nothing, shown together with what was concealed.
    #[key(name = "decoy")]
    pub decoys: Vec<DecoyKeys>,
    /// The claim that the recording is held against.
    #[key(required)]
    pub claim: Option<ClaimKeys>,
    /// What is known from elsewhere, one table each.
    #[key(name = "reference")]
    pub references: Vec<ReferenceKeys>,
    /// The rules by which the answer is judged, one table each. All must hold.
    #[key(name = "rule", required)]
    pub rules: Vec<RuleKeys>,
}

/// The recording: a file, or a simulation of what is true.
#[derive(Table)]
#[table("recording")]
pub(super) struct RecordingKeys {
    /// File, relative to the folder of data.
    #[key(example = "fog/static.csv")]
    pub path: Option<String>,
    /// SHA-256 of the file, required with `path`.
    #[key(example = "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855")]
    pub sha256: Option<String>,
    /// In place of `path`: model of what is true, relative to the proof file. Its effects are what is concealed.
    #[key(example = "truth.toml")]
    pub simulated: Option<String>,
    /// Length of the simulation, required with `simulated`.
    #[key(quantity = "s", above = 0, example = "10 h")]
    pub duration_s: Option<f64>,
    /// Seed of the simulation, and of effects that are added.
    #[key(min = 0, max = 9e15, default = 1, example = 7)]
    pub seed: u64,
    /// Gyro output: id of a channel, or column where no channels are declared.
    #[key(example = "rate_x")]
    pub rate: Option<String>,
    /// Unit of that column where no channels are declared.
    #[key(example = "nrad/s")]
    pub unit: Option<String>,
    /// Sample rate, required without timestamps.
    #[key(quantity = "Hz", above = 0, example = "100 Hz")]
    pub sample_rate_hz: Option<f64>,
    /// Consecutive rows of which the mean is taken before anything else; rows around a gap are left out.
    #[key(min = 1, max = 1e6, default = 1, example = 10)]
    pub average: usize,
    /// Beginning of the part that is used, after the first row.
    #[key(quantity = "s", min = 0, example = "600 s")]
    pub from_s: Option<f64>,
    /// End of that part.
    #[key(quantity = "s", min = 0, example = "3600 s")]
    pub to_s: Option<f64>,
    #[key(section)]
    pub section: Section,
}

/// What is concealed.
#[derive(Table)]
#[table("conceal")]
pub(super) struct ConcealKeys {
    /// Columns that are taken out of the recording, by their names in explanations: `temp_degC` for a temperature,
    /// otherwise the id of the channel, or its name if no channels are declared.
    #[key(example = ["ramp_counts"])]
    pub columns: Vec<String>,
    /// Model whose effects are added to the rate, relative to the proof file; nothing else of it is used.
    #[key(example = "injected.toml")]
    pub effects: Option<String>,
    #[key(section)]
    pub section: Section,
}

/// A column that drives nothing: one of the recording, shifted in time and continued from its other end.
#[derive(Table)]
#[table("decoy")]
pub(super) struct DecoyKeys {
    /// Name under which it is shown.
    #[key(required, example = "decoy_1")]
    pub name: Option<String>,
    /// Column that it is made from.
    #[key(required, example = "ramp_counts")]
    pub of: Option<String>,
    /// Shift.
    #[key(quantity = "s", above = 0, required, example = "120 s")]
    pub shift_s: Option<f64>,
}

/// The claim: a model, or what the program itself identifies from a part of what is shown or from another output.
#[derive(Table)]
#[table("claim")]
pub(super) struct ClaimKeys {
    /// Model, relative to the proof file. Default: identified.
    #[key(example = "claim.toml")]
    pub model: Option<String>,
    /// Beginning of the part from which it is identified, after the first row of the recording.
    #[key(quantity = "s", min = 0, example = "0 s")]
    pub from_s: Option<f64>,
    /// End of that part.
    #[key(quantity = "s", min = 0, example = "600 s")]
    pub to_s: Option<f64>,
    /// Another output that it is identified from.
    #[key(example = "rate_y")]
    pub rate: Option<String>,
    #[key(section)]
    pub section: Section,
}

/// What is known from elsewhere.
#[derive(Table)]
#[table("reference")]
pub(super) struct ReferenceKeys {
    /// Id by which rules name it.
    #[key(id, required, example = "reset_frequency")]
    pub id: Option<String>,
    /// What it is.
    #[key(required, example = "Frequency of the resets")]
    pub what: Option<LocalText>,
    /// Low end of the interval.
    #[key(example = 4.166)]
    pub low: Option<f64>,
    /// High end of the interval.
    #[key(example = 4.176)]
    pub high: Option<f64>,
    /// Unit of the interval.
    #[key(example = "Hz")]
    pub unit: Option<Unit>,
    /// Where it comes from.
    #[key(required, example = "README of the recording")]
    pub source: Option<LocalText>,
    #[key(section)]
    pub section: Section,
}

/// Explanations that a rule can speak of.
pub const SHOWN_EXPLANATIONS: &[Word] = &[
    ("concealed", "the explanation of what is shown while something is concealed"),
    ("unveiled", "the explanation with the concealed columns shown among the decoys"),
];

/// What a rule asks for.
pub const RULE_KINDS: &[Word] = &[
    ("verdict", "the verdict is one of `verdicts`"),
    ("name", "an effect is one of `kinds`, or has one of them among its equivalents"),
    ("not_name", "no effect is one of `kinds`"),
    ("follow", "an effect follows one of `columns`"),
    ("not_follow", "no effect follows any of `columns`"),
    ("parameter", "`parameter` of an effect of `kinds` lies in the interval of `reference`"),
    ("locate", "an effect is located in `domain` within `low` to `high`"),
    ("course", "the inferred course correlates with one of `columns`, by size at least `at_least`"),
    ("improve", "the mean square of the held-out residual falls by the share `at_least`"),
    ("recover", "of the mean square of what was added, the share `at_least` is in the inferred course"),
];

/// Domains of a location.
pub const LOCATION_DOMAINS: &[Word] = &[
    ("time", "s"),
    ("frequency", "Hz"),
    ("lag", "s"),
    ("temperature", "°C"),
    ("temperature_rate", "°C/min"),
    ("input_rate", "deg/s"),
    ("outer_rate", "deg/s"),
    ("angle", "deg"),
    ("amplitude", "deg/h"),
    ("timestamps", "s"),
    ("supply", "V"),
    ("driver", "unit of the column"),
];

/// Verdicts of an explanation.
pub const EXPLANATION_VERDICTS: &[Word] = &[
    ("consistent", "the recording is an ordinary draw of the claim"),
    ("mismatch", "named effects account for the difference"),
    ("unknown-mismatch", "some of it has no name"),
];

words!(Domain, LOCATION_DOMAINS, |word: &str| Domain::ALL.iter().copied().find(|domain| domain.id() == word));

/// A rule.
#[derive(Table)]
#[table("rule")]
pub(super) struct RuleKeys {
    /// Which explanation it speaks of.
    #[key(choice = SHOWN_EXPLANATIONS, default = "concealed", example = "unveiled")]
    pub when: &'static str,
    /// What must hold.
    #[key(choice = RULE_KINDS, required, example = "name")]
    pub must: Option<&'static str>,
    /// Verdicts.
    #[key(choice = EXPLANATION_VERDICTS, example = ["mismatch"])]
    pub verdicts: Option<Vec<&'static str>>,
    /// Effects by their ids (`sagnac effects`), or `unknown`.
    #[key(kind = Kind::Effects, example = ["comb"])]
    pub kinds: Vec<String>,
    /// Columns by their names as they are shown.
    #[key(example = ["ramp_counts"])]
    pub columns: Vec<String>,
    /// Parameter of an effect.
    #[key(example = "frequency_hz")]
    pub parameter: Option<String>,
    /// Id of a reference.
    #[key(example = "reset_frequency")]
    pub reference: Option<String>,
    /// Domain of a location, as in explain.json.
    #[key(example = "frequency")]
    pub domain: Option<Domain>,
    /// Low end of a location.
    #[key(example = 600)]
    pub low: Option<f64>,
    /// High end of a location.
    #[key(example = 900)]
    pub high: Option<f64>,
    /// Share or correlation.
    #[key(min = 0, max = 1, example = 0.9)]
    pub at_least: Option<f64>,
    #[key(section)]
    pub section: Section,
}
