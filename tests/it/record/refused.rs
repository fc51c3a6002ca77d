//! What is refused before anything moves.

use super::{Bench, SHORT, unit};
use crate::support::sagnac_as_typed;
use std::fs;

#[test]
fn a_schedule_beyond_the_limits_is_refused_and_nothing_is_reached() {
    for (schedule, words) in [
        (SHORT.replace("20.0", "130.0"), "table_rate_deg_s = 130; the limits of `table` are -120 to 120"),
        (
            "format = \"schedule/1\"\n[start]\ntemp_degC = 25.0\n[[step]]\ndo = \"ramp\"\nto_degC = 80.0\nrate_degC_per_h = 60.0\n"
                .to_owned(),
            "temp_degC = 80; the limits of `chamber` are -40 to 75",
        ),
        (
            "format = \"schedule/1\"\n[start]\ntemp_degC = 25.0\n[[step]]\ndo = \"ramp\"\nto_degC = 60.0\nrate_degC_per_h = 1000.0\n"
                .to_owned(),
            "changes temp_degC by 1000 an hour; `chamber` may be asked for at most 900",
        ),
        (
            "format = \"schedule/1\"\n[[step]]\ndo = \"headings\"\nangles_deg = [0.0, 90.0]\ndwell_s = 10.0\n".to_owned(),
            "the schedule moves `table_angle_deg`, but no device of the bench does",
        ),
    ] {
        let bench = Bench::new(unit(2.0), &[], "60 s", &schedule);
        let said = bench.record();
        assert!(said.code == 2 && said.err.contains(words), "{words}: {said:?}");
        assert!(said.err.contains("nothing was moved"), "{said:?}");
        assert!(bench.twin.commands("table").is_empty() && !bench.at("rec").exists());
    }
}

#[test]
fn a_check_reaches_nothing_and_a_folder_that_is_taken_is_left_alone() {
    let bench = Bench::new(unit(2.0), &[], "60 s", SHORT);
    let said = sagnac_as_typed(bench.folder(), &[&bench.args()[..], &["--check"]].concat(), &[]);
    assert!(said.code == 0 && said.out.contains("Devices: 4"), "{said:?}");
    assert!(!bench.at("rec").exists());
    fs::create_dir(bench.at("rec")).unwrap();
    fs::write(bench.at("rec/mine.txt"), "mine").unwrap();
    let said = bench.record();
    assert!(said.code == 2 && said.err.contains("is not empty"), "{said:?}");
    assert_eq!(fs::read_dir(bench.at("rec")).unwrap().count(), 1);
}

#[test]
fn a_device_that_is_not_there_ends_it_before_anything_moves_and_the_others_are_safe() {
    let bench = Bench::new(unit(2.0), &[], "60 s", SHORT);
    let text = fs::read_to_string(bench.at("bench.toml")).unwrap();
    let gone = std::net::TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().to_string();
    let place = text.rfind("address = \"").unwrap();
    let end = place + text[place..].find('\n').unwrap();
    fs::write(bench.at("bench.toml"), format!("{}address = \"{gone}\"{}", &text[..place], &text[end..]))
        .unwrap();
    let said = bench.record();
    assert!(said.code == 2 && said.err.contains("`supply` cannot be reached"), "{said:?}");
    assert_eq!(bench.twin.commands("table"), [":DEM:RATE 1,0", ":MODE:OFF 1"]);
}
