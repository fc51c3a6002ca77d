//! The file formats of the targets.

use super::quantity::Source;
use super::target::{AXES, Sheet};
use std::fmt::Write;

/// A number as every one of the formats reads it, with seven significant digits.
pub fn number(value: f64) -> String {
    let magnitude = value.abs();
    let rounded: f64 = format!("{value:.6e}").parse().unwrap_or(value);
    if value == 0.0 || (1e-3..1e6).contains(&magnitude) {
        return if rounded.fract() == 0.0 { format!("{rounded:.1}") } else { format!("{rounded}") };
    }
    // YAML 1.1 reads an exponent without a sign as text.
    let text = format!("{value:.6e}");
    match text.split_once('e') {
        Some((digits, exponent)) if !exponent.starts_with('-') => format!("{digits}e+{exponent}"),
        _ => text,
    }
}

/// The largest magnitude.
fn worst(values: [f64; AXES]) -> f64 {
    values.into_iter().map(f64::abs).fold(0.0, f64::max)
}

fn list(values: [f64; AXES], separator: &str) -> String {
    values.map(number).join(separator)
}

/// Each quantity as the worst of the axes: YAML.
pub fn scalars(sheet: &Sheet<'_>) -> String {
    let mut out = sheet.comments();
    for (quantity, values) in sheet.stated() {
        let _ = writeln!(out, "{}: {}", quantity.name, number(worst(values)));
    }
    out
}

/// Each axis and their mean: YAML as OpenCV reads it.
pub fn axes_and_mean(sheet: &Sheet<'_>) -> String {
    let mut out =
        format!("%YAML:1.0\n---\n{}type: IMU\nname: \"{}\"\nGyr:\n", sheet.comments(), plain(sheet.unit));
    out.push_str("   unit: \" rad/s\"\n");
    let mut block = |name: &str, of: &dyn Fn([f64; AXES]) -> f64| {
        let _ = writeln!(out, "   {name}:");
        for (quantity, values) in sheet.stated() {
            let _ = writeln!(out, "      {}: {}", quantity.name, number(of(values)));
        }
    };
    block("avg-axis", &|v| v.iter().sum::<f64>() / AXES as f64);
    block("x-axis", &|v| v[0]);
    block("y-axis", &|v| v[1]);
    block("z-axis", &|v| v[2]);
    out
}

/// A dictionary of arrays: Python.
pub fn python(sheet: &Sheet<'_>) -> String {
    let mut out = sheet.comments();
    out.push_str("import numpy as np\n\ngyro_err = {\n");
    for (quantity, values) in sheet.stated() {
        let _ = writeln!(out, "    '{}': np.array([{}]),", quantity.name, list(values, ", "));
    }
    out.push_str("}\n");
    out
}

/// Members of a structure: MATLAB or Octave, for `NaveGo`.
pub fn navego(sheet: &Sheet<'_>) -> String {
    let mut out = sheet.comments();
    for (quantity, values) in sheet.stated() {
        let value = match quantity.source {
            Source::Step => number(values[0]),
            _ => format!("[{}]", list(values, " ")),
        };
        let _ = writeln!(out, "imu.{} = {value}; % {}", quantity.name, quantity.unit);
    }
    out
}

/// Terms of the filter that makes flicker noise.
const FLICKER_TERMS: u32 = 20_000;

/// Parameters of a gyro: MATLAB `gyroparams`.
pub fn gyroparams(sheet: &Sheet<'_>) -> String {
    let mut out = sheet.comments();
    let flicker = sheet.stated().any(|(q, _)| q.source == Source::Flicker);
    if flicker {
        let _ = writeln!(out, "terms = 1:{FLICKER_TERMS};");
        out.push_str(
            "flicker = struct('Numerator', 1, 'Denominator', [1, cumprod((terms - 1.5) ./ terms)]);\n",
        );
    }
    out.push_str("params = gyroparams('NoiseType', 'double-sided'");
    for (quantity, values) in sheet.stated() {
        let _ = write!(out, ", ...\n    '{}', [{}]", quantity.name, list(values, " "));
    }
    if flicker {
        out.push_str(", ...\n    'BiasInstabilityCoefficients', flicker");
    }
    out.push_str(");\n");
    out
}

/// Noise of the axes of an IMU: SDF.
pub fn sdf(sheet: &Sheet<'_>) -> String {
    let mut out = String::from("<!--\n");
    for line in &sheet.head {
        // Two hyphens end a comment.
        let _ = writeln!(out, "  {}", line.replace("--", "- -"));
    }
    out.push_str("-->\n<angular_velocity>\n");
    for (i, axis) in ["x", "y", "z"].into_iter().enumerate() {
        let _ = write!(out, "  <{axis}>\n    <noise type=\"gaussian\">\n      <mean>0</mean>\n");
        for (quantity, values) in sheet.stated() {
            let name = quantity.name;
            let _ = writeln!(out, "      <{name}>{}</{name}>", number(values[i]));
        }
        let _ = writeln!(out, "    </noise>\n  </{axis}>");
    }
    out.push_str("</angular_velocity>\n");
    out
}

/// One parameter a line by `line`; a quantity without axes as the worst of them.
fn parameters(sheet: &Sheet<'_>, axes: [&str; AXES], line: impl Fn(&str, f64) -> String) -> String {
    let mut out = sheet.comments();
    for (quantity, values) in sheet.stated() {
        if quantity.name.contains('#') {
            for (axis, value) in axes.into_iter().zip(values) {
                out.push_str(&line(&quantity.name.replace('#', axis), value));
            }
        } else {
            out.push_str(&line(quantity.name, worst(values)));
        }
    }
    out
}

/// Type of a 32-bit floating-point parameter in MAVLink.
const MAV_PARAM_TYPE_REAL32: u8 = 9;

/// Parameters as `QGroundControl` loads them.
pub fn px4(sheet: &Sheet<'_>) -> String {
    parameters(sheet, ["0", "1", "2"], |name, value| {
        format!("1\t1\t{name}\t{}\t{MAV_PARAM_TYPE_REAL32}\n", number(value))
    })
}

/// Parameters as Mission Planner and `MAVProxy` load them.
pub fn ardupilot(sheet: &Sheet<'_>) -> String {
    parameters(sheet, ["X", "Y", "Z"], |name, value| format!("{name},{}\n", number(value)))
}

/// A text without what would end it or its line.
fn plain(text: &str) -> String {
    text.chars().filter(|c| !c.is_control() && !matches!(c, '"' | '\\')).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_read_by_every_format() {
        for (value, text) in [
            (0.0, "0.0"),
            (200.0, "200.0"),
            (0.012_345_678_9, "0.01234568"),
            (1.25e-5, "1.250000e-5"),
            (-3.5e-7, "-3.500000e-7"),
            (2e7, "2.000000e+7"),
        ] {
            assert_eq!(number(value), text);
            assert!((number(value).parse::<f64>().unwrap() - value).abs() <= 1e-6 * value.abs());
        }
    }

    #[test]
    fn names_cannot_end_their_line() {
        assert_eq!(plain("SN\"-1\\\n: x"), "SN-1: x");
        assert_eq!(worst([-3.0, 2.0, 0.0]), 3.0);
    }
}
