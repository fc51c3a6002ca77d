//! Who is told of a verdict: hook commands, and readers of the page of the day.

use super::Bench;
use crate::support::{sagnac, sagnac_as_typed};
use serde_json::Value;
use std::fs;

#[cfg(unix)]
#[test]
fn a_hook_is_told_once_and_again_where_it_failed_without_another_test() {
    let script = "test -e open || { echo no network >&2; exit 7; }; cat >> told.jsonl";
    let bench = Bench::new(&format!("hook = [\"sh\", \"-c\", \"{script}\"]\n"));
    bench.put("a_SN-1.csv", "pass");
    let said = bench.once();
    assert!(said.code == 2 && said.err.contains("no network"), "{said:?}");
    assert_eq!(bench.record()["tests"][0]["hook"], "pending");
    let made = bench.results();
    fs::write(bench.at("open"), "").unwrap();
    let said = bench.once();
    assert_eq!(said.code, 0, "{said:?}");
    assert_eq!(bench.record()["tests"][0]["hook"], "told");
    assert_eq!(bench.results(), made);
    assert_eq!(bench.once().code, 0);
    let told = fs::read_to_string(bench.at("told.jsonl")).unwrap();
    let events: Vec<Value> = told.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let [event] = events.as_slice() else { panic!("{told}") };
    assert_eq!(
        (&event["format"], &event["serial"], &event["verdict"]),
        (&"watch-event/1".into(), &"SN-1".into(), &"pass".into())
    );
    assert_eq!(event["id"], bench.record()["tests"][0]["id"]);
    let result: Value =
        serde_json::from_slice(&fs::read(event["result"].as_str().unwrap()).unwrap()).unwrap();
    assert_eq!(result["verdict"], "pass");
}

#[test]
fn the_page_of_the_day_is_in_both_languages_and_leads_to_the_results() {
    let bench = Bench::new("");
    bench.put("a_SN-1.csv", "pass");
    bench.put("b_SN-2.csv", "fail");
    bench.write("c_SN-3.csv", "");
    let args = [&Bench::ONCE[..], &["--lang", "ru"]].concat();
    assert_eq!(sagnac_as_typed(bench.folder(), &args, &[]).code, 1);
    let page = fs::read_to_string(bench.day().join("index.html")).unwrap();
    for said in ["Страница дня", "Не испытано", "SN-2", "запись не закончена или повреждена"]
    {
        assert!(page.contains(said), "{said}");
    }
    for (place, _) in bench.results() {
        let below = place.strip_prefix(bench.at("out/results")).unwrap().to_str().unwrap().to_owned();
        let link = format!("../../results/{below}/report.html");
        assert!(page.contains(&format!("href=\"{link}\"")), "{link}");
        assert!(bench.day().join(link).is_file());
        let report = fs::read_to_string(place.join("report.html")).unwrap();
        assert!(report.contains("lang=\"ru\""));
    }
    let day = bench.day();
    let again = ["report", day.to_str().unwrap(), "--lang", "en", "--out", "english"];
    let said = sagnac(bench.folder(), &again);
    assert_eq!(said.code, 0, "{said:?}");
    let page = fs::read_to_string(bench.at("english/index.md")).unwrap();
    for said in ["Worst verdict: fail", "Not tested", "SN-1", "incomplete or damaged"] {
        assert!(page.contains(said), "{said}: {page}");
    }
    assert!(!page.contains("Испыт"), "{page}");
}
