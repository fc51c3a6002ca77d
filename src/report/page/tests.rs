//! Every kind of block in every form, and what is hostile in their texts.

use super::*;
use crate::i18n::Lang;
use crate::report::Renderer;
use crate::report::render::page_context;
use crate::report::terminal::Terminal;

/// A text that is markup in every form.
const HOSTILE: &str = "</td><script>alert(1)</script> \"x' *a*|b [l](javascript:1) `c|d";

/// What stands between the frame of a page of HTML.
fn html(blocks: Vec<Block>) -> String {
    let page = Page { title: "t".into(), generator: "g".into(), footer: "f".into(), blocks };
    let text =
        Renderer::new().render("page.html", &page_context(seen(&page, &Html), Lang::En), Lang::En).unwrap();
    let (_, main) = text.split_once("<main>").unwrap();
    main.split_once("<footer>f</footer>").unwrap().0.trim().to_owned()
}

fn markdown(blocks: Vec<Block>) -> String {
    let page = Page { footer: "f".into(), blocks, ..Page::default() };
    let context = page_context(seen(&page, &Markdown), Lang::En);
    let text = Renderer::new().render("page.md", &context, Lang::En).unwrap();
    text.trim_end().strip_suffix('f').unwrap().trim_end().to_owned()
}

fn on_terminal(blocks: &[Block]) -> String {
    terminal(blocks, Terminal { width: 60, colour: false })
}

fn pass() -> State {
    State { id: "pass".into(), word: "годен".into() }
}

fn head(size: &str) -> Block {
    let counts = if size.is_empty() { vec![] } else { vec![(pass(), 2)] };
    Block::Head(Head {
        kind: "Plan".into(),
        title: "SN <1>".into(),
        size: size.into(),
        label: "Outcome".into(),
        verdict: pass(),
        counts,
        is_signed: false,
    })
}

/// A table of a quantity with its interval and unit, listed in Markdown.
fn parameters() -> Table {
    let quantity = Quantity { number: Some(0.5), printed: "0.50".into(), unit: "°/h".into() };
    Table::new("cards", 1)
        .column(Column::text("name", "Parameter"), ["Bias"])
        .column(Column::number("value", "Value"), [quantity])
        .column(Column::number("interval", "Interval").listed(Listed::Bracketed), ["0.4 … 0.6"])
        .units("Unit")
        .laid_out(Layout::Grid, Layout::List)
}

#[test]
fn a_head_names_kind_subject_and_verdict() {
    let page = html(vec![head("")]);
    assert!(page.contains("<p class=\"kind\">Plan</p>") && page.contains("<h1>SN &lt;1&gt;</h1>"), "{page}");
    assert!(
        page.contains("<div class=\"verdict pass\">") && page.contains("<strong>годен</strong>"),
        "{page}"
    );
    assert_eq!(markdown(vec![head("")]), "# Plan: SN &lt;1&gt;\n\n**Outcome: годен**");
    assert_eq!(on_terminal(&[head("")]), "ГОДЕН  SN <1>\n");
    // Of several, it says how many have which verdict.
    assert!(html(vec![head("2 units")]).contains("<span class=\"mark pass\">годен</span></dt><dd>2</dd>"));
    assert_eq!(markdown(vec![head("2 units")]), "# SN &lt;1&gt;\n\n**Outcome: годен** · 2 units · годен 2");
    assert_eq!(on_terminal(&[head("2 units")]), "ГОДЕН  SN <1> · 2 units (годен 2)\n");
}

#[test]
fn a_head_without_a_verdict_has_title_and_size_alone() {
    let head = |size: &str| {
        Block::Head(Head { kind: "Sheet".into(), title: "A".into(), size: size.into(), ..Head::default() })
    };
    let page = html(vec![head("2 units")]);
    assert!(page.contains("<p class=\"kind\">Sheet · 2 units</p>") && !page.contains("verdict"), "{page}");
    assert_eq!(markdown(vec![head("2 units")]), "# A\n\nSheet · 2 units");
    assert_eq!(markdown(vec![head("")]), "# A");
    assert_eq!(on_terminal(&[head("2 units")]), "A · 2 units\n");
}

