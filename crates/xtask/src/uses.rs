//! Which file of a crate uses which. Imports are followed to the file that defines what they name.

use proc_macro2::{Ident, TokenStream, TokenTree};
use std::collections::{BTreeMap, HashMap, HashSet};
use syn::{ext::IdentExt, visit, visit::Visit};

/// Imports of imports that are followed.
const DEEPEST: usize = 8;

/// A use of one file by another, by their paths below `src`.
#[derive(Clone, Debug)]
pub struct Use {
    pub from: String,
    pub to: String,
    pub line: usize,
    /// By a unit test.
    pub test: bool,
}

/// All uses among `files`, the crate's sources by their paths below `src`. A module that passes on what its submodules
/// define does not use them by that.
pub fn uses(files: &BTreeMap<String, String>) -> Result<Vec<Use>, String> {
    let mut parsed = BTreeMap::new();
    for (file, text) in files {
        parsed.insert(file.as_str(), syn::parse_file(text).map_err(|e| format!("{file}: {e}"))?);
    }
    let root = ["lib.rs", "main.rs"].into_iter().find(|name| files.contains_key(*name));
    let root = root.ok_or("no lib.rs or main.rs")?;
    let top = Module { file: root.into(), ..Module::default() };
    let mut tree =
        Tree { files: &parsed, modules: vec![top], paths: Vec::new(), place: Vec::new(), here: 0, test: false };
    tree.visit_file(&parsed[root]);
    let found = tree.paths.iter().filter_map(|path| {
        let (from, to) = (&tree.modules[path.home].file, &tree.modules[tree.used(path)?].file);
        (from != to).then(|| Use { from: from.clone(), to: to.clone(), line: path.line, test: path.test })
    });
    Ok(found.collect())
}

#[derive(Default)]
struct Module {
    file: String,
    parent: Option<usize>,
    children: HashMap<String, usize>,
    /// Names of what it defines, modules left out.
    items: HashSet<String>,
    /// Imports by the module's name for them, each with whether it is public.
    imports: HashMap<String, (Vec<String>, bool)>,
    /// Modules of which everything is imported.
    globs: Vec<Vec<String>>,
}

/// A path in an import, an expression, a type, a pattern or a macro's body.
struct NamedPath {
    /// The module that it stands in.
    home: usize,
    /// Its segments; `*` ends the import of everything.
    names: Vec<String>,
    line: usize,
    /// Of an import, whether it is public.
    import: Option<bool>,
    /// Of unit tests.
    test: bool,
}

/// What a path leads to: a module, or something that a module's file defines.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Target {
    Module(usize),
    Item(usize),
}

/// The modules of a crate, and what is read of them so far.
struct Tree<'a> {
    files: &'a BTreeMap<&'a str, syn::File>,
    modules: Vec<Module>,
    paths: Vec<NamedPath>,
    /// Names of the modules around the one that is being read.
    place: Vec<String>,
    here: usize,
    test: bool,
}

fn is_cfg_test(attribute: &syn::Attribute) -> bool {
    matches!(&attribute.meta, syn::Meta::List(list) if list.path.is_ident("cfg") && list.tokens.to_string() == "test")
}

