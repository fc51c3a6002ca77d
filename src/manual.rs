//! The documents that the program carries, and the search over them.

use std::collections::BTreeSet;

/// Names a document below `docs/` and carries its text.
macro_rules! pages {
    ($($path:literal),* $(,)?) => {
        &[$(Page { path: $path, text: include_str!(concat!("../docs/", $path)) }),*]
    };
}

/// A document.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Page {
    /// Path below `docs/`.
    pub path: &'static str,
    /// Text, Markdown.
    pub text: &'static str,
}

/// The documents for users, in the order of reading.
pub const PAGES: &[Page] = pages![
    "tutorial.md",
    "cookbook.md",
    "comparison.md",
    "glossary.md",
    "guide/acceleration.md",
    "guide/bench-check.md",
    "guide/compare.md",
    "guide/datasheet.md",
    "guide/documents.md",
    "guide/explain.md",
    "guide/export.md",
    "guide/figure.md",
    "guide/formulas.md",
    "guide/influence.md",
    "guide/interim.md",
    "guide/layout.md",
    "guide/limits.md",
    "guide/lot.md",
    "guide/manifest.md",
    "guide/model.md",
    "guide/output-noise.md",
    "guide/phases.md",
    "guide/plan.md",
    "guide/procedure.md",
    "guide/programs.md",
    "guide/prove.md",
    "guide/python-ray.md",
    "guide/python-spark.md",
    "guide/python.md",
    "guide/rate-table.md",
    "guide/record.md",
    "guide/recordings.md",
    "guide/rehearse.md",
    "guide/report.md",
    "guide/serve.md",
    "guide/start-up.md",
    "guide/store.md",
    "guide/temperature.md",
    "guide/transfer-function.md",
    "guide/watch.md",
    "methods/acceleration.md",
    "methods/allan-deviation.md",
    "methods/bench-check.md",
    "methods/comparison.md",
    "methods/control-charts.md",
    "methods/correlated-noise.md",
    "methods/criticism.md",
    "methods/decisions.md",
    "methods/explanation.md",
    "methods/faults.md",
    "methods/goodness-of-fit.md",
    "methods/identification.md",
    "methods/influence.md",
    "methods/interim.md",
    "methods/lines.md",
    "methods/lots.md",
    "methods/noise-model.md",
    "methods/numerical-range.md",
    "methods/output-noise.md",
    "methods/rate-table.md",
    "methods/rounding.md",
    "methods/russian-values.md",
    "methods/start-up.md",
    "methods/static-bias.md",
    "methods/temperature.md",
    "methods/transfer-function.md",
    "methods/uncertainty-budget.md",
];

/// Weight of a word in a heading against one in the text.
const HEADING_WEIGHT: usize = 8;
/// Shortest beginning of a word that stands for it.
const MIN_STEM: usize = 3;

impl Page {
    /// Its name: the path without folder and ending.
    pub fn name(&self) -> &'static str {
        let file = self.path.rsplit('/').next().unwrap_or(self.path);
        file.strip_suffix(".md").unwrap_or(file)
    }

    /// Its title: the first heading.
    pub fn title(&self) -> &'static str {
        self.text.lines().find_map(|line| line.strip_prefix("# ")).unwrap_or(self.path)
    }

    /// Its sections, each from its heading to the next.
    fn sections(self) -> Vec<Section> {
        let mut starts = vec![];
        let (mut place, mut in_code) = (0, false);
        for line in self.text.split_inclusive('\n') {
            in_code ^= line.starts_with("```");
            if !in_code && line.starts_with('#') {
                starts.push(place);
            }
            place += line.len();
        }
        let ends = starts.iter().skip(1).copied().chain([self.text.len()]);
        let section = |(start, end): (usize, usize)| {
            let text = self.text.get(start..end)?;
            let heading = text.lines().next()?.trim_start_matches('#').trim();
            Some(Section { page: self, heading, text: text.trim_end() })
        };
        starts.iter().copied().zip(ends).filter_map(section).collect()
    }
}

