use super::partial::{prefix, remove_abandoned};
use super::*;
use serde_json::json;
use std::time::{Duration, SystemTime};

fn order(unit: &str, force: bool) -> Order {
    Order { inputs: BTreeMap::from([("unit".to_owned(), unit.to_owned())]), force, ..Order::default() }
}

fn begin(target: &Path) -> Result<StagedFolder, OutputError> {
    StagedFolder::begin(target, Kind::Result, order("1", false))
}

fn staged_by(target: &Path, order: Order) -> StagedFolder {
    let staged = StagedFolder::begin(target, Kind::Result, order).unwrap();
    staged.write("figures/a.svg", b"<svg/>").unwrap();
    staged
}

fn staged(target: &Path) -> StagedFolder {
    staged_by(target, order("1", false))
}

fn record(round: u64) -> serde_json::Value {
    json!({"format": "result/1", "round": round})
}

fn round(target: &Path) -> u64 {
    let text = fs::read_to_string(target.join("result.json")).unwrap();
    serde_json::from_str::<serde_json::Value>(&text).unwrap()["round"].as_u64().unwrap()
}

fn entries(folder: &Path) -> Vec<String> {
    let names = fs::read_dir(folder).unwrap();
    let mut names: Vec<String> =
        names.map(|e| e.unwrap().file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

#[test]
fn a_folder_appears_whole_and_replaces_an_earlier_result() {
    let dir = tempfile::tempdir().unwrap();
    let target = dir.path().join("result");
    for n in [1, 2] {
        staged(&target).publish(record(n)).unwrap();
        assert_eq!(round(&target), n);
    }
    assert_eq!(entries(dir.path()), ["result"], "nothing but the result stays");
    fs::create_dir(dir.path().join("empty")).unwrap();
    staged(&dir.path().join("empty")).publish(record(1)).unwrap();
    assert_eq!(entries(&dir.path().join("empty")), ["SHA256SUMS", "figures", "result.json"]);
}

#[test]
fn a_result_of_other_inputs_is_replaced_by_force_only() {
    let dir = tempfile::tempdir().unwrap();
    let target = dir.path().join("result");
    let meanwhile = staged_by(&target, order("2", false));
    staged(&target).publish(record(1)).unwrap();
    let refused = StagedFolder::begin(&target, Kind::Result, order("2", false));
    assert!(matches!(refused, Err(OutputError::Other { differ, .. }) if differ == ["unit"]));
    assert!(matches!(meanwhile.publish(record(2)), Err(OutputError::Other { .. })));
    assert_eq!((round(&target), entries(dir.path())), (1, vec!["result".to_owned()]));
    let forced = staged_by(&target, order("2", true));
    assert!(forced.replaces().is_some());
    forced.publish(record(2)).unwrap();
    assert_eq!((round(&target), entries(dir.path())), (2, vec!["result".to_owned()]));
}

#[test]
fn runs_that_name_their_own_place_take_the_next_free_one() {
    let dir = tempfile::tempdir().unwrap();
    let target = dir.path().join("result");
    let fresh = || staged_by(&target, Order { fresh: true, ..order("1", false) });
    let begun: Vec<StagedFolder> = (0..4).map(|_| fresh()).collect();
    let mut places: Vec<PathBuf> = std::thread::scope(|scope| {
        let runs: Vec<_> =
            begun.into_iter().map(|run| scope.spawn(|| run.publish(record(1)).unwrap())).collect();
        runs.into_iter().map(|run| run.join().unwrap()).collect()
    });
    places.sort();
    let names = ["result", "result_2", "result_3", "result_4"];
    assert_eq!(places, names.map(|name| dir.path().join(name)));
    assert_eq!(entries(dir.path()), names);
    for place in &places {
        assert_eq!(entries(place), ["SHA256SUMS", "figures", "result.json"]);
    }
    fs::write(dir.path().join("result_5"), "of the user").unwrap();
    assert_eq!(fresh().publish(record(2)).unwrap(), dir.path().join("result_6"));
    assert_eq!((round(&target), entries(dir.path()).len()), (1, 6));
}

#[test]
fn an_input_in_the_folder_of_the_result_is_refused() {
    let dir = tempfile::tempdir().unwrap();
    let target = dir.path().join("result");
    staged(&target).publish(record(1)).unwrap();
    for input in ["result/figures/a.svg", "result/not-there.csv", "result/result.json"] {
        let order = Order { read: vec![dir.path().join(input)], ..order("1", true) };
        let refused = StagedFolder::begin(&target, Kind::Result, order);
        assert!(matches!(refused, Err(OutputError::InputInside { .. })), "{input}");
    }
}

#[test]
fn without_an_exchange_the_old_folder_steps_aside() {
    let dir = tempfile::tempdir().unwrap();
    let target = dir.path().join("result");
    staged(&target).publish(record(1)).unwrap();
    let beside = dir.path().join("beside");
    staged(&beside).publish(record(2)).unwrap();
    replace_in_two_steps(&beside, &target, Kind::Result, &order("1", false)).unwrap();
    assert_eq!((round(&target), entries(dir.path())), (2, vec!["result".to_owned()]));
}

#[test]
fn abandoned_work_leaves_nothing_and_foreign_folders_are_safe() {
    let dir = tempfile::tempdir().unwrap();
    let target = dir.path().join("result");
    drop(staged(&target));
    assert!(entries(dir.path()).is_empty());

    fs::create_dir(&target).unwrap();
    let refused = || matches!(begin(&target), Err(OutputError::InTheWay { .. }));
    fs::write(target.join("thesis.txt"), "do not touch").unwrap();
    assert!(refused());
    fs::write(target.join("result.json"), "{\"format\": \"another program\"}").unwrap();
    assert!(refused());
    fs::remove_file(target.join("thesis.txt")).unwrap();
    fs::write(target.join("result.json"), "{\"format\": \"result/1\"}").unwrap();
    assert!(refused(), "a result that does not list its files");
    fs::remove_dir_all(&target).unwrap();
    staged(&target).publish(record(1)).unwrap();
    for name in ["thesis.txt", "figures/photo.jpg", "phases/recording.csv", "figures/.hidden/x"] {
        fs::create_dir_all(target.join(name).parent().unwrap()).unwrap();
        fs::write(target.join(name), "of the user").unwrap();
        for force in [false, true] {
            let refused = StagedFolder::begin(&target, Kind::Result, order("2", force));
            assert!(matches!(refused, Err(OutputError::InTheWay { .. })), "{name}");
        }
        fs::remove_file(target.join(name)).unwrap();
        if name.contains("phases") || name.contains("hidden") {
            assert!(refused(), "an empty folder of the user's");
            fs::remove_dir(target.join(name).parent().unwrap()).unwrap();
        }
    }
    assert!(!refused());
}

#[test]
fn what_comes_while_the_work_goes_on_is_safe() {
    let dir = tempfile::tempdir().unwrap();
    let target = dir.path().join("result");
    let (one, two, three) = (staged(&target), staged(&target), staged(&target));
    one.publish(record(1)).unwrap();
    two.publish(record(2)).unwrap();
    assert_eq!(round(&target), 2);
    fs::write(target.join("scan.pdf"), "signed").unwrap();
    let refused = three.publish(record(3)).unwrap_err().to_string();
    assert!(refused.contains("contains `scan.pdf`"), "{refused}");
    assert_eq!(fs::read_to_string(target.join("scan.pdf")).unwrap(), "signed");
    assert_eq!(entries(dir.path()), ["result"]);
}

#[test]
fn only_what_is_dead_and_ours_is_cleared_away() {
    let dir = tempfile::tempdir().unwrap();
    let age = |name: &str, hours: u64, file: &str| {
        let folder = dir.path().join(name);
        fs::create_dir(&folder).unwrap();
        fs::write(folder.join(file), "half").unwrap();
        let then = SystemTime::now() - Duration::from_secs(hours * 3600);
        File::open(&folder).unwrap().set_modified(then).unwrap();
    };
    // Without a lock that tells, age does.
    age(".r.partial-oldOLD", 25, "report.md");
    age(".r.partial-newNEW", 23, "report.md");
    age(".r.partial-notOWN", 25, "thesis.txt");
    age(".r.partial-longer-name", 25, "report.md");
    age(".s.partial-0123abcd-newNEW", 23, "report.md");
    age(".s.partial-0123abcd-oldOLD", 25, "report.md");
    age("r.partial-oldOLD", 25, "report.md");
    // A lock tells of this machine.
    let live = begin(&dir.path().join("r")).unwrap();
    age(&format!("{}deadDE", prefix("other")), 0, "report.md");
    age(&format!("{}notOWN", prefix("other")), 0, "thesis.txt");
    fs::write(dir.path().join(format!("{}deadDE", prefix("simulated.csv"))), "time_s").unwrap();
    remove_abandoned(dir.path());
    let own = live.staging.path().file_name().unwrap().to_string_lossy().into_owned();
    let mut expected = vec![
        ".r.partial-longer-name".to_owned(),
        ".r.partial-newNEW".to_owned(),
        ".r.partial-notOWN".to_owned(),
        ".s.partial-0123abcd-newNEW".to_owned(),
        "r.partial-oldOLD".to_owned(),
        format!("{}notOWN", prefix("other")),
        own,
    ];
    expected.sort();
    assert_eq!(entries(dir.path()), expected);
}

#[test]
fn names_that_are_no_folder_to_be_made_are_refused() {
    for odd in ["..", "/", "", "a/.."] {
        let refused = begin(Path::new(odd));
        assert!(matches!(refused, Err(OutputError::NoName(_))), "{odd}");
    }
    let dir = tempfile::tempdir().unwrap();
    let begun = begin(&dir.path().join("r")).unwrap();
    assert!(matches!(begun.write("notes.txt", b""), Err(OutputError::Unforeseen(_))));
}

#[test]
fn a_lot_appears_with_its_units_and_is_replaced_as_a_whole() {
    let dir = tempfile::tempdir().unwrap();
    let target = dir.path().join("lot");
    for n in [1, 2] {
        let lot = StagedFolder::begin(&target, Kind::Lot, order("1", false)).unwrap();
        let part = StagedPart::begin(&lot, "SN-1", BTreeMap::new());
        part.write("figures/a.svg", b"<svg/>").unwrap();
        assert!(matches!(part.write("notes.txt", b""), Err(OutputError::Unforeseen(_))));
        part.finish(record(n)).unwrap();
        assert_eq!(target.exists(), n > 1, "a unit that is done waits for the others");
        lot.write("index.html", b"<html/>").unwrap();
        lot.publish(json!({"format": "lot/1", "units": [1]})).unwrap();
        assert_eq!(entries(&target), ["SHA256SUMS", "SN-1", "index.html", "index.json"]);
        assert_eq!((round(&target.join("SN-1")), entries(dir.path()).len()), (n, 1));
    }
    fs::write(target.join("SN-1/notes.txt"), "of the user").unwrap();
    let refused = StagedFolder::begin(&target, Kind::Lot, order("1", true));
    assert!(matches!(refused, Err(OutputError::InTheWay { .. })));
}

#[test]
fn a_lot_that_a_killed_run_left_is_removed_and_a_folder_of_the_user_is_not() {
    let dir = tempfile::tempdir().unwrap();
    let left = |name: &str, file: &str| {
        let folder = dir.path().join(format!("{}{name}", prefix("lot")));
        fs::create_dir_all(folder.join("SN-1")).unwrap();
        fs::write(folder.join("SN-1").join(file), "").unwrap();
        folder
    };
    let (ours, other) = (left("abcdef", "report.html"), left("ghijkl", "notes.txt"));
    remove_abandoned(dir.path());
    assert!(!ours.exists() && other.exists());
}
