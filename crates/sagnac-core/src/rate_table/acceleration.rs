//! Sensitivity of the bias to acceleration, from positions in the field of gravity.
//!
//! Three axes of the unit: the input axis I, the output axis O and S = I × O. At rest the acceleration is 1 g upwards, and
//! a_I² + a_O² + a_S² = g²: the square along S is not free and belongs to the bias. The Earth rate is an input along I and is taken
//! out with a scale factor of 1 and its uncertainty: axis-parallel positions alone cannot tell it from the term in a_I.

use super::blocks::Blocks;
use super::known::{Stretch, cut, solve};
use super::setup::{Input, ReferenceInput};
use crate::numeric::reml::Combination;
use nalgebra::DMatrix;

/// Terms that are fitted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Order {
    /// The bias and the three accelerations.
    #[default]
    Linear,
    /// Squares and products too.
    Quadratic,
}

/// A term of the output.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Term {
    /// Bias at no acceleration.
    Bias,
    /// Along the input axis.
    I,
    /// Along the output axis.
    O,
    /// Along S.
    S,
    /// Square along the input axis.
    II,
    /// Square along the output axis.
    OO,
    /// Product along input and output axis.
    IO,
    /// Product along the input axis and S.
    IS,
    /// Product along the output axis and S.
    OS,
}

const QUADRATIC_TERMS: [Term; 9] =
    [Term::Bias, Term::I, Term::O, Term::S, Term::II, Term::OO, Term::IO, Term::IS, Term::OS];

impl Order {
    /// Its terms.
    pub fn terms(self) -> &'static [Term] {
        match self {
            Order::Linear => &QUADRATIC_TERMS[..4],
            Order::Quadratic => &QUADRATIC_TERMS,
        }
    }
}

impl Term {
    /// Name in notes: the axes.
    pub fn name(self) -> &'static str {
        match self {
            Term::Bias => "D",
            Term::I => "I",
            Term::O => "O",
            Term::S => "S",
            Term::II => "II",
            Term::OO => "OO",
            Term::IO => "IO",
            Term::IS => "IS",
            Term::OS => "OS",
        }
    }

    /// Its factor at an acceleration along I, O and S, g.
    fn at(self, [i, o, s]: [f64; 3]) -> f64 {
        match self {
            Term::Bias => 1.0,
            Term::I => i,
            Term::O => o,
            Term::S => s,
            Term::II => i * i,
            Term::OO => o * o,
            Term::IO => i * o,
            Term::IS => i * s,
            Term::OS => o * s,
        }
    }
}

/// A test in positions in the field of gravity.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct AccelerationTest {
    /// Terms that are fitted.
    pub order: Order,
    /// Standard uncertainty of the scale factor by which the Earth rate is taken out, relative.
    pub scale_factor_uncertainty: f64,
    /// Positions, each with the direction of the input axis.
    pub positions: Vec<ReferenceInput>,
    /// Angle about the input axis of each, deg: 0 with the output axis horizontal and to the right.
    pub rolls_deg: Vec<f64>,
}

impl AccelerationTest {
    /// Acceleration along I, O and S in a position, g; `None` where it states no direction.
    pub fn acceleration(&self, position: usize) -> Option<[f64; 3]> {
        let Input::Position { elevation, .. } = self.positions.get(position)?.input else { return None };
        let (raised, roll) = (elevation.0.to_radians(), self.rolls_deg.get(position)?.to_radians());
        Some([raised.sin(), -raised.cos() * roll.sin(), -raised.cos() * roll.cos()])
    }

    /// What the stated positions determine, before anything is recorded.
    pub fn design(&self) -> Design {
        let rows: Vec<[f64; 3]> = (0..self.positions.len()).filter_map(|p| self.acceleration(p)).collect();
        Design::of(self.order, &rows)
    }
}

/// Length of what is left of a column beside the others, as a share of it or of 1 g, from which it is one of its own.
const MIN_INDEPENDENT_SHARE: f64 = 1e-6;

