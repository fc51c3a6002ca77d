//! The shipped procedures and limits, the schema, the guide.

use sagnac::config::manifest::tables::MANIFEST_FILE;
use sagnac::config::model::tables::MODEL_FILE;
use sagnac::config::procedure::check::{check, check_report};
use sagnac::config::procedure::model::{Allowance, EarthRate, Taus};
use sagnac::config::procedure::spec::{Kind, Need, TableSpec};
use sagnac::config::procedure::tables::PROCEDURE_FILE;
use sagnac::config::procedure::tables::limits::LIMITS_FILE;
use sagnac::config::procedure::tables::phases::PHASES_FILE;
use sagnac::config::procedure::{
    effective, guide, load, load_limits, parse_limits, parse_procedure, power, schema,
};
use sagnac::estimate::Rule;
use sagnac::i18n::{Lang, Localize};
use sagnac::measurand::Test;
use sagnac::recording::{ColumnRef, Role};
use std::path::{Path, PathBuf};

fn shipped(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("procedures").join(path)
}

fn toml_files(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().path());
    entries.filter(|p| p.extension().is_some_and(|e| e == "toml")).collect()
}

#[test]
fn the_static_procedure_says_what_its_file_says() {
    let loaded = load(&shipped("static-bias.toml")).unwrap();
    assert!(loaded.warnings.is_empty(), "{:?}", loaded.warnings);
    assert_eq!(loaded.sha256.len(), 64);
    let p = &loaded.value;
    assert_eq!((p.id.as_str(), p.unit_under_test.serial_required), ("static-bias", true));
    assert_eq!(p.sample_rate_hz, None);
    let columns: Vec<_> = p.channels.iter().map(|c| (c.channel.role, c.channel.column.clone())).collect();
    let name = |n: &str| ColumnRef::Name(n.to_owned());
    assert_eq!(
        columns,
        [
            (Role::Time, name("time_s")),
            (Role::Rate, name("rate_deg_h")),
            (Role::Temperature, name("temp_degC"))
        ]
    );
    assert_eq!((p.conditions.minimum_duration_s, p.conditions.warm_up_s), (Some(36_000.0), 1800.0));
    let t = &p.conditions.temperatures[0];
    assert_eq!(
        (t.nominal_deg_c, t.tolerance_deg_c, t.sensor_uncertainty_deg_c, t.coverage_factor, t.smoothing_s),
        (20.0, 0.4, 0.05, 2.0, 60.0)
    );
    assert_eq!(p.conditions.faults.gaps, Some(Allowance::Count(10)));
    assert!(
        matches!(p.conditions.faults.missing_samples, Some(Allowance::Share(s)) if (s - 0.001).abs() < 1e-15)
    );
    let site = p.site.as_ref().unwrap();
    assert_eq!((site.latitude_deg, site.orientation_of("rate").elevation_deg), (55.98, 90.0));
    assert!((site.orientation_of("rate").elevation_uncertainty_deg - 30.0 / 3600.0).abs() < 1e-15);
    assert_eq!(p.analysis.taus, Taus::Octave);
    let ids: Vec<_> = p.measurands.iter().map(|m| m.measurand.id).collect();
    let all: Vec<_> =
        sagnac::measurand::MEASURANDS.iter().filter(|m| m.test() == Test::Static).map(|m| m.id).collect();
    assert!(all.iter().all(|id| ids.contains(id)), "every measurand of this version is determined");
    assert_eq!(p.measurands[0].earth_rate, EarthRate::Remove);
    assert_eq!(p.clauses.len(), 14);
    let due = p.instruments.iter().all(|i| i.calibration_due.is_some_and(|d| d.to_string() == "2030-12-31"));
    assert!(due && p.instruments.len() == 4);
}

#[test]
fn every_shipped_file_is_sound() {
    let mut files = toml_files(&shipped(""));
    files.extend(toml_files(&shipped("limits")));
    assert!(files.len() >= 7);
    for file in &files {
        if let Err(problems) = check(file) {
            panic!("{problems}");
        }
    }
    let paths: Vec<&Path> = files.iter().map(PathBuf::as_path).collect();
    let report = check_report(&paths, Lang::En, &|_| None, &|_| None);
    assert_eq!(report.failed, 0, "{}", report.text);
    assert_eq!(report.text.matches("; valid").count(), files.len());
}

