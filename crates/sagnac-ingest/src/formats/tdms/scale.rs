//! Scales of a channel: what turns the numbers stored into values. A scale that is not known makes the channel no
//! column of numbers; it is never left out.

use super::properties::Properties;

/// Input of a scale that is the number stored.
const RAW: f64 = 4_294_967_295.0;
/// Most scales of a channel, and most coefficients of one.
const MAX_STEPS: usize = 64;

/// One step from the number stored to the value: a polynomial, lowest power first.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Step(pub Vec<f64>);

/// The steps of a channel, the first one first; none where the numbers stored are the values.
///
/// # Errors
/// The name of a scale that is not known here.
pub(super) fn steps(properties: [&Properties; 3]) -> Result<Vec<Step>, String> {
    for p in properties {
        let count = p.number("NI_Number_Of_Scales").unwrap_or(0.0);
        if count < 1.0 {
            continue;
        }
        // `scaled` says that what is stored has been scaled already.
        if p.text("NI_Scaling_Status") == Some("scaled") {
            return Ok(Vec::new());
        }
        return chain(p, count);
    }
    Ok(Vec::new())
}

fn chain(p: &Properties, count: f64) -> Result<Vec<Step>, String> {
    if !(1.0..=MAX_STEPS as f64).contains(&count) {
        return Err(format!("{count} scales"));
    }
    let mut steps = Vec::new();
    let mut index = count as usize - 1;
    // The last scale gives the value; each names the one that it takes its input from.
    for _ in 0..MAX_STEPS {
        let name = |rest: &str| format!("NI_Scale[{index}]_{rest}");
        let number = |rest: &str| p.number(&name(rest)).filter(|v| v.is_finite());
        let kind = p.text(&name("Scale_Type")).unwrap_or("DAQmx").to_owned();
        let unknown = || kind.clone();
        match kind.as_str() {
            "Linear" => {
                let slope = number("Linear_Slope").ok_or_else(unknown)?;
                steps.push(Step(vec![number("Linear_Y_Intercept").ok_or_else(unknown)?, slope]));
            }
            "Polynomial" => {
                let size = number("Polynomial_Coefficients_Size").unwrap_or(4.0);
                if !(1.0..=MAX_STEPS as f64).contains(&size) {
                    return Err(unknown());
                }
                let coefficients: Option<Vec<f64>> =
                    (0..size as usize).map(|i| number(&format!("Polynomial_Coefficients[{i}]"))).collect();
                steps.push(Step(coefficients.ok_or_else(unknown)?));
            }
            "AdvancedAPI" => {}
            _ => return Err(kind),
        }
        let input = number(&format!("{kind}_Input_Source")).unwrap_or(RAW);
        if input == RAW {
            steps.reverse();
            return Ok(steps);
        }
        if !(0.0..MAX_STEPS as f64).contains(&input) {
            return Err(kind);
        }
        index = input as usize;
    }
    Err("a circle of scales".to_owned())
}

impl Step {
    /// The value of the polynomial.
    #[inline]
    pub fn apply(&self, x: f64) -> f64 {
        match self.0.as_slice() {
            [intercept, slope] => x * slope + intercept,
            coefficients => coefficients.iter().rev().fold(0.0, |sum, c| sum * x + c),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::properties::Value;
    use super::*;

    fn properties(entries: &[(&str, Value)]) -> Properties {
        let mut p = Properties::default();
        entries.iter().for_each(|(k, v)| p.set((*k).to_owned(), v.clone()));
        p
    }

    #[test]
    fn a_chain_of_scales_is_applied_in_the_order_of_its_inputs() {
        let (n, t) = (Value::Number, |t: &str| Value::Text(t.to_owned()));
        let none = Properties::default();
        let p = properties(&[
            ("NI_Number_Of_Scales", n(2.0)),
            ("NI_Scale[0]_Scale_Type", t("Linear")),
            ("NI_Scale[0]_Linear_Slope", n(2.0)),
            ("NI_Scale[0]_Linear_Y_Intercept", n(1.0)),
            ("NI_Scale[0]_Linear_Input_Source", n(RAW)),
            ("NI_Scale[1]_Scale_Type", t("Polynomial")),
            ("NI_Scale[1]_Polynomial_Coefficients_Size", n(3.0)),
            ("NI_Scale[1]_Polynomial_Coefficients[0]", n(5.0)),
            ("NI_Scale[1]_Polynomial_Coefficients[1]", n(0.0)),
            ("NI_Scale[1]_Polynomial_Coefficients[2]", n(1.0)),
            ("NI_Scale[1]_Polynomial_Input_Source", n(0.0)),
        ]);
        let steps = steps([&p, &none, &none]).unwrap();
        // 3 becomes 2 · 3 + 1 = 7, and that 7² + 5 = 54.
        assert_eq!(steps.iter().fold(3.0, |x, s| s.apply(x)), 54.0);
    }

    #[test]
    fn an_unknown_scale_and_a_circle_are_refused() {
        let none = Properties::default();
        let t = |t: &str| Value::Text(t.to_owned());
        let p =
            properties(&[("NI_Number_Of_Scales", Value::Number(1.0)), ("NI_Scale[0]_Scale_Type", t("RTD"))]);
        assert_eq!(steps([&p, &none, &none]), Err("RTD".to_owned()));
        let circle = properties(&[
            ("NI_Number_Of_Scales", Value::Number(1.0)),
            ("NI_Scale[0]_Scale_Type", t("AdvancedAPI")),
            ("NI_Scale[0]_AdvancedAPI_Input_Source", Value::Number(0.0)),
        ]);
        assert!(steps([&circle, &none, &none]).is_err());
    }

    #[test]
    fn what_has_been_scaled_already_is_left() {
        let none = Properties::default();
        let t = |t: &str| Value::Text(t.to_owned());
        let p =
            properties(&[("NI_Number_Of_Scales", Value::Number(1.0)), ("NI_Scaling_Status", t("scaled"))]);
        assert_eq!(steps([&p, &none, &none]), Ok(Vec::new()));
    }
}