#[test]
fn a_value_has_its_details_on_pages_alone() {
    let quantity = Quantity { number: Some(0.5), printed: "0.50".into(), unit: "°/h".into() };
    let cell = Value::from(quantity)
        .strong()
        .detail(Joined::Interval, "0.4 … 0.6")
        .detail(Joined::Remark, "")
        .detail(Joined::Further, "ratio 7");
    let table = Table::new("", 1)
        .units_in_names()
        .column(Column::text("name", "Name"), [Value::from("Bias").detail(Joined::Unit, "°/h")])
        .column(Column::number("typical", "Typical"), [cell])
        .column(Column::number("units", "Units"), [Value::from("30").detail(Joined::Remark, "2 bounded")]);
    let page = html(vec![Block::Table(table.clone())]);
    for part in [
        "<th scope=\"row\">Bias, <span class=\"unit\">°/h</span></th>",
        "<td class=\"n\"><b>0.50</b><small>0.4 … 0.6</small><small>ratio 7</small></td>",
        "<td class=\"n\">30<small>2 bounded</small></td>",
    ] {
        assert!(page.contains(part), "{part}\n{page}");
    }
    let row = "| Bias, °/h | **0.50** [0.4 … 0.6]; ratio 7 | 30 (2 bounded) |";
    assert!(markdown(vec![Block::Table(table.clone())]).ends_with(row));
    assert_eq!(csv(&table), "name,typical,units\nBias,5e-1,30\n");
    let shown = on_terminal(&[Block::Table(table)]);
    assert_eq!(shown, "  Name   Typical  Units\n  Bias  0.50\u{202f}°/h     30\n");
}

#[test]
fn remarks_are_a_list() {
    assert_eq!(Block::remarks([]), None);
    let remarks = || Block::remarks(["a `b` < c".to_owned(), "d".to_owned()]).into_iter().collect();
    assert_eq!(html(remarks()), "<ul class=\"remarks\"><li>a <code>b</code> &lt; c</li><li>d</li></ul>");
    assert_eq!(markdown(remarks()), "- a `b` &lt; c\n- d");
    assert_eq!(on_terminal(&remarks()), "\n  a `b` < c\n  d\n");
}

#[test]
fn sentences_and_headings_are_shown_by_every_form() {
    let sentence = "Column `a_b` < 1.".to_owned();
    let verdict = Heading { level: 3, text: "Run".into(), verdict: Some(pass()) };
    let blocks = || {
        vec![
            Block::Lead(Lead { id: "fail".into(), sentences: vec![sentence.clone()] }),
            Block::section("figures", "Facts", vec![Block::Heading(verdict.clone())]),
            Block::Paragraph(sentence.clone()),
            Block::Hint(sentence.clone()),
        ]
    };
    let page = html(blocks());
    let shown = "Column <code>a_b</code> <span class=\"unit\">&lt; 1.</span>";
    for part in [
        format!("<div class=\"says fail\"><p>{shown}</p></div>"),
        "<section class=\"figures\">\n<h2>Facts</h2>".to_owned(),
        "<h3>Run: <strong class=\"pass\">годен</strong></h3>".to_owned(),
        format!("<p>{shown}</p>\n<p class=\"hint\">{shown}</p>"),
    ] {
        assert!(page.contains(&part), "{part}\n{page}");
    }
    let shown = "Column `a_b` &lt; 1.";
    assert_eq!(
        markdown(blocks()),
        format!("{shown}\n\n## Facts\n\n### Run\n\n**годен**\n\n{shown}\n\n{shown}")
    );
    let shown = "  Column `a_b` < 1.\n";
    assert_eq!(on_terminal(&blocks()), format!("{shown}\nFacts\n\nRun\n{shown}\n{shown}"));
}

#[test]
fn facts_and_steps_are_lists() {
    let blocks = || {
        let hashes = vec![("r.csv".to_owned(), "ab12".to_owned())];
        let items = vec![Step { text: "Do".into(), hashes }, Step { text: "Look".into(), hashes: vec![] }];
        vec![
            Block::identity([("Case".to_owned(), "unit".to_owned()), ("Empty".to_owned(), " ".to_owned())]),
            Block::files([("a.json".to_owned(), "for programs".to_owned())]),
            Block::Steps(Steps { class: "steps", items }),
        ]
    };
    let page = html(blocks());
    assert!(page.contains("<div><dt>Case</dt><dd>unit</dd></div>\n</dl>"), "{page}");
    assert!(page.contains("<dt><code>a.json</code></dt><dd>for programs</dd>"), "{page}");
    assert!(page.contains("<li>Do<br><code>r.csv</code> <span class=\"hash\">ab12</span></li>"), "{page}");
    assert_eq!(
        markdown(blocks()),
        "- Case: unit\n\n- `a.json`: for programs\n\n1. Do\n   - `r.csv`: `ab12`\n2. Look"
    );
    assert_eq!(on_terminal(&blocks()), "  1. Do\n  2. Look\n");
}

