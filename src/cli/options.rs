//! Options that several verbs have.

use super::place;
use crate::i18n::{Lang, Note};
use crate::noise::tau_grid::TauGrid;
use crate::report::Renderer;
use clap::Args;
use std::path::Path;

/// Choice of the averaging times.
#[derive(Debug, Args)]
pub struct GridArgs {
    /// Averaging times: octave, decade, all, or a list in seconds (1,10,100), each a multiple of the sample interval
    #[arg(long, value_name = "GRID")]
    pub taus: Option<String>,
    /// Sum every overlapping term at any length (8 bytes of memory per sample)
    #[arg(long)]
    pub exact: bool,
}

impl GridArgs {
    /// The averaging times asked for.
    ///
    /// # Errors
    /// The diagnostic, in words.
    pub fn grid(&self, lang: Lang) -> Result<Option<TauGrid>, String> {
        self.taus.as_deref().map(str::parse::<TauGrid>).transpose().map_err(|e| {
            let note = Note::new("cli.of_option").with("option", "--taus").with("what", e.note());
            place::error(&note, lang)
        })
    }
}

/// The renderer with the user's templates, if any.
///
/// # Errors
/// The diagnostic, in words.
pub fn renderer(templates: Option<&Path>, lang: Lang) -> Result<Renderer, String> {
    templates
        .map_or_else(|| Ok(Renderer::new()), Renderer::with_overrides)
        .map_err(|e| place::error(&e.note(), lang))
}
