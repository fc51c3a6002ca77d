//! The document of a comparison: Russian beside Allan figures of units, with what explains each ratio, or the published tables.

mod columns;
mod laboratories;
mod published;
mod unit;

use super::document::{Documented, Record};
use super::number::date_time;
use super::page::{self, Block, Head, Page};
use super::translator::Translator;
use crate::acceptance::compare::Comparison;
use crate::figure::Figure;
use crate::i18n::Lang;
use crate::output::Kind;

impl Documented for Comparison {
    fn record(&self) -> Record<'_> {
        Record::Comparison(self)
    }

    fn kind(&self) -> Kind {
        Kind::Comparison
    }

    fn subject(&self) -> Option<&str> {
        None
    }

    fn made_at(&self) -> &str {
        &self.compared_at
    }

    fn program_version(&self) -> Option<&str> {
        Some(&self.program.version)
    }

    fn page(&self, figures: &[Figure], lang: Lang) -> Page {
        pages(self, figures, Translator { lang })
    }

    /// The figures of each unit in a row, what is said of each, and the limits.
    fn on_terminal(&self, lang: Lang) -> Vec<Block> {
        let words = Translator { lang };
        let of_laboratories = self.laboratories.as_ref().map(|l| laboratories::on_terminal(l, words));
        let rest = match &self.published {
            Some(checked) => published::on_terminal(checked, words),
            None if self.units.is_empty() => vec![],
            None => unit::on_terminal(&self.units, words),
        };
        of_laboratories.into_iter().flatten().chain(rest).collect()
    }
}

/// `comparison.csv`: one row a unit or a published device, plain numbers, empty where there is none; the same in every language.
pub fn csv(comparison: &Comparison) -> String {
    let words = Translator { lang: Lang::En };
    page::csv(&match &comparison.published {
        Some(checked) => published::table(checked, words),
        None => columns::table(&comparison.units, words),
    })
}

/// `agreement.csv`: one row for each quantity that two results of one unit have; `None` for other comparisons.
pub fn agreement_csv(comparison: &Comparison) -> Option<String> {
    let words = Translator { lang: Lang::En };
    Some(page::csv(&laboratories::table(comparison.laboratories.as_ref()?, words)))
}

fn pages(comparison: &Comparison, figures: &[Figure], words: Translator) -> Page {
    let generator = format!("{} {}", comparison.program.name, comparison.program.version);
    let of_laboratories = comparison.laboratories.as_ref();
    let title = of_laboratories.map_or_else(|| words.t("compare.title"), |l| laboratories::title(l, words));
    let head = Head { kind: words.t("compare.kind"), title: title.clone(), ..Head::default() };
    let of_laboratories = of_laboratories.map_or_else(Vec::new, |l| laboratories::blocks(l, words));
    let units = Some(&comparison.units).filter(|units| !units.is_empty());
    let units = units.map_or_else(Vec::new, |units| unit::blocks(units, figures, words));
    let published = comparison.published.as_ref();
    let published = published.map_or_else(Vec::new, |checked| published::blocks(checked, words));
    Page {
        title,
        footer: format!("{} · {generator}", date_time(&comparison.compared_at)),
        blocks: std::iter::once(Block::Head(head))
            .chain(of_laboratories)
            .chain(units)
            .chain(published)
            .collect(),
        generator,
    }
}