#[test]
fn a_unit_stands_in_its_column_or_at_the_number() {
    let page = html(vec![Block::Table(parameters())]);
    assert!(
        page.contains("<th scope=\"row\">Bias</th><td class=\"n\" data-label=\"Value\">0.50</td>"),
        "{page}"
    );
    assert!(page.contains("<td data-label=\"Unit\">°/h</td>"), "{page}");
    assert_eq!(markdown(vec![Block::Table(parameters())]), "- Bias: 0.50\u{202f}°/h (0.4 … 0.6)");
    let shown = on_terminal(&[Block::heading("H"), Block::Table(parameters())]);
    assert_eq!(shown, "\nH\n  Parameter     Value   Interval\n  Bias       0.50\u{202f}°/h  0.4 … 0.6\n");
}

#[test]
fn a_table_marks_states_lists_and_the_chosen_row() {
    let table = || {
        let list = |item: &str, ordered| Value::List { items: vec![item.into(), "b".into()], ordered };
        let mut table = Table::new("", 2)
            .column(Column::text("steps", "Steps"), [list("a", true), list("c", false)])
            .column(Column::text("state", "State"), [Value::State(pass()), Value::Empty])
            .column(
                Column::text("kind", "Kind").on_terminal(OnTerminal::Bracketed),
                [Value::Named { text: "Drift".into(), id: "rate_ramp".into() }, Value::Code("x".into())],
            )
            .column(
                Column::text("page", "Page").on_terminal(OnTerminal::Hidden),
                [Value::Link { text: "SN".into(), to: "a/b.html".into() }, Value::Empty],
            );
        table.rows[0].chosen = true;
        vec![Block::Table(table)]
    };
    let page = html(table());
    for part in [
        "<tr class=\"chosen\"><th scope=\"row\"><ol><li>a</li><li>b</li></ol></th>",
        "<td><span class=\"mark pass\">годен</span></td><td>Drift <code>rate_ramp</code></td>",
        "<td><a href=\"a/b.html\">SN</a></td></tr>",
        "<th scope=\"row\"><ul><li>c</li><li>b</li></ul></th><td></td><td><code>x</code></td>",
    ] {
        assert!(page.contains(part), "{part}\n{page}");
    }
    assert_eq!(
        markdown(table()),
        "| Steps | State | Kind | Page |\n|---|---|---|---|\n\
         | → a; b | годен | Drift (`rate_ramp`) | SN |\n| c b |  | `x` |  |"
    );
    let shown = on_terminal(&table());
    assert_eq!(shown, "  Steps  State\n  a; b   годен (Drift)\n  c b     (x)\n");
}

#[test]
fn a_list_leaves_out_what_is_empty() {
    let table = || {
        Table::new("", 1)
            .column(Column::text("what", "What"), ["Scale"])
            .column(Column::text("known", "Known"), [""])
            .column(Column::text("found", "Found").listed(Listed::Below("Found: ".into())), ["0.5"])
            .column(
                Column::text("source", "Source").class("hint").listed(Listed::Below(String::new())),
                ["X"],
            )
            .laid_out(Layout::List, Layout::List)
    };
    let page = html(vec![Block::Table(table())]);
    assert_eq!(page, "<p><b>Scale</b><br><span>Found: 0.5</span><br><span class=\"hint\">X</span></p>");
    assert_eq!(markdown(vec![Block::Table(table())]), "- Scale\n  - Found: 0.5\n  - X");
}

