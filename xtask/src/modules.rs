//! Modules of a package and which module uses which, read from the sources.
//!
//! Imports and paths in production code are followed to the file that they name; what a file re-exports leads on to where
//! it is defined. A `mod` line is no use, so a folder's `mod.rs` may list files that use each other in one direction.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// Path of a module within its package, without `crate`.
pub type Module = Vec<String>;

/// The modules of a package, read from its sources.
pub struct Package {
    /// Production text of each module.
    pub text: BTreeMap<Module, String>,
    /// Targets of the names that a module re-exports.
    reexports: BTreeMap<Module, BTreeMap<String, Module>>,
}

/// Source text without comments, contents of literals and unit tests.
pub fn production(source: &str) -> String {
    let source = source.split("#[cfg(test)]\nmod tests").next().unwrap_or_default();
    let mut out = String::new();
    for line in source.lines() {
        let (mut inside, mut escaped, mut before) = (false, false, ' ');
        for c in line.chars() {
            match (inside, c) {
                (false, '/') if before == '/' => break,
                (false, '"') if before != '\'' => inside = true,
                (true, '\\') if !escaped => escaped = true,
                (true, '"') if !escaped => inside = false,
                (true, _) => escaped = false,
                (false, _) => out.push(c),
            }
            before = c;
        }
        out.push('\n');
    }
    out
}

fn read(folder: &Path, at: &[String], text: &mut BTreeMap<Module, String>) -> std::io::Result<()> {
    for entry in std::fs::read_dir(folder)? {
        let path = entry?.path();
        let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        if path.is_dir() {
            read(&path, &[at, &[stem]].concat(), text)?;
        } else if path.extension().is_some_and(|e| e == "rs") && !stem.ends_with("tests") && stem != "main" {
            let own = ["mod", "lib"].contains(&stem.as_str());
            let module = if own { at.to_vec() } else { [at, &[stem]].concat() };
            text.insert(module, production(&std::fs::read_to_string(&path)?));
        }
    }
    Ok(())
}

/// The single paths of a tree such as `a::{b, c::{self, d}}`.
fn expand(tree: &str) -> Vec<String> {
    let Some((before, rest)) = tree.split_once('{') else {
        return vec![tree.split(" as ").next().unwrap_or_default().trim().to_owned()];
    };
    let body = rest.rsplit_once('}').map_or(rest, |(body, _)| body);
    let (mut depth, mut part, mut parts) = (0, String::new(), vec![]);
    for c in body.chars() {
        depth += i32::from(c == '{') - i32::from(c == '}');
        if c == ',' && depth == 0 {
            parts.push(std::mem::take(&mut part));
        } else {
            part.push(c);
        }
    }
    parts.push(part);
    let whole = |p: String| format!("{}{p}", before.trim());
    parts.iter().filter(|p| !p.trim().is_empty()).flat_map(|p| expand(p)).map(whole).collect()
}

/// Statements that import: whether they re-export, and their tree. What is left of the text follows.
fn imports(text: &str) -> (Vec<(bool, String)>, String) {
    let (mut found, mut left, mut rest) = (vec![], String::new(), text);
    while let Some(at) = rest.find("use ") {
        let (before, from) = rest.split_at(at);
        let Some(end) =
            from.find(';').filter(|_| before.is_empty() || before.ends_with(['\n', ' ', '(', ')']))
        else {
            left.push_str(&rest[..at + 4]);
            rest = &rest[at + 4..];
            continue;
        };
        let line = before.rsplit('\n').next().unwrap_or_default();
        found.push((line.trim_start().starts_with("pub"), from[4..end].replace('\n', " ")));
        left.push_str(before);
        rest = &from[end + 1..];
    }
    left.push_str(rest);
    (found, left)
}

/// Paths in expressions and types.
fn paths(text: &str) -> Vec<String> {
    text.split(|c: char| !(c.is_alphanumeric() || c == '_' || c == ':'))
        .filter(|t| t.contains("::"))
        .map(|t| t.trim_matches(':').to_owned())
        .collect()
}

impl Package {
    /// The modules below a source folder.
    pub fn new(root: &Path) -> std::io::Result<Package> {
        let mut text = BTreeMap::new();
        read(root, &[], &mut text)?;
        let mut package = Package { text, reexports: BTreeMap::new() };
        for (module, text) in &package.text {
            let mut names = BTreeMap::new();
            for path in
                imports(text).0.iter().filter(|(public, _)| *public).flat_map(|(_, tree)| expand(tree))
            {
                if let Some(target) = package.absolute(&path, module) {
                    names.insert(target.last().cloned().unwrap_or_default(), target);
                }
            }
            package.reexports.insert(module.clone(), names);
        }
        Ok(package)
    }

    /// A path from the root of the package, where it is one.
    fn absolute(&self, path: &str, from: &Module) -> Option<Module> {
        let mut parts: Vec<String> =
            path.split("::").map(|p| p.trim().to_owned()).filter(|p| !p.is_empty()).collect();
        let mut base = from.clone();
        match parts.first()?.as_str() {
            "crate" => base.clear(),
            "self" => {}
            "super" => {
                while parts.first().is_some_and(|p| p == "super") {
                    base.pop();
                    parts.remove(0);
                }
                return Some([base, parts].concat());
            }
            first => {
                let child = [from.clone(), vec![first.to_owned()]].concat();
                return self.text.contains_key(&child).then(|| [base, parts].concat());
            }
        }
        parts.remove(0);
        Some([base, parts].concat())
    }

    /// The file in which a path ends.
    fn file(&self, path: &Module, depth: usize) -> Option<Module> {
        let (at, rest) =
            (0..=path.len()).rev().map(|k| path.split_at(k)).find(|(m, _)| self.text.contains_key(*m))?;
        let target = rest.first().and_then(|name| self.reexports.get(at)?.get(name));
        match target {
            Some(target) if depth < 8 && target != path => {
                self.file(&[target.clone(), rest[1..].to_vec()].concat(), depth + 1)
            }
            _ => Some(at.to_vec()),
        }
    }

    /// The modules that each module uses.
    pub fn uses(&self) -> BTreeMap<&Module, BTreeSet<Module>> {
        let of = |(module, text): (&Module, &String)| {
            named(text)
                .iter()
                .filter_map(|path| self.absolute(path, module))
                .filter_map(|path| self.file(&path, 0))
                .filter(|file| file != module)
                .collect()
        };
        self.text.iter().map(|m| (m.0, of(m))).collect()
    }

    /// The module of this package that a path from its root ends in; `None` where only the root itself does.
    #[allow(dead_code, reason = "the test of circles includes this file and stays within one package")]
    pub fn target(&self, path: &str) -> Option<Module> {
        let path: Module = path.split("::").map(str::to_owned).collect();
        self.file(&path, 0).filter(|module| !module.is_empty())
    }
}

/// Paths that a module names, except those that it only re-exports.
pub fn named(text: &str) -> Vec<String> {
    let (found, left) = imports(text);
    let own = found.iter().filter(|(public, _)| !public).flat_map(|(_, tree)| expand(tree));
    own.chain(paths(&left)).map(|path| path.trim_end_matches('*').to_owned()).collect()
}
