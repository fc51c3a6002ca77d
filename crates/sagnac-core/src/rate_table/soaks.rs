//! Soaks of a test on a rate table: stretches of constant temperature in which the same rates are gone through.
//!
//! A step belongs to a soak if the temperature stays within the stated tolerance during it, and if that of its neighbours in the
//! soak does. A table that rests while the chamber moves makes a long step of no constant temperature, which belongs to none.

use super::steps::{Step, Steps};

/// Rates that a soak needs: fewer give no line.
const MIN_RATES: usize = 2;

/// A soak.
#[derive(Debug, Clone, PartialEq)]
pub struct Soak {
    /// Mean temperature, degC.
    pub temperature: f64,
    /// Standard deviation of that by the scatter of its steps, degC.
    pub temperature_standard: f64,
    /// +1 when it was reached from a lower temperature, −1 from a higher one, 0 where that is not known.
    pub direction: i8,
    /// Positions of its steps in [`Steps::list`], in order of time.
    pub steps: Vec<usize>,
}

/// Lowest and highest temperature of the parts of a step, degC; `None` where one is not known.
fn range_of(step: &Step) -> Option<(f64, f64)> {
    let known = step.parts.iter().all(|p| p.temperature.is_finite()) && step.temperature.is_finite();
    let of_parts = step.parts.iter().map(|p| p.temperature);
    known.then(|| of_parts.fold((step.temperature, step.temperature), |(l, h), t| (l.min(t), h.max(t))))
}

/// The soaks in order of time; the temperature of each stays within `tolerance` of the middle of its range, degC.
pub fn find(steps: &Steps, tolerance: f64) -> Vec<Soak> {
    let width = 2.0 * tolerance;
    let mut groups: Vec<(f64, f64, Vec<usize>)> = vec![];
    for (at, step) in steps.list.iter().enumerate() {
        let Some((low, high)) = range_of(step).filter(|(low, high)| high - low <= width) else { continue };
        match groups.last_mut() {
            Some(last) if last.1.max(high) - last.0.min(low) <= width => {
                (last.0, last.1) = (last.0.min(low), last.1.max(high));
                last.2.push(at);
            }
            _ => groups.push((low, high, vec![at])),
        }
    }
    groups.retain(|(_, _, own)| levels_of(steps, own) >= MIN_RATES);
    let mut soaks: Vec<Soak> = vec![];
    for (_, _, own) in groups {
        let count = own.len() as f64;
        let temperature = own.iter().map(|i| steps.list[*i].temperature).sum::<f64>() / count;
        let square: f64 = own.iter().map(|i| (steps.list[*i].temperature - temperature).powi(2)).sum();
        let temperature_standard = (square / ((count - 1.0) * count)).sqrt();
        let direction = soaks.last().map_or(0, |before| match temperature - before.temperature {
            change if change > width => 1,
            change if change < -width => -1,
            _ => before.direction,
        });
        soaks.push(Soak { temperature, temperature_standard, direction, steps: own });
    }
    soaks
}

/// Number of different rates.
fn levels_of(steps: &Steps, own: &[usize]) -> usize {
    let mut levels: Vec<usize> = own.iter().map(|i| steps.list[*i].level).collect();
    levels.sort_unstable();
    levels.dedup();
    levels.len()
}

/// Soaks of one temperature together, by rising temperature: positions among `soaks`.
pub fn by_temperature(soaks: &[Soak], tolerance: f64) -> Vec<Vec<usize>> {
    let mut order: Vec<usize> = (0..soaks.len()).collect();
    order.sort_by(|a, b| soaks[*a].temperature.total_cmp(&soaks[*b].temperature));
    let mut points: Vec<Vec<usize>> = vec![];
    for at in order {
        let lowest = points.last().and_then(|p| p.first()).map(|i| soaks[*i].temperature);
        match (points.last_mut(), lowest) {
            (Some(last), Some(low)) if soaks[at].temperature - low <= 2.0 * tolerance => last.push(at),
            _ => points.push(vec![at]),
        }
    }
    points
}

/// The steps of all soaks, with their cycles counted within each soak; `None` where no soak goes through its rates twice.
pub fn in_cycles(steps: &Steps, soaks: &[Soak]) -> Option<Steps> {
    let sequence = |soak: &Soak| soak.steps.iter().map(|i| steps.list[*i].level).collect::<Vec<usize>>();
    let sequences: Vec<Vec<usize>> = soaks.iter().map(sequence).collect();
    let longest = sequences.iter().map(Vec::len).max()?;
    let least = soaks.iter().map(|s| levels_of(steps, &s.steps)).max()?;
    let repeats =
        |period: &usize| sequences.iter().all(|s| s.iter().zip(s.iter().skip(*period)).all(|(a, b)| a == b));
    // A rest that began the first cycle may have gone with the ramp before.
    let period = (least..=longest.div_ceil(2)).find(repeats)?;
    let mut cycles = 0;
    let mut of_step = vec![];
    for soak in soaks {
        let count = soak.steps.len();
        // A single step at the end is no cycle of its own.
        let whole = if count % period == 1 { count / period } else { count.div_ceil(period) }.max(1);
        of_step.extend((0..count).map(|i| cycles + (i / period).min(whole - 1)));
        cycles += whole;
    }
    Some(chosen(steps, soaks, &of_step, cycles))
}