#[test]
fn figures_are_drawn_or_linked_and_the_summary_ends_on_paper_alone() {
    let figure = Figure {
        id: "sigma".into(),
        number: 1,
        mark: String::new(),
        title: "σ <τ>".into(),
        caption: "Falls.".into(),
        is_titled: false,
        svg: "<svg></svg>".into(),
        readings: "{\"a\":1}".into(),
        href: "figures/s.svg".into(),
    };
    let blocks =
        || vec![Block::Figure(Box::new(figure.clone())), Block::SummaryEnd, Block::Paragraph("x".into())];
    let page = html(blocks());
    assert!(
        page.contains("<figure data-readings=\"{&quot;a&quot;:1}\"><svg></svg><figcaption>Falls."),
        "{page}"
    );
    assert!(!page.contains("summary"), "{page}");
    assert_eq!(markdown(blocks()), "![σ &lt;τ&gt;](figures/s.svg)\n\nFalls.\n\nx");
    assert_eq!(on_terminal(&blocks()), "  x\n");
    let titled = Block::Figure(Box::new(Figure { is_titled: true, ..figure.clone() }));
    let page = html(vec![titled]);
    assert!(page.contains("<figcaption>σ &lt;τ&gt;. Falls.</figcaption>"), "{page}");
    let page = Page { blocks: blocks(), ..Page::default() };
    let context = crate::report::render::paper_context(page_context(seen(&page, &Markdown), Lang::En));
    let paper = Renderer::new().render("page.md", &context, Lang::En).unwrap();
    assert!(paper.contains("Falls.\n\n<!-- summary -->\n\nx"), "{paper}");
}

#[test]
fn a_verdict_that_may_be_signed_stands_before_its_reasons() {
    let blocks = || {
        let head =
            Head { kind: "Report".into(), title: "SN".into(), label: "Verdict".into(), ..Head::default() };
        let reasons = Reasons {
            class: "reasons",
            id: "pass".into(),
            mark: "why".into(),
            heading: "Reasons".into(),
            sentences: vec!["a < b".into()],
        };
        vec![Block::Head(Head { is_signed: true, verdict: pass(), ..head }), Block::Reasons(reasons)]
    };
    let page = html(blocks());
    assert!(page.contains("<strong>годен</strong>"), "{page}");
    assert!(page.contains("<section class=\"reasons pass\" id=\"why\">"), "{page}");
    assert!(page.contains("<ul><li>a &lt; b</li></ul>"), "{page}");
    assert_eq!(markdown(blocks()), "# SN\n\n**Verdict: ГОДЕН**\n\n## Reasons\n\n- a &lt; b");
    assert_eq!(on_terminal(&blocks()), "ГОДЕН  SN\n\nReasons\n  a < b\n");
    // A page without a verdict states none.
    let none = html(vec![Block::Head(Head { is_signed: true, title: "SN".into(), ..Head::default() })]);
    assert!(none.contains("<h1>SN</h1>") && !none.contains("verdict"), "{none}");
}

#[test]
fn lists_footnotes_links_methods_and_folds_are_shown() {
    let blocks = || {
        let method =
            Method { title: "M".into(), formulas: vec!["y_x".into()], text: "T".into(), source: "S".into() };
        let link = Link { words: "Model: m".into(), text: "whole".into(), to: "explain/report".into() };
        let heading = Heading { level: 2, text: "Methods".into(), verdict: None };
        vec![
            Block::List(List { class: "remarks", items: vec![("a".into(), true), ("b".into(), false)] }),
            Block::Footnotes(Footnotes { anchor: "p-".into(), notes: vec![(3, "n".into())] }),
            Block::Link(link),
            Block::Fold(heading, vec![Block::Method(method)]),
        ]
    };
    let page = html(blocks());
    for part in [
        "<ul class=\"remarks\"><li class=\"fail\">a</li><li>b</li></ul>",
        "<li id=\"note-p-3\" value=\"3\">n</li>",
        "<summary><h2>Methods</h2></summary>",
        "<p class=\"formula\">y<sub>x</sub></p>",
        "report.html\">whole</a>",
    ] {
        assert!(page.contains(part), "{part}\n{page}");
    }
    assert_eq!(
        markdown(blocks()),
        "- **a**\n- b\n\n3. n\n\nModel: m · [whole](explain/report.md)\n\n## Methods\n\n### M\n\n- y\\_x\n\nT (S)"
    );
}

