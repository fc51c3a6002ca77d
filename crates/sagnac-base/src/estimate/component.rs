//! Components of uncertainty: what the standard uncertainty of an estimate is made of (JCGM 100:2008, 5.1 and clause 8).

use super::{Estimate, Spread};
use serde::{Deserialize, Serialize};

/// Largest degrees of freedom that are stated as a number; above, the law is normal.
const NORMAL_DOF: f64 = 1e6;

/// An input quantity with an uncertainty of its own.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum InputQuantity {
    /// The readings of the gyro: noise and scatter of the recording itself.
    Readings,
    /// Earth rate along the input axis.
    EarthRate,
    /// Rate of the table.
    TableRate,
    /// Angle of the table.
    TableAngle,
    /// Angle between the axis of the table and the input axis.
    AxisAlignment,
    /// Earth rate over the turns of the table.
    EarthOverTurns,
    /// Reading of the thermometer.
    Thermometer,
    /// Level of an influence such as field or supply.
    InfluenceLevel,
    /// Temperature between the intervals that are compared.
    TemperatureDifference,
    /// Rounding of the readings.
    Rounding,
    /// Offset of the clock of a file beside the recording.
    ClockOffset,
    /// Rate of the clock of a file beside the recording.
    ClockRate,
    /// What the inputs of a formula have in common.
    FormulaInputs,
}

/// How an uncertainty is known.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum UncertaintySource {
    /// From the recording (type A).
    Measured,
    /// Stated in the procedure, from a certificate or a data sheet (type B).
    Certificate,
    /// Derived from an assumption, such as a largest possible effect (type B).
    Assumed,
}

impl UncertaintySource {
    /// Word of it in a result.
    pub const fn id(self) -> &'static str {
        match self {
            UncertaintySource::Measured => "measured",
            UncertaintySource::Certificate => "certificate",
            UncertaintySource::Assumed => "assumed",
        }
    }
}

/// Law of a component.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum ComponentLaw {
    /// Gaussian.
    Normal,
    /// Student's t, with its degrees of freedom.
    StudentT,
    /// A standard deviation whose square is a scaled χ², with its degrees of freedom.
    ChiSquare,
    /// All values within a half-width are as likely.
    Uniform,
    /// Read off a likelihood, point by point.
    Tabulated,
}

impl ComponentLaw {
    /// Word of it in a result.
    pub const fn id(self) -> &'static str {
        match self {
            ComponentLaw::Normal => "normal",
            ComponentLaw::StudentT => "student_t",
            ComponentLaw::ChiSquare => "chi_square",
            ComponentLaw::Uniform => "uniform",
            ComponentLaw::Tabulated => "tabulated",
        }
    }
}

/// What other results share the same error.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum CommonTo {
    /// Tests at one site.
    Site,
    /// Tests on one table.
    Table,
    /// Tests with one thermometer.
    Thermometer,
    /// Tests with one source of the influence.
    InfluenceSource,
    /// Results that share inputs of a formula.
    Inputs,
}

impl CommonTo {
    /// Word of it in a result.
    pub const fn id(self) -> &'static str {
        match self {
            CommonTo::Site => "site",
            CommonTo::Table => "table",
            CommonTo::Thermometer => "thermometer",
            CommonTo::InfluenceSource => "influence_source",
            CommonTo::Inputs => "inputs",
        }
    }
}

impl InputQuantity {
    /// All of them.
    pub const ALL: [InputQuantity; 13] = [
        InputQuantity::Readings,
        InputQuantity::EarthRate,
        InputQuantity::TableRate,
        InputQuantity::TableAngle,
        InputQuantity::AxisAlignment,
        InputQuantity::EarthOverTurns,
        InputQuantity::Thermometer,
        InputQuantity::InfluenceLevel,
        InputQuantity::TemperatureDifference,
        InputQuantity::Rounding,
        InputQuantity::ClockOffset,
        InputQuantity::ClockRate,
        InputQuantity::FormulaInputs,
    ];

    /// How its uncertainty is known, the law of it, and what shares it.
    const fn facts(self) -> (UncertaintySource, ComponentLaw, Option<CommonTo>) {
        use ComponentLaw::{Normal, StudentT, Uniform};
        use UncertaintySource::{Assumed, Certificate, Measured};
        match self {
            InputQuantity::Readings => (Measured, StudentT, None),
            InputQuantity::EarthRate => (Certificate, Normal, Some(CommonTo::Site)),
            InputQuantity::TableRate | InputQuantity::AxisAlignment => {
                (Certificate, Normal, Some(CommonTo::Table))
            }
            InputQuantity::TableAngle | InputQuantity::ClockOffset => (Certificate, Normal, None),
            InputQuantity::ClockRate => (Measured, Normal, None),
            InputQuantity::EarthOverTurns
            | InputQuantity::TemperatureDifference
            | InputQuantity::Rounding => (Assumed, Uniform, None),
            InputQuantity::Thermometer => (Certificate, Normal, Some(CommonTo::Thermometer)),
            InputQuantity::InfluenceLevel => (Certificate, Normal, Some(CommonTo::InfluenceSource)),
            InputQuantity::FormulaInputs => (Measured, Normal, Some(CommonTo::Inputs)),
        }
    }

