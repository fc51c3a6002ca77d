//! A micromechanical unit over days with its temperature: Astro Pi.

use super::{analyse, columns, curve};
use crate::support::real::set;

#[test]
fn astro_pi_with_and_without_its_gaps() {
    let Some(folder) = set("mems_astropi_68h_temperature") else { return };
    let axes = ["gyro_x_rad_s", "gyro_y_rad_s", "gyro_z_rad_s"];
    let taus = [10.0, 100.0, 1000.0];
    let micro = 1e6 * std::f64::consts::PI / 180.0 / 3600.0;
    let published = [
        ("part_b_warming_day", [(151.7, 110.8, 48.9), (989.0, 341.5, 113.4), (129.7, 92.9, 42.1)]),
        ("part_d_cool_days", [(147.9, 110.3, 60.5), (1460.0, 463.1, 146.4), (130.8, 94.7, 50.3)]),
    ];
    for (part, rows) in published {
        let file = folder.join(format!("{part}.csv.gz"));
        // The published deviations take the readings as evenly spaced.
        let plain = analyse(&file, Err(0.1), &axes, "rad/s", Some(&taus));
        for (name, (at10, at100, at1000)) in axes.into_iter().zip(rows) {
            let oadev = curve(&plain, name, "oadev");
            for (m, deviation) in [(1, at10), (10, at100), (100, at1000)] {
                let ours = oadev[&m] * micro;
                assert!(
                    (ours - deviation).abs() <= 0.051 * (deviation / 100.0).max(1.0),
                    "{part} {name} {m}: {ours}"
                );
            }
        }
        // With the stamps, every step of 20 s is a gap of one reading.
        let stamps = columns(&file, &["t_s"]).remove(0);
        let steps = stamps.windows(2).filter(|w| w[1] - w[0] > 15.0).count() as u64;
        let stamped = analyse(&file, Ok("t_s"), &axes, "rad/s", None);
        let integrity = &stamped.record.integrity;
        assert!(steps > 0);
        assert_eq!((integrity.gaps, integrity.missing_samples), (steps, steps));
        assert_eq!((integrity.duplicate_timestamps, integrity.backward_timestamps), (0, 0));
    }
}
