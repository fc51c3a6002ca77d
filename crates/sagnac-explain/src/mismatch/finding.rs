//! The result of an explanation, as `explain.json` has it.

use super::noticeable_record::{NotComputed, NoticeableSize};
use crate::effect::{Domain, Place, UNKNOWN, find};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The document `explain.json`. Format `explain/1`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Explanation {
    /// `explain/1`
    pub format: String,
    /// The case that the claim names.
    pub case: String,
    /// What it comes to.
    pub verdict: MismatchVerdict,
    /// One entry a cause, the principal first.
    pub effects: Vec<Finding>,
    /// What the named effects leave, where it is more than chance and a small part of the misfit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rest: Option<Rest>,
    /// Baseline against augmented.
    pub fit: Fit,
    /// Probability of so large a mismatch under a correct claim, everything that was looked at counted.
    pub family_p_value: f64,
    /// The same with the augmented claim; that of the baseline where nothing was added.
    pub family_p_value_after: f64,
    /// Significance asked for.
    pub alpha: f64,
    /// Everything that was tried on the baseline, the largest ΔBIC first.
    pub candidates: Vec<Candidate>,
    /// Tests of the residual, before and after.
    pub tests: Vec<Test>,
    /// Values of the claim with what the recording says of them, under the stated uncertainties.
    pub nuisances: Vec<NuisanceValue>,
    /// What the recording is: rows, missing rows, sample interval, length.
    pub recording: RecordingFacts,
    /// Every column beside time and rate, with its part in what was found.
    #[serde(default)]
    pub columns: Vec<ColumnRecord>,
    /// For each kind of effect that was not found, the size that would have been noticed with a probability of 95 %, the most
    /// useful first. Empty where something is left without a name.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub noticeable: Vec<NoticeableSize>,
    /// Kinds without such a size, and why.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub noticeable_not_computed: Vec<NotComputed>,
    /// Experiments that would decide between equivalents, as keys of words.
    pub experiments: Vec<Experiment>,
}

/// What the comparison of a recording with a claim comes to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum MismatchVerdict {
    /// The recording is an ordinary draw of the claim.
    Consistent,
    /// Effects of the catalogue account for the difference.
    Mismatch,
    /// Some of the difference no effect accounts for.
    UnknownMismatch,
}

impl MismatchVerdict {
    /// Its id in files: `consistent`, `mismatch`, `unknown-mismatch`.
    pub fn id(self) -> &'static str {
        match self {
            MismatchVerdict::Consistent => "consistent",
            MismatchVerdict::Mismatch => "mismatch",
            MismatchVerdict::UnknownMismatch => "unknown-mismatch",
        }
    }
}

/// One cause.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Finding {
    /// Kind of the contract, or `unknown`.
    pub kind: String,
    /// Effect of the catalogue, where the format has no kind of that name for it: `kind` is then `unknown`, or the kind that
    /// holds it among others.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub effect: Option<String>,
    /// Column that it follows, for a kind that any column can drive.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub column: Option<String>,
    /// Second column, where it follows a product.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub column2: Option<String>,
    /// Law by which it follows that column: `linear`, `rate`, `lag`, `curve`, `hysteresis` or `product`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub law: Option<String>,
    /// The law that it follows as a formula in deg/h and the units of the columns, rates of change per hour, for a law that no
    /// kind describes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub formula: Option<String>,
    /// What it looks like, for a cause without a name.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shape: Option<ShapeRecord>,
    /// Kinds that this recording cannot tell from it, at most three.
    pub equivalents: Vec<String>,
    /// How probable each kind is, given that an effect of the catalogue is there; those below a hundredth are left out, and so is all
    /// of it where the cause was found in single samples.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub probabilities: BTreeMap<String, f64>,
    /// Parameters by name.
    pub parameters: BTreeMap<String, ParameterValue>,
    /// Where it lives, principal first.
    #[serde(rename = "where")]
    pub places: Vec<PlaceRecord>,
    /// BIC without it less BIC with it.
    pub delta_bic: f64,
    /// Probability under its absence, corrected for the search.
    pub p_value: f64,
    /// Held-out gain of log-likelihood when it is added to the claim with the entries before it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub heldout_gain: Option<f64>,
    /// Share of the located excess that is removed, 0 to 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub removed_share: Option<f64>,
}

impl Finding {
    /// Id of the effect of the catalogue, whether the format of explanations has a kind for it or not.
    pub fn effect_id(&self) -> &str {
        self.effect.as_deref().unwrap_or(&self.kind)
    }

    /// Its equivalents that are another cause: that a column without a role is followed is the same cause by another name, where
    /// the finding says which column it is.
    pub fn other_causes(&self) -> impl Iterator<Item = &String> {
        let any_column = |kind: &str| find(kind).is_some_and(|e| e.follows_any_column());
        let same = self.column.is_some() && !any_column(&self.kind);
        self.equivalents.iter().filter(move |kind| !(same && any_column(kind)))
    }

    /// True for a cause that nothing in the catalogue describes.
    pub fn is_unnamed(&self) -> bool {
        self.effect_id() == UNKNOWN
    }
}

