//! Whether a narrow peak stays coherent over the whole record.

use super::evidence::{Evidence, FineBin};
use super::lines::SpectralLine;

/// Share of the power over the floor that a line has in its core.
const CORE_SHARE: f64 = 0.7;
/// Half width of the core in modes, where a line of any phase and frequency keeps nine tenths of its power, and in
/// bins of a windowed periodogram.
const CORE_HALF_WIDTH: [usize; 2] = [3, 2];
/// Bins of the periodogram to each side that a disturbance may fill.
const WINDOW_BINS: f64 = 8.0;
/// Excess, in standard deviations of noise, that is needed to tell.
const MIN_SCORE: f64 = 6.0;

/// True for a line that keeps its phase over the record: its power lies within the few modes that a sinusoid fills. False where
/// it is spread over more of them, as that of a disturbance that decays; true where the evidence cannot tell.
pub fn is_coherent(evidence: &Evidence, line: &SpectralLine) -> bool {
    let near = |bin: &&FineBin, reach: f64| (bin.frequency_hz - line.frequency_hz).abs() <= reach;
    let reach_hz = WINDOW_BINS * line.resolution_hz;
    let ring: Vec<f64> = evidence
        .fine()
        .iter()
        .filter(|b| near(b, 3.0 * reach_hz) && !near(b, reach_hz))
        .map(|b| b.power)
        .collect();
    let window: Vec<&FineBin> = evidence.fine().iter().filter(|b| near(b, reach_hz)).collect();
    let single = window.windows(2).all(|w| w[0].precedes(w[1]));
    if ring.len() < 8 || window.len() < 5 || !single {
        return true;
    }
    let floor = ring.iter().sum::<f64>() / ring.len() as f64;
    let dof = window.first().map_or(1.0, |b| b.dof);
    let excess: f64 = window.iter().map(|b| b.power - floor).sum();
    let sigma = floor * (2.0 * window.len() as f64 / dof).sqrt();
    if excess < MIN_SCORE * sigma {
        return true;
    }
    let peak = (0..window.len()).max_by(|a, b| window[*a].power.total_cmp(&window[*b].power)).unwrap_or(0);
    let half = if dof > 1.5 { CORE_HALF_WIDTH[1] } else { CORE_HALF_WIDTH[0] };
    let core = window.get(peak.saturating_sub(half)..(peak + half + 1).min(window.len())).unwrap_or(&[]);
    core.iter().map(|b| b.power - floor).sum::<f64>() >= CORE_SHARE * excess
}

#[cfg(test)]
mod tests {
    use super::super::composite::{Composite, Damped, Line};
    use super::super::data::BlockSeries;
    use super::super::model::NoiseModel;
    use super::super::simulate::{Setup, Simulator};
    use super::*;

    fn evidence(model: &Composite, seed: u64) -> Evidence {
        let n = 36_000;
        let mean = Simulator::of(model, &Setup::for_record(seed, 1.0, n as u64)).take(n);
        let blocks = BlockSeries { block_len: 1, first_index: 0, count: vec![1; n], mean, rounding: vec![] };
        Evidence::new(&blocks, None, 1.0, &[])
    }

    fn line(frequency_hz: f64) -> SpectralLine {
        SpectralLine {
            frequency_hz,
            resolution_hz: 1.0 / 2048.0,
            amplitude_deg_h: 0.1,
            excess: 10.0,
            false_alarm_probability: 0.0,
            harmonic_of: None,
            harmonic_order: 1,
            sinusoid: None,
        }
    }

    #[test]
    fn lines_are_told_from_disturbances_that_decay() {
        let white = Composite::from(NoiseModel { n: 0.0023, ..Default::default() });
        for seed in 0..20 {
            let frequency_hz = 0.05 + 1.7e-3 * seed as f64;
            let steady =
                Composite { lines: vec![Line { amplitude_deg_h: 0.05, frequency_hz }], ..white.clone() };
            assert!(is_coherent(&evidence(&steady, seed), &line(frequency_hz)), "line at {frequency_hz}");
            let process = Damped { rms_deg_h: 0.08, frequency_hz, decay_time_s: 1000.0 };
            let decaying = Composite { quasi_periodic: vec![process], ..white.clone() };
            assert!(!is_coherent(&evidence(&decaying, seed), &line(frequency_hz)), "{frequency_hz}");
        }
    }
}
