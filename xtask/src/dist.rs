//! What is handed out: the program with PDF, completions, manual page, list of its packages, hashes, a Debian package, and
//! wheels for Python.

use crate::notices;
use serde_json::{Value, json};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

/// Target of a program that needs no library of the machine.
const STATIC: &str = "x86_64-unknown-linux-musl";
/// Completion scripts: the shell, and the place of its script below the root of a system.
const COMPLETIONS: [(&str, &str); 3] = [
    ("bash", "usr/share/bash-completion/completions/sagnac"),
    ("zsh", "usr/share/zsh/vendor-completions/_sagnac"),
    ("fish", "usr/share/fish/vendor_completions.d/sagnac.fish"),
];
/// Targets of wheels: name, and what a wheel of it runs on. One that the compiler or the linker lacks is left out, and said so.
const WHEELS: [(&str, &str); 5] = [
    ("x86_64-unknown-linux-gnu", "Linux"),
    ("aarch64-unknown-linux-gnu", "Linux on ARM"),
    ("aarch64-apple-darwin", "macOS"),
    ("x86_64-apple-darwin", "macOS on Intel"),
    ("x86_64-pc-windows-msvc", "Windows"),
];
/// Files of the project that travel with the program.
const PAPERS: [&str; 4] = ["LICENSE-MIT", "LICENSE-APACHE", "THIRD-PARTY.md", "README.md"];

/// What is asked for.
pub struct Options {
    /// Profile of the build.
    pub profile: String,
    /// Folder to write, which must not exist.
    pub out: PathBuf,
    /// Whether the program makes PDF.
    pub pdf: bool,
    /// Whether wheels are made.
    pub wheels: bool,
}

impl Options {
    /// The options of a command line; `None` where one is unknown.
    pub fn of(root: &Path, arguments: &[String]) -> Option<Options> {
        let out = root.join("target/dist");
        let mut options = Options { profile: "release".into(), out, pdf: true, wheels: true };
        let mut rest = arguments;
        loop {
            match rest {
                [] => return Some(options),
                [flag, after @ ..] if flag == "--without-pdf" => {
                    options.pdf = false;
                    rest = after;
                }
                [flag, after @ ..] if flag == "--without-wheels" => {
                    options.wheels = false;
                    rest = after;
                }
                [flag, profile, after @ ..] if flag == "--profile" => {
                    options.profile.clone_from(profile);
                    rest = after;
                }
                [flag, folder, after @ ..] if flag == "--out" => {
                    options.out = std::path::absolute(folder).ok()?;
                    rest = after;
                }
                _ => return None,
            }
        }
    }
}

/// Writes the folder.
pub fn run(root: &Path, options: &Options) -> ExitCode {
    match dist(root, options) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

fn dist(root: &Path, options: &Options) -> Result<(), String> {
    let out = &options.out;
    if out.exists() {
        return Err(format!("{} exists: name a new folder with --out, or remove it", out.display()));
    }
    let target = static_target();
    match target {
        Some(target) => println!("target {target}: needs no library of the machine"),
        None => println!(
            "target of this machine: needs its C library; `rustup target add {STATIC}` makes it static"
        ),
    }
    let metadata = notices::metadata(root)?;
    let version = package(&metadata, "sagnac")?["version"].as_str().unwrap_or_default().to_owned();
    let program = build(root, &metadata, target, options)?;
    // Complete or not at all: the folder gets its name when everything is in it.
    let staged = out.with_extension("partial");
    if staged.exists() {
        fs::remove_dir_all(&staged).map_err(|e| failed(&staged, &e))?;
    }
    let tree = staged.join("tree");
    install(root, &program, &tree)?;
    write(&staged.join("sagnac.cdx.json"), &bill(&metadata, &version)?)?;
    let name = format!("sagnac-{version}-{}", target.unwrap_or("linux-gnu"));
    said(Command::new("tar").current_dir(&staged).args([
        "--sort=name",
        "--mtime=@0",
        "--owner=0",
        "--group=0",
        "--numeric-owner",
        &format!("--transform=s,^tree,{name},"),
        "-czf",
        &format!("{name}.tar.gz"),
        "tree",
    ]))?;
    debian(&staged, &tree, &version, target)?;
    if options.wheels {
        wheels(root, &staged, options)?;
    }
    fs::remove_dir_all(&tree).map_err(|e| failed(&tree, &e))?;
    let mut files: Vec<String> = fs::read_dir(&staged)
        .map_err(|e| failed(&staged, &e))?
        .filter_map(|entry| entry.ok()?.file_name().into_string().ok())
        .collect();
    files.sort();
    let sums = said(Command::new("sha256sum").current_dir(&staged).args(&files))?;
    write(&staged.join("SHA256SUMS"), &sums)?;
    fs::rename(&staged, out).map_err(|e| failed(out, &e))?;
    files.iter().for_each(|file| println!("{}", out.join(file).display()));
    Ok(())
}

/// The static target where the compiler has it.
fn static_target() -> Option<&'static str> {
    let sysroot = said(Command::new("rustc").args(["--print", "sysroot"])).ok()?;
    Path::new(sysroot.trim()).join("lib/rustlib").join(STATIC).join("lib").is_dir().then_some(STATIC)
}

