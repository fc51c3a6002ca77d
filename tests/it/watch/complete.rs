//! When a recording is complete.

use super::{Bench, pairs};
use crate::support::quick::Quick;
use std::fs;
use std::time::SystemTime;

/// Sets the time of the last change of a file of the folder to now.
fn touch(bench: &Bench, name: &str) {
    let file = fs::File::options().write(true).open(bench.at("in").join(name)).unwrap();
    file.set_modified(SystemTime::now()).unwrap();
}

#[test]
fn a_file_that_changes_or_is_cut_off_is_not_tested() {
    let bench = Bench::new("");
    bench.put("a_SN-1.csv", "pass");
    bench.numbered("b_SN-2.csv", 2);
    touch(&bench, "b_SN-2.csv");
    let whole = fs::read_to_string(Quick::new("fail").recording).unwrap();
    let (cut, _) = whole.trim_end().rsplit_once(',').unwrap();
    bench.write("c_SN-3.csv", cut);
    bench.write("d_SN-4.csv", "");
    let said = bench.once();
    assert_eq!(said.code, 0, "{said:?}");
    assert_eq!(bench.verdicts(), pairs(&[("SN-1", "pass")]));
    let expected = [
        ("b_SN-2.csv", "watch.not_still"),
        ("c_SN-3.csv", "watch.cut_off"),
        ("d_SN-4.csv", "watch.not_opened"),
    ];
    assert_eq!(bench.untested(), pairs(&expected));
    bench.write("c_SN-3.csv", &whole);
    assert_eq!(bench.once().code, 1);
    assert_eq!(bench.verdicts(), pairs(&[("SN-1", "pass"), ("SN-3", "fail")]));
}

#[test]
fn a_marker_says_that_the_writer_is_done() {
    let bench = Bench::with_pattern("*_{serial}.*", "complete = \"marker\"\nmarker = \".ready\"\n");
    bench.put("a_SN-1.csv", "pass");
    touch(&bench, "a_SN-1.csv");
    bench.once();
    assert_eq!(bench.untested(), pairs(&[("a_SN-1.csv", "watch.no_marker")]));
    bench.write("a_SN-1.csv.ready", "");
    assert_eq!(bench.once().code, 0);
    assert_eq!(bench.verdicts(), pairs(&[("SN-1", "pass")]));
    assert!(bench.untested().is_empty());
}

#[test]
fn a_footer_or_the_name_says_it_at_once() {
    let bench = Bench::new("complete = \"footer\"\n");
    bench.put("a_SN-1.csv", "pass");
    bench.once();
    assert_eq!(bench.untested(), pairs(&[("a_SN-1.csv", "watch.no_footer")]));
    bench.rule("*_{serial}.csv", "complete = \"name\"\n");
    touch(&bench, "a_SN-1.csv");
    assert_eq!(bench.once().code, 0);
    assert_eq!(bench.verdicts(), pairs(&[("SN-1", "pass")]));
}

#[cfg(unix)]
#[test]
fn links_pipes_and_hidden_files_are_not_read() {
    let bench = Bench::new("");
    bench.put(".a_SN-1.csv", "pass");
    fs::write(bench.at("secret.csv"), "time_s,rate_deg_h\n0,1\n").unwrap();
    std::os::unix::fs::symlink("../secret.csv", bench.at("in/b_SN-2.csv")).unwrap();
    let made = std::process::Command::new("mkfifo").arg(bench.at("in/c_SN-3.csv")).status().unwrap();
    assert!(made.success());
    let said = bench.once();
    assert_eq!(said.code, 0, "{said:?}");
    let expected = [("b_SN-2.csv", "watch.link"), ("c_SN-3.csv", "watch.no_file")];
    assert_eq!((bench.untested(), bench.results()), (pairs(&expected), vec![]));
}

#[test]
fn nothing_is_written_into_the_folder() {
    let bench = Bench::new("");
    bench.put("a_SN-1.csv", "pass");
    let args = ["watch", "in", "--rules", "watch.toml", "--out", "in/out", "--once"];
    let said = crate::support::sagnac_as_typed(bench.folder(), &args, &[]);
    assert!(said.code == 2 && said.err.contains("lies in the watched folder"), "{said:?}");
    bench.once();
    assert_eq!(crate::support::names(&bench.at("in")), ["a_SN-1.csv"]);
}
