//! The page of an explanation: what it says of each kind and each verdict, in both languages.

use crate::report::explain_fixture as fixture;
use sagnac::effect::{Domain, Place, find};
use sagnac::figure::Figure;
use sagnac::i18n::{EffectText, Lang, effect_text, table};
use sagnac::mismatch::figures::{TimeSeries, time_course};
use sagnac::mismatch::finding::Explanation;
use sagnac::report::explain::{Context, ExplainFile};
use sagnac::report::page::{Block, Value, terminal};
use sagnac::report::terminal::Terminal;
use sagnac::report::{Document, Documented, PageForm, Renderer};
use std::collections::BTreeSet;

fn context() -> Context {
    Context {
        recording: "recording.csv".into(),
        claim: "model.toml".into(),
        identified: false,
        description: Some("static, laboratory".into()),
        explained_at: "2026-11-21T04:23:29Z".into(),
        correction: true,
        notes: vec![],
    }
}

fn file(all: &Explanation) -> ExplainFile {
    ExplainFile { explanation: all.clone(), context: context() }
}

/// All blocks of a page, those within sections too.
fn flat(blocks: &[Block]) -> Vec<&Block> {
    let each = blocks.iter().flat_map(|block| match block {
        Block::Section(_, below) | Block::Fold(_, below) => flat(below),
        other => vec![other],
    });
    each.collect()
}

/// The verdict in sentences.
fn verdict(all: &Explanation, lang: Lang) -> Vec<String> {
    let page = file(all).page(&[], lang);
    let lead =
        page.blocks.into_iter().find_map(|b| if let Block::Lead(lead) = b { Some(lead) } else { None });
    lead.unwrap().sentences
}

/// Names of the parameters of the effects.
fn parameters(all: &Explanation, lang: Lang) -> Vec<String> {
    let names = |block: &Block| match block {
        Block::Table(table) => {
            table.only(&["parameter"]).rows.iter().flat_map(|r| &r.cells).map(Value::plain).collect()
        }
        _ => Vec::new(),
    };
    flat(&file(all).page(&[], lang).blocks).into_iter().flat_map(names).collect()
}

fn figure() -> Figure {
    let time: Vec<f64> = (0..2000).map(f64::from).collect();
    let step: Vec<f64> = time.iter().map(|t| if *t < 900.0 { 0.0 } else { 1.0 }).collect();
    time_course(&TimeSeries {
        time_s: &time,
        before: &step,
        after: Some(&vec![0.0; 2000]),
        contribution: Some(&step),
        places: &[Place { domain: Domain::Time, from: 880.0, to: 920.0 }],
    })
}

fn pages(all: &Explanation, lang: Lang) -> [String; 2] {
    let (file, figures) = (file(all), [figure()]);
    let document = Document::new(&file, &figures, &[], lang);
    [PageForm::Html, PageForm::Markdown].map(|form| document.text(form, &Renderer::new()).unwrap())
}

#[test]
fn every_kind_is_said_with_its_parameters() {
    assert_eq!(fixture::KINDS.len(), 42, "the kinds of the contract but `unknown`");
    for lang in Lang::ALL {
        for (kind, ids) in fixture::KINDS {
            let all = fixture::explained(vec![fixture::of_kind(kind)]);
            let said = &verdict(&all, *lang)[0];
            assert!(!said.contains(['{', '}']) && !said.contains("explain."), "{kind}: {said}");
            assert!(!said.contains(kind) || !kind.contains('_'), "{kind} has no words: {said}");
            // Of each kind the sentence gives at least one number, and every parameter has a name.
            assert!(said.contains('3'), "{kind}: {said}");
            let names = parameters(&all, *lang);
            assert!(
                names.iter().all(|n| !ids.iter().any(|(id, _)| id == n)),
                "{kind}: a parameter without a name"
            );
            assert_eq!(names.len(), ids.len());
        }
    }
}