/// Builds the program; gives its file.
fn build(root: &Path, metadata: &Value, target: Option<&str>, options: &Options) -> Result<PathBuf, String> {
    let mut cargo = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    cargo.current_dir(root).args(["build", "--locked", "--package", "sagnac", "--bin", "sagnac"]);
    cargo.args(["--profile", &options.profile]);
    if options.pdf {
        cargo.args(["--features", "pdf"]);
    }
    if let Some(target) = target {
        cargo.args(["--target", target]);
    }
    let status = cargo.status().map_err(|e| format!("failed to start cargo: {e}"))?;
    if !status.success() {
        return Err("the program was not built".to_owned());
    }
    let folder = if options.profile == "dev" { "debug" } else { options.profile.as_str() };
    let built = Path::new(metadata["target_directory"].as_str().unwrap_or("target"));
    let program = built.join(target.unwrap_or_default()).join(folder).join("sagnac");
    if program.is_file() { Ok(program) } else { Err(format!("{} was not built", program.display())) }
}

/// Puts the program and what belongs to it where a system has them, below a folder.
fn install(root: &Path, program: &Path, tree: &Path) -> Result<(), String> {
    copy(program, &tree.join("usr/bin/sagnac"))?;
    for (shell, place) in COMPLETIONS {
        write(&tree.join(place), &said(Command::new(program).args(["completions", shell]))?)?;
    }
    write(&tree.join("usr/share/man/man1/sagnac.1"), &said(Command::new(program).arg("man"))?)?;
    for paper in PAPERS {
        copy(&root.join(paper), &tree.join("usr/share/doc/sagnac").join(paper))?;
    }
    Ok(())
}

/// The packages that the program contains, as CycloneDX 1.5.
fn bill(metadata: &Value, version: &str) -> Result<String, String> {
    let linked = notices::linked(metadata);
    let packages: BTreeMap<&str, &Value> = metadata["packages"]
        .as_array()
        .into_iter()
        .flatten()
        .filter_map(|p| Some((p["id"].as_str()?, p)))
        .filter(|(id, _)| linked.contains(*id))
        .collect();
    let of = |p: &Value, key: &str| p[key].as_str().unwrap_or_default().to_owned();
    let url = |p: &Value| format!("pkg:cargo/{}@{}", of(p, "name"), of(p, "version"));
    let component = |p: &&Value| {
        json!({
            "type": "library", "bom-ref": url(p), "name": of(p, "name"), "version": of(p, "version"), "purl": url(p),
            "licenses": [{ "expression": of(p, "license").replace('/', " OR ") }],
        })
    };
    let nodes = metadata["resolve"]["nodes"].as_array().into_iter().flatten();
    let depends = |node: &Value| {
        let own = packages.get(node["id"].as_str()?)?;
        let on = node["dependencies"].as_array()?.iter().filter_map(Value::as_str);
        let on: BTreeSet<String> = on.filter_map(|id| packages.get(id)).map(|p| url(p)).collect();
        Some(json!({ "ref": url(own), "dependsOn": on }))
    };
    let mut components: Vec<Value> =
        packages.values().filter(|p| of(p, "name") != "sagnac").map(component).collect();
    components.sort_by_key(|c| c["purl"].to_string());
    let mut dependencies: Vec<Value> = nodes.filter_map(depends).collect();
    dependencies.sort_by_key(|d| d["ref"].to_string());
    let own = json!({
        "type": "application", "bom-ref": format!("pkg:cargo/sagnac@{version}"), "name": "sagnac", "version": version,
        "purl": format!("pkg:cargo/sagnac@{version}"),
    });
    let bill = json!({
        "bomFormat": "CycloneDX", "specVersion": "1.5", "version": 1, "metadata": { "component": own },
        "components": components, "dependencies": dependencies,
    });
    serde_json::to_string_pretty(&bill).map(|text| text + "\n").map_err(|e| e.to_string())
}