/// Which terms positions determine, and how well.
#[derive(Debug, Clone, PartialEq)]
pub struct Design {
    /// Terms of the model.
    pub terms: &'static [Term],
    /// Number of independent combinations of terms.
    pub rank: usize,
    /// Standard deviation of each term over that of the mean of one position; `None` where the positions do not determine it.
    pub deviations: Vec<Option<f64>>,
    /// Columns that are fitted.
    columns: Vec<usize>,
}

impl Design {
    fn of(order: Order, rows: &[[f64; 3]]) -> Design {
        let terms = order.terms();
        let x = matrix(terms, rows);
        let columns = independent(&x, None);
        let fitted = x.select_columns(&columns);
        let normal = (fitted.transpose() * &fitted).try_inverse();
        let deviation = |term: usize| {
            // A term is determined where its column is not a sum of all others.
            let others = independent(&x, Some(term));
            let at = columns.iter().position(|c| *c == term)?;
            (others.len() < columns.len()).then(|| Some(normal.as_ref()?[(at, at)].max(0.0).sqrt()))?
        };
        let deviations = (0..terms.len()).map(deviation).collect();
        Design { terms, rank: columns.len(), deviations, columns }
    }

    /// Terms that the positions do not determine.
    pub fn missing(&self) -> impl Iterator<Item = Term> {
        let each = self.terms.iter().zip(&self.deviations);
        each.filter(|(_, deviation)| deviation.is_none()).map(|(term, _)| *term)
    }
}

fn matrix(terms: &[Term], rows: &[[f64; 3]]) -> DMatrix<f64> {
    DMatrix::from_fn(rows.len(), terms.len(), |i, j| terms[j].at(rows[i]))
}

/// The first columns that are independent of those before them; one may be left out.
fn independent(x: &DMatrix<f64>, without: Option<usize>) -> Vec<usize> {
    let (mut basis, mut columns) = (vec![], vec![]);
    for j in (0..x.ncols()).filter(|j| Some(*j) != without) {
        let own = x.column(j).into_owned();
        let mut left = own.clone();
        // Twice, so that rounding leaves nothing of the others.
        for b in basis.iter().chain(&basis) {
            left -= b * left.dot(b);
        }
        if left.norm() > MIN_INDEPENDENT_SHARE * own.norm().max(1.0) {
            basis.push(left.normalize());
            columns.push(j);
        }
    }
    columns
}

/// One channel in positions in the field of gravity.
#[derive(Debug, Clone)]
pub struct Acceleration {
    /// Channel.
    pub channel: String,
    /// What the positions of the recording determine.
    pub design: Design,
    /// Coefficients of the terms, deg/h per power of g; `None` where the positions do not determine them.
    pub coefficients: Vec<Option<Combination>>,
    /// Mean output in every position, the Earth rate taken out, and what the model has there, deg/h.
    pub means: Vec<(f64, f64)>,
}

