//! `cargo xtask package`: what a release consists of, built on this machine: the wheel and the source of the Python
//! package, an archive of the program, the installer, and their checksums.

use crate::{
    folder::{copy, copy_file, remove},
    program::{cargo, done, installed, target},
    view,
    wheel::Environment,
};
use std::{
    env, fs,
    path::{Path, PathBuf},
    process::Command,
};

/// What is built with, beside Rust: a C compiler that links for old systems, and maturin.
const LOCK: &str = "packaging/requirements.lock";
/// The oldest C library on which the program and the wheel run, that of RHEL 8 and Debian 10.
const GLIBC: &str = "2.28";
/// What makes the Debian package.
const CARGO_DEB: &str = "cargo-deb@3.8.0";
/// Folder of what is made, below the build folder.
const FILES: &str = "release-files";
/// The profile of cargo that packages are built with: optimised across crates.
const PROFILE: &str = "dist";
/// Crates in the order in which they are published.
pub const CRATES: &[&str] = &[
    "maille-geometry",
    "maille-svg",
    "maille-features",
    "maille-design",
    "maille",
    "maille-verify",
    "maille-prove",
    "maille-io",
    "maille-mesh",
    "maille-render",
    "maille-chapter6",
    "maille-view",
    "maille-cli",
];

/// Builds all below the build folder.
pub fn write(root: &Path) -> Result<(), String> {
    let out = target(root).join(FILES);
    remove(&out)?;
    view::page(root)?;
    let tools = Environment::of_tools(root, "packaging", LOCK)?;
    copy_file(&root.join("packaging/install.sh"), &out.join("install.sh"))?;
    archive(root, &tools, &out)?;
    python(root, &tools, &out)?;
    let mut command = tools.python();
    command.arg(root.join("packaging/checksums.py")).arg(&out);
    done(&mut command, "write the checksums")?;
    println!("   {}", out.display());
    Ok(())
}

/// Where the recipes get their addresses from.
pub enum Recipes<'a> {
    /// The repository and the maintainer that they name.
    Of { repository: &'a str, maintainer: &'a str },
    /// An example: the recipes are tried, as far as this machine can.
    Try,
}

/// The source of the Python package among what `write` has made.
fn source(root: &Path) -> Result<PathBuf, String> {
    let sdist = target(root).join(FILES).join(format!("maille-{}.tar.gz", env!("CARGO_PKG_VERSION")));
    match sdist.is_file() {
        true => Ok(sdist),
        false => Err(format!("{} is not there; make it with `cargo xtask package`", sdist.display())),
    }
}

/// Fills in the recipes of `packaging` for conda-forge and Homebrew, after `write`.
pub fn recipes(root: &Path, how: Recipes<'_>) -> Result<(), String> {
    let sdist = source(root)?;
    view::page(root)?;
    let mut command = Command::new(cargo());
    command.args(["package", "--no-verify", "--locked", "--allow-dirty", "--quiet"]).current_dir(root);
    done(command.args(CRATES.iter().flat_map(|name| ["--package", name])), "pack the crates")?;
    let tools = Environment::of_tools(root, "packaging", LOCK)?;
    let mut command = tools.tool(tools.program("python"));
    command.arg(root.join("packaging/recipes.py")).arg(target(root).join("recipes")).arg("--sdist").arg(sdist);
    command.arg("--crates").arg(target(root).join("package"));
    match how {
        Recipes::Of { repository, maintainer } => {
            command.args(["--repository", repository, "--maintainer", maintainer])
        }
        Recipes::Try => command.arg("--try").env("CARGO_TARGET_DIR", target(root)),
    };
    done(&mut command, "write the recipes")
}

/// Tries to publish every crate, in order, without doing so.
pub fn publish(root: &Path) -> Result<(), String> {
    // The page of the viewer is in its crate.
    view::page(root)?;
    let mut command = Command::new(cargo());
    command.args(["publish", "--dry-run", "--locked", "--allow-dirty"]).current_dir(root);
    done(command.args(CRATES.iter().flat_map(|name| ["--package", name])), "try to publish the crates")
}

