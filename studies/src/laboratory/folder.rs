//! Cases as folders: `recording.csv`, `model.toml` and `truth.json`.

use super::case::Case;
use super::truth::Truth;
use std::fmt::Write;
use std::path::Path;
use std::{fs, io};

/// Writes a case into a folder, which is created.
///
/// # Errors
/// If a file cannot be written.
pub fn write(case: &Case, folder: &Path) -> io::Result<()> {
    fs::create_dir_all(folder)?;
    fs::write(folder.join("recording.csv"), recording(case))?;
    fs::write(folder.join("model.toml"), case.claim.toml(&case.truth.case, &case.columns))?;
    let mut truth = case.truth.clone();
    for part in &mut truth.concealed {
        // Six digits of the largest: a file of a third of the size.
        let most = part.contribution_deg_h.iter().fold(0.0f64, |m, c| m.max(c.abs()));
        let unit = 10f64.powf((most.max(1e-12)).log10().ceil() - 6.0);
        part.contribution_deg_h.iter_mut().for_each(|c| *c = (*c / unit).round() * unit);
    }
    fs::write(folder.join("truth.json"), serde_json::to_string(&truth)?)
}

/// Reads the truth of a folder.
///
/// # Errors
/// If the file cannot be read, or is no truth.
pub fn truth(folder: &Path) -> io::Result<Truth> {
    Ok(serde_json::from_str(&fs::read_to_string(folder.join("truth.json"))?)?)
}

fn recording(case: &Case) -> String {
    let mut text = String::from("time_s,rate_deg_h");
    case.columns.keys().for_each(|name| text.extend([",", name]));
    text.push('\n');
    for (i, (time, rate)) in case.time_s.iter().zip(&case.rate_deg_h).enumerate() {
        // Writing to a text cannot fail.
        let _ = write!(text, "{time:.4},{rate:.6}");
        for (name, values) in &case.columns {
            let digits = if name.ends_with("_deg_s") { 8 } else { 5 };
            let _ = write!(text, ",{:.digits$}", values[i]);
        }
        text.push('\n');
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::laboratory::case::make;
    use crate::laboratory::truth::Strength;

    #[test]
    fn a_folder_holds_the_case() {
        let case = make("supply_sensitivity", Strength::Middling, 6).unwrap();
        let at = std::env::temp_dir().join(format!("laboratory-folder-{}", std::process::id()));
        write(&case, &at).unwrap();
        let back = truth(&at).unwrap();
        let text = fs::read_to_string(at.join("recording.csv")).unwrap();
        let model = fs::read_to_string(at.join("model.toml")).unwrap();
        fs::remove_dir_all(&at).unwrap();
        assert_eq!(text.lines().count(), case.time_s.len() + 1);
        assert!(text.starts_with("time_s,rate_deg_h,") && text.lines().next().unwrap().contains("supply_v"));
        assert!(model.contains("[uncertainty]") && model.contains("supply_v"), "{model}");
        let (told, kept) = (case.truth.contribution(), back.contribution());
        let most = told.iter().fold(0.0f64, |m, t| m.max(t.abs()));
        assert!(told.iter().zip(&kept).all(|(a, b)| (a - b).abs() < 1e-4 * most));
        assert_eq!(back.concealed[0].parameters, case.truth.concealed[0].parameters);
    }
}
