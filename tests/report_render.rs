//! Reports of invented runs: what must stand in them, and that nothing breaks out of them.

mod report_fixture;

use report_fixture as fixture;
use sagnac::report::{Renderer, render_html, render_markdown, write_figures};
use sagnac::text::Lang;
use std::path::Path;

fn html(record: &sagnac::record::RunRecord) -> String {
    render_html(record, &fixture::figures::all(), Lang::En, &Renderer::new()).unwrap()
}

#[test]
#[ignore = "writes the reports for the eye into the target folder"]
fn write_reports_for_the_eye() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("reports");
    std::fs::create_dir_all(folder.join("figures")).unwrap();
    let figures = fixture::figures::all();
    for (name, record) in [
        ("pass", fixture::pass()),
        ("three", fixture::three_channels()),
        ("error", fixture::error()),
        ("indeterminate", fixture::indeterminate()),
        ("analysis", fixture::analysis()),
    ] {
        let shown = if record.figures.is_empty() { &figures[..0] } else { &figures[..] };
        let html = render_html(&record, shown, Lang::En, &Renderer::new()).unwrap();
        std::fs::write(folder.join(format!("{name}.html")), html).unwrap();
        let md = render_markdown(&record, shown, Lang::En, &Renderer::new()).unwrap();
        std::fs::write(folder.join(format!("{name}.md")), md).unwrap();
    }
    write_figures(&folder.join("figures"), &figures, Lang::En).unwrap();
    assert!(folder.join("figures/sigma_tau.svg").is_file());
}

#[test]
fn an_html_report_is_whole() {
    let html = html(&fixture::pass());
    assert!(html.contains("F501-0417"));
}
