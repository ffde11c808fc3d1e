"""Fills in the recipes for conda-forge and Homebrew, and tries them.

    python packaging/recipes.py OUT --sdist FILE --crates FOLDER --repository https://... --maintainer NAME
    python packaging/recipes.py OUT --sdist FILE --crates FOLDER --try

--sdist is the file as it will be on PyPI, and FOLDER has the crates as they will be on crates.io: the recipes name
their SHA-256. --try fills in an example's address and renders both recipes of conda. By that of the program it
builds a package and runs its tests, and it does the same with Homebrew's formula, by packaging/homebrew/check.rb. Both
take the packed crates, with this machine's Rust. Whether conda-forge has the needed packages is not tried.
"""

import argparse
import hashlib
import pathlib
import re
import subprocess
import sys
import tarfile
import tempfile
import tomllib

HERE = pathlib.Path(__file__).resolve().parent
RECIPES = ("conda/maille/recipe.yaml", "conda/maille-cli/recipe.yaml", "homebrew/maille.rb")


def facts(sdist, crates, repository, maintainer):
    """What stands for each name between @."""
    project = tomllib.loads((HERE.parent / "crates/maille-py/pyproject.toml").read_text(encoding="utf-8"))["project"]
    numpy = next(need for need in project["dependencies"] if need.startswith("numpy>="))
    version = tomllib.loads((HERE.parent / "Cargo.toml").read_text(encoding="utf-8"))["workspace"]["package"]["version"]
    crate = crates / f"maille-cli-{version}.crate"
    return {
        "VERSION": version,
        "SHA256_PYPI": hashlib.sha256(sdist.read_bytes()).hexdigest(),
        "SHA256_CRATE": hashlib.sha256(crate.read_bytes()).hexdigest(),
        "NUMPY": numpy.removeprefix("numpy>="),
        "REPOSITORY": repository,
        "MAINTAINER": maintainer,
    }


def fill(out, known):
    for name in RECIPES:
        text = (HERE / name).read_text(encoding="utf-8")
        first, rest = text.split("\n", 1)
        rest = re.sub("@([A-Z0-9_]+)@", lambda found: known[found[1]], rest)
        file = out / name
        file.parent.mkdir(parents=True, exist_ok=True)
        new = file.with_name(file.name + ".new")
        new.write_text(first.split(" `")[0] + "\n" + rest, encoding="utf-8")
        new.replace(file)
        print(file)


def unpacked(out, crates, version):
    """The source of the program as crates.io will have it, and beside it the crates that it needs and are not there yet."""
    for crate in crates.glob(f"*-{version}.crate"):
        with tarfile.open(crate) as packed:
            packed.extractall(out, filter="data")
    source = out / f"maille-cli-{version}"
    others = [folder for folder in sorted(out.iterdir()) if folder != source]
    lines = [f'{folder.name.removesuffix("-" + version)} = {{ path = "{folder.as_posix()}" }}\n' for folder in others]
    (source / ".cargo").mkdir()
    (source / ".cargo/config.toml").write_text("[patch.crates-io]\n" + "".join(lines), encoding="utf-8")
    # The lockfile says that they are from crates.io; this says that they are not, and changes nothing else.
    subprocess.run(["cargo", "metadata", "--format-version", "1"], cwd=source, stdout=subprocess.DEVNULL, check=True)
    return source


def conda(out, source, work):
    """Renders both recipes as conda-forge would, and builds the program's without conda's compilers."""
    import rattler_build

    variants = {"c_compiler": ["gcc"], "rust_compiler": ["rust"], "c_stdlib": ["sysroot"], "python": ["3.10", "3.13"]}
    rendered = {}
    for name, count in (("maille", 2), ("maille-cli", 1)):
        recipe = rattler_build.Stage0Recipe.from_file(out / f"conda/{name}/recipe.yaml")
        found = recipe.render(rattler_build.VariantConfig(variants))
        if len(found) != count:
            raise SystemExit(f"{name}: {len(found)} variants, not {count}")
        rendered[name] = found[0].recipe.to_dict()
    recipe = rendered["maille-cli"]
    recipe["source"] = [{"path": str(source), "use_gitignore": False}]
    recipe["requirements"] = {}
    # A program of conda-forge lists the licences of all dependencies; the first line and the last file are its.
    recipe["build"] = {"number": 0, "script": recipe["build"]["script"][1:]}
    recipe["about"]["license_file"] = recipe["about"]["license_file"][:-1]
    rattler_build.Stage0Recipe.from_dict(recipe).run_build(
        channels=[], output_dir=work, env_isolation=rattler_build.EnvironmentIsolation.NONE)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", type=pathlib.Path)
    parser.add_argument("--sdist", type=pathlib.Path, required=True)
    parser.add_argument("--crates", type=pathlib.Path, required=True)
    parser.add_argument("--repository")
    parser.add_argument("--maintainer", help="account of who looks after the recipes, for conda-forge")
    parser.add_argument("--try", dest="tried", action="store_true")
    asked = parser.parse_args()
    if asked.tried:
        asked.repository, asked.maintainer = "https://example.org/maille", "someone"
    if not (asked.repository or "").startswith("https://") or not asked.maintainer:
        parser.error("give --repository https://... and --maintainer, or --try")
    known = facts(asked.sdist, asked.crates, asked.repository, asked.maintainer)
    fill(asked.out, known)
    if asked.tried:
        # Outside of the repository, whose workspace the crates would otherwise be counted to.
        with tempfile.TemporaryDirectory() as work:
            work = pathlib.Path(work)
            source = unpacked(work / "source", asked.crates, known["VERSION"])
            conda(asked.out, source, work / "conda")
            command = ["ruby", HERE / "homebrew/check.rb", asked.out / "homebrew/maille.rb", source, work / "homebrew"]
            sys.exit(subprocess.run(command).returncode)


if __name__ == "__main__":
    main()