/// Texts of a file that reports show and that are not in every language, each with its key.
fn of_one_language(spec: &'static TableSpec, file: &toml::Table, found: &mut Vec<String>) {
    for key in spec.keys {
        let Some(value) = file.get(key.name) else { continue };
        let tables = match value {
            toml::Value::Array(list) => list.iter().filter_map(|v| v.as_table()).collect(),
            other => other.as_table().into_iter().collect::<Vec<_>>(),
        };
        match key.kind {
            // The number of a clause and a standard are the same in every language.
            Kind::LocalText | Kind::LocalRemark => match value.as_str() {
                Some(text) if !text.starts_with("IEEE Std ") && text.chars().any(char::is_alphabetic) => {
                    found.push(format!("{}: {text}", key.name))
                }
                Some(_) => {}
                None if tables.iter().all(|t| t.len() == Lang::ALL.len()) => {}
                None => found.push(format!("{}: {value}", key.name)),
            },
            kind => {
                let below =
                    kind.table().into_iter().flat_map(|below| tables.iter().map(move |t| (below, *t)));
                below.for_each(|(below, table)| of_one_language(below, table, found));
            }
        }
    }
}

#[test]
fn every_text_of_shipped_files_is_in_every_language() {
    let samples = Path::new(env!("CARGO_MANIFEST_DIR")).join("samples");
    let mut examined = 0;
    for path in [shipped(""), shipped("limits"), samples].iter().flat_map(|folder| toml_files(folder)) {
        let text = std::fs::read_to_string(&path).unwrap();
        let spec = match (text.contains("\"procedure/1\""), text.contains("\"limits/1\"")) {
            (true, _) if text.contains("[[phase]]") => &PHASES_FILE,
            (true, _) => &PROCEDURE_FILE,
            (_, true) => &LIMITS_FILE,
            _ if text.contains("\"manifest/1\"") => &MANIFEST_FILE,
            _ => &MODEL_FILE,
        };
        let mut found = vec![];
        of_one_language(spec, &text.parse().unwrap(), &mut found);
        assert!(found.is_empty(), "{}: {found:#?}", path.display());
        examined += 1;
    }
    assert!(examined >= 25, "{examined}");
    let mut found = vec![];
    let plain = "[limits]\ntitle = \"Limits\"\n[[reference]]\nsource = { en = \"a\" }\nnote = \"12.1\"\n";
    of_one_language(&LIMITS_FILE, &plain.parse().unwrap(), &mut found);
    assert_eq!(found.len(), 2, "{found:?}");
}

#[test]
fn published_values_are_those_of_the_paper_and_no_limits() {
    // Tables 1 and 2 of Korkishko et al.: N, B, Russian drift over 100 s, Russian angle random walk, N of Table 2.
    for (file, n, b, drift, arw, n2) in [
        ("oius-200", 0.008, 0.006, 0.048, 0.0092, 0.0081),
        ("tius-500", 0.0065, 0.0025, 0.032, 0.010, 0.0068),
        ("oius-501", 0.0023, 0.0011, 0.014, 0.0065, 0.0023),
        ("oius-1000", 0.0009, 0.0006, 0.003, 0.0008, 0.00055),
        ("oius-2000", 0.00026, 0.00024, 0.0015, 0.00028, 0.00025),
    ] {
        let procedure = load(&shipped("static-bias.toml")).unwrap();
        let limits = load_limits(&shipped(&format!("limits/{file}.toml"))).unwrap();
        let all = effective(&procedure, Some(&limits));
        assert!(all.set.limits.is_empty() && all.warnings.is_empty(), "{file}");
        let value = |id: &str| all.reference(id, "rate").unwrap().record.value;
        assert_eq!(value("angle_random_walk"), n);
        assert_eq!(value("bias_instability"), b);
        assert_eq!(value("russian_drift_100s"), drift);
        assert_eq!(value("russian_arw_10s"), arw);
        let second =
            all.set.references.iter().filter(|r| r.measurand.id == "angle_random_walk").nth(1).unwrap();
        assert_eq!(second.record.value, n2);
        assert!(second.record.source.text().ends_with("Table 2"));
        assert_eq!(all.expected("angle_random_walk"), Some(n));
    }
}

