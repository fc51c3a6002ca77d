//! A template of the user in place of a built-in one.
#![no_main]

use libfuzzer_sys::fuzz_target;
use sagnac::i18n::Lang;
use sagnac::report::{Renderer, render_html};

fuzz_target!(|text: &str| {
    let Ok(folder) = tempfile::tempdir() else { return };
    if std::fs::write(folder.path().join("signoff.html"), text).is_err() {
        return;
    }
    let Ok(renderer) = Renderer::with_overrides(folder.path()) else { return };
    let (record, figures) = sagnac_fuzz::sample();
    let _ = render_html(record, figures, Lang::En, &renderer);
});
