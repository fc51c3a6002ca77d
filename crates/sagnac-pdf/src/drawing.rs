//! One drawing on paper of its own size, as PDF and as PNG.

use crate::fonts::{FONT_FAMILIES, FONT_FILES};
use crate::markup::string;
use crate::world::InMemory;
use crate::{PdfError, said};
use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{Options, Tree};
use typst::diag::Warned;
use typst::foundations::Smart;
use typst_layout::PagedDocument;
use typst_pdf::PdfOptions;

/// A drawing and its size on paper.
#[derive(Debug, Clone, Copy)]
pub struct Drawing<'a> {
    /// SVG.
    pub svg: &'a str,
    /// Width and height, mm.
    pub size_mm: (f64, f64),
    /// Title of the document, and what those read who do not see it.
    pub title: &'a str,
}

/// Name of the drawing in its document.
const DRAWING_FILE: &str = "drawing.svg";

const MM_PER_INCH: f64 = 25.4;

/// The drawing as a PDF of one page, with the letters of the shipped fonts embedded.
///
/// # Errors
/// [`PdfError`] with what the typesetter says of it.
pub fn drawing_as_pdf(drawing: &Drawing<'_>) -> Result<Vec<u8>, PdfError> {
    let (width, height) = drawing.size_mm;
    let families: Vec<String> = FONT_FAMILIES.iter().map(|f| string(f)).collect();
    let title = string(drawing.title);
    let document = format!(
        "#set document(title: {title}, date: none)\n\
         #set page(width: {width}mm, height: {height}mm, margin: 0pt)\n\
         #set text(font: ({}), fallback: false)\n\
         #image({}, width: 100%, height: 100%, fit: \"stretch\", alt: {title})\n",
        families.join(", "),
        string(DRAWING_FILE),
    );
    let world = InMemory::new(document, std::iter::once((DRAWING_FILE, drawing.svg.as_bytes())));
    let Warned { output, .. } = typst::compile::<PagedDocument>(&world);
    let document = output.map_err(|errors| said(&errors))?;
    let options = PdfOptions {
        // The same drawing gives the same bytes.
        ident: Smart::Custom(drawing.title.to_owned()),
        creator: Smart::Custom(Some("sagnac".into())),
        ..PdfOptions::default()
    };
    let bytes = typst_pdf::pdf(&document, &options).map_err(|errors| said(&errors));
    comemo::evict(1);
    bytes
}

/// The drawing as PNG of a resolution, in the shipped fonts.
///
/// # Errors
/// [`PdfError`] where it is no drawing, or too large for one picture.
pub fn drawing_as_png(drawing: &Drawing<'_>, dots_per_inch: f64) -> Result<Vec<u8>, PdfError> {
    let mut options = Options::default();
    let fonts = options.fontdb_mut();
    FONT_FILES.iter().for_each(|file| fonts.load_font_data(file.to_vec()));
    fonts.set_sans_serif_family(FONT_FAMILIES[0]);
    let failed = |e: &dyn std::fmt::Display| PdfError(vec![e.to_string()]);
    let tree = Tree::from_str(drawing.svg, &options).map_err(|e| failed(&e))?;
    let scale = (drawing.size_mm.0 / MM_PER_INCH * dots_per_inch) as f32 / tree.size().width();
    let dots = |px: f32| (px * scale).round() as u32;
    let (width, height) = (dots(tree.size().width()), dots(tree.size().height()));
    let mut picture = Pixmap::new(width, height).ok_or_else(|| failed(&format!("{width} × {height}")))?;
    resvg::render(&tree, Transform::from_scale(scale, scale), &mut picture.as_mut());
    picture.encode_png().map_err(|e| failed(&e))
}

#[cfg(test)]
mod tests {
    use super::*;

    const SQUARE: Drawing<'_> = Drawing {
        svg: "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"50.8mm\" height=\"25.4mm\" viewBox=\"0 0 192 96\" \
              font-family=\"system-ui, sans-serif\"><text x=\"10\" y=\"60\" font-size=\"50\">σ(τ)</text></svg>",
        size_mm: (50.8, 25.4),
        title: "Drawing",
    };

    #[test]
    fn a_picture_has_its_size_and_its_letters() {
        let png = drawing_as_png(&SQUARE, 100.0).unwrap();
        let picture = Pixmap::decode_png(&png).unwrap();
        assert_eq!((picture.width(), picture.height()), (200, 100));
        let black = picture.pixels().iter().filter(|p| p.alpha() > 200).count();
        assert!(black > 300, "{black}");
    }

    #[test]
    fn a_document_has_one_page_of_the_size() {
        let pdf = drawing_as_pdf(&SQUARE).unwrap();
        let document = lopdf::Document::load_mem(&pdf).unwrap();
        let pages: Vec<_> = document.get_pages().into_values().collect();
        let [page] = pages[..] else { panic!("{pages:?}") };
        let corners = document.get_dictionary(page).unwrap().get(b"MediaBox").unwrap().as_array().unwrap();
        let corners: Vec<f32> = corners.iter().map(|c| c.as_float().unwrap().round()).collect();
        // 50.8 mm are 144 pt.
        assert_eq!(corners, [0.0, 0.0, 144.0, 72.0]);
        assert_eq!(drawing_as_pdf(&SQUARE).unwrap(), pdf);
    }
}
