//! `sagnac prove`: what is concealed is gone from what the engine sees, the answer is judged by the rules, the page says so.

use crate::support::{Said, root, sagnac};
use sagnac::config::proof;
use serde_json::Value;
use std::path::{Path, PathBuf};
use tempfile::{TempDir, tempdir};

const CLAIM: &str = "[recording]\ncase = \"unit\"\nsample_rate_hz = 0.1\n[noise]\nN_deg_rt_h = 0.01\n[bias]\nvalue_deg_h = 1.0\n\
    [uncertainty]\nN_rel = 0.02\nbias_deg_h = 5.0\n";

/// The temperature goes up and down and the bias with it.
const DRIVEN: &str = "[[driver]]\ncolumn = \"temp_degC\"\ntime_s = [0.0, 20000.0, 30000.0, 50000.0, 60000.0]\n\
    value = [20.0, 40.0, 40.0, 20.0, 25.0]\nnoise = 0.01\n[[driver]]\ncolumn = \"supply_v\"\ntime_s = [0.0, 60000.0]\n\
    value = [27.0, 27.0]\nnoise = 0.01\n[[effect]]\nkind = \"temp_linear\"\n[effect.parameters]\n\
    coefficient_deg_h_per_degC = 0.05\n";

const STEP: &str =
    "[[effect]]\nkind = \"bias_step\"\n[effect.parameters]\nstep_deg_h = 0.5\ntime_s = 30000.0\n";

/// A folder with the recording `r.csv` of a driven unit, its claim, and what a proof file begins with.
fn driven() -> (TempDir, String) {
    let dir = tempdir().unwrap();
    let at = dir.path();
    std::fs::write(at.join("truth.toml"), format!("{CLAIM}{DRIVEN}")).unwrap();
    std::fs::write(at.join("claim.toml"), CLAIM).unwrap();
    std::fs::write(at.join("step.toml"), format!("{CLAIM}{STEP}")).unwrap();
    let said = sagnac(at, &["simulate", "truth.toml", "--duration", "60000s", "--out", "r.csv"]);
    assert_eq!(said.code, 0, "{said:?}");
    let hash = sagnac::output::sha256(&std::fs::read(at.join("r.csv")).unwrap());
    let head = format!(
        "format = \"proof/1\"\ntitle = {{ en = \"Driven\", ru = \"Под действием\" }}\nquestion = \"Is it found?\"\n\
         [recording]\npath = \"r.csv\"\nsha256 = \"{hash}\"\n"
    );
    (dir, head)
}

fn prove(at: &Path, text: &str, out: &str) -> Said {
    std::fs::write(at.join("p.toml"), text).unwrap();
    sagnac(at, &["prove", "p.toml", "--out", out])
}

fn record(at: &Path, out: &str) -> Value {
    serde_json::from_slice(&std::fs::read(at.join(out).join("proof.json")).unwrap()).unwrap()
}

const CONCEALED: &str = "[conceal]\ncolumns = [\"temp_degC\"]\n[[decoy]]\nname = \"decoy_1\"\nof = \"temp_degC\"\n\
    shift = \"17000 s\"\n[claim]\nmodel = \"claim.toml\"\n[[reference]]\nid = \"k\"\nwhat = \"Coefficient\"\nlow = 0.049\n\
    high = 0.051\nunit = \"deg/h/degC\"\nsource = \"the model\"\n[[rule]]\nmust = \"verdict\"\nverdicts = [\"mismatch\"]\n\
    [[rule]]\nmust = \"course\"\ncolumns = [\"temp_degC\"]\nat_least = 0.95\n[[rule]]\nmust = \"not_follow\"\n\
    columns = [\"temp_degC\"]\n[[rule]]\nwhen = \"unveiled\"\nmust = \"name\"\nkinds = [\"temp_linear\"]\n[[rule]]\n\
    when = \"unveiled\"\nmust = \"follow\"\ncolumns = [\"temp_degC\"]\n[[rule]]\nwhen = \"unveiled\"\nmust = \"not_follow\"\n\
    columns = [\"decoy_1\"]\n[[rule]]\nwhen = \"unveiled\"\nmust = \"parameter\"\nkinds = [\"temp_linear\"]\n\
    parameter = \"coefficient_deg_h_per_degC\"\nreference = \"k\"\n[[rule]]\nwhen = \"unveiled\"\nmust = \"improve\"\n\
    at_least = 0.5\n";

