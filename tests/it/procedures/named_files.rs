//! Files that a procedure or a manifest names stand beside it or below: one rule, and no line of any other file is shown.

use crate::support::{sagnac, shipped};
use std::path::Path;
use std::time::Instant;
use tempfile::{TempDir, tempdir};

const SECRET: &str = "root:$6$not-to-be-seen:19000:0:99999:7:::";

/// Where the named file stands in each kind of file; `NAMED` is its path.
const KINDS: [(&str, &str); 6] = [
    (
        "explain.toml",
        "format = \"procedure/1\"\n[procedure]\nid = \"p\"\ntitle = \"P\"\nrevision = \"A\"\n[unit_under_test]\n\
         serial_required = false\n[recording]\nsample_rate = \"1 Hz\"\n[[channel]]\nid = \"rate\"\ncolumn = 1\n\
         role = \"rate\"\nunit = \"deg/h\"\n[[measurand]]\nid = \"angle_random_walk\"\n[explain]\nmodel = \"NAMED\"\n",
    ),
    (
        "layout.toml",
        "format = \"procedure/1\"\n[procedure]\nid = \"p\"\ntitle = \"P\"\nrevision = \"A\"\n[unit_under_test]\n\
         serial_required = false\n[recording]\nsample_rate = \"1 Hz\"\nlayout = \"NAMED\"\n[[channel]]\nid = \"rate\"\n\
         column = 1\nrole = \"rate\"\nunit = \"deg/h\"\n[[measurand]]\nid = \"angle_random_walk\"\n",
    ),
    (
        "phase.toml",
        "format = \"procedure/1\"\n[procedure]\nid = \"p\"\ntitle = \"P\"\nrevision = \"A\"\n[[phase]]\nid = \"one\"\n\
         procedure = \"NAMED\"\n",
    ),
    (
        "phase_limits.toml",
        "format = \"procedure/1\"\n[procedure]\nid = \"p\"\ntitle = \"P\"\nrevision = \"A\"\n[[phase]]\nid = \"one\"\n\
         procedure = \"sound.toml\"\nlimits = \"NAMED\"\n",
    ),
    ("manifest.toml", "format = \"manifest/1\"\n[[file]]\npath = \"NAMED\"\n"),
    ("manifest_layout.toml", "format = \"manifest/1\"\nfiles = \"r.csv\"\n[recording]\nlayout = \"NAMED\"\n"),
];

/// A folder `home` with a recording, and a file outside of it.
fn place() -> TempDir {
    let dir = tempdir().unwrap();
    let home = dir.path().join("home");
    std::fs::create_dir_all(home.join("limits")).unwrap();
    std::fs::write(dir.path().join("shadow"), format!("{SECRET}\n")).unwrap();
    std::fs::write(home.join("r.csv"), "rate\n1\n2\n3\n").unwrap();
    std::fs::copy(shipped("procedures/static-bias.toml"), home.join("sound.toml")).unwrap();
    dir
}

fn refused(home: &Path, named: &str, why: &str) {
    for (file, text) in KINDS {
        std::fs::write(home.join(file), text.replace("NAMED", named)).unwrap();
        let checked = sagnac(home, &["check", file]);
        let run = if text.contains("manifest/") {
            sagnac(home, &["analyze", file, "--out", "out"])
        } else {
            sagnac(home, &["run", file, "r.csv", "--out", "out"])
        };
        let line = text.lines().position(|l| l.contains("NAMED")).unwrap() + 1;
        for said in [&checked, &run] {
            let all = format!("{}{}", said.out, said.err);
            assert_eq!(said.code, 2, "{file} {named}: {said:?}");
            assert!(
                all.contains(why) && all.contains(&format!("{file}:{line}:")),
                "{file} {named}: {said:?}"
            );
            assert!(!all.contains("not-to-be-seen"), "{file} {named} shows a line: {said:?}");
        }
    }
}

#[test]
fn what_stands_outside_the_folder_is_refused_alike_and_never_shown() {
    let dir = place();
    let home = dir.path().join("home");
    let outside = dir.path().join("shadow");
    refused(&home, outside.to_str().unwrap(), "not a path relative to this file");
    refused(&home, "../shadow", "leads outside the folder");
    refused(&home, "limits/../../shadow", "leads outside the folder");
    refused(&home, "c:/shadow", "not a path relative to this file");
    refused(&home, "..\\\\shadow", "leads outside the folder");
    refused(&home, "none.toml", "there is no file");
    refused(&home, "limits", "is a folder");
}

#[cfg(unix)]
#[test]
fn a_link_that_leads_out_is_refused_alike() {
    let dir = place();
    let home = dir.path().join("home");
    std::os::unix::fs::symlink(dir.path().join("shadow"), home.join("link.toml")).unwrap();
    std::os::unix::fs::symlink(dir.path(), home.join("door")).unwrap();
    refused(&home, "link.toml", "link that leads out");
    refused(&home, "door/shadow", "link that leads out");
    refused(&home, "/dev/zero", "not a path relative to this file");
}

#[test]
fn paths_of_the_command_line_are_free() {
    let dir = place();
    let home = dir.path().join("home");
    std::fs::write(dir.path().join("r.csv"), "rate\n1\n2\n3\n").unwrap();
    let (file, text) = KINDS[2];
    std::fs::write(home.join(file), text.replace("NAMED", "sound.toml")).unwrap();
    let below = home.join("limits");
    let said = sagnac(&below, &["check", "../phase.toml", "../sound.toml"]);
    assert_eq!(said.code, 0, "{said:?}");
    let said = sagnac(&below, &["inspect", "../../r.csv"]);
    assert!(!said.err.contains("leads out"), "{said:?}");
}

#[cfg(unix)]
#[test]
fn a_pattern_over_links_in_circles_ends_at_once() {
    let dir = place();
    let home = dir.path().join("home");
    for i in 0..6 {
        std::os::unix::fs::symlink(&home, home.join(format!("up{i}"))).unwrap();
        std::os::unix::fs::symlink(&home, home.join(format!("limits/up{i}"))).unwrap();
    }
    std::fs::write(home.join("m.toml"), "format = \"manifest/1\"\nfiles = \"**/*.csv\"\n").unwrap();
    let started = Instant::now();
    let said = sagnac(&home, &["check", "m.toml"]);
    assert!(said.code == 0 && said.out.contains("manifest of 1 file"), "{said:?}");
    let many = format!("{}*.csv", "*/".repeat(30));
    let said = sagnac(&home, &["inspect", &many]);
    assert!(said.code == 2 && said.err.contains("no file matches"), "{said:?}");
    let said = sagnac(&home, &["inspect", "**/r.csv", "--join"]);
    assert!(said.err.contains("r.csv") || said.code == 0, "{said:?}");
    assert!(started.elapsed().as_secs() < 20, "{:?}", started.elapsed());
}
