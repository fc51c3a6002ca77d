//! What a folder holds.

use super::checksums::CHECKSUMS_FILE;

/// Name of the copy of the procedure in the folder of a result.
pub const PROCEDURE_FILE: &str = "procedure.toml";

/// Name of the copy of the limits file in the folder of a result.
pub const LIMITS_FILE: &str = "limits.toml";

/// Folder of the signatures in a folder of results.
pub const SIGNATURES_FOLDER: &str = "signatures";

/// Name of the pages of a certificate of conformity, without the ending.
pub const CERTIFICATE_STEM: &str = "certificate";

/// Largest record of a folder that is read, bytes; results of shipped samples take about a tenth of a megabyte.
pub const MAX_RECORD_BYTES: u64 = 256 << 20;

/// What a folder holds; one kind never takes the place of another.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// The result of a run or an analysis.
    Result,
    /// A comparison.
    Comparison,
    /// The explanation of a mismatch.
    Explanation,
    /// A lot: an index, and a result folder for each unit.
    Lot,
    /// Several recordings that are explained together: a record, and an explanation of each.
    Joint,
    /// The plan of the next test.
    Plan,
    /// The data sheet of a lot.
    DataSheet,
    /// A proof: what was concealed, what was said, what is true.
    Proof,
    /// A day of a watched folder.
    Day,
    /// A rehearsal of a test on simulated units.
    Rehearsal,
}

impl Kind {
    /// Every kind.
    pub const ALL: [Kind; 10] = [
        Kind::Result,
        Kind::Comparison,
        Kind::Explanation,
        Kind::Joint,
        Kind::Lot,
        Kind::Plan,
        Kind::DataSheet,
        Kind::Proof,
        Kind::Day,
        Kind::Rehearsal,
    ];

    /// The JSON file that a folder of this kind holds, and by which it is known.
    pub fn record_file(self) -> &'static str {
        match self {
            Kind::Result => "result.json",
            Kind::Comparison => "comparison.json",
            Kind::Explanation => "explain.json",
            Kind::Lot => "index.json",
            Kind::Joint => "joint.json",
            Kind::Plan => "plan.json",
            Kind::DataSheet => "datasheet.json",
            Kind::Proof => "proof.json",
            Kind::Day => "day.json",
            Kind::Rehearsal => "rehearsal.json",
        }
    }

    /// Name of its pages without the ending, such as `report` for `report.html`.
    pub fn page_stem(self) -> &'static str {
        match self {
            Kind::Result | Kind::Explanation | Kind::Joint | Kind::Plan | Kind::Proof | Kind::Rehearsal => {
                "report"
            }
            Kind::Comparison => "comparison",
            Kind::Lot | Kind::Day => "index",
            Kind::DataSheet => "datasheet",
        }
    }

    /// The sentence about a result of this kind that is about to be replaced; of a run, one of a unit with a serial number.
    pub(super) fn description(self) -> &'static str {
        match self {
            Kind::Result => "output_error.what.result",
            Kind::Comparison => "output_error.what.comparison",
            Kind::Explanation => "output_error.what.explanation",
            Kind::Lot => "output_error.what.lot",
            Kind::Joint => "output_error.what.joint",
            Kind::Plan => "output_error.what.plan",
            Kind::DataSheet => "output_error.what.datasheet",
            Kind::Proof => "output_error.what.proof",
            Kind::Day => "output_error.what.day",
            Kind::Rehearsal => "output_error.what.rehearsal",
        }
    }

    /// The reason why a folder that is none of this kind is not replaced.
    pub(super) fn foreign(self) -> &'static str {
        match self {
            Kind::Result => "output_error.why.foreign",
            Kind::Comparison => "compare.more.foreign_folder",
            Kind::Explanation => "explain.error.foreign_folder",
            Kind::Lot => "output_error.why.foreign_lot",
            Kind::Joint => "joint.error.foreign_folder",
            Kind::Plan => "plan.error.foreign_folder",
            Kind::DataSheet => "output_error.why.foreign_datasheet",
            Kind::Proof => "prove.error.foreign_folder",
            Kind::Day => "output_error.why.foreign_day",
            Kind::Rehearsal => "output_error.why.foreign_rehearsal",
        }
    }

    /// How that file begins, without spaces.
    pub(super) fn start(self) -> &'static str {
        match self {
            Kind::Result => "{\"format\":\"result/",
            Kind::Comparison => "{\"format\":\"comparison/",
            Kind::Explanation => "{\"format\":\"explain/",
            Kind::Lot => "{\"format\":\"lot/",
            Kind::Joint => "{\"format\":\"explain-joint/",
            Kind::Plan => "{\"format\":\"plan/",
            Kind::DataSheet => "{\"format\":\"datasheet/",
            Kind::Proof => "{\"format\":\"proof-result/",
            Kind::Day => "{\"format\":\"day/",
            Kind::Rehearsal => "{\"format\":\"rehearsal/",
        }
    }

    /// True for the name of a table, or of another file that is data for other programs.
    pub fn is_table(self, name: &str) -> bool {
        match self {
            Kind::Result => {
                (name.starts_with("sigma_tau") && name.ends_with(".csv"))
                    || matches!(name, "table_steps.csv" | "interval_means.csv")
                    || matches!(name, PROCEDURE_FILE | LIMITS_FILE)
                    || (["compensation", "scale_factor_compensation"]
                        .iter()
                        .any(|stem| name.starts_with(stem))
                        && [".toml", ".json", ".h"].iter().any(|ext| name.ends_with(ext)))
            }
            Kind::Comparison => matches!(name, "comparison.csv" | "agreement.csv"),
            Kind::Explanation => {
                matches!(name, "correction.csv" | "augmented.toml" | "alternatives.toml")
            }
            Kind::Lot => name == "index.csv",
            Kind::Joint => name == "augmented.toml",
            Kind::Plan => name == "schedule.toml",
            Kind::DataSheet => name == "limits.toml",
            Kind::Proof => name == "model.toml",
            Kind::Day | Kind::Rehearsal => false,
        }
    }

    /// True for the name, without its ending, of a certificate of conformity in a folder of this kind.
    fn has_certificate(self, stem: &str) -> bool {
        self == Kind::Result && stem == CERTIFICATE_STEM
    }

    /// True for a name that stands in a folder of this kind.
    pub(super) fn owns(self, name: &str) -> bool {
        let stem =
            name.rsplit_once('.').filter(|(_, ending)| matches!(*ending, "html" | "md" | "pdf" | "docx"));
        let page = stem.is_some_and(|(stem, _)| stem == self.page_stem() || self.has_certificate(stem))
            || match self {
                Kind::Result => {
                    matches!(name, "explain" | "phases" | SIGNATURES_FOLDER)
                        || matches!(name, "measurands.csv" | "measurands.parquet")
                        || matches!(name, "junit.xml" | "dcc.xml" | "atml.xml")
                }
                Kind::Joint => name == "recordings",
                Kind::Lot => matches!(name, "junit.xml" | "index.xlsx"),
                Kind::Comparison
                | Kind::Explanation
                | Kind::Plan
                | Kind::DataSheet
                | Kind::Proof
                | Kind::Day
                | Kind::Rehearsal => false,
            };
        page || matches!(name, "figures" | "signatures.json" | CHECKSUMS_FILE)
            || name == self.record_file()
            || self.is_table(name)
    }
}
