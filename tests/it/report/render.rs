//! Reports of invented runs: what must stand in them, and that nothing breaks out of them.

use crate::report::fixture;
use sagnac::estimate::Rule;
use sagnac::i18n::Lang;
use sagnac::record::{RunKind, RunRecord};
use sagnac::report::{Renderer, ReportError, render_html, render_markdown, write_figures};
use std::path::Path;

fn html(record: &RunRecord) -> String {
    render_html(record, &fixture::figures::all(), Lang::En, &Renderer::new()).unwrap()
}

fn markdown(record: &RunRecord) -> String {
    render_markdown(record, &fixture::figures::all(), Lang::En, &Renderer::new()).unwrap()
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
fn both_forms_say_the_same() {
    for record in [fixture::pass(), fixture::three_channels(), fixture::indeterminate(), fixture::analysis()]
    {
        let (html, md) = (html(&record), markdown(&record));
        for shown in [
            "F501-0417",
            "2026-11-20 16:42:07 UTC",
            "0.002315",
            "0.002296 … 0.002334",
            "≤ 0.000512 (95 %)",
            "9f86d081884c7d659a2feaa0c55ad015a3bf4f1b2b0b822cd15d6c15b0f00a08",
            "0.08330",
            "9\u{202f}h 29\u{202f}min 59\u{202f}s",
            "Overlapping Allan deviation with its 95 % band",
        ] {
            assert!(html.contains(shown), "HTML lacks {shown}");
            assert!(md.contains(shown), "Markdown lacks {shown}");
        }
        // Nothing is decided by an analysis, and nothing is signed.
        let is_signed = record.kind == RunKind::Run;
        assert_eq!([&html, &md].map(|page| page.contains("Reviewed by")), [is_signed; 2]);
        assert_eq!(html.contains("class=\"verdict"), is_signed);
        assert_eq!(html.matches("<svg ").count(), 5);
        assert!(md.contains("](figures/sigma_tau.svg)"));
    }
}

#[test]
fn the_verdict_leads_and_errors_come_first() {
    let html = html(&fixture::error());
    let verdict = html.find("<strong>error</strong>").unwrap();
    let errors = html.find(">Errors<").unwrap();
    let identity = html.find(">Unit, procedure, session<").unwrap();
    assert!(verdict < errors && errors < identity);
    assert!(html.contains("<dt>Serial number</dt><dd>missing</dd>"));
    assert!(html.contains("12\u{202f}345"));
    let pass = markdown(&fixture::pass());
    assert!(
        pass.starts_with("# Static test: bias and noise at rest\n\n**Verdict: PASS**"),
        "{}",
        &pass[..80]
    );
}

#[test]
fn a_failed_row_and_its_waiver_stand_side_by_side() {
    let html = html(&fixture::three_channels());
    assert!(html.contains("class=\"mark fail\">fail</span>"));
    assert!(html.contains("Chief inspector") && html.contains("<strong>fail</strong>"));
    assert!(html.contains("> 99.99\u{202f}%") || html.contains("&gt; 99.99\u{202f}%"));
    assert!(html.contains("0.0123 … 0.0345\u{202f}Hz"), "the band of the misfit is shown");
}

#[test]
fn limits_are_shown_with_every_digit_and_rules_when_they_differ() {
    let mut record = fixture::pass();
    let shared = html(&record);
    assert!(shared.contains("Decision rule for all rows: guard band, risk 5\u{202f}%."));
    let limit = record.measurands[1].limit.as_mut().unwrap();
    limit.max = Some(0.002_999_987);
    limit.rule = Rule::Simple;
    let html = html(&record);
    assert!(html.contains("≤\u{202f}0.002999987<small>simple acceptance</small>"));
    assert!(!html.contains("Decision rule for all rows"));
}

#[test]
fn nothing_breaks_out_of_the_report() {
    let evil = "</style></title><script>alert(1)</script><img src=x onerror=alert(1)>\"'|\n# x `y` [z](javascript:1)";
    let mut record = fixture::three_channels();
    record.unit_under_test.serial = Some(evil.into());
    record.session.operator = Some(evil.into());
    record.recording[0].path = evil.into();
    record.measurands[0].channel = evil.into();
    record.integrity.faults[0].seen.note = evil.into();
    let mut figures = fixture::figures::all();
    figures[1].id = evil.into();
    figures[1].channel = evil.into();
    let html = render_html(&record, &figures, Lang::En, &Renderer::new()).unwrap();
    // The one script is that of the page, which its policy names by its digest.
    assert!(
        html.matches("<script").count() == 1 && !html.contains("alert(1)</script>") && !html.contains("<img")
    );
    assert!(!html.split("</script>").nth(1).unwrap().contains("<script"));
    assert_eq!(html.matches("</style>").count(), 1);
    let md = render_markdown(&record, &figures, Lang::En, &Renderer::new()).unwrap();
    assert!(!md.contains("<script") && !md.contains("\n# x"));
    assert!(md.contains("\\[z\\](javascript:1)") && !md.contains("[z](javascript:1)"));
    // Every line of a table has as many cells as its head.
    let bars = |line: &str| line.replace("\\\\", "").replace("\\|", "").matches('|').count();
    let lines: Vec<&str> = md.lines().collect();
    for pair in lines.windows(2) {
        if pair[0].starts_with('|') && pair[1].starts_with('|') {
            assert_eq!(bars(pair[0]), bars(pair[1]), "{}\n{}", pair[0], pair[1]);
        }
    }
}

#[test]
fn a_folder_replaces_templates_by_name() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("signoff.html"), "<p>Signed for {{ run.unit_under_test.serial }}: {{ run.measurands[1].value | digits(3) }} {{ 'deg/h' | unit }}; {{ run.summary[0] | say }}</p>{% include 'extra.html' %}").unwrap();
    std::fs::write(folder.path().join("extra.html"), "<p>Extra</p>").unwrap();
    let renderer = Renderer::with_overrides(folder.path()).unwrap();
    let html = render_html(&fixture::pass(), &[], Lang::En, &renderer).unwrap();
    assert!(html.contains("<p>Signed for F501-0417: 0.00231 °/h; The worst row decides"), "{html}");
    assert!(html.contains("<p>Extra</p>") && !html.contains("Reviewed by"));
}

