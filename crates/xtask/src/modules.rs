//! The modules of a crate, and which of its files uses which.

use crate::source::{self, NamedPath, Source};
use std::collections::{BTreeMap, HashMap, HashSet};

/// Imports of imports that are followed.
const DEEPEST: usize = 8;

/// A use of one file by another, with the first line that makes it.
pub type Uses = BTreeMap<(String, String), usize>;

#[derive(Default)]
struct Module {
    file: String,
    parent: Option<usize>,
    children: HashMap<String, usize>,
    items: HashSet<String>,
    /// Imports by the module's name for them, each with whether it is public.
    imports: HashMap<String, (Vec<String>, bool)>,
    /// Modules of which everything is imported.
    globs: Vec<Vec<String>>,
}

/// What a path leads to: a module, or something that a module's file defines.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Target {
    Module(usize),
    Item(usize),
}

/// Who uses whom among `files`, the crate's sources by their paths below `src`.
///
/// Imports are followed to the file that defines what they name. A module that passes on what its submodules define
/// does not use them by that. Unit tests may use what they like.
pub fn uses(files: &BTreeMap<String, String>) -> Result<Uses, String> {
    let mut tree = Tree::default();
    let root = ["lib.rs", "main.rs"].into_iter().find(|name| files.contains_key(*name));
    tree.add(files, root.ok_or("no lib.rs or main.rs")?, &[], None)?;
    let mut out = Uses::new();
    for (home, path) in std::mem::take(&mut tree.paths) {
        let Some(target) = tree.used(home, &path).filter(|_| !path.test) else { continue };
        let (from, to) = (&tree.modules[home].file, &tree.modules[target].file);
        if from != to {
            let line = out.entry((from.clone(), to.clone())).or_insert(usize::MAX);
            *line = path.line().min(*line);
        }
    }
    Ok(out)
}

#[derive(Default)]
struct Tree {
    modules: Vec<Module>,
    /// Paths with the modules that they stand in.
    paths: Vec<(usize, NamedPath)>,
}

impl Tree {
    /// Reads the file of a module and those below it.
    fn add(
        &mut self,
        files: &BTreeMap<String, String>,
        file: &str,
        name: &[String],
        parent: Option<usize>,
    ) -> Result<(), String> {
        let Source { modules, items, paths } = source::read(&files[file]).map_err(|e| format!("{file}: {e}"))?;
        let mut known = HashMap::from([(Vec::new(), self.module(file, name.last(), parent))]);
        for (inner, _) in &modules {
            let (last, above) = inner.split_last().expect("a module has a name");
            let full = [name, inner].concat().join("/");
            let candidates = [format!("{full}.rs"), format!("{full}/mod.rs")];
            match candidates.iter().find(|file| files.contains_key(*file)) {
                Some(file) => self.add(files, file, &[name, inner].concat(), Some(known[above]))?,
                None => {
                    let module = self.module(file, Some(last), Some(known[above]));
                    known.insert(inner.clone(), module);
                }
            }
        }
        for (inner, item) in items {
            self.modules[known[&inner]].items.insert(item);
        }
        for path in paths {
            let home = known[&path.module];
            if let Some(import) = &path.import {
                let mut names: Vec<String> = path.names().into_iter().map(str::to_string).collect();
                if names.last().is_some_and(|last| last == "*") {
                    names.pop();
                    self.modules[home].globs.push(names);
                } else {
                    self.modules[home].imports.insert(import.alias.clone(), (names, import.public));
                }
            }
            self.paths.push((home, path));
        }
        Ok(())
    }

    fn module(&mut self, file: &str, name: Option<&String>, parent: Option<usize>) -> usize {
        let index = self.modules.len();
        if let (Some(parent), Some(name)) = (parent, name) {
            self.modules[parent].children.insert(name.clone(), index);
        }
        self.modules.push(Module { file: file.into(), parent, ..Module::default() });
        index
    }

    /// The module whose file is used by a path in `home`, if it is one of this crate's.
    fn used(&self, home: usize, path: &NamedPath) -> Option<usize> {
        let names = path.names();
        if let [name] = names[..]
            && path.import.is_none()
        {
            // A private import counts where it stands; one that passes a name on counts where the name is used.
            let Module { items, imports, .. } = &self.modules[home];
            if items.contains(name) || !imports.get(name).is_some_and(|(_, public)| *public) {
                return None;
            }
        }
        let below = names.strip_suffix(&["*"]);
        let target = match self.resolve(home, below.unwrap_or(&names), 0)? {
            Target::Item(module) => module,
            Target::Module(module) if below.is_some() => module,
            Target::Module(_) => return None,
        };
        let passed_on = path.import.as_ref().is_some_and(|import| import.public) && self.is_below(target, home);
        (!passed_on).then_some(target)
    }

    fn is_below(&self, module: usize, above: usize) -> bool {
        let mut at = Some(module);
        while let Some(module) = at {
            if module == above {
                return true;
            }
            at = self.modules[module].parent;
        }
        false
    }

    fn resolve(&self, home: usize, names: &[&str], depth: usize) -> Option<Target> {
        let (first, rest) = names.split_first()?;
        let mut at = match *first {
            "crate" => Target::Module(0),
            "self" => Target::Module(home),
            "super" => Target::Module(self.modules[home].parent?),
            name => self.name(home, name, rest.is_empty(), depth)?,
        };
        for (k, name) in rest.iter().enumerate() {
            let Target::Module(module) = at else { break };
            at = match *name {
                "self" => at,
                "super" => Target::Module(self.modules[module].parent?),
                // What is not found was made by a macro, or comes from another crate.
                name => self.name(module, name, k + 1 == rest.len(), depth).unwrap_or(Target::Item(module)),
            };
        }
        Some(at)
    }

    /// What `name` is in a module; where a path ends, an item rather than a module of that name.
    fn name(&self, module: usize, name: &str, last: bool, depth: usize) -> Option<Target> {
        if depth > DEEPEST {
            return None;
        }
        let Module { children, items, imports, globs, .. } = &self.modules[module];
        let child = children.get(name).map(|child| Target::Module(*child));
        if !last && child.is_some() {
            return child;
        }
        if items.contains(name) {
            return Some(Target::Item(module));
        }
        if let Some((path, _)) = imports.get(name)
            && let Some(found) = self.resolve(module, &borrowed(path), depth + 1)
        {
            return Some(found);
        }
        let everything = || {
            globs.iter().find_map(|path| match self.resolve(module, &borrowed(path), depth + 1)? {
                Target::Module(from) if from != module => self.name(from, name, last, depth + 1),
                _ => None,
            })
        };
        child.or_else(everything)
    }
}

fn borrowed(path: &[String]) -> Vec<&str> {
    path.iter().map(String::as_str).collect()
}