#[test]
fn a_factor_makes_limits_of_published_values() {
    let text = std::fs::read_to_string(shipped("limits/oius-501.toml")).unwrap();
    let with_factor = text.replace("# factor = 1.5", "factor = 1.5");
    assert_ne!(text, with_factor);
    let limits = parse_limits("f.toml", with_factor.as_bytes()).unwrap();
    let procedure = load(&shipped("static-bias.toml")).unwrap();
    let all = effective(&procedure, Some(&limits));
    let limit = &all.limit("angle_random_walk", "rate").unwrap().limit;
    assert!((limit.max.unwrap() - 0.00345).abs() < 1e-12);
    assert_eq!(
        (limit.min, limit.rule, limit.risk, limit.source.as_str()),
        (None, Rule::GuardBand, 0.05, "f.toml")
    );
    assert_eq!(all.set.limits.len(), 5);
    let tight = text.replace("# factor = 1.5", "factor = 1");
    let warned = parse_limits("f.toml", tight.as_bytes()).unwrap().warnings;
    assert_eq!(warned.len(), 5, "a limit at the typical value is worth a warning");
}

#[test]
fn a_factor_on_what_can_be_negative_bounds_its_magnitude() {
    let text = "format = \"limits/1\"\n[limits]\nid = \"l\"\ntitle = \"L\"\nrevision = \"A\"\n\
                [[reference]]\nmeasurand = \"static_bias\"\nvalue = \"-0.2 deg/h\"\nsource = \"s\"\n\
                [[limit]]\nmeasurand = \"static_bias\"\nfactor = 2\n";
    let limits = parse_limits("l", text.as_bytes()).unwrap().value;
    assert_eq!((limits.set.limits[0].limit.min, limits.set.limits[0].limit.max), (Some(-0.4), Some(0.4)));
}

const PROCEDURE: &str = r#"
format = "procedure/1"
[procedure]
id = "two"
title = "Two axes"
revision = "A"
[recording]
sample_rate = "10 Hz"
[[channel]]
id = "x"
column = 1
role = "angle_increment"
unit = "count"
scale = "0.01 arcsec/count"
reversed = true
[[channel]]
id = "y"
column = "wy"
role = "rate"
unit = "mrad/s"
rail_high = "1 deg/s"
[conditions]
minimum_duration = "1 h"
[[measurand]]
id = "angle_random_walk"
[[measurand]]
id = "rate_random_walk"
channel = "y"
[[limit]]
measurand = "angle_random_walk"
max = "0.01 deg/sqrt(h)"
[[limit]]
measurand = "angle_random_walk"
channel = "x"
max = "0.02 deg/sqrt(h)"
[[limit]]
measurand = "rate_random_walk"
max = "1 deg/h/sqrt(h)"
"#;

#[test]
fn counts_rails_and_reversed_axes_arrive_ready_for_reading() {
    let p = parse_procedure("p", PROCEDURE.as_bytes()).unwrap().value;
    let x = p.channel("x").unwrap();
    assert_eq!((x.channel.unit.text(), x.channel.scale, x.unit_in_file.as_str()), ("arcsec", -0.01, "count"));
    assert_eq!(x.channel.column, ColumnRef::Position(1));
    let y = p.channel("y").unwrap();
    assert_eq!((y.channel.unit.text(), y.channel.scale, y.rail_high), ("mrad/s", 1.0, Some(3600.0)));
    assert_eq!(p.sample_rate_tolerance, 0.01);
}