#[test]
fn a_wrong_template_is_named_with_its_line() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("other.html"), "x").unwrap();
    let error = Renderer::with_overrides(folder.path()).unwrap_err();
    assert!(
        matches!(&error, ReportError::NothingReplaced { names, .. } if names.contains("report.md")),
        "{error}"
    );
    std::fs::write(folder.path().join("report.md"), "fine\n{% if %}").unwrap();
    let error = Renderer::with_overrides(folder.path()).unwrap_err();
    assert!(error.to_string().starts_with("template `report.md`, line 2: "), "{error}");
    std::fs::write(folder.path().join("report.md"), "fine\n\n{{ v.nothing.here }}").unwrap();
    let renderer = Renderer::with_overrides(folder.path()).unwrap();
    let error = render_markdown(&fixture::pass(), &[], Lang::En, &renderer).unwrap_err();
    assert!(error.to_string().starts_with("template `report.md`, line 3: "), "{error}");
    assert!(matches!(Renderer::with_overrides(&folder.path().join("none")), Err(ReportError::Io { .. })));
}

#[test]
fn a_record_of_nothing_still_makes_a_report() {
    let mut record = fixture::error();
    record.procedure = None;
    record.recording = vec![];
    record.conditions = vec![];
    record.instruments = vec![];
    record.clauses = vec![];
    record.options = vec![];
    record.window = Default::default();
    let html = render_html(&record, &[], Lang::En, &Renderer::new()).unwrap();
    assert!(html.contains("<strong>error</strong>") && !html.contains("Nothing was excluded."));
    assert!(!html.contains("NaN") && !html.contains("None"));
}

#[test]
fn odd_numbers_and_many_faults_read_well() {
    let mut record = fixture::pass();
    for (row, value) in record.measurands.iter_mut().zip([f64::NAN, f64::INFINITY, 5e-324, f64::MAX]) {
        row.value = Some(value);
        row.margin = Some(-value);
        row.specific_risk = Some(value);
    }
    record.window.to_s = f64::NAN;
    record.lines[0].frequency_hz = 0.0;
    let one = record.integrity.faults[0].clone();
    record.integrity.faults = vec![one; 100];
    for text in [html(&record), markdown(&record)] {
        assert!(!text.contains("NaN") && !text.contains(">inf") && !text.contains(" inf "));
        assert!(text.contains("10 of 100 listed faults are shown"));
        assert_eq!(text.matches("8.1 robust standard deviations from the median").count(), 10);
    }
}

#[test]
fn the_markdown_report_is_as_it_was() {
    insta::assert_snapshot!("three_channels_markdown", markdown(&fixture::three_channels()));
}

#[test]
fn the_figure_is_as_it_was() {
    let svg = sagnac::report::svg::render(&fixture::figures::sigma_tau(), Lang::En);
    insta::assert_snapshot!("sigma_tau_svg", svg);
}

/// A text of a figure: left, right, baseline, size, words.
fn texts(svg: &str) -> Vec<(f64, f64, f64, f64, String)> {
    let attribute = |line: &str, name: &str| {
        let from = line.find(&format!(" {name}=\"")).map(|i| i + name.len() + 3)?;
        line[from..].split('"').next().map(str::to_owned)
    };
    svg.lines()
        .filter(|l| l.starts_with("<text") && !l.contains("rotate"))
        .map(|l| {
            let number = |name| attribute(l, name).unwrap().parse::<f64>().unwrap();
            let words = l.split('>').nth(1).unwrap().trim_end_matches("</text").to_owned();
            let (x, size) = (number("x"), number("font-size"));
            let width = 0.52 * size * words.chars().count() as f64;
            let left = match attribute(l, "text-anchor").as_deref() {
                Some("middle") => x - 0.5 * width,
                Some("end") => x - width,
                _ => x,
            };
            (left, left + width, number("y"), size, words)
        })
        .collect()
}

#[test]
fn no_words_of_a_figure_overlap_or_leave_it() {
    for figure in fixture::figures::all() {
        let svg = sagnac::report::svg::render(&figure, Lang::En);
        let texts = texts(&svg);
        assert!(texts.len() > 8, "{}", figure.id);
        for (i, a) in texts.iter().enumerate() {
            assert!(a.0 >= -0.5 && a.1 <= 760.5, "{}: {a:?}", figure.id);
            for b in &texts[i + 1..] {
                let apart = a.1 < b.0 || b.1 < a.0 || (a.2 - b.2).abs() >= 0.8 * a.3.min(b.3);
                assert!(apart, "{}: {a:?} {b:?}", figure.id);
            }
        }
    }
}
