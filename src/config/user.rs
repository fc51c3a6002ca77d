//! The user's own settings: `sagnac/config.toml` in the folder of configurations.

use super::diagnostics::Problems;
use super::read_tables::checked;
use super::spec::TableSpec;
use super::table::Table;
use super::text_file::{self, Wording};
use std::ffi::OsString;
use std::path::PathBuf;

/// Messages for settings that cannot be read at all.
const READ_MESSAGES: Wording = Wording { unreadable: "user_config.unreadable", folder: "user_config.folder" };

/// The settings as a whole.
pub static CONFIG_FILE: TableSpec = *ConfigTables::SPEC;

/// The settings of a user.
#[derive(Table)]
#[table("", format = "config/1", format_may_lack)]
struct ConfigTables {
    /// The store that runs are kept in.
    store: Option<StoreKeys>,
}

/// The store that runs are kept in. `--store` and `SAGNAC_STORE` come first.
#[derive(Table)]
#[table("store")]
struct StoreKeys {
    /// Folder of the store, relative to this file.
    #[key(required, example = "/srv/sagnac")]
    path: Option<PathBuf>,
}

/// The settings of a user.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct UserConfig {
    /// Folder of the store.
    pub store: Option<PathBuf>,
}

/// Where the settings stand, by the variables of an environment; `None` where none of these is set.
fn place(variable: impl Fn(&str) -> Option<OsString>) -> Option<PathBuf> {
    let set = |name: &str| variable(name).filter(|v| !v.is_empty()).map(PathBuf::from);
    let folder = set("XDG_CONFIG_HOME").or_else(|| set("HOME").map(|home| home.join(".config")))?;
    Some(folder.join("sagnac").join("config.toml"))
}

/// Reads the settings of a user. Where there are none, nothing is set.
///
/// # Errors
/// Every problem of the file, each with its place.
pub fn load(variable: impl Fn(&str) -> Option<OsString>) -> Result<UserConfig, Problems> {
    let Some(path) = place(variable).filter(|p| p.exists()) else { return Ok(UserConfig::default()) };
    let source = text_file::source(&path.display().to_string(), &text_file::bytes(&path, &READ_MESSAGES)?)?;
    let (config, problems) = checked(&source, &CONFIG_FILE, |root, _| {
        let store = ConfigTables::read(root).store.and_then(|s| s.path);
        let folder = path.parent().unwrap_or(&path);
        UserConfig { store: store.map(|s| folder.join(s)) }
    });
    config.ok_or(problems)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    fn with(folder: &Path) -> impl Fn(&str) -> Option<OsString> {
        let folder = folder.as_os_str().to_owned();
        move |name| (name == "HOME").then(|| folder.clone())
    }

    #[test]
    fn the_store_is_that_of_the_file() {
        let home = tempfile::tempdir().unwrap();
        assert_eq!(load(with(home.path())).unwrap(), UserConfig::default());
        assert_eq!(load(|_| None).unwrap(), UserConfig::default());
        let folder = home.path().join(".config/sagnac");
        std::fs::create_dir_all(&folder).unwrap();
        let write = |text: &str| std::fs::write(folder.join("config.toml"), text).unwrap();
        write("[store]\npath = \"/srv/sagnac\"\n");
        assert_eq!(load(with(home.path())).unwrap().store, Some(PathBuf::from("/srv/sagnac")));
        write("[store]\npath = \"kept\"\n");
        assert_eq!(load(with(home.path())).unwrap().store, Some(folder.join("kept")));
        write("[store]\npaht = \"kept\"\n");
        let said = load(with(home.path())).unwrap_err().to_string();
        assert!(said.contains("config.toml:2:1") && said.contains("`path`"), "{said}");
    }
}
