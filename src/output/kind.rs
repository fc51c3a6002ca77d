//! What a folder holds.

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
}

impl Kind {
    /// Every kind.
    pub const ALL: [Kind; 7] = [
        Kind::Result,
        Kind::Comparison,
        Kind::Explanation,
        Kind::Joint,
        Kind::Lot,
        Kind::Plan,
        Kind::DataSheet,
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
        }
    }

    /// Name of its pages without the ending, such as `report` for `report.html`.
    pub fn page_stem(self) -> &'static str {
        match self {
            Kind::Result | Kind::Explanation | Kind::Joint | Kind::Plan => "report",
            Kind::Comparison => "comparison",
            Kind::Lot => "index",
            Kind::DataSheet => "datasheet",
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
        }
    }

    /// True for the name of a table, or of another file that is data for other programs.
    pub fn is_table(self, name: &str) -> bool {
        match self {
            Kind::Result => {
                (name.starts_with("sigma_tau") && name.ends_with(".csv"))
                    || matches!(name, "table_steps.csv" | "interval_means.csv")
                    || (name.starts_with("compensation")
                        && [".toml", ".json", ".h"].iter().any(|ext| name.ends_with(ext)))
            }
            Kind::Comparison => name == "comparison.csv",
            Kind::Explanation => {
                matches!(name, "correction.csv" | "augmented.toml" | "alternatives.toml")
            }
            Kind::Lot => name == "index.csv",
            Kind::Joint => name == "augmented.toml",
            Kind::Plan => name == "schedule.toml",
            Kind::DataSheet => name == "limits.toml",
        }
    }

    /// True for a name that stands in a folder of this kind.
    pub(super) fn owns(self, name: &str) -> bool {
        let page = match self {
            Kind::Result => matches!(name, "report.html" | "report.md" | "explain" | "phases"),
            Kind::Comparison => matches!(name, "comparison.html" | "comparison.md"),
            Kind::Explanation | Kind::Plan => matches!(name, "report.html" | "report.md"),
            Kind::Joint => matches!(name, "report.html" | "report.md" | "recordings"),
            Kind::Lot => matches!(name, "index.html" | "index.md" | "junit.xml"),
            Kind::DataSheet => matches!(name, "datasheet.html" | "datasheet.md"),
        };
        page || name == "figures" || name == self.record_file() || self.is_table(name)
    }
}