#[test]
fn a_concealed_thermometer_is_inferred_and_then_named() {
    let (dir, head) = driven();
    let at = dir.path();
    let said = prove(at, &format!("{head}{CONCEALED}"), "p");
    assert_eq!(said.code, 0, "{said:?}");
    assert!(said.out.starts_with("PROVED") && said.out.contains("Rules that hold: all 8."), "{}", said.out);
    let proof = record(at, "p");
    // The hash of what is concealed stands first, and is that of the column.
    let rows = std::fs::read_to_string(at.join("r.csv")).unwrap();
    let place = rows.lines().next().unwrap().split(',').position(|n| n == "temp_degC").unwrap();
    let column = |line: &str| line.split(',').nth(place).unwrap().parse::<f64>().unwrap();
    let values: String = rows.lines().skip(1).map(|l| format!("{}\n", column(l))).collect();
    let hash = sagnac::output::sha256(values.as_bytes());
    assert_eq!(proof["hidden"][0]["sha256"], hash.as_str());
    let steps: Vec<&str> =
        proof["protocol"].as_array().unwrap().iter().map(|s| s["step"].as_str().unwrap()).collect();
    assert_eq!(steps, ["concealed", "claim", "shown", "explained", "unveiled", "explained_again"]);
    assert_eq!(proof["protocol"][0]["sha256"]["temp_degC"], hash.as_str());
    // At first the engine had the supply only; then the temperature and its shifted copy too.
    let columns = |of: &str| -> Vec<String> {
        let columns = proof[of]["columns"].as_array().unwrap();
        columns.iter().map(|c| c["name"].as_str().unwrap().to_owned()).collect()
    };
    assert_eq!(columns("concealed"), ["supply_v"]);
    let mut all = columns("unveiled");
    all.sort();
    assert_eq!(all, ["decoy_1", "supply_v", "temp_degC"]);
    let course = &proof["courses"][0];
    assert!(course["correlation"].as_f64().unwrap() > 0.95, "{course}");
    let found = &proof["references"][0]["found"];
    assert!((found["value"].as_f64().unwrap() - 0.05).abs() < 0.001, "{found}");
    // The folder holds together, and is rendered in another language.
    let verified = sagnac(at, &["verify", "p"]);
    assert_eq!(verified.code, 0, "{verified:?}");
    assert_eq!(sagnac(at, &["report", "p", "--lang", "ru", "--out", "ru"]).code, 0);
    let page = std::fs::read_to_string(at.join("ru/report.md")).unwrap();
    assert!(page.contains("Под действием") && page.contains("**Итог: доказано**"), "{page}");
    let html = std::fs::read_to_string(at.join("p/report.html")).unwrap();
    assert!(html.contains("What was hidden") && html.contains(&hash) && html.contains("<svg"));
}

#[test]
fn a_rule_that_does_not_hold_is_said_and_fails() {
    let (dir, head) = driven();
    let rules = CONCEALED
        .replace("kinds = [\"temp_linear\"]\n[[rule]]\nwhen", "kinds = [\"bias_step\"]\n[[rule]]\nwhen");
    assert_ne!(rules, CONCEALED);
    let said = prove(dir.path(), &format!("{head}{rules}"), "p");
    assert_eq!(said.code, 1, "{said:?}");
    assert!(said.out.starts_with("NOT PROVED") && said.out.contains("does not hold"), "{}", said.out);
    let proof = record(dir.path(), "p");
    let held = proof["rules"].as_array().unwrap().iter().filter(|r| r["holds"] == true).count();
    assert_eq!((proof["outcome"].as_str(), held), (Some("fails"), 7));
}

