//! Runs of the program that several tests read. Each is made once, at its first use, in a folder that is read-only
//! afterwards, so that no test depends on what another one leaves.

use super::{Said, files, limits, procedure, result, sagnac_as_typed, sample, shipped};
use serde_json::Value;
use std::collections::HashMap;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::sync::{LazyLock, Mutex, OnceLock};

/// A run of the program and what it wrote.
#[derive(Debug)]
pub struct SharedRun {
    /// Exit code and texts of the program.
    pub said: Said,
    /// The result: a folder or, of a simulation, a file.
    pub out: PathBuf,
    record: OnceLock<Value>,
}

impl SharedRun {
    /// `result.json`, parsed.
    pub fn result(&self) -> &Value {
        self.record.get_or_init(|| result(&self.out))
    }

    /// A text file of the result.
    pub fn text(&self, file: &str) -> String {
        fs::read_to_string(self.out.join(file)).unwrap_or_else(|e| panic!("{file}: {e}: {:?}", self.said))
    }

    /// The path of the result, for a command line.
    pub fn path(&self) -> &str {
        self.out.to_str().unwrap()
    }

    /// Copies a result folder to a place where a test may change it.
    pub fn copy_to(&self, place: &Path) {
        for (name, bytes) in files(&self.out) {
            let file = place.join(name);
            fs::create_dir_all(file.parent().unwrap()).unwrap();
            fs::write(file, bytes).unwrap();
        }
    }
}

/// The run of a command line in a folder of its own, with `--out` added.
pub fn shared(args: &[&str], out: &str) -> &'static SharedRun {
    static RUNS: LazyLock<Mutex<HashMap<String, &'static OnceLock<SharedRun>>>> =
        LazyLock::new(Mutex::default);
    let typed = [args, &["--out", out]].concat();
    // Only the list is locked: different runs are made side by side.
    let run =
        *RUNS.lock().unwrap().entry(typed.join("\0")).or_insert_with(|| Box::leak(Box::new(OnceLock::new())));
    run.get_or_init(|| {
        let folder = tempfile::tempdir_in(home()).unwrap().keep();
        // In English, whatever the language of the machine.
        let said = sagnac_as_typed(&folder, &typed, &[("LC_ALL", "C.UTF-8")]);
        make_read_only(&folder, true);
        SharedRun { said, out: folder.join(out), record: OnceLock::new() }
    })
}

/// A sample tested with the static procedure and the limits of the samples as unit SN-1.
pub fn tested_once(name: &str) -> &'static SharedRun {
    shared(&["run", &procedure(), &sample(name), "--limits", &limits(), "--serial", "SN-1"], "r")
}

/// A sample analysed without a procedure.
pub fn analyzed_once(name: &str) -> &'static SharedRun {
    shared(&["analyze", &sample(name)], "a")
}

/// The samples of an acceptance test in three phases, tested.
pub fn phased_once(end: &str) -> &'static SharedRun {
    let manifest = shipped(&format!("samples/acceptance-{end}.toml"));
    shared(&["run", &shipped("procedures/acceptance.toml"), &manifest], "r")
}

/// An input that several tests read, written at its first use; its path, for a command line.
pub fn shared_input(name: &str, content: impl FnOnce() -> String) -> String {
    static WRITING: Mutex<()> = Mutex::new(());
    let path = home().join(name);
    let _writing = WRITING.lock().unwrap();
    if !path.exists() {
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(&path, content()).unwrap();
        make_read_only(&path, true);
    }
    path.to_str().unwrap().to_owned()
}

/// The folder of this process below `target/tmp`. A test program drops nothing at its end, so the folders of those that
/// have ended, whose locks are free, are removed here.
fn home() -> &'static Path {
    static HOME: LazyLock<(PathBuf, File)> = LazyLock::new(|| {
        let place = Path::new(env!("CARGO_TARGET_TMPDIR")).join("shared-runs");
        fs::create_dir_all(&place).unwrap();
        let beginning = File::create(place.join("begin.lock")).unwrap();
        beginning.lock().unwrap();
        for entry in fs::read_dir(&place).unwrap().flatten().filter(|e| e.path().is_dir()) {
            let lock = entry.path().with_extension("lock");
            if File::create(&lock).is_ok_and(|lock| lock.try_lock().is_ok()) {
                make_read_only(&entry.path(), false);
                fs::remove_dir_all(entry.path()).unwrap();
                fs::remove_file(lock).unwrap();
            }
        }
        let folder = place.join(std::process::id().to_string());
        let lock = File::create(folder.with_extension("lock")).unwrap();
        lock.lock().unwrap();
        fs::create_dir(&folder).unwrap();
        (folder, lock)
    });
    &HOME.0
}

/// Takes away, or gives back, the right to write a file, or a folder and all that is in it.
fn make_read_only(path: &Path, read_only: bool) {
    let set = || {
        let mut rights = fs::metadata(path).unwrap().permissions();
        rights.set_readonly(read_only);
        fs::set_permissions(path, rights).unwrap();
    };
    // A folder is opened before its content can be, and closed after it.
    if !read_only {
        set();
    }
    if path.is_dir() {
        fs::read_dir(path).unwrap().flatten().for_each(|e| make_read_only(&e.path(), read_only));
    }
    if read_only {
        set();
    }
}