#[test]
fn a_parameter_that_could_not_be_estimated_is_not_invented() {
    for (kind, _) in fixture::KINDS {
        let mut finding = fixture::of_kind(kind);
        finding.parameters.clear();
        for lang in Lang::ALL {
            let said = verdict(&fixture::explained(vec![finding.clone()]), *lang).join(" ");
            assert!(!said.contains(['{', '}']) && !said.contains("NaN"), "{kind}: {said}");
            if find(kind).is_some() {
                assert!(said.contains(effect_text(kind, EffectText::Title, *lang)), "{kind}: {said}");
            }
        }
    }
}

#[test]
fn every_domain_of_the_contract_has_its_phrase() {
    for domain in fixture::DOMAINS {
        for lang in Lang::ALL {
            let mut finding = fixture::of_kind("rate_ramp");
            finding.places = vec![fixture::place(domain, 2.0, 3.0)];
            let page = file(&fixture::explained(vec![finding])).page(&[], *lang);
            let about = flat(&page.blocks).into_iter().find_map(|b| match b {
                Block::Facts(facts) if facts.class == "about" => facts.rows.first(),
                _ => None,
            });
            let shown = about.unwrap().1.plain();
            assert!(shown.contains('2') && !shown.contains(['{', '_']), "{domain}: {shown}");
        }
    }
}

#[test]
fn what_the_verdicts_say() {
    let mut out = String::new();
    for lang in Lang::ALL {
        for all in [fixture::consistent(), fixture::bias_step(), fixture::two(), fixture::unknown()] {
            let blocks = file(&all).on_terminal(*lang);
            out.push_str(&terminal(&blocks, Terminal { width: 100, colour: false }));
            out.push('\n');
        }
    }
    insta::assert_snapshot!("explain_verdicts", out);
}

#[test]
fn the_pages_in_both_languages() {
    for (lang, name) in [(Lang::En, "explain_page_en"), (Lang::Ru, "explain_page_ru")] {
        let text = pages(&fixture::two(), lang)[1].replace(env!("CARGO_PKG_VERSION"), "<version>");
        insta::assert_snapshot!(name, text);
    }
}

#[test]
fn no_page_shows_a_key_or_what_is_no_number() {
    let tables: BTreeSet<String> =
        table(Lang::En).keys().filter_map(|k| k.split('.').next()).map(str::to_owned).collect();
    let mut odd = fixture::two();
    odd.family_p_value_after = f64::NAN;
    odd.fit.augmented.log_likelihood = f64::NEG_INFINITY;
    odd.fit.augmented.heldout_rms_deg_h = f64::NAN;
    odd.effects[0].p_value = 0.0;
    odd.effects[1].removed_share = Some(f64::NAN);
    odd.effects[1].places[0].to = f64::INFINITY;
    if let Some(p) = odd.effects[0].parameters.get_mut("N_deg_rt_h") {
        p.ci95 = [f64::NAN, f64::INFINITY];
    }
    let every = [fixture::consistent(), fixture::bias_step(), fixture::two(), fixture::unknown(), odd];
    for all in &every {
        for lang in Lang::ALL {
            for text in pages(all, *lang) {
                assert!(!text.contains("NaN") && !text.contains("inf "), "{text}");
                let word = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '.';
                let shown: Vec<&str> = text
                    .split(|c: char| !word(c))
                    .map(|w| w.trim_end_matches('.'))
                    .filter(|w| w.contains('.') && tables.contains(w.split('.').next().unwrap_or_default()))
                    .filter(|w| table(Lang::En).contains_key(*w))
                    .collect();
                assert!(shown.is_empty(), "{shown:?}");
            }
        }
    }
}

#[test]
fn what_users_write_cannot_leave_its_place() {
    let mut all = fixture::consistent();
    all.case = "</title><script>alert(1)</script>".into();
    let [html, markdown] = pages(&all, Lang::En);
    // The one script is that of the page, in its head.
    let (head, body) = html.split_once("</script>").unwrap();
    assert!(
        head.matches("<script").count() == 1 && !body.contains("<script") && !markdown.contains("<script")
    );
}
