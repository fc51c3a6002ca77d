//! Markov noise and quasi-periodic disturbances of the joint fit: the strongest of each, the others in a note.

use super::descriptor::Measurand;
use super::evidence::GyroEvidence;
use crate::estimate::Estimate;
use crate::message::{Arg, Note, note};
use crate::noise::identification::{MarkovFound, QuasiPeriodicFound};

/// Standard deviation of Markov noise.
pub static MARKOV_SIGMA: Measurand = Measurand::at_rest(
    "markov_sigma",
    "deg/h",
    "standard deviation of exponentially correlated noise",
    |m, gyro, _| vec![markov(m, gyro, |p| &p.sigma)],
)
.needs_stillness();

/// Correlation time of Markov noise.
pub static MARKOV_CORRELATION_TIME: Measurand =
    Measurand::at_rest("markov_correlation_time", "s", "its correlation time", |m, gyro, _| {
        vec![markov(m, gyro, |p| &p.correlation_time)]
    })
    .needs_stillness();

/// Amplitude of a quasi-periodic disturbance.
pub static QUASI_PERIODIC_AMPLITUDE: Measurand = Measurand::at_rest(
    "quasi_periodic_amplitude",
    "deg/h",
    "rms of a narrow-band disturbance",
    |m, gyro, _| vec![quasi_periodic(m, gyro, |p| &p.amplitude)],
)
.needs_stillness();

/// Frequency of a quasi-periodic disturbance.
pub static QUASI_PERIODIC_FREQUENCY: Measurand =
    Measurand::at_rest("quasi_periodic_frequency", "Hz", "its centre frequency", |m, gyro, _| {
        vec![quasi_periodic(m, gyro, |p| &p.frequency)]
    });

/// Coherence time of a quasi-periodic disturbance.
pub static QUASI_PERIODIC_COHERENCE_TIME: Measurand =
    Measurand::at_rest("quasi_periodic_coherence_time", "s", "its coherence time", |m, gyro, _| {
        vec![quasi_periodic(m, gyro, |p| &p.coherence_time)]
    })
    .needs_stillness();

fn markov<'a>(m: &Measurand, gyro: &'a GyroEvidence, of: fn(&MarkovFound) -> &Estimate) -> Estimate {
    let process = |p: &'a MarkovFound| {
        let MarkovFound { sigma, correlation_time } = p;
        let size = sigma.value.unwrap_or(0.0);
        let place =
            note!("correlated.markov", sigma = size, time_s = correlation_time.value.unwrap_or(f64::NAN));
        (of(p), size, place)
    };
    strongest(m, gyro, gyro.identification.markov.iter().map(process).collect(), "correlated.no_markov")
}

fn quasi_periodic<'a>(
    m: &Measurand,
    gyro: &'a GyroEvidence,
    of: fn(&QuasiPeriodicFound) -> &Estimate,
) -> Estimate {
    let process = |p: &'a QuasiPeriodicFound| {
        let QuasiPeriodicFound { amplitude, frequency, .. } = p;
        let size = amplitude.value.unwrap_or(0.0);
        let place = note!(
            "correlated.quasi_periodic",
            rms = size,
            frequency_hz = frequency.value.unwrap_or(f64::NAN)
        );
        (of(p), size, place)
    };
    let processes = gyro.identification.quasi_periodic.iter().map(process).collect();
    strongest(m, gyro, processes, "correlated.no_periodic")
}

/// The estimate of the largest process. Each has the quantity asked for, its size, and a place that names it among others.
fn strongest(
    m: &Measurand,
    gyro: &GyroEvidence,
    processes: Vec<(&Estimate, f64, Note)>,
    none: &'static str,
) -> Estimate {
    let Some(strongest) = (0..processes.len()).max_by(|a, b| processes[*a].1.total_cmp(&processes[*b].1))
    else {
        return m.not_identifiable(&gyro.channel, None, gyro.identification.method).note(Note::new(none));
    };
    let mut estimate = m.named(processes[strongest].0);
    estimate.channel.clone_from(&gyro.channel);
    let others: Vec<Arg> = processes
        .into_iter()
        .enumerate()
        .filter(|(i, _)| *i != strongest)
        .map(|(_, (_, _, place))| Arg::from(place))
        .collect();
    if others.is_empty() {
        return estimate;
    }
    estimate.note(note!("correlated.others", others = Arg::Several(others, "; ".into())))
}

#[cfg(test)]
mod tests {
    use super::super::Options;
    use super::super::test_evidence::{gyro, notes, shows, told, withholds};
    use super::*;
    use crate::estimate::Spread;

    fn estimate(value: f64) -> Estimate {
        let spread = Spread::Normal { standard_uncertainty: 0.1 * value };
        Estimate::measured("any", "other", value, "any", spread, "joint")
    }

    fn row(m: &Measurand, gyro: &GyroEvidence) -> Estimate {
        let mut rows = m.evaluate_gyro(gyro, &Options { remove_earth_rate: false });
        assert_eq!(rows.len(), 1);
        rows.remove(0)
    }

    #[test]
    fn the_strongest_process_is_stated_and_the_others_are_named() {
        let mut gyro = gyro();
        let process = |sigma, time| MarkovFound { sigma: estimate(sigma), correlation_time: estimate(time) };
        gyro.identification.markov = vec![process(0.1, 500.0), process(0.3, 20.0), process(0.2, 90.0)];
        let found = row(&MARKOV_SIGMA, &gyro);
        shows(&found, 0.3, "joint");
        assert_eq!((found.id, found.unit, found.channel.as_str()), ("markov_sigma", "deg/h", "g"));
        let place = |sigma: f64, time_s: f64| Arg::from(note!("correlated.markov", sigma, time_s));
        let others = Arg::Several(vec![place(0.1, 500.0), place(0.2, 90.0)], "; ".into());
        assert_eq!(told(&found, "correlated.others", "others"), &others);
        shows(&row(&MARKOV_CORRELATION_TIME, &gyro), 20.0, "joint");
        gyro.identification.markov.truncate(1);
        assert_eq!(notes(&row(&MARKOV_SIGMA, &gyro)), [""; 0]);
    }

    #[test]
    fn a_quasi_periodic_disturbance_has_amplitude_frequency_and_coherence() {
        let mut gyro = gyro();
        let found = |amplitude, frequency, time| QuasiPeriodicFound {
            amplitude: estimate(amplitude),
            frequency: estimate(frequency),
            coherence_time: estimate(time),
        };
        gyro.identification.quasi_periodic = vec![found(0.2, 0.05, 300.0), found(0.1, 0.01, 900.0)];
        shows(&row(&QUASI_PERIODIC_AMPLITUDE, &gyro), 0.2, "joint");
        shows(&row(&QUASI_PERIODIC_FREQUENCY, &gyro), 0.05, "joint");
        let time = row(&QUASI_PERIODIC_COHERENCE_TIME, &gyro);
        shows(&time, 300.0, "joint");
        let place = note!("correlated.quasi_periodic", rms = 0.1, frequency_hz = 0.01);
        let others = Arg::Several(vec![Arg::from(place)], "; ".into());
        assert_eq!(told(&time, "correlated.others", "others"), &others);
    }

    #[test]
    fn without_a_process_the_row_says_so() {
        let gyro = gyro();
        for (m, note) in
            [(&MARKOV_SIGMA, "correlated.no_markov"), (&QUASI_PERIODIC_AMPLITUDE, "correlated.no_periodic")]
        {
            let none = row(m, &gyro);
            withholds(&none, None, gyro.identification.method);
            assert_eq!(notes(&none), [note]);
        }
    }
}
