//! `sagnac figure`: figures of results for papers.

use crate::support::shared::{SharedRun, tested_once};
use crate::support::{Said, sagnac};
use sagnac::report::pdf::MAKES_PDF;
use std::path::Path;
use tempfile::tempdir;

fn drawn(folder: &Path, results: &[&SharedRun], more: &[&str]) -> Said {
    let results = results.iter().map(|r| r.path());
    let args: Vec<&str> =
        ["figure"].into_iter().chain(results).chain(["--lang", "en"]).chain(more.iter().copied()).collect();
    sagnac(folder, &args)
}

/// The entries of the legend, from the description of the drawing: `ordinate / abscissa: entry; entry`.
fn legend(svg: &str) -> Vec<&str> {
    let description =
        svg.split("-desc\">").nth(1).and_then(|d| d.split("</desc>").next()).expect("a description");
    description.split_once(": ").expect("entries").1.split("; ").collect()
}

#[test]
fn a_figure_has_the_width_of_a_column_and_a_short_legend() {
    let dir = tempdir().unwrap();
    let said = drawn(dir.path(), &[tested_once("pass")], &["sigma-tau"]);
    assert_eq!((said.code, said.err.as_str()), (0, ""), "{said:?}");
    assert!(said.out.contains("width=\"85mm\""), "{}", &said.out[..300]);
    assert_eq!(legend(&said.out), ["fitted model", "σ(τ), overlapping", "limit"]);
    assert!(!said.out.contains("font-weight"), "the title is set by the paper");
    let all = "data,intervals,model,terms,limits,reference,muted,labels";
    let whole = drawn(dir.path(), &[tested_once("pass")], &["sigma-tau", "--layers", all]);
    assert!(legend(&whole.out).len() > legend(&said.out).len(), "{:?}", legend(&whole.out));
}

#[test]
fn words_keep_their_size_at_every_width() {
    let dir = tempdir().unwrap();
    for (width, px) in [("85mm", "321.3"), ("17cm", "642.5")] {
        let svg = drawn(dir.path(), &[tested_once("pass")], &["sigma-tau", "--width", width]).out;
        assert!(svg.contains(&format!("viewBox=\"0 0 {px} ")), "{width}: {}", &svg[..300]);
        assert!(svg.contains("font-size=\"12\""), "{width}");
    }
}

#[test]
fn records_share_a_figure_each_with_its_entry() {
    let dir = tempdir().unwrap();
    let both = [tested_once("pass"), tested_once("fail")];
    let svg = drawn(dir.path(), &both, &["sigma-tau", "--label", "Unit A", "--label", "Unit B"]).out;
    let entries = legend(&svg);
    assert!(entries.contains(&"Unit A") && entries.contains(&"Unit B"), "{entries:?}");
    // Their limits are the same and stand once.
    assert_eq!(entries.iter().filter(|e| e.contains("limit")).count(), entries.len() - 2, "{entries:?}");
    let one_too_many = ["sigma-tau", "--label", "1", "--label", "2", "--label", "3"];
    assert_eq!(drawn(dir.path(), &both, &one_too_many).code, 2);
}

#[test]
fn an_ordinate_is_shown_in_another_unit_or_as_a_random_walk() {
    let dir = tempdir().unwrap();
    let title = |unit: &str| drawn(dir.path(), &[tested_once("pass")], &["sigma-tau", "--unit", unit]);
    assert!(title("deg/s").out.contains("°/s"));
    assert!(title("deg/sqrt(h)").out.contains("σ(τ)·√τ, °/√h"));
    let said = title("degC");
    assert!(said.code == 2 && said.err.contains("degC") && said.err.contains("deg/h"), "{said:?}");
}

#[test]
fn a_file_is_written_with_its_caption_and_in_its_format() {
    let dir = tempdir().unwrap();
    let said = drawn(dir.path(), &[tested_once("pass")], &["spectrum", "--out", "s.svg"]);
    assert_eq!(said.code, 0, "{said:?}");
    assert!(said.out.starts_with("s.svg\nSpectrum of the rate. "), "{}", said.out);
    for (format, start) in [("pdf", "%PDF"), ("png", "\u{89}PNG")] {
        let name = format!("f.{format}");
        let said = drawn(dir.path(), &[tested_once("pass")], &["sigma-tau", "--out", &name]);
        let written = std::fs::read(dir.path().join(&name));
        if MAKES_PDF {
            let bytes = written.unwrap();
            let first: String = bytes.iter().take(4).map(|b| char::from(*b)).collect();
            assert_eq!((said.code, first.as_str()), (0, start), "{said:?}");
        } else {
            assert!(said.code == 2 && said.err.contains("--format svg") && written.is_err(), "{said:?}");
        }
    }
}

#[test]
fn what_cannot_be_drawn_is_refused_with_what_can() {
    let dir = tempdir().unwrap();
    for (more, fragment) in [
        (&["dead-zone"][..], "sigma-tau"),
        (&["sigma-tau", "--width", "85"], "85mm"),
        (&["sigma-tau", "--layers", "reference", "--unit", "furlong"], "--unit"),
        (&["no-such-figure"], "sigma-tau"),
    ] {
        let said = drawn(dir.path(), &[tested_once("pass")], more);
        assert!(said.code == 2 && said.err.contains(fragment), "{more:?}: {said:?}");
    }
}
