//! Many writers, and writers that are killed.

use crate::store::{kept, store, store_says, with_store, write_results};
use crate::support::{names, program};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

fn start(folder: &Path, args: &[&str]) -> Child {
    Command::new(program())
        .current_dir(folder)
        .args(args)
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap()
}

fn all_write_at_once(options: &[&str]) {
    const WRITERS: usize = 8;
    let dir = tempfile::tempdir().unwrap();
    store(dir.path(), &[&["init", "store"], options].concat());
    write_results(&dir.path().join("made"), 5 * WRITERS);
    let children: Vec<Child> = (0..WRITERS)
        .map(|w| {
            let own: Vec<String> = (0..5)
                .flat_map(|i| [1, 2].map(|attempt| format!("made/u{:03}-{attempt}", WRITERS * i + w)))
                .collect();
            // Every writer has the results of its neighbour too: what is there already is not doubled.
            let next: Vec<String> =
                (0..5).map(|i| format!("made/u{:03}-1", WRITERS * i + (w + 1) % WRITERS)).collect();
            let args: Vec<&str> = ["store", "import", "store"]
                .into_iter()
                .chain(own.iter().chain(&next).map(String::as_str))
                .collect();
            start(dir.path(), &args)
        })
        .collect();
    for child in children {
        let output = child.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    }
    assert_eq!(kept(&dir.path().join("store")).len(), 10 * WRITERS);
    let said = store(dir.path(), &["verify", "store"]);
    assert!(said.out.contains(&format!("Results: {}; ", 10 * WRITERS)), "{}", said.out);
    assert!(names(&dir.path().join("store/pending")).is_empty());
}

#[test]
fn eight_writers_lose_and_double_nothing() {
    all_write_at_once(&[]);
}

#[test]
fn eight_writers_on_a_shared_disk_lose_and_double_nothing() {
    all_write_at_once(&["--shared-disk"]);
}

/// Kills imports at random moments; gives how many were killed in their course.
fn kill_at_random_moments(times: usize, seed: u64) -> usize {
    const UNITS: usize = 12;
    let dir = with_store();
    write_results(&dir.path().join("made"), UNITS);
    let import = ["store", "import", "store", "made"];
    // How long a whole import takes, into a store beside.
    store(dir.path(), &["init", "beside"]);
    let began = Instant::now();
    store(dir.path(), &["import", "beside", "made"]);
    let whole = began.elapsed();
    let mut random = Xoshiro256PlusPlus::seed_from_u64(seed);
    let (mut killed, mut there) = (0, 0);
    for i in 0..times {
        if i % 6 == 0 {
            std::fs::remove_dir_all(dir.path().join("store")).unwrap();
            store(dir.path(), &["init", "store"]);
            there = 0;
        }
        let mut child = start(dir.path(), &import);
        let share: f64 = random.random();
        std::thread::sleep(whole.mul_f64(share).min(Duration::from_secs(10)));
        child.kill().unwrap();
        killed += usize::from(child.wait().unwrap().code().is_none());
        // Opening it takes up what is there without a row.
        let said = store_says(dir.path(), &["verify", "store"]);
        assert_eq!(said.code, 0, "kill {i}: {said:?}");
        let now = kept(&dir.path().join("store")).len();
        assert!(now >= there, "kill {i}: {now} of {there} results are left");
        there = now;
    }
    let said = store(dir.path(), &import[1..]);
    let total = 2 * UNITS;
    assert!(said.out.contains(&format!("Added: {}; there already: {there}", total - there)), "{}", said.out);
    assert_eq!(kept(&dir.path().join("store")).len(), total);
    store(dir.path(), &["verify", "store"]);
    let hidden = names(&dir.path().join("store/results")).into_iter().filter(|n| n.starts_with('.')).count();
    assert_eq!(hidden, 0, "what dead writers left is removed by the next");
    println!("{times} imports: {killed} killed in their course");
    killed
}

#[test]
fn a_killed_writer_leaves_every_result_whole_or_none_of_it() {
    let killed = kill_at_random_moments(36, 5);
    // About half; fewer where the machine is busy with other work now and not at the next moment.
    assert!(killed >= 9, "{killed} of 36 were killed in their course");
}

#[test]
#[ignore = "takes minutes"]
fn a_killed_writer_leaves_every_result_whole_or_none_of_it_300_times() {
    let killed = kill_at_random_moments(300, 13);
    assert!(killed >= 150, "{killed} of 300 were killed in their course");
}
