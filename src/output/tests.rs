use super::*;

const FIRST: &str = "{\n  \"format\": \"result/1\",\n  \"round\": 1\n}";
const SECOND: &str = "{\"format\":\"result/1\",\"round\":2}";

fn staged(target: &Path, result: &str) -> StagedFolder {
    let staged = StagedFolder::begin(target).unwrap();
    staged.write("result.json", result.as_bytes()).unwrap();
    staged.write("figures/a.svg", b"<svg/>").unwrap();
    staged
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
    for round in [FIRST, SECOND] {
        staged(&target, round).publish().unwrap();
        assert_eq!(fs::read_to_string(target.join("result.json")).unwrap(), round);
    }
    assert_eq!(entries(dir.path()), ["result"], "nothing but the result stays");
    fs::create_dir(dir.path().join("empty")).unwrap();
    staged(&dir.path().join("empty"), FIRST).publish().unwrap();
    assert_eq!(entries(&dir.path().join("empty")), ["figures", "result.json"]);
}

#[test]
fn without_an_exchange_the_old_folder_steps_aside() {
    let dir = tempfile::tempdir().unwrap();
    let target = dir.path().join("result");
    for round in [FIRST, SECOND] {
        let path = staged(&target, round).staging.keep();
        replace_in_two_steps(&path, &target, Kind::Result).unwrap();
        assert_eq!(fs::read_to_string(target.join("result.json")).unwrap(), round);
        assert_eq!(entries(dir.path()), ["result"]);
    }
}

#[test]
fn abandoned_work_leaves_nothing_and_foreign_folders_are_safe() {
    let dir = tempfile::tempdir().unwrap();
    let target = dir.path().join("result");
    drop(staged(&target, FIRST));
    assert!(entries(dir.path()).is_empty());

    fs::create_dir(&target).unwrap();
    let refused = || matches!(StagedFolder::begin(&target), Err(OutputError::InTheWay { .. }));
    fs::write(target.join("thesis.txt"), "do not touch").unwrap();
    assert!(refused());
    fs::write(target.join("result.json"), "{\"format\": \"another program\"}").unwrap();
    assert!(refused());
    fs::write(target.join("result.json"), FIRST).unwrap();
    assert!(refused(), "a result with something of the user's in it");
    fs::remove_file(target.join("thesis.txt")).unwrap();
    assert!(!refused());
}

#[test]
fn what_comes_while_the_work_goes_on_is_safe() {
    let dir = tempfile::tempdir().unwrap();
    let target = dir.path().join("result");
    let (one, two, three) = (staged(&target, FIRST), staged(&target, SECOND), staged(&target, FIRST));
    one.publish().unwrap();
    two.publish().unwrap();
    assert_eq!(fs::read_to_string(target.join("result.json")).unwrap(), SECOND);
    fs::write(target.join("scan.pdf"), "signed").unwrap();
    let refused = three.publish().unwrap_err().to_string();
    assert!(refused.contains("holds `scan.pdf`"), "{refused}");
    assert_eq!(fs::read_to_string(target.join("scan.pdf")).unwrap(), "signed");
    assert_eq!(entries(dir.path()), ["result"]);
}

#[test]
fn only_what_is_old_and_ours_is_cleared_away() {
    let dir = tempfile::tempdir().unwrap();
    let age = |name: &str, hours: u64, file: &str| {
        let folder = dir.path().join(name);
        fs::create_dir(&folder).unwrap();
        fs::write(folder.join(file), "half").unwrap();
        let then = SystemTime::now() - Duration::from_secs(hours * 3600);
        File::open(&folder).unwrap().set_modified(then).unwrap();
    };
    age(".r.partial-oldOLD", 25, "report.md");
    age(".r.partial-newNEW", 23, "report.md");
    age(".r.partial-notOWN", 25, "thesis.txt");
    age(".r.partial-longer-name", 25, "report.md");
    age(".other.partial-oldOLD", 25, "report.md");
    let begun = StagedFolder::begin(&dir.path().join("r")).unwrap();
    let own = begun.staging.path().file_name().unwrap().to_string_lossy().into_owned();
    let left: Vec<String> = entries(dir.path()).into_iter().filter(|n| *n != own).collect();
    assert_eq!(
        left,
        [".other.partial-oldOLD", ".r.partial-longer-name", ".r.partial-newNEW", ".r.partial-notOWN"]
    );
}

#[test]
fn names_that_are_no_folder_to_be_made_are_refused() {
    for odd in ["..", "/", "", "a/.."] {
        let refused = StagedFolder::begin(Path::new(odd));
        assert!(matches!(refused, Err(OutputError::NoName(_))), "{odd}");
    }
    let dir = tempfile::tempdir().unwrap();
    let begun = StagedFolder::begin(&dir.path().join("r")).unwrap();
    assert!(matches!(begun.write("notes.txt", b""), Err(OutputError::Unforeseen(_))));
}