    /// How its uncertainty is known.
    pub const fn source(self) -> UncertaintySource {
        self.facts().0
    }

    /// Word of it in a result.
    pub const fn id(self) -> &'static str {
        match self {
            InputQuantity::Readings => "readings",
            InputQuantity::EarthRate => "earth_rate",
            InputQuantity::TableRate => "table_rate",
            InputQuantity::TableAngle => "table_angle",
            InputQuantity::AxisAlignment => "axis_alignment",
            InputQuantity::EarthOverTurns => "earth_over_turns",
            InputQuantity::Thermometer => "thermometer",
            InputQuantity::InfluenceLevel => "influence_level",
            InputQuantity::TemperatureDifference => "temperature_difference",
            InputQuantity::Rounding => "rounding",
            InputQuantity::ClockOffset => "clock_offset",
            InputQuantity::ClockRate => "clock_rate",
            InputQuantity::FormulaInputs => "formula_inputs",
        }
    }

    /// What other results share its error.
    pub const fn common_to(self) -> Option<CommonTo> {
        self.facts().2
    }
}

/// A component of the standard uncertainty of an estimate.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Component {
    /// Input quantity.
    pub input: InputQuantity,
    /// How its uncertainty is known.
    pub source: UncertaintySource,
    /// Law.
    pub law: ComponentLaw,
    /// Standard uncertainty of the input, in the unit below.
    pub standard_uncertainty: f64,
    /// Unit of the input.
    pub unit: String,
    /// Degrees of freedom; absent where they are without limit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub degrees_of_freedom: Option<f64>,
    /// Change of the estimate per change of the input, unit of the estimate per unit of the input.
    pub sensitivity: f64,
    /// Standard uncertainty of the estimate by this component alone, unit of the estimate.
    pub contribution: f64,
    /// Part of the variance of the estimate, 0 to 1.
    pub share_of_variance: f64,
    /// What other results share this error.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub common_to: Option<CommonTo>,
}

impl Component {
    /// A component of an input with a standard uncertainty in `unit` and the sensitivity of the estimate to it.
    pub fn of(input: InputQuantity, standard_uncertainty: f64, unit: &str, sensitivity: f64) -> Component {
        let (source, law, common_to) = input.facts();
        Component {
            input,
            source,
            law,
            standard_uncertainty,
            unit: unit.to_owned(),
            degrees_of_freedom: None,
            sensitivity,
            contribution: (standard_uncertainty * sensitivity).abs(),
            share_of_variance: 0.0,
            common_to,
        }
    }
}

/// Standard uncertainties of components together: the root of the sum of squares. Without components it is zero, where a sum of
/// nothing would be minus zero.
fn together<'a>(components: impl Iterator<Item = &'a Component>) -> f64 {
    components.fold(0.0, |sum: f64, c| sum + c.contribution * c.contribution).sqrt()
}

impl Estimate {
    /// Part of the standard uncertainty that other tests share, unit of the value.
    pub fn common(&self) -> f64 {
        together(self.components.iter().filter(|c| c.common_to.is_some()))
    }

    /// The uncertainty budget: the components of equipment and site, and what the readings leave of the standard uncertainty.
    /// Largest first; empty without a value or an uncertainty.
    pub fn budget(&self) -> Vec<Component> {
        let Some((standard, law, dof)) = self.value.and_then(|value| self.spread.standard(value)) else {
            return vec![];
        };
        let variance = standard * standard;
        let mut budget: Vec<Component> =
            self.components.iter().filter(|c| c.contribution > 0.0).cloned().collect();
        let others = together(budget.iter());
        let readings = (variance - others * others).max(0.0).sqrt();
        // Rounding leaves a rest where components are all that there is.
        if readings > 1e-6 * standard {
            // By Welch and Satterthwaite, where the others have no limit of theirs.
            let dof = dof.map(|dof| dof * (readings / standard).powi(4)).filter(|dof| *dof < NORMAL_DOF);
            let law = if law == ComponentLaw::StudentT && dof.is_none() { ComponentLaw::Normal } else { law };
            let found = Component::of(InputQuantity::Readings, readings, self.unit, 1.0);
            budget.push(Component { law, degrees_of_freedom: dof, ..found });
        }
        let total = together(budget.iter()).powi(2);
        for component in &mut budget {
            component.share_of_variance = component.contribution.powi(2) / total;
        }
        budget.sort_by(|a, b| b.contribution.total_cmp(&a.contribution));
        budget
    }
}

