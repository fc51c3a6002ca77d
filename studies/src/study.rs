//! What a study is: claims of the program, each set against simulated truth over many records.

use serde::{Deserialize, Serialize};

/// A Monte Carlo study: one page of `docs/validation/`.
pub struct Study {
    /// Short name; `cargo xtask validate ID` runs this study alone.
    pub id: &'static str,
    /// Heading of its page.
    pub title: &'static str,
    /// What is simulated and how it is judged, for the page.
    pub method: &'static str,
    /// Records of each case, unless the command says otherwise.
    pub records: u64,
    /// Its cases. Each is run, kept and resumed on its own.
    pub cases: fn() -> Vec<Case>,
}

/// One simulated situation of a study.
pub struct Case {
    /// What is simulated, unique within the study.
    pub name: String,
    /// Runs a number of records from a seed on, on all cores.
    pub run: Box<dyn Fn(u64, u64) -> Vec<Row>>,
}

impl Case {
    /// A case from its name and what it runs: a function of the number of records and the first seed.
    pub fn new(name: impl Into<String>, run: impl Fn(u64, u64) -> Vec<Row> + 'static) -> Case {
        Case { name: name.into(), run: Box::new(run) }
    }
}

/// What is asked of a measured share or ratio.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Asked {
    /// This much or more.
    AtLeast(f64),
    /// This much or less.
    AtMost(f64),
    /// Between the two, ends included.
    Between(f64, f64),
    /// Nothing: the number is reported.
    Nothing,
}

impl Asked {
    fn range(self) -> (f64, f64) {
        match self {
            Asked::AtLeast(low) => (low, f64::INFINITY),
            Asked::AtMost(high) => (f64::NEG_INFINITY, high),
            Asked::Between(low, high) => (low, high),
            Asked::Nothing => (f64::NEG_INFINITY, f64::INFINITY),
        }
    }
}

impl std::fmt::Display for Asked {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Asked::AtLeast(low) => write!(f, "≥ {low}"),
            Asked::AtMost(high) => write!(f, "≤ {high}"),
            Asked::Between(low, high) => write!(f, "{low} to {high}"),
            Asked::Nothing => write!(f, "–"),
        }
    }
}

/// Whether a measured number is what was asked.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// The whole Monte Carlo interval lies outside what is asked.
    Misses,
    /// The number lies outside, its Monte Carlo interval reaches in: more records decide.
    Unresolved,
    /// The number is as asked.
    Holds,
    /// Nothing is asked.
    Reported,
}

impl Verdict {
    /// Word in the tables.
    pub fn name(self) -> &'static str {
        match self {
            Verdict::Misses => "**misses**",
            Verdict::Unresolved => "unresolved",
            Verdict::Holds => "holds",
            Verdict::Reported => "reported",
        }
    }
}

/// One line of a study.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// What the number is of, such as a measurand.
    pub quantity: String,
    /// What is claimed of it.
    pub claim: String,
    /// What is asked of the number.
    pub asked: Asked,
    /// The number; absent where no record gave one.
    pub measured: Option<f64>,
    /// 95 % interval of the Monte Carlo; absent for a number that is no share.
    pub interval: Option<[f64; 2]>,
    /// Number of records that the number is taken over.
    pub of: u64,
    /// Whether it is as asked.
    pub verdict: Verdict,
}

impl Row {
    /// The share of `of` records in which something happened, with its Wilson interval.
    ///
    /// Source: E. B. Wilson, J. Am. Stat. Assoc. 22 (1927) 209.
    pub fn share(
        quantity: impl Into<String>,
        claim: impl Into<String>,
        asked: Asked,
        hits: u64,
        of: u64,
    ) -> Row {
        let interval = (of > 0).then(|| wilson(hits, of));
        let measured = (of > 0).then(|| hits as f64 / of as f64);
        Row::judged(quantity.into(), claim.into(), asked, measured, interval, of)
    }

    /// A number that is no share; judged by itself.
    pub fn number(
        quantity: impl Into<String>,
        claim: impl Into<String>,
        asked: Asked,
        value: f64,
        of: u64,
    ) -> Row {
        Row::judged(quantity.into(), claim.into(), asked, value.is_finite().then_some(value), None, of)
    }

    /// A number that is no share, with its 95 % interval of the Monte Carlo.
    pub fn estimate(
        quantity: impl Into<String>,
        claim: impl Into<String>,
        asked: Asked,
        value: f64,
        interval: [f64; 2],
        of: u64,
    ) -> Row {
        let measured = value.is_finite().then_some(value);
        Row::judged(quantity.into(), claim.into(), asked, measured, measured.map(|_| interval), of)
    }

    /// How far the number lies outside what is asked; negative within.
    pub(crate) fn shortfall(&self) -> f64 {
        let (least, most) = self.asked.range();
        self.measured.map_or(f64::NEG_INFINITY, |value| (least - value).max(value - most))
    }

    fn judged(
        quantity: String,
        claim: String,
        asked: Asked,
        measured: Option<f64>,
        interval: Option<[f64; 2]>,
        of: u64,
    ) -> Row {
        let (least, most) = asked.range();
        let verdict = match (asked, measured) {
            (Asked::Nothing, _) => Verdict::Reported,
            (_, None) => Verdict::Unresolved,
            (_, Some(value)) if least <= value && value <= most => Verdict::Holds,
            (_, Some(value)) => {
                let [low, high] = interval.unwrap_or([value, value]);
                if high < least || low > most { Verdict::Misses } else { Verdict::Unresolved }
            }
        };
        Row { quantity, claim, asked, measured, interval, of, verdict }
    }
}

/// 95 % Wilson score interval of a share.
fn wilson(hits: u64, of: u64) -> [f64; 2] {
    const Z: f64 = 1.959_963_984_540_054;
    let (n, p) = (of as f64, hits as f64 / of as f64);
    let centre = (p + Z * Z / (2.0 * n)) / (1.0 + Z * Z / n);
    let half = Z / (1.0 + Z * Z / n) * (p * (1.0 - p) / n + Z * Z / (4.0 * n * n)).sqrt();
    [(centre - half).max(0.0), (centre + half).min(1.0)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_interval_of_a_share_is_wilsons() {
        // 81 of 263: Newcombe, Stat. Med. 17 (1998) 857, table I.
        let [low, high] = wilson(81, 263);
        assert!((low - 0.2553).abs() < 5e-5 && (high - 0.3662).abs() < 5e-5, "{low} {high}");
        // 0 of 20 likewise.
        let [low, high] = wilson(0, 20);
        assert!(low == 0.0 && (high - 0.1611).abs() < 5e-5, "{high}");
    }

    #[test]
    fn a_share_misses_only_where_chance_does_not_explain_it() {
        let verdict = |hits, of, asked| Row::share("x", "covers", asked, hits, of).verdict;
        assert_eq!(verdict(95, 100, Asked::AtLeast(0.93)), Verdict::Holds);
        assert_eq!(verdict(90, 100, Asked::AtLeast(0.93)), Verdict::Unresolved);
        assert_eq!(verdict(900, 1000, Asked::AtLeast(0.93)), Verdict::Misses);
        assert_eq!(verdict(0, 0, Asked::AtLeast(0.93)), Verdict::Unresolved);
        assert_eq!(verdict(5, 100, Asked::Nothing), Verdict::Reported);
        assert_eq!(Row::number("w", "width", Asked::AtMost(1.2), 1.3, 10).verdict, Verdict::Misses);
    }
}