#[test]
fn an_added_effect_is_recovered_and_an_untouched_part_is_consistent() {
    let (dir, head) = driven();
    let at = dir.path();
    // Constant temperature: nothing but noise is in this part.
    let part = "from = \"20500 s\"\nto = \"29500 s\"\n";
    let claim = "[claim]\nmodel = \"claim.toml\"\n";
    let null = format!("{head}{part}{claim}[[rule]]\nmust = \"verdict\"\nverdicts = [\"consistent\"]\n");
    let said = prove(at, &null, "null");
    assert_eq!(said.code, 0, "{said:?}");
    assert!(record(at, "null")["hidden"].as_array().unwrap().is_empty());
    let step = std::fs::read_to_string(at.join("step.toml")).unwrap().replace("30000.0", "25000.0");
    std::fs::write(at.join("step.toml"), step).unwrap();
    let added = format!(
        "{head}{part}[conceal]\neffects = \"step.toml\"\n{claim}[[rule]]\nmust = \"name\"\nkinds = [\"bias_step\"]\n\
         [[rule]]\nmust = \"locate\"\ndomain = \"time\"\nlow = 24000\nhigh = 26000\n[[rule]]\nmust = \"recover\"\nat_least = 0.9\n"
    );
    let said = prove(at, &added, "added");
    assert_eq!(said.code, 0, "{said:?}");
    let proof = record(at, "added");
    assert_eq!((proof["hidden"][0]["what"].as_str(), proof["unveiled"].is_null()), (Some("added"), true));
    assert!(proof["courses"][0]["recovered_share"].as_f64().unwrap() > 0.9);
}

#[test]
fn a_claim_is_identified_from_a_part_or_another_output() {
    let dir = tempdir().unwrap();
    let at = dir.path();
    std::fs::write(at.join("truth.toml"), format!("{CLAIM}{STEP}")).unwrap();
    let proof = "format = \"proof/1\"\ntitle = \"Step\"\nquestion = \"Is it found?\"\n[recording]\nsimulated = \"truth.toml\"\n\
        duration = \"60000 s\"\nfrom = \"20000 s\"\n[claim]\nto = \"20000 s\"\n[[rule]]\nmust = \"name\"\nkinds = [\"bias_step\"]\n";
    let said = prove(at, proof, "p");
    assert_eq!(said.code, 0, "{said:?}");
    let record = record(at, "p");
    assert_eq!(
        (record["claim"].as_str(), record["hidden"][0]["what"].as_str()),
        (Some("part"), Some("simulated"))
    );
    let model = sagnac::config::model::load(&at.join("p/model.toml")).unwrap();
    assert!((model.noise.n / 0.01 - 1.0).abs() < 0.1, "{}", model.noise.n);
}

#[test]
fn what_cannot_be_proved_is_refused_with_one_diagnostic() {
    let (dir, head) = driven();
    let at = dir.path();
    let whole = format!("{head}{CONCEALED}");
    for (from, to, part) in [
        ("sha256 = \"", "sha256 = \"0", "not the recording of this proof"),
        ("path = \"r.csv\"", "path = \"gone.csv\"", "--data names the folder"),
        (
            "columns = [\"temp_degC\"]\n[[decoy]]",
            "columns = [\"pressure\"]\n[[decoy]]",
            "no column `pressure`",
        ),
        ("of = \"temp_degC\"", "of = \"nothing\"", "no column `nothing`"),
        ("must = \"verdict\"", "must = \"guess\"", "p.toml:"),
    ] {
        let said = prove(at, &whole.replacen(from, to, 1), "refused");
        assert_eq!(said.code, 2, "{to}: {said:?}");
        assert!(said.err.contains(part) && said.err.matches("error: ").count() == 1, "{to}: {}", said.err);
        assert!(!at.join("refused").exists(), "{to}");
    }
}

/// Every file below a folder.
fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().path());
    entries.flat_map(|p| if p.is_dir() { files(&p) } else { vec![p] }).collect()
}

#[test]
fn every_proof_of_the_project_is_sound_and_every_run_of_one_is_listed() {
    let page = std::fs::read_to_string(root().join("docs/PROOFS.md")).unwrap();
    let mut proofs = 0;
    for file in files(&root().join("proofs")) {
        if !std::fs::read_to_string(&file).unwrap().starts_with("format = \"proof/1\"") {
            sagnac::config::model::load(&file).unwrap_or_else(|e| panic!("{e}"));
            continue;
        }
        proof::load(&file).unwrap_or_else(|e| panic!("{e}"));
        let name = file.strip_prefix(root()).unwrap().display().to_string();
        assert!(page.contains(&format!("`{name}`")), "{name} is not in docs/PROOFS.md");
        proofs += 1;
    }
    assert!(proofs >= 40, "{proofs}");
}
