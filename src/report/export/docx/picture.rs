//! Figures inside a document.

use super::super::xml::{Xml, empty, node};
use crate::figure::Figure;
use crate::i18n::Lang;
use crate::report::svg::{self, Canvas, Drawing};
use std::io;

/// Widest and highest figure, mm.
const WIDTH_MM: f64 = 170.0;
const HEIGHT_MM: f64 = 215.0;

/// English metric units in a millimetre, in which sizes are stated.
const EMU_PER_MM: f64 = 36_000.0;

/// Namespace of drawings.
const DRAWING: &str = "http://schemas.openxmlformats.org/drawingml/2006/main";
/// Namespace of pictures, which also says that a drawing is one.
const PICTURE: &str = "http://schemas.openxmlformats.org/drawingml/2006/picture";
/// The extension by which word processors since 2016 draw SVG.
const SVG_EXTENSION: &str = "{96DAC541-7B7A-43D3-8B79-37D633B846F1}";
const SVG_NAMESPACE: &str = "http://schemas.microsoft.com/office/drawing/2016/SVG/main";

/// A figure as it is drawn on the page of a document.
pub(super) fn drawing(figure: &Figure, lang: Lang) -> Drawing {
    svg::draw(figure, Canvas::Paper { width_mm: WIDTH_MM }, lang)
}

/// A paragraph with a picture: the number of its drawing, counted from 1, its text for those who do not see it, and its size in mm.
pub(super) fn picture(
    xml: &mut Xml,
    number: usize,
    title: &str,
    (width, height): (f64, f64),
) -> io::Result<()> {
    let scale = (HEIGHT_MM / height).min(1.0);
    let emu = |mm: f64| format!("{:.0}", mm * scale * EMU_PER_MM);
    let (across, down) = (emu(width), emu(height));
    let (id, relation) = (number.to_string(), relation(number));
    let size = [("cx", across.as_str()), ("cy", down.as_str())];
    let named = [("id", id.as_str()), ("name", relation.as_str()), ("descr", title)];
    let inline = [("distT", "0"), ("distB", "0"), ("distL", "0"), ("distR", "0")];
    node(xml, "w:p", &[], |xml| {
        node(xml, "w:pPr", &[], |xml| empty(xml, "w:pStyle", &[("w:val", "Figure")]))?;
        node(xml, "w:r", &[], |xml| {
            node(xml, "w:drawing", &[], |xml| {
                node(xml, "wp:inline", &inline, |xml| {
                    empty(xml, "wp:extent", &size)?;
                    empty(xml, "wp:docPr", &named)?;
                    node(xml, "a:graphic", &[("xmlns:a", DRAWING)], |xml| {
                        node(xml, "a:graphicData", &[("uri", PICTURE)], |xml| {
                            node(xml, "pic:pic", &[("xmlns:pic", PICTURE)], |xml| {
                                node(xml, "pic:nvPicPr", &[], |xml| {
                                    empty(xml, "pic:cNvPr", &named)?;
                                    empty(xml, "pic:cNvPicPr", &[])
                                })?;
                                fill(xml, &relation)?;
                                shape(xml, &size)
                            })
                        })
                    })
                })
            })
        })
    })
}

/// The drawing of a picture: as SVG for those that know the extension, and as the picture itself.
fn fill(xml: &mut Xml, relation: &str) -> io::Result<()> {
    node(xml, "pic:blipFill", &[], |xml| {
        node(xml, "a:blip", &[("r:embed", relation)], |xml| {
            node(xml, "a:extLst", &[], |xml| {
                node(xml, "a:ext", &[("uri", SVG_EXTENSION)], |xml| {
                    empty(xml, "asvg:svgBlip", &[("xmlns:asvg", SVG_NAMESPACE), ("r:embed", relation)])
                })
            })
        })?;
        node(xml, "a:stretch", &[], |xml| empty(xml, "a:fillRect", &[]))
    })
}

fn shape(xml: &mut Xml, size: &[(&str, &str)]) -> io::Result<()> {
    node(xml, "pic:spPr", &[], |xml| {
        node(xml, "a:xfrm", &[], |xml| {
            empty(xml, "a:off", &[("x", "0"), ("y", "0")])?;
            empty(xml, "a:ext", size)
        })?;
        node(xml, "a:prstGeom", &[("prst", "rect")], |xml| empty(xml, "a:avLst", &[]))
    })
}

/// Name by which a document knows a drawing.
pub(super) fn relation(number: usize) -> String {
    format!("figure{number}")
}