/// Evaluates a channel. `earth` gives the Earth rate along an axis with its standard uncertainty. `None` where the stretches do not
/// give one more row than terms.
pub fn evaluate(
    blocks: &Blocks,
    test: &AccelerationTest,
    stretches: &[Stretch],
    channel: usize,
    earth: &dyn Fn((f64, f64), (f64, f64)) -> (f64, f64),
) -> Option<Acceleration> {
    let id = blocks.gyros.get(channel)?;
    let own: Vec<&Stretch> = stretches
        .iter()
        .filter(|s| test.positions.get(s.known).is_some_and(|k| k.channel.as_ref().is_none_or(|c| c == id)))
        .collect();
    let (mut inputs, mut accelerations) = (vec![], vec![]);
    for s in &own {
        let Input::Position { heading, elevation } = test.positions.get(s.known)?.input else { return None };
        inputs.push((earth(heading, elevation), elevation.1.to_radians()));
        accelerations.push(test.acceleration(s.known)?);
    }
    let design = Design::of(test.order, &accelerations);
    let mut cut = cut(blocks, &own, channel)?;
    let n = cut.rows.len();
    for i in 0..n {
        cut.y[i] -= inputs[cut.of[i]].0.0;
    }
    let of_position = matrix(design.terms, &accelerations).select_columns(&design.columns);
    let x = DMatrix::from_fn(n, design.columns.len(), |i, j| of_position[(cut.of[i], j)]);
    // The scale factor is the same in all positions, a direction is that of its own.
    let known = |of_gravity: &[f64]| {
        DMatrix::from_fn(n, n, |i, j| {
            let (a, b) = (cut.of[i], cut.of[j]);
            let common = test.scale_factor_uncertainty.powi(2) * inputs[a].0.0 * inputs[b].0.0;
            let same = if a == b { inputs[a].0.1.powi(2) + of_gravity[a].powi(2) } else { 0.0 };
            common + same
        })
    };
    let (first, _) = solve(&cut, &x, &known(&vec![0.0; own.len()]))?;
    // A tilt turns gravity by its angle across: it moves a linear term by its coefficient times the angle at most.
    let across = (0..design.columns.len())
        .filter(|j| design.terms[design.columns[*j]] != Term::Bias)
        .map(|j| first.coefficients[j].powi(2))
        .sum::<f64>()
        .sqrt();
    let of_gravity: Vec<f64> = inputs.iter().map(|(_, tilt)| across * tilt).collect();
    let (fit, _) = solve(&cut, &x, &known(&of_gravity))?;
    let coefficient = |term: usize| {
        design.deviations[term]?;
        design.columns.iter().position(|c| *c == term).map(|at| fit.coefficient(at))
    };
    let coefficients = (0..design.terms.len()).map(coefficient).collect();
    let means = (0..own.len())
        .map(|p| {
            let rows = || (0..n).filter(|i| cut.of[*i] == p);
            let time_s: f64 = rows().map(|i| cut.rows.length_s[i]).sum();
            let mean = rows().map(|i| cut.y[i] * cut.rows.length_s[i]).sum::<f64>() / time_s;
            (mean, of_position.row(p).transpose().dot(&fit.coefficients))
        })
        .collect();
    Some(Acceleration { channel: id.clone(), design, coefficients, means })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rate_table::blocks::Block;

    fn test(order: Order, positions: &[(f64, f64)]) -> AccelerationTest {
        let position = |elevation: f64| ReferenceInput {
            phase: None,
            from_s: None,
            to_s: None,
            channel: None,
            input: Input::Position { heading: (90.0, 0.0), elevation: (elevation, 0.0) },
        };
        AccelerationTest {
            order,
            scale_factor_uncertainty: 0.0,
            positions: positions.iter().map(|p| position(p.0)).collect(),
            rolls_deg: positions.iter().map(|p| p.1).collect(),
        }
    }

    const FACES: [(f64, f64); 6] =
        [(90.0, 0.0), (-90.0, 0.0), (0.0, 0.0), (0.0, 90.0), (0.0, 180.0), (0.0, 270.0)];
    /// The shipped schedule.
    const FOURTEEN: [(f64, f64); 14] = [
        (90.0, 0.0),
        (45.0, 45.0),
        (45.0, 135.0),
        (45.0, 225.0),
        (45.0, 315.0),
        (0.0, 0.0),
        (0.0, 45.0),
        (0.0, 90.0),
        (0.0, 180.0),
        (0.0, 270.0),
        (-45.0, 45.0),
        (-45.0, 135.0),
        (-45.0, 225.0),
        (-45.0, 315.0),
    ];

    #[test]
    fn gravity_lies_along_the_axis_that_points_up() {
        let test = test(Order::Linear, &[(90.0, 0.0), (0.0, 0.0), (0.0, 270.0), (45.0, 180.0)]);
        let half = 0.5f64.sqrt();
        for (k, expected) in
            [[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0], [half, 0.0, half]].iter().enumerate()
        {
            let found = test.acceleration(k).unwrap();
            assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{k}: {found:?}");
        }
        assert_eq!(test.acceleration(4), None);
    }

    #[test]
    fn positions_along_the_axes_never_tell_the_products() {
        let six = test(Order::Linear, &FACES).design();
        assert_eq!((six.rank, six.missing().count()), (4, 0));
        // Bias from all six, each term from a pair: 1/√6 and 1/√2.
        for (found, expected) in six.deviations.iter().zip([6f64, 2.0, 2.0, 2.0]) {
            assert!((found.unwrap() - expected.powf(-0.5)).abs() < 1e-9, "{found:?}");
        }
        let squares = test(Order::Quadratic, &FACES).design();
        assert_eq!(squares.rank, 6);
        assert_eq!(squares.missing().collect::<Vec<_>>(), [Term::IO, Term::IS, Term::OS]);
    }

    #[test]
    fn the_schedule_of_fourteen_positions_tells_every_term() {
        let design = test(Order::Quadratic, &FOURTEEN).design();
        assert_eq!((design.rank, design.missing().count()), (9, 0));
        // Computed by another program.
        for (found, expected) in
            design.deviations.iter().zip([0.667, 0.467, 0.484, 0.484, 1.086, 1.0, 1.0, 1.0, 1.222])
        {
            assert!((found.unwrap() - expected).abs() < 6e-4, "{found:?} {expected}");
        }
    }

    #[test]
    fn a_term_that_others_make_up_is_missing_with_them() {
        // Input axis up only: the bias cannot be told from the terms along it.
        let design = test(Order::Linear, &[(90.0, 0.0), (90.0, 90.0)]).design();
        assert_eq!(design.rank, 1);
        assert_eq!(design.missing().count(), 4);
    }

    /// A recording of 100 s in each position, a block a second, that scatters evenly within ±0.01 deg/h.
    fn blocks(test: &AccelerationTest, of: &dyn Fn([f64; 3], f64) -> f64) -> (Blocks, Vec<Stretch>) {
        let mut list = vec![];
        let mut state = 7u64;
        for p in 0..test.positions.len() {
            for _ in 0..100 {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                let noise = 0.02 * ((state >> 11) as f64 / (1u64 << 53) as f64 - 0.5);
                let a = test.acceleration(p).unwrap();
                let index = list.len() as u64;
                list.push(Block {
                    first_index: index,
                    first_row: index + 1,
                    samples: 1,
                    continues: index > 0,
                    gyro: vec![of(a, 12.0 * a[0]) + noise],
                    table_rate: f64::NAN,
                    outer_rate: f64::NAN,
                    temperature: f64::NAN,
                    beside: vec![],
                    angle_first: f64::NAN,
                    angle_last: f64::NAN,
                });
            }
        }
        let blocks = Blocks { list, interval_s: 1.0, gyros: vec!["g".into()], ..Blocks::default() };
        let stretch = |k: usize| Stretch { known: k, blocks: (100 * k, 100 * (k + 1)) };
        (blocks, (0..test.positions.len()).map(stretch).collect())
    }

    fn earth(_: (f64, f64), elevation: (f64, f64)) -> (f64, f64) {
        (12.0 * elevation.0.to_radians().sin(), 0.0)
    }

    #[test]
    fn coefficients_come_back_and_the_uncertainty_of_the_scale_factor_is_in_the_input_axis() {
        let mut test = test(Order::Quadratic, &FOURTEEN);
        let of = |[i, o, s]: [f64; 3], earth: f64| {
            earth + 0.3 + 0.5 * i - 0.2 * o + 0.1 * s + 0.05 * i * i + 0.02 * o * o - 0.04 * i * o
                + 0.03 * i * s
                + 0.06 * o * s
        };
        let (blocks, stretches) = blocks(&test, &of);
        let found = super::evaluate(&blocks, &test, &stretches, 0, &earth).unwrap();
        for (c, truth) in found.coefficients.iter().zip([0.3, 0.5, -0.2, 0.1, 0.05, 0.02, -0.04, 0.03, 0.06])
        {
            let c = c.unwrap();
            assert!((c.value - truth).abs() < 4.0 * c.standard + 1e-9 && c.standard < 0.003, "{c:?} {truth}");
        }
        assert!(found.means.iter().all(|(mean, model)| (mean - model).abs() < 0.005), "{:?}", found.means);
        // 1000 ppm of the Earth rate, which goes with a_I.
        test.scale_factor_uncertainty = 1e-3;
        let wide = super::evaluate(&blocks, &test, &stretches, 0, &earth).unwrap();
        let along = wide.coefficients[1].unwrap().standard;
        assert!((along - 0.012).abs() < 0.001, "{along}");
        assert!(wide.coefficients[2].unwrap().standard < 0.003);
    }
}