/// The program with its licences, manual pages and completions.
fn archive(root: &Path, tools: &Environment, out: &Path) -> Result<(), String> {
    let os = env::consts::OS;
    let mut command = tools.tool(cargo());
    let build = ["--profile", PROFILE, "--locked", "--package", "maille-cli", "--features", "view"];
    let program = match os {
        "linux" => {
            let triple = format!("{}-unknown-linux-gnu", env::consts::ARCH);
            command.arg("zigbuild").args(build).args(["--target", &format!("{triple}.{GLIBC}")]);
            target(root).join(triple).join(PROFILE).join("maille")
        }
        _ => {
            command.arg("build").args(build);
            target(root).join(PROFILE).join(format!("maille{}", env::consts::EXE_SUFFIX))
        }
    };
    done(command.current_dir(root), "build the program")?;
    let name = format!("maille-{}-{}-{os}", env!("CARGO_PKG_VERSION"), env::consts::ARCH);
    let folder = target(root).join("package").join(&name);
    let (manuals, completions) = (folder.join("man"), folder.join("completions"));
    for folder in [&manuals, &completions] {
        fs::create_dir_all(folder).map_err(|e| format!("{} cannot be made: {e}", folder.display()))?;
    }
    copy_file(&program, &folder.join("maille").with_extension(env::consts::EXE_EXTENSION))?;
    for name in ["README.md", "LICENSE-MIT", "LICENSE-APACHE"] {
        copy_file(&root.join(name), &folder.join(name))?;
    }
    done(Command::new(&program).arg("man").arg(&manuals).arg("--overwrite"), "write the manual pages")?;
    for shell in ["bash", "zsh", "fish"] {
        let text = Command::new(&program).args(["completions", shell]).output();
        let text = text.ok().filter(|text| text.status.success()).ok_or("`maille completions` did not run")?;
        let file = completions.join(format!("maille.{shell}"));
        fs::write(&file, text.stdout).map_err(|e| format!("{} cannot be written: {e}", file.display()))?;
    }
    if os == "linux" {
        debian(root, &program, &folder, out)?;
    }
    let mut command = Command::new("tar");
    command.arg("-czf").arg(out.join(format!("{name}.tar.gz")));
    done(command.arg("-C").arg(target(root).join("package")).arg(&name), "write the archive")
}

/// The program's Debian package, of what the archive has; its parts are named in the manifest of `maille-cli`, which finds
/// them beside the program.
fn debian(root: &Path, program: &Path, archive: &Path, out: &Path) -> Result<(), String> {
    let parts = program.with_file_name("debian");
    remove(&parts)?;
    for part in ["man", "completions"] {
        copy(&archive.join(part), &parts.join(part))?;
    }
    let mut command = Command::new(installed(root, CARGO_DEB)?);
    command.args(["--package", "maille-cli", "--no-build", "--no-strip", "--profile", PROFILE, "--target"]);
    command.arg(format!("{}-unknown-linux-gnu", env::consts::ARCH)).arg("--output").arg(out);
    done(command.current_dir(root), "write the Debian package")
}

/// The wheel for all Pythons from 3.10 on, and the source that pip can build where there is no wheel.
fn python(root: &Path, tools: &Environment, out: &Path) -> Result<(), String> {
    let manifest = root.join("crates/maille-py/Cargo.toml");
    let maturin = |command: &str| {
        let mut tool = tools.tool(tools.program("maturin"));
        tool.arg(command).arg("--manifest-path").arg(&manifest).arg("--out").arg(out).current_dir(root);
        tool
    };
    let mut wheel = maturin("build");
    wheel.args(["--profile", PROFILE, "--locked"]);
    if env::consts::OS == "linux" {
        wheel.args(["--zig", "--compatibility", &format!("manylinux_{}", GLIBC.replace('.', "_"))]);
    }
    done(&mut wheel, "build the wheel")?;
    done(&mut maturin("sdist"), "pack the source of the Python package")
}

/// Installs what `write` has built into a Debian without Rust, and runs it there; needs root and debootstrap.
pub fn try_clean(root: &Path) -> Result<(), String> {
    source(root)?;
    let script = root.join("packaging/clean.sh");
    done(Command::new("sh").arg(script).arg(target(root).join(FILES)), "try the packages in a clean Debian")
}
