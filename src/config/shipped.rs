//! Procedures and limits that the program carries, so that they are found by name from any folder.

use crate::i18n::Lang;
use std::path::{Component, Path, PathBuf};

/// Kind of a shipped file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ShippedKind {
    /// A procedure.
    Procedure,
    /// A limits file.
    Limits,
}

/// A file that the program carries.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shipped {
    /// Name by which it is found.
    pub name: &'static str,
    /// Its kind.
    pub kind: ShippedKind,
    /// Its text.
    pub text: &'static str,
}

/// A clause of the standard as a procedure states it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StatedClause {
    /// Number of the clause.
    pub number: String,
    /// Its title.
    pub title: String,
    /// True where the procedure deals with it.
    pub here: bool,
    /// What of it.
    pub note: String,
    /// Rows of the report of the procedure.
    pub measurands: Vec<String>,
}

/// A text of a file in a language.
fn in_language(value: Option<&toml::Value>, lang: Lang) -> String {
    let text = value.and_then(|t| t.as_str().or_else(|| t.get(lang.code())?.as_str()));
    text.unwrap_or_default().to_owned()
}

macro_rules! shipped {
    ($kind:ident, $folder:literal: $($name:literal)*) => {
        &[$(Shipped {
            name: $name,
            kind: ShippedKind::$kind,
            text: include_str!(concat!("../../", $folder, "/", $name, ".toml")),
        }),*]
    };
}

/// Every procedure, by name.
pub static SHIPPED_PROCEDURES: &[Shipped] = shipped!(Procedure, "procedures":
    "acceleration"
    "acceptance"
    "bench-check"
    "bias-repeatability"
    "electromagnetic-immunity"
    "magnetic-sensitivity"
    "maximum-rate"
    "misalignment"
    "multi-position"
    "output-noise"
    "pressure-sensitivity"
    "scale-factor"
    "scale-factor-over-temperature"
    "scale-factor-under-pressure"
    "start-up"
    "static-bias"
    "supply-sensitivity"
    "temperature-ramp"
    "temperature-soak"
    "threshold"
    "transfer-function"
    "vibration"
    "vibration-by-frequency"
    "warm-up"
);

/// Every limits file, by name.
pub static SHIPPED_LIMITS: &[Shipped] = shipped!(Limits, "procedures/limits":
    "oius-1000"
    "oius-200"
    "oius-2000"
    "oius-501"
    "sample-temperature"
    "sample-unit"
    "sample-warm-up"
    "tius-500"
);

impl Shipped {
    /// Where it stands in the folder of all shipped files.
    pub fn path(&self) -> String {
        match self.kind {
            ShippedKind::Procedure => format!("{}.toml", self.name),
            ShippedKind::Limits => format!("limits/{}.toml", self.name),
        }
    }

    /// Its name as a path by which it is found.
    pub fn name_as_path(&self) -> PathBuf {
        PathBuf::from(self.name)
    }

    /// Its title in a language, as its file states it.
    pub fn title(&self, lang: Lang) -> String {
        let table = match self.kind {
            ShippedKind::Procedure => "procedure",
            ShippedKind::Limits => "limits",
        };
        let file = self.text.parse::<toml::Table>().unwrap_or_default();
        in_language(file.get(table).and_then(|identity| identity.get("title")), lang)
    }

    /// The clauses of the standard that it states.
    pub fn clauses(&self, lang: Lang) -> Vec<StatedClause> {
        let file = self.text.parse::<toml::Table>().unwrap_or_default();
        let tables =
            |name: &str| file.get(name).and_then(|list| list.as_array()).cloned().unwrap_or_default();
        let ids = tables("measurand");
        let measurands: Vec<String> =
            ids.iter().filter_map(|m| Some(m.get("id")?.as_str()?.to_owned())).collect();
        let stated = |clause: &toml::Value| StatedClause {
            number: in_language(clause.get("clause"), lang),
            title: in_language(clause.get("title"), lang),
            here: clause.get("status").and_then(toml::Value::as_str) == Some("here"),
            note: in_language(clause.get("note"), lang),
            measurands: measurands.clone(),
        };
        tables("clause").iter().map(stated).collect()
    }
}

/// The shipped file at a path in the folder of all shipped files, as one of them names another.
pub fn at(path: &str) -> Option<&'static Shipped> {
    SHIPPED_PROCEDURES.iter().chain(SHIPPED_LIMITS).find(|s| s.path() == path)
}

/// The shipped file that a name stands for. `None` for anything with a folder or an ending, which is a path.
pub fn find(path: &Path) -> Option<&'static Shipped> {
    let mut parts = path.components();
    let (Some(Component::Normal(name)), None) = (parts.next(), parts.next()) else { return None };
    let name = name.to_str()?;
    SHIPPED_PROCEDURES.iter().chain(SHIPPED_LIMITS).find(|s| s.name == name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn every_file_of_the_folder_is_carried_and_no_name_stands_for_two() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("procedures");
        let names = |folder: &Path| -> BTreeSet<String> {
            let files = std::fs::read_dir(folder).unwrap().map(|f| f.unwrap().path());
            let toml = files.filter(|f| f.extension().is_some_and(|e| e == "toml"));
            toml.map(|f| f.file_stem().unwrap().to_string_lossy().into_owned()).collect()
        };
        let of = |list: &[Shipped]| -> BTreeSet<String> { list.iter().map(|s| s.name.to_owned()).collect() };
        assert_eq!(of(SHIPPED_PROCEDURES), names(&root));
        assert_eq!(of(SHIPPED_LIMITS), names(&root.join("limits")));
        assert!(of(SHIPPED_PROCEDURES).is_disjoint(&of(SHIPPED_LIMITS)));
        // What a shipped file names in the way of a file is shipped too.
        for s in SHIPPED_PROCEDURES.iter().filter(|s| s.text.contains("[[phase]]")) {
            let named = s
                .text
                .lines()
                .filter_map(|l| l.strip_prefix("procedure = \"").or(l.strip_prefix("limits = \"")));
            named.for_each(|n| assert!(at(n.trim_end_matches('"')).is_some(), "{}: {n}", s.name));
        }
        for s in SHIPPED_PROCEDURES.iter().chain(SHIPPED_LIMITS) {
            for lang in Lang::ALL {
                assert!(!s.title(*lang).is_empty(), "{}", s.name);
            }
            let same = s.title(Lang::Ru) == s.title(Lang::En);
            assert!(!same, "{}: one title for both languages", s.name);
            assert_eq!(std::fs::read_to_string(root.join(s.path())).unwrap(), s.text);
        }
    }

    #[test]
    fn a_name_is_no_path() {
        assert_eq!(find(Path::new("static-bias")).map(|s| s.kind), Some(ShippedKind::Procedure));
        assert_eq!(find(Path::new("sample-unit")).map(|s| s.kind), Some(ShippedKind::Limits));
        for path in ["./static-bias", "static-bias.toml", "a/static-bias", "", "..", "static"] {
            assert_eq!(find(Path::new(path)), None, "{path}");
        }
    }
}
