//! The fonts that are embedded, and what they can show.

use std::sync::LazyLock;
use typst::foundations::Bytes;
use typst::text::{Font, FontBook};
use typst::utils::LazyHash;

/// Families in the order in which a letter is looked for.
pub const FONT_FAMILIES: [&str; 3] = ["Noto Sans", "Noto Sans Math", "Noto Sans Symbols2"];

/// The files of the fonts.
pub static FONT_FILES: [&[u8]; 6] = [
    include_bytes!("../fonts/NotoSans-Regular.ttf"),
    include_bytes!("../fonts/NotoSans-Bold.ttf"),
    include_bytes!("../fonts/NotoSans-Italic.ttf"),
    include_bytes!("../fonts/NotoSans-BoldItalic.ttf"),
    include_bytes!("../fonts/NotoSansMath-Regular.ttf"),
    include_bytes!("../fonts/NotoSansSymbols2-Regular.ttf"),
];

/// The fonts.
pub static SHIPPED_FONTS: LazyLock<Vec<Font>> =
    LazyLock::new(|| FONT_FILES.iter().flat_map(|file| Font::iter(Bytes::new(*file))).collect());

/// Their names and what each can show.
pub static FONT_BOOK: LazyLock<LazyHash<FontBook>> =
    LazyLock::new(|| LazyHash::new(FontBook::from_fonts(SHIPPED_FONTS.iter())));

/// The text with every character that no font shows in its place written as its number, such as `[U+4E2D]`: an archived
/// document must not have signs that nobody can read. Controls are left out.
pub fn shown(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '\n' | '\t' => out.push(' '),
            c if c.is_control() => {}
            c if SHIPPED_FONTS.iter().any(|f| f.info().coverage.contains(u32::from(c))) => out.push(c),
            c => out.push_str(&format!("[U+{:04X}]", u32::from(c))),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_the_reports_use_is_shown_as_it_is() {
        let text =
            "Угловое случайное блуждание № 1: N = 0,0012 °/√ч ± 3σ, τ ≤ 100 с; ☐ ½ ⁻¹ ₀ → ∞ − × · „ “ …";
        assert_eq!(shown(text), text);
    }

    #[test]
    fn what_no_font_has_is_named_by_its_number() {
        assert_eq!(shown("SN\u{4E2D}\u{0}1"), "SN[U+4E2D]1");
    }

    #[test]
    fn every_family_is_there() {
        for family in FONT_FAMILIES {
            assert!(FONT_BOOK.contains_family(&family.to_lowercase()), "{family}");
        }
    }
}
