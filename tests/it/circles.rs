//! No circle among the files of a package: a file uses only files that do not lead back to it.

#[path = "../../xtask/src/modules.rs"]
mod modules;

use modules::{Module, Package};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// Modules that lead back to themselves.
fn circles(uses: &BTreeMap<&Module, BTreeSet<Module>>) -> Vec<String> {
    let reached = |from: &Module| {
        let (mut seen, mut open) = (BTreeSet::new(), vec![from.clone()]);
        while let Some(at) = open.pop() {
            for next in uses.get(&at).into_iter().flatten() {
                if seen.insert(next.clone()) {
                    open.push(next.clone());
                }
            }
        }
        seen
    };
    let all: BTreeMap<&Module, BTreeSet<Module>> = uses.keys().map(|m| (*m, reached(m))).collect();
    let name = |m: &Module| if m.is_empty() { "crate".to_owned() } else { m.join("::") };
    let back = |m: &Module, n: &Module| all[m].contains(n) && all.get(n).is_some_and(|r| r.contains(m));
    let circular = |m: &Module| {
        let others: Vec<String> = uses[m].iter().filter(|n| back(m, n)).map(name).collect();
        (!others.is_empty()).then(|| format!("{} uses {}", name(m), others.join(", ")))
    };
    uses.keys().filter_map(|m| circular(m)).collect()
}

#[test]
fn no_file_leads_back_to_itself() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let (mut found, mut modules, mut used) = (vec![], 0, 0);
    for folder in [
        "src",
        "crates/sagnac-base/src",
        "crates/sagnac-core/src",
        "crates/sagnac-explain/src",
        "crates/sagnac-ingest/src",
        "crates/sagnac-noise/src",
        "studies/src",
    ] {
        let package = Package::new(&root.join(folder)).unwrap();
        assert!(package.text.len() > 20, "{folder}");
        let uses = package.uses();
        modules += package.text.len();
        used += uses.values().map(BTreeSet::len).sum::<usize>();
        found.extend(circles(&uses).into_iter().map(|c| format!("{folder}: {c}")));
    }
    assert!(used > 2 * modules, "only {used} uses found among {modules} modules");
    assert!(found.is_empty(), "{}", found.join("\n"));
}

#[test]
fn a_circle_is_found() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write("lib.rs", "mod a;\nmod b;\nmod c;\npub use c::C;\n");
    write("a.rs", "use crate::b::{B, other as o};\n");
    write("b.rs", "fn f() -> super::C { super::c::C }\n");
    write("c.rs", "// use crate::a::A;\n#[cfg(test)]\nmod tests { use crate::a::A; }\n");
    let package = Package::new(folder.path()).unwrap();
    assert_eq!(circles(&package.uses()), Vec::<String>::new());
    write("c.rs", "pub struct C(crate::a::A);\n");
    let package = Package::new(folder.path()).unwrap();
    assert_eq!(circles(&package.uses()), ["a uses b", "b uses c", "c uses a"]);
}