/// What a cause without a name looks like.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ShapeRecord {
    /// The test that shows it best, as in `tests`.
    pub form: String,
    /// Events that stand out by themselves.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub count: Option<usize>,
    /// About how long each is, s.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub each_s: Option<f64>,
    /// Standard deviation of what it adds at its place, deg/h.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rms_deg_h: Option<f64>,
}

/// A parameter with its interval.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ParameterValue {
    /// Value.
    pub value: f64,
    /// Unit.
    pub unit: String,
    /// 95 % interval.
    pub ci95: [f64; 2],
}

/// An interval of a domain.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PlaceRecord {
    /// Domain.
    pub domain: Domain,
    /// Lower end.
    pub from: f64,
    /// Upper end.
    pub to: f64,
}

impl PlaceRecord {
    /// A place as it is recorded.
    pub fn of(place: &Place) -> PlaceRecord {
        PlaceRecord { domain: place.domain, from: place.from, to: place.to }
    }
}

/// What named effects leave: more than chance, and so small a part of the misfit that it is no cause of its own.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Rest {
    /// Probability of as much by chance, all tests counted.
    pub p_value: f64,
    /// Its part of the misfit, in log-likelihood over the claim, 0 to 1.
    pub share: f64,
    /// Where it shows.
    #[serde(rename = "where")]
    pub places: Vec<PlaceRecord>,
}

/// Baseline and augmented.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Fit {
    /// Bin length of the held-out residual, s.
    pub heldout_tau_s: f64,
    /// The claim with its nuisances re-estimated.
    pub baseline: FitFigures,
    /// The same with the effects.
    pub augmented: FitFigures,
}

/// Figures of one model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FitFigures {
    /// Natural logarithm, whole recording.
    pub log_likelihood: f64,
    /// Of the held-out blocks, parameters from the others.
    pub heldout_log_likelihood: f64,
    /// Of the held-out residual in bins, deg/h.
    pub heldout_rms_deg_h: f64,
    /// −2 ln L + parameters · ln rows.
    pub bic: f64,
}

/// An effect that was tried.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Candidate {
    /// Kind.
    pub kind: String,
    /// BIC of the baseline less its own.
    pub delta_bic: f64,
    /// Gain of log-likelihood.
    pub log_likelihood_gain: f64,
    /// Corrected for its own search.
    pub p_value: f64,
}

/// A test of one view.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Test {
    /// Id: `spectrum`, `line`, `level`, `variance`, `distribution`, ...
    pub id: String,
    /// Domain of the largest departure.
    pub domain: Domain,
    /// Lower end of it.
    pub from: f64,
    /// Upper end of it.
    pub to: f64,
    /// p-value with the claim.
    pub p_before: f64,
    /// p-value with the augmented claim.
    pub p_after: f64,
}

/// A stated value and what the recording says of it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct NuisanceValue {
    /// Key in `model.toml`.
    pub name: String,
    /// Unit.
    pub unit: String,
    /// As claimed.
    pub claimed: f64,
    /// Stated standard deviation.
    pub uncertainty: f64,
    /// Fitted with the claim.
    pub baseline: f64,
    /// Fitted with the augmented claim.
    pub augmented: f64,
}

/// What was read.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RecordingFacts {
    /// Rows.
    pub rows: usize,
    /// Rows missing inside.
    pub missing: usize,
    /// Sample interval, s.
    pub sample_interval_s: f64,
    /// From the first to the last row, s.
    pub length_s: f64,
    /// Columns that were used.
    pub columns: Vec<String>,
    /// Columns that were left out on request.
    pub hidden: Vec<String>,
}

impl RecordingFacts {
    /// Time that the samples cover, s: each is a mean over its interval, so the last one lasts as long as the others.
    pub fn duration_s(&self) -> f64 {
        self.length_s + self.sample_interval_s
    }
}

/// What became of a recorded column.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ColumnRecord {
    /// Its name: the standard one (`temp_degC`) where it has one, else that of the file.
    pub name: String,
    /// Its name in the file, where that is another.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub recorded_as: Option<String>,
    /// Its part in what was found.
    pub status: ColumnStatus,
    /// Why it cannot be used.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reason: Option<UnusableColumn>,
    /// Of a silent column: one-sided 95 % limit of what is proportional to it, rms over the record, deg/h.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub at_most_deg_h: Option<f64>,
}

/// The part of a column in what was found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum ColumnStatus {
    /// Something that was found follows it.
    Used,
    /// It was tested and nothing follows it.
    Silent,
    /// It cannot drive anything.
    Unusable,
}

/// Why a column cannot drive anything.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum UnusableColumn {
    /// It does not change.
    Constant,
    /// It is a straight line in time.
    CountsTime,
}

impl ColumnStatus {
    /// Its id in files.
    pub fn id(self) -> &'static str {
        match self {
            ColumnStatus::Used => "used",
            ColumnStatus::Silent => "silent",
            ColumnStatus::Unusable => "unusable",
        }
    }
}

impl UnusableColumn {
    /// Its id in files.
    pub fn id(self) -> &'static str {
        match self {
            UnusableColumn::Constant => "constant",
            UnusableColumn::CountsTime => "counts_time",
        }
    }
}

/// What would decide between two kinds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Experiment {
    /// The chosen kind.
    pub kind: String,
    /// The other.
    pub against: String,
    /// How many times as long a record tells them apart in 95 of 100, if length alone can.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub times_longer: Option<f64>,
}