/// The steps of all soaks, each soak as one cycle.
pub fn as_cycles(steps: &Steps, soaks: &[Soak]) -> Steps {
    let of_step: Vec<usize> = soaks.iter().enumerate().flat_map(|(at, s)| vec![at; s.steps.len()]).collect();
    chosen(steps, soaks, &of_step, soaks.len())
}

fn chosen(steps: &Steps, soaks: &[Soak], of_step: &[usize], cycles: usize) -> Steps {
    let list = soaks.iter().flat_map(|s| &s.steps).zip(of_step);
    let list = list.map(|(i, cycle)| Step { cycle: *cycle, ..steps.list[*i].clone() }).collect();
    Steps { list, levels: steps.levels.clone(), cycles, too_short: steps.too_short }
}

#[cfg(test)]
pub(super) mod tests {
    use super::super::steps::Part;
    use super::*;

    /// Steps of rates in deg/h with their outputs, deg/h, and temperatures: two parts of 10 s that scatter about each.
    pub fn recorded(of: &[(f64, f64, f64)]) -> Steps {
        let mut levels: Vec<f64> = of.iter().map(|s| s.0).collect();
        levels.sort_by(f64::total_cmp);
        levels.dedup();
        let part = |at: usize, rate: f64, output: f64, temperature: f64| Part {
            mid_s: 10.0 * at as f64 + 5.0,
            length_s: 10.0,
            rate,
            outer: 0.0,
            temperature,
            gyro: vec![output],
            angle: (f64::NAN, f64::NAN),
        };
        let step = |(i, (rate, output, temperature)): (usize, &(f64, f64, f64))| Step {
            from_s: 20.0 * i as f64,
            to_s: 20.0 * (i + 1) as f64,
            first_row: 0,
            end_row: 0,
            rate: *rate,
            nominal: *rate,
            outer: 0.0,
            temperature: *temperature,
            gyro: vec![*output],
            turns: 0.0,
            level: levels.iter().position(|l| l == rate).unwrap(),
            approach: 0,
            cycle: 0,
            parts: vec![
                part(2 * i, *rate, output + 0.5, *temperature),
                part(2 * i + 1, *rate, output - 0.5, *temperature),
            ],
            unsettled: None,
        };
        Steps { list: of.iter().enumerate().map(step).collect(), levels, cycles: 1, too_short: 0 }
    }

    /// Steps of rates in deg/h at temperatures.
    fn steps(of: &[(f64, f64)]) -> Steps {
        recorded(&of.iter().map(|(rate, temperature)| (*rate, *rate, *temperature)).collect::<Vec<_>>())
    }

    fn at(rates: &[f64], temperature: f64) -> Vec<(f64, f64)> {
        rates.iter().map(|r| (*r, temperature)).collect()
    }

    const TWICE: [f64; 6] = [9.0, 0.0, -9.0, 9.0, 0.0, -9.0];

    #[test]
    fn soaks_are_where_rates_differ_and_the_temperature_does_not() {
        let all = [at(&TWICE, -40.0), at(&TWICE, 21.0), at(&TWICE, 70.0), at(&TWICE, 20.0), at(&[0.0], 0.0)];
        let mut steps = steps(&all.concat());
        // The table rests while the chamber heats: its step joins no soak.
        steps.list[6].parts[0].temperature = -30.0;
        let soaks = find(&steps, 1.0);
        let found: Vec<(f64, i8, usize)> =
            soaks.iter().map(|s| (s.temperature, s.direction, s.steps.len())).collect();
        assert_eq!(found, [(-40.0, 0, 6), (21.0, 1, 5), (70.0, 1, 6), (20.0, -1, 6)]);
        assert_eq!(by_temperature(&soaks, 1.0), [vec![0], vec![3, 1], vec![2]]);
        assert_eq!(by_temperature(&soaks, 0.4).len(), 4);
    }

    #[test]
    fn cycles_are_counted_within_a_soak_even_where_its_first_step_is_lost() {
        let steps = steps(&[at(&TWICE, -40.0), at(&TWICE[1..], 20.0)].concat());
        let chosen = in_cycles(&steps, &find(&steps, 1.0)).unwrap();
        let cycles: Vec<usize> = chosen.list.iter().map(|s| s.cycle).collect();
        assert_eq!(cycles, [0, 0, 0, 1, 1, 1, 2, 2, 2, 3, 3]);
        assert_eq!(chosen.cycles, 4);
    }

    #[test]
    fn rates_gone_through_once_are_no_cycles() {
        let steps = steps(&[at(&TWICE[..3], -40.0), at(&TWICE[..3], 20.0)].concat());
        let soaks = find(&steps, 1.0);
        assert_eq!(in_cycles(&steps, &soaks), None);
        let cycles: Vec<usize> = as_cycles(&steps, &soaks).list.iter().map(|s| s.cycle).collect();
        assert_eq!(cycles, [0, 0, 0, 1, 1, 1]);
    }

    #[test]
    fn an_unknown_temperature_is_no_soak() {
        assert!(find(&steps(&at(&TWICE, f64::NAN)), 1.0).is_empty());
        assert!(find(&Steps::default(), 1.0).is_empty());
        assert_eq!(in_cycles(&Steps::default(), &[]), None);
    }
}