impl Tree<'_> {
    fn push(&mut self, path: Vec<&Ident>, import: Option<bool>) {
        let Some(last) = path.last() else { return };
        let line = last.span().start().line;
        self.push_names(path.iter().map(|ident| ident.unraw().to_string()).collect(), line, import);
    }

    fn push_names(&mut self, names: Vec<String>, line: usize, import: Option<bool>) {
        self.paths.push(NamedPath { home: self.here, names, line, import, test: self.test });
    }

    fn import<'t>(&mut self, tree: &'t syn::UseTree, mut prefix: Vec<&'t Ident>, public: bool) {
        let names = |path: &[&Ident]| path.iter().map(|ident| ident.unraw().to_string()).collect::<Vec<_>>();
        let alias = match tree {
            syn::UseTree::Path(path) => {
                prefix.push(&path.ident);
                return self.import(&path.tree, prefix, public);
            }
            syn::UseTree::Group(group) => {
                return group.items.iter().for_each(|tree| self.import(tree, prefix.clone(), public));
            }
            syn::UseTree::Glob(glob) => {
                let mut of = names(&prefix);
                self.modules[self.here].globs.push(of.clone());
                of.push("*".into());
                return self.push_names(of, glob.star_token.span.start().line, Some(public));
            }
            syn::UseTree::Name(name) => {
                prefix.push(&name.ident);
                None
            }
            syn::UseTree::Rename(rename) => {
                prefix.push(&rename.ident);
                Some(rename.rename.unraw().to_string())
            }
        };
        // `a::{self}` is `a`.
        let path = names(&prefix);
        let alias = alias.or_else(|| path.iter().rev().find(|name| *name != "self").cloned()).unwrap_or_default();
        self.modules[self.here].imports.insert(alias, (path, public));
        self.push(prefix, Some(public));
    }

    /// Paths in a macro's body, found by their separators.
    fn tokens(&mut self, tokens: &TokenStream) {
        let tokens: Vec<TokenTree> = tokens.clone().into_iter().collect();
        let (mut path, mut colons) = (Vec::new(), 0);
        for token in &tokens {
            match token {
                TokenTree::Ident(ident) => {
                    if colons != 2 {
                        self.push(std::mem::take(&mut path), None);
                    }
                    path.push(ident);
                    colons = 0;
                }
                TokenTree::Punct(sign) if sign.as_char() == ':' => colons += 1,
                other => {
                    self.push(std::mem::take(&mut path), None);
                    colons = 0;
                    if let TokenTree::Group(group) = other {
                        self.tokens(&group.stream());
                    }
                }
            }
        }
        self.push(path, None);
    }

    /// The module whose file a path uses, if it is one of this crate's.
    fn used(&self, path: &NamedPath) -> Option<usize> {
        let names: Vec<&str> = path.names.iter().map(String::as_str).collect();
        if let [name] = names[..]
            && path.import.is_none()
        {
            // A private import counts where it stands; one that passes a name on counts where the name is used.
            let Module { items, imports, .. } = &self.modules[path.home];
            if items.contains(name) || !imports.get(name).is_some_and(|(_, public)| *public) {
                return None;
            }
        }
        let below = names.strip_suffix(&["*"]);
        let target = match self.resolve(path.home, below.unwrap_or(&names), 0)? {
            Target::Item(module) => module,
            Target::Module(module) if below.is_some() => module,
            Target::Module(_) => return None,
        };
        let passed_on = path.import == Some(true) && self.is_below(target, path.home);
        (!passed_on).then_some(target)
    }

    fn is_below(&self, module: usize, above: usize) -> bool {
        std::iter::successors(Some(module), |module| self.modules[*module].parent).any(|module| module == above)
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
        let follow =
            |path: &[String]| self.resolve(module, &path.iter().map(String::as_str).collect::<Vec<_>>(), depth + 1);
        let everything = || {
            globs.iter().find_map(|path| match follow(path)? {
                Target::Module(from) if from != module => self.name(from, name, last, depth + 1),
                _ => None,
            })
        };
        imports.get(name).and_then(|(path, _)| follow(path)).or(child).or_else(everything)
    }
}