#[test]
fn cells_have_footnotes_smaller_lines_and_room_for_two() {
    let table = || {
        let noted = Value::from("N").noted("p-", vec![1, 2]);
        let wide = Value::Wide(Box::new(Value::from("≤ 1").over(["not resolved".into(), Value::Empty])));
        let mut table = Table::new("", 2)
            .column(Column::text("name", "Name"), [Value::from("Phase"), noted])
            .column(Column::number("value", "Value"), [Value::Empty, wide])
            .column(Column::number("interval", "Interval"), [""])
            .column(Column::text("fit", "Fit"), [Value::Empty, Value::from("bad").strong()]);
        table.rows[0].is_heading = true;
        table
    };
    let page = html(vec![Block::Table(table())]);
    for part in [
        "<tr class=\"group\"><th colspan=\"4\">Phase</th></tr>",
        "N<sup><a href=\"#note-p-1\">1</a></sup><sup>,</sup><sup><a href=\"#note-p-2\">2</a></sup></th>",
        "<td class=\"n bound\" colspan=\"2\">≤ 1<small>not resolved</small></td><td><b>bad</b></td>",
    ] {
        assert!(page.contains(part), "{part}\n{page}");
    }
    let rows = "| Phase |  |  |  |\n| N (1) (2) | ≤ 1 (not resolved) |  | **bad** |";
    assert!(
        markdown(vec![Block::Table(table())]).ends_with(rows),
        "{}",
        markdown(vec![Block::Table(table())])
    );
}

#[test]
fn nothing_in_a_text_is_markup() {
    let text = || HOSTILE.to_owned();
    let named = Value::Named { text: text(), id: text() };
    let values = || {
        [
            Value::Text(text()),
            Value::Sentence(text()),
            Value::Code(text()),
            Value::Formula(text()),
            Value::Digest(text()),
            named.clone(),
            Value::Link { text: text(), to: text() },
            Value::state(text(), text()),
            Value::List { items: vec![text()], ordered: false },
            Value::Quantity(Quantity { number: None, printed: text(), unit: text() }),
            [Joined::Interval, Joined::Remark, Joined::Further, Joined::Unit]
                .into_iter()
                .fold(Value::Text(text()).strong(), |value, joined| value.detail(joined, text())),
        ]
    };
    let blocks = || {
        let table = values().into_iter().fold(Table::new("cards", 1), |t, v| {
            t.column(Column::text("c", HOSTILE).listed(Listed::Below(text())), [v])
        });
        let listed = table.clone().laid_out(Layout::List, Layout::List);
        vec![
            Block::Head(Head { kind: text(), title: text(), size: text(), label: text(), ..Head::default() }),
            Block::Lead(Lead { id: text(), sentences: vec![text()] }),
            Block::heading(named.clone()),
            Block::List(List { class: "remarks", items: vec![(text(), true)] }),
            Block::Facts(Facts { class: "", rows: values().map(|v| (v.clone(), v)).into() }),
            Block::Steps(Steps {
                class: "",
                items: vec![Step { text: text(), hashes: vec![(text(), text())] }],
            }),
            Block::Table(table),
            Block::Table(listed),
        ]
    };
    let page = html(blocks());
    assert!(!page.contains("<script") && !page.contains("alert(1)</") && !page.contains("\"x'"), "{page}");
    assert!(!page.contains("href=\"</"), "{page}");
    let page = markdown(blocks());
    // Within code nothing is markup.
    let prose = page.replace(&Markdown.code(HOSTILE), "");
    assert!(!prose.contains("<script") && !prose.contains("[l](javascript"), "{prose}");
    // Bars end no cell but where the table has them.
    let bars = |line: &str| line.replace("\\|", "").matches('|').count();
    let rows: Vec<&str> = page.lines().filter(|l| l.starts_with('|')).collect();
    assert_eq!(rows.iter().map(|r| bars(r)).collect::<Vec<_>>(), [12, 12, 12], "{page}");
    let steers = Block::heading(Value::Text("\u{1b}[2Jx".into()));
    assert!(!on_terminal(&[steers]).contains('\u{1b}'));
}

#[test]
fn a_fence_of_code_is_longer_than_what_it_holds() {
    assert_eq!(Markdown.code("temp_degC"), "`temp_degC`");
    assert_eq!(Markdown.code("a`b|c"), "`` a`b\\|c ``");
}

#[test]
fn a_user_replaces_the_template_of_a_block() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("block-hint.html"), "<aside>{{ b.text }}</aside>").unwrap();
    let page =
        Page { blocks: vec![Block::Hint("a < b".into()), Block::Paragraph("c".into())], ..Page::default() };
    let renderer = Renderer::with_overrides(folder.path()).unwrap();
    let text = renderer.render("page.html", &page_context(seen(&page, &Html), Lang::En), Lang::En).unwrap();
    assert!(text.contains("<aside>a &lt; b</aside>\n<p>c</p>"), "{text}");
}