#[test]
fn a_limits_file_goes_over_the_limits_of_the_procedure() {
    let procedure = parse_procedure("p", PROCEDURE.as_bytes()).unwrap();
    let max = |limits: &sagnac::config::procedure::EffectiveLimits, id: &str, channel: &str| {
        limits.limit(id, channel).and_then(|l| l.limit.max)
    };
    let own = effective(&procedure, None);
    assert_eq!(max(&own, "angle_random_walk", "x"), Some(0.02));
    assert_eq!(max(&own, "angle_random_walk", "y"), Some(0.01));
    let head = "format = \"limits/1\"\n[limits]\nid = \"l\"\ntitle = \"L\"\nrevision = \"A\"\n";
    let file = |rest: &str| parse_limits("l", format!("{head}{rest}").as_bytes()).unwrap();

    let for_all = file("[[limit]]\nmeasurand = \"angle_random_walk\"\nmax = \"0.5 deg/sqrt(h)\"\n");
    let all = effective(&procedure, Some(&for_all));
    assert_eq!(max(&all, "angle_random_walk", "x"), Some(0.5));
    assert_eq!(max(&all, "rate_random_walk", "y"), Some(1.0), "what the file leaves alone stays");
    assert_eq!(all.set.limits.len(), 2);

    let for_x =
        file("[[limit]]\nmeasurand = \"angle_random_walk\"\nchannel = \"x\"\nmax = \"0.5 deg/sqrt(h)\"\n");
    let all = effective(&procedure, Some(&for_x));
    assert_eq!(max(&all, "angle_random_walk", "x"), Some(0.5));
    assert_eq!(max(&all, "angle_random_walk", "y"), Some(0.01));

    let unmeasured = file("[[limit]]\nmeasurand = \"static_bias\"\nmax_abs = \"1 deg/h\"\n");
    let all = effective(&procedure, Some(&unmeasured));
    assert_eq!(all.warnings.len(), 1);
    assert!(all.warnings[0].message.say(Lang::En).contains("not used"));
}

#[test]
fn power_is_asked_of_each_limit_on_the_channels_it_judges() {
    let procedure = parse_procedure("p", PROCEDURE.as_bytes()).unwrap();
    let limits = effective(&procedure, None);
    let questions = power::questions(&procedure.value, &limits);
    let asked: Vec<_> = questions.iter().map(|q| (q.limit.measurand.id, q.channels.join(","))).collect();
    let expected = [("angle_random_walk", "y"), ("angle_random_walk", "x"), ("rate_random_walk", "y")];
    assert_eq!(asked, expected.map(|(id, c)| (id, c.to_owned())));
    assert!(questions.iter().all(|q| q.duration_s == 3600.0 && q.sample_rate_hz == Some(10.0)));
    let warned = power::warnings(&questions, &procedure, None, |q| {
        (q.limit.measurand.id == "rate_random_walk").then(|| ("power.never".into(), None))
    });
    assert_eq!((warned.len(), warned[0].token.as_str()), (1, "[[limit]]"));
    assert_eq!(warned[0].line, PROCEDURE.lines().position(|l| l.contains("1 deg/h/sqrt(h)")).unwrap() - 1);
}

fn keys(root: &'static TableSpec) -> Vec<(String, &'static sagnac::config::procedure::spec::KeySpec)> {
    root.walk()
        .into_iter()
        .flat_map(|t| t.keys.iter().map(|k| (format!("{}.{}", t.name, k.name), k)))
        .collect()
}

#[test]
fn every_key_is_described_and_its_example_and_default_are_toml() {
    for root in [&PROCEDURE_FILE, &LIMITS_FILE, &MODEL_FILE] {
        for (path, key) in keys(root) {
            assert!(key.doc.ends_with('.') && key.doc.len() > 8, "{path}: {}", key.doc);
            let nested = key.kind.table().is_some() || matches!(key.kind, Kind::QuantityMap | Kind::Values);
            assert_eq!(key.example.is_empty(), nested, "{path}");
            for literal in [Some(key.example), if let Need::Default(d) = key.need { Some(d) } else { None }] {
                let Some(literal) = literal.filter(|l| !l.is_empty()) else { continue };
                assert!(format!("x = {literal}").parse::<toml::Table>().is_ok(), "{path}: {literal}");
            }
        }
    }
}