/// The Debian package, where the machine has the program that makes one.
fn debian(staged: &Path, tree: &Path, version: &str, target: Option<&str>) -> Result<(), String> {
    let Ok(architecture) = said(Command::new("dpkg").arg("--print-architecture")) else {
        println!("no Debian package: this machine has no dpkg");
        return Ok(());
    };
    let architecture = architecture.trim();
    // A static program needs nothing.
    let depends = if target.is_some() { "" } else { "Depends: libc6\n" };
    let control = format!(
        "Package: sagnac\nVersion: {version}\nArchitecture: {architecture}\nSection: science\nPriority: optional\n\
         Maintainer: The Sagnac project <sagnac@localhost>\n{depends}\
         Description: automated acceptance tests of precision gyroscopes\n \
         A procedure and a recording in, a report with verdict and uncertainties out.\n"
    );
    write(&tree.join("DEBIAN/control"), &control)?;
    let name = format!("sagnac_{version}_{architecture}.deb");
    let made = Command::new("dpkg-deb")
        .current_dir(staged)
        .env("SOURCE_DATE_EPOCH", "0")
        .args(["--root-owner-group", "--build", "tree", &name])
        .output()
        .map_err(|e| format!("failed to start dpkg-deb: {e}"))?;
    if made.status.success() { Ok(()) } else { Err(String::from_utf8_lossy(&made.stderr).into_owned()) }
}

/// Wheels of the package for Python with the program inside, for every target that this machine builds for.
fn wheels(root: &Path, staged: &Path, options: &Options) -> Result<(), String> {
    if said(Command::new("maturin").arg("--version")).is_err() {
        println!("no wheels: `pip install maturin` makes them");
        return Ok(());
    }
    let host = said(Command::new("rustc").arg("-vV"))?;
    let host = host.lines().find_map(|line| line.strip_prefix("host: ")).unwrap_or_default();
    let sysroot = said(Command::new("rustc").args(["--print", "sysroot"]))?;
    // Zig links for other systems, and against an old C library.
    let zig = said(Command::new("python3").args(["-m", "ziglang", "version"])).is_ok();
    for (target, system) in WHEELS {
        if !Path::new(sysroot.trim()).join("lib/rustlib").join(target).join("lib").is_dir() {
            println!("no wheel for {system}: `rustup target add {target}` is missing");
            continue;
        }
        let linux = target.contains("linux");
        if target != host && !(zig && linux) {
            println!("no wheel for {system}: this machine does not link for {target}");
            continue;
        }
        let mut maturin = Command::new("maturin");
        maturin.current_dir(root).args([
            "build",
            "--locked",
            "--profile",
            &options.profile,
            "--target",
            target,
        ]);
        maturin.arg("--out").arg(staged);
        if zig && linux {
            maturin.args(["--zig", "--compatibility", "manylinux2014"]);
        }
        let status = maturin.status().map_err(|e| format!("failed to start maturin: {e}"))?;
        if !status.success() {
            return Err(format!("the wheel for {target} was not built"));
        }
    }
    Ok(())
}

fn package<'a>(metadata: &'a Value, name: &str) -> Result<&'a Value, String> {
    let mut all = metadata["packages"].as_array().into_iter().flatten();
    all.find(|p| p["name"] == name).ok_or_else(|| format!("no package {name}"))
}

/// What a command prints.
fn said(command: &mut Command) -> Result<String, String> {
    let done = command.output().map_err(|e| format!("failed to start {:?}: {e}", command.get_program()))?;
    if !done.status.success() {
        return Err(String::from_utf8_lossy(&done.stderr).into_owned());
    }
    String::from_utf8(done.stdout).map_err(|e| e.to_string())
}

fn write(path: &Path, text: &str) -> Result<(), String> {
    make_folder(path)?;
    fs::write(path, text).map_err(|e| failed(path, &e))
}

fn copy(from: &Path, to: &Path) -> Result<(), String> {
    make_folder(to)?;
    fs::copy(from, to).map(|_| ()).map_err(|e| failed(from, &e))
}

fn make_folder(of: &Path) -> Result<(), String> {
    of.parent().map_or(Ok(()), |folder| fs::create_dir_all(folder).map_err(|e| failed(folder, &e)))
}

fn failed(path: &Path, error: &std::io::Error) -> String {
    format!("{}: {error}", path.display())
}