impl Spread {
    /// Standard uncertainty of a value with its law and degrees of freedom; that of a curve is half its central 68 %.
    fn standard(&self, value: f64) -> Option<(f64, ComponentLaw, Option<f64>)> {
        let found = match self {
            Spread::Normal { standard_uncertainty } => (*standard_uncertainty, ComponentLaw::Normal, None),
            Spread::StudentT { standard_uncertainty, dof } => {
                (*standard_uncertainty, ComponentLaw::StudentT, Some(*dof))
            }
            Spread::ChiSquare { dof } => {
                (value.abs() / (2.0 * dof).sqrt(), ComponentLaw::ChiSquare, Some(*dof))
            }
            Spread::Curve(_) => {
                let one = super::normal_probability(1.0);
                let half = 0.5 * (self.bound(value, one)? - self.bound(value, 1.0 - one)?);
                (half, ComponentLaw::Tabulated, None)
            }
            Spread::Unknown => return None,
        };
        (found.0.is_finite() && found.0 > 0.0).then_some(found)
    }
}

/// The spread of a budget: what its components give together, by Welch and Satterthwaite. A budget of one component with another
/// law has the spread of that law, a tabulated one none.
pub fn spread_of(budget: &[Component]) -> Spread {
    let standard_uncertainty = together(budget.iter());
    let limited = budget.iter().filter_map(|c| Some(c.contribution.powi(4) / c.degrees_of_freedom?));
    let per_dof: f64 = limited.sum();
    match budget {
        [Component { law: ComponentLaw::ChiSquare, degrees_of_freedom: Some(dof), .. }] => {
            Spread::ChiSquare { dof: *dof }
        }
        list if list.iter().any(|c| c.law == ComponentLaw::Tabulated) => Spread::Unknown,
        _ if per_dof > 0.0 => {
            Spread::StudentT { standard_uncertainty, dof: standard_uncertainty.powi(4) / per_dof }
        }
        _ => Spread::Normal { standard_uncertainty },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn on_a_table(readings: f64, dof: f64, table: f64) -> Estimate {
        let standard_uncertainty = readings.hypot(table);
        let dof = dof * (standard_uncertainty / readings).powi(4);
        let spread = Spread::StudentT { standard_uncertainty, dof };
        let mut estimate = Estimate::measured("scale_factor_error", "z", 100.0, "ppm", spread, "line");
        estimate.components = vec![Component::of(InputQuantity::TableRate, 1e-6 * table, "1", 1e6)];
        estimate
    }

    #[test]
    fn the_parts_of_a_budget_give_the_interval() {
        let estimate = on_a_table(3.0, 6.0, 4.0);
        let budget = estimate.budget();
        assert_eq!(
            budget.iter().map(|c| c.input).collect::<Vec<_>>(),
            [InputQuantity::TableRate, InputQuantity::Readings]
        );
        assert!((budget[0].share_of_variance - 0.64).abs() < 1e-12);
        assert!((budget[1].degrees_of_freedom.unwrap() - 6.0).abs() < 1e-9);
        let (again, stated) =
            (spread_of(&budget).interval(100.0, 0.95).unwrap(), estimate.interval95().unwrap());
        assert!((again.low - stated.low).abs() < 1e-9 && (again.high - stated.high).abs() < 1e-9);
        assert!((estimate.common() - 4.0).abs() < 1e-12);
    }

    #[test]
    fn a_budget_of_readings_alone_keeps_their_law() {
        let estimate =
            Estimate::measured("x", "z", 2.0, "deg/h", Spread::ChiSquare { dof: 8.0 }, "overlapping_allan");
        let budget = estimate.budget();
        assert_eq!((budget.len(), budget[0].law), (1, ComponentLaw::ChiSquare));
        assert!((budget[0].contribution - 0.5).abs() < 1e-12);
        assert_eq!(spread_of(&budget), estimate.spread);
    }

    #[test]
    fn nothing_is_budgeted_without_an_uncertainty() {
        let unknown = Estimate::measured("x", "z", 2.0, "deg/h", Spread::Unknown, "mean");
        assert!(unknown.budget().is_empty());
        let withheld = Estimate::not_identifiable("x", "z", None, "deg/h", "mean");
        assert!(withheld.budget().is_empty());
        assert!(unknown.common() == 0.0 && unknown.common().is_sign_positive());
    }

    #[test]
    fn an_uncertainty_that_equipment_makes_alone_has_no_rest() {
        let spread = Spread::Normal { standard_uncertainty: 0.02 };
        let mut estimate =
            Estimate::measured("earth_rate_component", "z", -8.4, "deg/h", spread, "from_site");
        estimate.components = vec![Component::of(InputQuantity::EarthRate, 0.02, "deg/h", 1.0)];
        assert_eq!(estimate.budget().len(), 1);
    }
}