/// A file in which every key has its example, so that each example is read by the rules of its key.
fn written_out(spec: &'static TableSpec, out: &mut String) {
    for key in spec.keys.iter().filter(|k| !k.example.is_empty()) {
        // These exclude each other in one limit.
        if spec.name == "limit" && ["min", "max_abs", "factor"].contains(&key.name) {
            continue;
        }
        out.push_str(&format!("{} = {}\n", key.name, key.example));
    }
    for key in spec.keys {
        if let Some(below) = key.kind.table() {
            let list = matches!(key.kind, Kind::Tables(_));
            out.push_str(&if list { format!("[[{}]]\n", below.name) } else { format!("[{}]\n", below.name) });
            written_out(below, out);
        }
    }
}

#[test]
fn every_example_is_accepted_by_its_own_key() {
    let mut text = String::new();
    written_out(&PROCEDURE_FILE, &mut text);
    // The examples of different keys do not fit together, so only problems of a single value count.
    if let Err(problems) = parse_procedure("examples", text.as_bytes()) {
        for p in &problems.list {
            let whole = [
                "is declared",
                "declares no channel",
                "has the role",
                "not an option",
                "not measure",
                "does not determine",
                "gives a",
                "is not declared",
                "a warm-up test needs",
                "is not a channel with",
                "is determined at rest",
                "are two tests",
                "beyond half the declared sample rate",
                "exclude each other",
                "cannot rest on another check",
                "needs a channel with the role",
                "need a channel with the role",
                "no channel has the role",
                "no channel with the role",
                "Looks are for tests of a unit at rest",
            ];
            assert!(whole.iter().any(|w| p.message.say(Lang::En).contains(w)), "{p}");
        }
    }
    let mut text = String::new();
    written_out(&LIMITS_FILE, &mut text);
    parse_limits("examples", text.as_bytes()).unwrap();
    let mut text = String::new();
    written_out(&MODEL_FILE, &mut text);
    if let Err(problems) = sagnac::config::model::parse("examples", text.as_bytes()) {
        for p in &problems.list {
            // Of the example of a kind, its parameters are no example of their own.
            assert!(p.token == "\"line\"" || p.token == "line", "{p}");
        }
    }
}

#[test]
fn the_schema_holds_every_key_with_its_description() {
    let both = schema::procedure();
    let [single, phased] = [0, 1].map(|i| both["oneOf"][i].clone());
    assert_eq!(both["oneOf"].as_array().unwrap().len(), 2);
    let (limits, model) = (schema::limits(), schema::model());
    for whole in [&both, &limits, &model] {
        assert_eq!(whole["$schema"], "https://json-schema.org/draft/2020-12/schema");
    }
    for (schema, root) in
        [(&single, &PROCEDURE_FILE), (&phased, &PHASES_FILE), (&limits, &LIMITS_FILE), (&model, &MODEL_FILE)]
    {
        let mut count = 0;
        count_described(schema, &mut count);
        // A table that may be a list too stands twice in the schema.
        assert!(count >= keys(root).len(), "{count}");
        assert_eq!(schema["additionalProperties"], false);
    }
    let schema = single;
    let role = &schema["properties"]["channel"]["items"]["properties"]["role"]["oneOf"];
    assert_eq!(role.as_array().unwrap().len(), Role::ALL.len());
    let ids = schema["properties"]["measurand"]["items"]["properties"]["id"]["enum"].as_array().unwrap();
    assert!(["angle_random_walk", "bias_repeatability"].iter().all(|id| ids.iter().any(|i| i == id)));
    assert_eq!(schema["properties"]["conditions"]["properties"]["warm_up"]["default"], "0 s");
}

/// Alternatives whose keys a file keeps to, none missing and none unknown.
fn forms_of(text: &str) -> Vec<usize> {
    let schema = schema::procedure();
    let file: toml::Table = text.parse().unwrap();
    let fits = |form: &serde_json::Value| {
        let known = form["properties"].as_object().unwrap();
        let required = form["required"].as_array().unwrap();
        file.keys().all(|k| known.contains_key(k))
            && required.iter().all(|k| file.contains_key(k.as_str().unwrap()))
    };
    let forms = schema["oneOf"].as_array().unwrap().iter().enumerate();
    forms.filter(|(_, f)| fits(f)).map(|(i, _)| i).collect()
}