impl<'ast> Visit<'ast> for Tree<'ast> {
    fn visit_item(&mut self, item: &'ast syn::Item) {
        let name = match item {
            syn::Item::Const(item) => Some(&item.ident),
            syn::Item::Enum(item) => Some(&item.ident),
            syn::Item::Fn(item) => Some(&item.sig.ident),
            syn::Item::Macro(item) => item.ident.as_ref(),
            syn::Item::Static(item) => Some(&item.ident),
            syn::Item::Struct(item) => Some(&item.ident),
            syn::Item::Trait(item) => Some(&item.ident),
            syn::Item::Type(item) => Some(&item.ident),
            syn::Item::Union(item) => Some(&item.ident),
            _ => None,
        };
        self.modules[self.here].items.extend(name.map(|name| name.unraw().to_string()));
        visit::visit_item(self, item);
    }

    /// Modules without a body are files.
    fn visit_item_mod(&mut self, item: &'ast syn::ItemMod) {
        let (outside, tests_outside) = (self.here, self.test);
        self.place.push(item.ident.unraw().to_string());
        let place = self.place.join("/");
        let candidates = [format!("{place}.rs"), format!("{place}/mod.rs")];
        let file = candidates.iter().find_map(|file| self.files.get_key_value(file.as_str()));
        let (file, items) = match (&item.content, file) {
            (None, Some((file, source))) => (file.to_string(), &source.items[..]),
            (content, _) => {
                (self.modules[outside].file.clone(), content.as_ref().map_or(&[][..], |(_, items)| &items[..]))
            }
        };
        self.here = self.modules.len();
        self.test |= item.attrs.iter().any(is_cfg_test);
        self.modules.push(Module { file, parent: Some(outside), ..Module::default() });
        self.modules[outside].children.insert(item.ident.unraw().to_string(), self.here);
        items.iter().for_each(|item| self.visit_item(item));
        self.place.pop();
        (self.here, self.test) = (outside, tests_outside);
    }

    fn visit_item_use(&mut self, item: &'ast syn::ItemUse) {
        if item.leading_colon.is_none() {
            self.import(&item.tree, Vec::new(), !matches!(item.vis, syn::Visibility::Inherited));
        }
    }

    fn visit_path(&mut self, path: &'ast syn::Path) {
        if path.leading_colon.is_none() {
            self.push(path.segments.iter().map(|part| &part.ident).collect(), None);
        }
        visit::visit_path(self, path);
    }

    fn visit_macro(&mut self, item: &'ast syn::Macro) {
        self.tokens(&item.tokens);
        visit::visit_macro(self, item);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Uses in the order in which they are read.
    fn found(files: &[(&str, &str)]) -> Vec<String> {
        let files = files.iter().map(|(name, text)| (name.to_string(), text.to_string())).collect();
        uses(&files).unwrap().into_iter().map(|u| format!("{}:{} {}", u.from, u.line, u.to)).collect()
    }

    #[test]
    fn paths_lead_to_the_file_that_defines() {
        let files = [
            ("main.rs", "mod a; mod b; fn main() { a::e::run() }"),
            ("a/mod.rs", "pub mod e; use crate::b; pub use e::*; pub struct A(b::Other);"),
            ("a/e.rs", "pub struct E; pub fn run() {} use serde::E as F; #[cfg(test)] mod tests { use crate::b; }"),
            ("b.rs", "use super::a; pub struct Other; fn f(x: a::E) -> a::E { a::f() }"),
        ];
        assert_eq!(
            found(&files),
            ["a/mod.rs:1 b.rs", "b.rs:1 a/e.rs", "b.rs:1 a/e.rs", "b.rs:1 a/mod.rs", "main.rs:1 a/e.rs"]
        );
    }

    #[test]
    fn every_kind_of_import_is_followed() {
        let a = "pub struct C; pub fn d() {} pub struct r#type;";
        let of = |b: &str| found(&[("lib.rs", "mod a; mod b;"), ("a.rs", a), ("b.rs", b)]);
        assert_eq!(of("use crate::a::{self, C as D,\n d};"), ["b.rs:1 a.rs", "b.rs:2 a.rs"], "a module is not a file");
        assert_eq!(of("\nuse super::a::*;"), ["b.rs:2 a.rs"]);
        assert_eq!(of("pub(crate) use crate::a::r#type;"), ["b.rs:1 a.rs"]);
        assert_eq!(of("use crate as root; fn f() {\n root::a::d() }"), ["b.rs:2 a.rs"]);
        assert_eq!(of("mod c {\n use super::super::a::C; }"), ["b.rs:2 a.rs"], "inline modules");
        let reexported = [("lib.rs", "mod a; mod b; pub use a::C;"), ("a.rs", a), ("b.rs", "use crate::C;")];
        assert_eq!(found(&reexported), ["b.rs:1 a.rs"], "what the root passes on is not the root's");
        assert_eq!(of("use crate::*;"), ["b.rs:1 lib.rs"]);
    }

    #[test]
    fn expressions_types_and_macros_name_paths() {
        let a = "pub struct C; pub mod d { pub fn e() {} }";
        let text = "/// crate::a::C\nfn f(x: &crate::a::C<u8>) -> u8 {\n \"crate::a::C\";\n x!(g, $crate::a::C,\n [super::a::d::e(k)]) }";
        let files = [("lib.rs", "mod a; mod b;"), ("a.rs", a), ("b.rs", text)];
        assert_eq!(found(&files), ["b.rs:2 a.rs", "b.rs:4 a.rs", "b.rs:5 a.rs"]);
    }

    #[test]
    fn unit_tests_are_told() {
        let test = "pub struct A; #[cfg(test)] mod tests { use crate::b::B; }";
        let files = [("lib.rs", "mod a; mod b;"), ("a.rs", test), ("b.rs", "pub struct B;")];
        let files = files.map(|(name, text)| (name.to_string(), text.to_string()));
        let [only] = &uses(&files.into()).unwrap()[..] else { panic!("one use") };
        assert!(only.test && only.from == "a.rs" && only.to == "b.rs");
    }
}
