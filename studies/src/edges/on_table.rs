//! Procedures of tests on a rate table, as text.

use std::fmt::Write;

/// A column of the recording.
pub struct Column {
    /// Id of its channel.
    pub id: &'static str,
    /// Name in the file.
    pub column: &'static str,
    /// Role of the channel.
    pub role: &'static str,
    /// Unit in the file.
    pub unit: &'static str,
}

/// One column.
pub const fn column(
    id: &'static str,
    column: &'static str,
    role: &'static str,
    unit: &'static str,
) -> Column {
    Column { id, column, role, unit }
}

/// The procedure of a test on a table: time in `time_s`, the columns, `sections` from `[rate_table]` on, and what is
/// measured.
pub fn procedure(title: &str, columns: &[Column], sections: &str, ids: &[impl AsRef<str>]) -> String {
    let id = title.to_lowercase().replace(' ', "-");
    let mut text = format!(
        "format = \"procedure/1\"\n[procedure]\nid = \"{id}\"\ntitle = \"{title}\"\nrevision = \"A\"\n\
         standard = \"drawn\"\nclause = \"drawn\"\nauthor = \"drawn\"\n[unit_under_test]\nserial_required = true\n"
    );
    for Column { id, column, role, unit } in [column("time", "time_s", "time", "s")].iter().chain(columns) {
        let _ = write!(
            text,
            "[[channel]]\nid = \"{id}\"\ncolumn = \"{column}\"\nrole = \"{role}\"\nunit = \"{unit}\"\n"
        );
    }
    let _ = write!(text, "{sections}\n[[instrument]]\nname = \"table\"\ncalibration_due = 2999-12-31\n");
    for id in ids {
        let _ = writeln!(text, "[[measurand]]\nid = \"{}\"", id.as_ref());
    }
    text + &format!("[[clause]]\nclause = \"1\"\ntitle = \"{title}\"\nstatus = \"here\"\n")
}