/// A section of a document.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Section {
    /// Its document.
    pub page: Page,
    /// Its heading.
    pub heading: &'static str,
    /// Heading and text, Markdown.
    pub text: &'static str,
}

/// The document of a name or a path; `None` where there is none.
pub fn page(name: &str) -> Option<Page> {
    let named = |p: &&Page| p.name() == name || p.path == name || p.path.strip_suffix(".md") == Some(name);
    PAGES.iter().find(named).copied()
}

/// Sections that have every word, or words that begin with it, the best first: words in headings count more.
pub fn search(words: &[String]) -> Vec<Section> {
    let wanted: BTreeSet<String> = words.iter().flat_map(|w| parts(w)).collect();
    if wanted.is_empty() {
        return vec![];
    }
    let mut found: Vec<(usize, Section)> = PAGES
        .iter()
        .flat_map(|page| page.sections())
        .filter_map(|section| {
            let in_text = parts(section.text);
            let in_heading: Vec<String> =
                parts(section.heading).into_iter().chain(parts(section.page.title())).collect();
            let weight = |word: &String| {
                let count = |of: &[String]| of.iter().filter(|w| stands_for(word, w)).count();
                Some(count(&in_text) + HEADING_WEIGHT * count(&in_heading)).filter(|n| *n > 0)
            };
            let weights: Option<Vec<usize>> = wanted.iter().map(weight).collect();
            // A long section has each word more often.
            Some((1000 * weights?.iter().min()? / (20 + in_text.len()), section))
        })
        .collect();
    found.sort_by_key(|(weight, _)| std::cmp::Reverse(*weight));
    found.into_iter().map(|(_, section)| section).collect()
}

/// True where a word of a question stands for a word of a text.
fn stands_for(asked: &str, word: &str) -> bool {
    word == asked || (asked.chars().count() >= MIN_STEM && word.starts_with(asked))
}

/// Words of a text in small letters.
fn parts(text: &str) -> Vec<String> {
    let is_part = |c: char| c.is_alphanumeric() || c == '_';
    text.split(|c| !is_part(c)).filter(|w| !w.is_empty()).map(str::to_lowercase).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(question: &str) -> Vec<(&'static str, &'static str)> {
        let words: Vec<String> = question.split(' ').map(str::to_owned).collect();
        search(&words).iter().map(|s| (s.page.path, s.heading)).collect()
    }

    #[test]
    fn a_question_finds_the_section_that_answers_it() {
        assert_eq!(found("two loggers").first().map(|f| f.0), Some("cookbook.md"));
        assert_eq!(found("maximum rate").first().map(|f| f.0), Some("guide/rate-table.md"));
        assert!(found("hook").iter().take(3).any(|f| f.0 == "guide/watch.md"));
        assert!(found("markov").iter().any(|f| f.0.starts_with("methods/")));
    }

    #[test]
    fn every_word_is_needed_and_none_finds_nothing() {
        assert!(found("hook").len() > found("hook mail").len());
        assert!(found("xyzzy").is_empty() && found("hook xyzzy").is_empty() && found("").is_empty());
    }

    #[test]
    fn a_line_of_code_begins_no_section() {
        let text = "# A\n\n```sh\n# no heading\n```\n\n## B\nb\n";
        let page = Page { path: "a.md", text };
        let headings: Vec<&str> = page.sections().iter().map(|s| s.heading).collect();
        assert_eq!(headings, ["A", "B"]);
    }

    #[test]
    fn every_page_for_users_is_carried() {
        let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("docs");
        for folder in ["guide", "methods"] {
            for entry in std::fs::read_dir(root.join(folder)).unwrap() {
                let name = format!("{folder}/{}", entry.unwrap().file_name().to_string_lossy());
                assert!(name == "methods/README.md" || page(&name).is_some(), "{name}");
            }
        }
        assert!(PAGES.iter().all(|p| p.title() != p.path), "a page without a title");
    }
}