#[test]
fn every_shipped_procedure_is_of_one_form_of_the_schema() {
    let forms: Vec<usize> = toml_files(&shipped(""))
        .iter()
        .flat_map(|path| {
            let text = std::fs::read_to_string(path).unwrap();
            let forms = forms_of(&text);
            assert_eq!(forms, [usize::from(text.contains("[[phase]]"))], "{}", path.display());
            forms
        })
        .collect();
    assert!(forms.contains(&0) && forms.contains(&1));
}

fn count_described(schema: &serde_json::Value, count: &mut usize) {
    if let Some(properties) = schema.get("properties").and_then(|p| p.as_object()) {
        for (name, value) in properties {
            let documented = value["description"].as_str().is_some_and(|d| d.len() > 8);
            let measurand = sagnac::measurand::find(name).is_some();
            assert!(documented || measurand, "{name}");
            *count += usize::from(documented);
        }
    }
    match schema {
        serde_json::Value::Object(o) => o.values().for_each(|v| count_described(v, count)),
        serde_json::Value::Array(a) => a.iter().for_each(|v| count_described(v, count)),
        _ => {}
    }
}

/// The part of a guide page between its marks.
fn between<'a>(page: &'a str, mark: &str) -> &'a str {
    let start = format!("<!-- {mark} -->\n");
    let (_, rest) = page.split_once(start.as_str()).unwrap_or_else(|| panic!("no mark {mark}"));
    rest.split_once("<!-- end -->").expect("end mark").0
}

#[test]
fn the_guide_is_the_key_tables() {
    let guide_folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/guide");
    let write = std::env::var_os("SAGNAC_WRITE_GUIDE").is_some();
    for (file, mark, made) in [
        ("procedure.md", "keys", guide::procedure_reference()),
        ("procedure.md", "measurands", guide::measurand_reference()),
        ("phases.md", "keys", guide::phases_reference()),
        ("limits.md", "keys", guide::limits_reference()),
        ("layout.md", "keys", guide::layout_reference()),
        ("model.md", "keys", guide::model_reference()),
        ("prove.md", "keys", guide::proof_reference()),
    ] {
        let path = guide_folder.join(file);
        let page = std::fs::read_to_string(&path).unwrap();
        let stands = between(&page, mark);
        if write {
            let (start, made) = (format!("<!-- {mark} -->\n"), made.trim_end().to_owned() + "\n");
            let page = page.replace(&format!("{start}{stands}"), &format!("{start}{made}"));
            std::fs::write(&path, page).unwrap();
        } else {
            let hint = "run the tests once with SAGNAC_WRITE_GUIDE=1";
            assert_eq!(stands.trim(), made.trim(), "{file} is not up to date; {hint}");
        }
    }
}

#[test]
fn the_files_shown_in_the_guide_are_sound() {
    let page = |name: &str| {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/guide").join(name);
        let text = std::fs::read_to_string(path).unwrap();
        let (_, rest) = text.split_once("```toml\n").expect("a block");
        rest.split_once("```").expect("its end").0.to_owned()
    };
    let procedure =
        parse_procedure("procedure.md", page("procedure.md").as_bytes()).unwrap_or_else(|e| panic!("{e}"));
    assert!(procedure.warnings.is_empty());
    let limits = parse_limits("limits.md", page("limits.md").as_bytes()).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(limits.value.set.limits.len(), 4);
    let layout = sagnac::config::layout::parse("layout.md", page("layout.md").as_bytes());
    let layout = layout.unwrap_or_else(|e| panic!("{e}"));
    assert_eq!((layout.record_bytes, layout.names().count()), (32, 11));
    let model = sagnac::config::model::parse("model.md", page("model.md").as_bytes())
        .unwrap_or_else(|e| panic!("{e}"));
    assert_eq!((model.claim.effects.len(), model.drivers.len()), (1, 1));
    let proof = sagnac::config::proof::parse("prove.md", page("prove.md").as_bytes(), Path::new("."))
        .unwrap_or_else(|e| panic!("{e}"));
    assert_eq!((proof.decoys.len(), proof.references.len(), proof.rules.len()), (1, 1, 3));
}
