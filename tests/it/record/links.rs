//! Devices by the clock of this computer: a process that speaks JSON, a file that grows.

use crate::support::{program, sagnac, sagnac_as_typed};
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use tempfile::tempdir;

/// A driver as anybody would write it: a row every 20 ms; it becomes safe when it is asked to, or at the end of its input.
const DRIVER: &str = r#"
echo '{"v":1,"hello":{"name":"shell","serial":"SN-9","channels":[{"id":"rate_deg_h"},{"id":"supply_v"}],"commands":[{"id":"supply_v","min":0,"max":9}]}}'
( i=0; while :; do i=$((i+1)); echo "{\"rate_deg_h\":1.$((i%7)),\"supply_v\":$(cat volts)}"; sleep 0.02; done ) &
beat=$!
while read -r line; do
  id=${line#*\"id\":}; id=${id%%,*}
  case $line in
    *safe*) echo 0 > volts; echo "safe" >> log; echo "{\"id\":$id,\"ok\":true}" ;;
    *set*) v=${line#*supply_v\":}; echo "${v%%\}*}" > volts; echo "set" >> log; echo "{\"id\":$id,\"ok\":true}" ;;
  esac
done
kill $beat
echo "end" >> log
"#;

const BENCH: &str = "format = \"bench/1\"\npart = \"200 ms\"\n[[device]]\nid = \"unit\"\nunit_under_test = true\n\
    command = [\"sh\", \"driver.sh\"]\n[[device.move]]\nquantity = \"supply_v\"\nlowest = 4\nhighest = 6\n\
    tolerance = 0.1\nwithin = \"5 s\"\nbegin = 5\n\
    [[device]]\nid = \"room\"\nlink = \"file\"\npath = \"room.log\"\nlanguage = \"text\"\ncolumns = [\"room_temp_degC\"]\n";

/// A folder with the bench, and a program that writes the log of the room.
fn bench(folder: &Path) -> std::process::Child {
    for (name, text) in [("driver.sh", DRIVER), ("bench.toml", BENCH), ("volts", "0\n"), ("room.log", "")] {
        fs::write(folder.join(name), text).unwrap();
    }
    let writer = "while echo 21.5 >> room.log; do sleep 0.05; done";
    Command::new("sh")
        .args(["-c", writer])
        .current_dir(folder)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap()
}

#[cfg(unix)]
#[test]
fn a_process_and_a_file_are_recorded_and_the_process_ends_safe() {
    let dir = tempdir().unwrap();
    let mut room = bench(dir.path());
    let said =
        sagnac_as_typed(dir.path(), &["record", "bench.toml", "--duration", "1s", "--out", "rec"], &[]);
    room.kill().unwrap();
    room.wait().unwrap();
    assert_eq!(said.code, 0, "{said:?}");
    assert!(said.out.contains("`unit` is in its safe state"), "{said:?}");
    assert_eq!(fs::read_to_string(dir.path().join("log")).unwrap(), "set\nsafe\nend\n");
    assert_eq!(fs::read_to_string(dir.path().join("volts")).unwrap().trim(), "0");
    let inspected = sagnac(dir.path(), &["inspect", "rec/recording.toml"]);
    assert_eq!(inspected.code, 0, "{inspected:?}");
    let manifest = fs::read_to_string(dir.path().join("rec/recording.toml")).unwrap();
    assert!(manifest.contains("serial = \"SN-9\""), "{manifest}");
    for words in ["rate_deg_h", "room_temp_degC"] {
        assert!(inspected.out.contains(words), "{words}: {}", inspected.out);
    }
}

#[cfg(unix)]
#[test]
fn a_driver_is_told_the_end_of_its_input_when_the_recorder_is_killed() {
    let dir = tempdir().unwrap();
    let mut room = bench(dir.path());
    let mut recorder = Command::new(program())
        .args(["record", "bench.toml", "--out", "rec"])
        .current_dir(dir.path())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let wait_for = |what: &dyn Fn() -> bool| {
        let began = std::time::Instant::now();
        while !what() {
            assert!(began.elapsed() < std::time::Duration::from_secs(30));
            std::thread::sleep(std::time::Duration::from_millis(10));
        }
    };
    wait_for(&|| dir.path().join("rec/unit-000002.csv").exists());
    recorder.kill().unwrap();
    recorder.wait().unwrap();
    wait_for(&|| fs::read_to_string(dir.path().join("log")).is_ok_and(|log| log.ends_with("end\n")));
    room.kill().unwrap();
    room.wait().unwrap();
    assert_eq!(sagnac(dir.path(), &["inspect", "rec/recording.toml"]).code, 0);
}
