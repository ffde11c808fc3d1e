//! What a Rust file defines, imports and names.

use proc_macro2::{Ident, TokenStream, TokenTree};
use syn::{ext::IdentExt, visit, visit::Visit};

/// What one file says, each with the inline modules that it stands in.
#[derive(Debug, Default)]
pub struct Source {
    /// Modules with their lines; those without a body are files.
    pub modules: Vec<(Vec<String>, usize)>,
    /// Items by name, modules and imports left out.
    pub items: Vec<(Vec<String>, String)>,
    pub paths: Vec<NamedPath>,
}

/// A path in an import, an expression, a type, a pattern or a macro's body.
#[derive(Clone, Debug)]
pub struct NamedPath {
    pub module: Vec<String>,
    /// Segments with their lines; `*` ends the import of everything.
    pub segments: Vec<(String, usize)>,
    pub import: Option<Import>,
    /// Of unit tests.
    pub test: bool,
}

#[derive(Clone, Debug)]
pub struct Import {
    /// What the module calls it.
    pub alias: String,
    pub public: bool,
}

impl NamedPath {
    pub fn names(&self) -> Vec<&str> {
        self.segments.iter().map(|(name, _)| name.as_str()).collect()
    }

    pub fn line(&self) -> usize {
        self.segments.last().map_or(0, |(_, line)| *line)
    }
}

/// Reads a file.
pub fn read(text: &str) -> Result<Source, syn::Error> {
    let mut reader = Reader::default();
    reader.visit_file(&syn::parse_file(text)?);
    Ok(reader.out)
}

#[derive(Default)]
struct Reader {
    out: Source,
    here: Vec<String>,
    test: bool,
}

fn segment(ident: &Ident) -> (String, usize) {
    (ident.unraw().to_string(), ident.span().start().line)
}

fn is_cfg_test(attribute: &syn::Attribute) -> bool {
    matches!(&attribute.meta, syn::Meta::List(list) if list.path.is_ident("cfg") && list.tokens.to_string() == "test")
}

impl Reader {
    fn push(&mut self, segments: Vec<(String, usize)>, import: Option<Import>) {
        if !segments.is_empty() {
            self.out.paths.push(NamedPath { module: self.here.clone(), segments, import, test: self.test });
        }
    }

    fn import(&mut self, tree: &syn::UseTree, mut prefix: Vec<(String, usize)>, public: bool) {
        let alias = match tree {
            syn::UseTree::Path(path) => {
                prefix.push(segment(&path.ident));
                return self.import(&path.tree, prefix, public);
            }
            syn::UseTree::Group(group) => {
                return group.items.iter().for_each(|tree| self.import(tree, prefix.clone(), public));
            }
            syn::UseTree::Name(name) => {
                prefix.push(segment(&name.ident));
                None
            }
            syn::UseTree::Rename(rename) => {
                prefix.push(segment(&rename.ident));
                Some(segment(&rename.rename).0)
            }
            syn::UseTree::Glob(glob) => {
                prefix.push(("*".into(), glob.star_token.span.start().line));
                None
            }
        };
        // `a::{self}` is `a`.
        let named = prefix.iter().rev().map(|(name, _)| name).find(|name| *name != "self");
        let alias = alias.or_else(|| named.cloned()).unwrap_or_default();
        self.push(prefix, Some(Import { alias, public }));
    }

    /// Paths in a macro's body, found by their separators.
    fn tokens(&mut self, tokens: TokenStream) {
        let (mut path, mut colons) = (Vec::new(), 0);
        for token in tokens {
            match token {
                TokenTree::Ident(ident) => {
                    if colons != 2 {
                        self.push(std::mem::take(&mut path), None);
                    }
                    path.push(segment(&ident));
                    colons = 0;
                }
                TokenTree::Punct(sign) if sign.as_char() == ':' => colons += 1,
                other => {
                    self.push(std::mem::take(&mut path), None);
                    colons = 0;
                    if let TokenTree::Group(group) = other {
                        self.tokens(group.stream());
                    }
                }
            }
        }
        self.push(path, None);
    }
}

impl<'ast> Visit<'ast> for Reader {
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
        self.out.items.extend(name.map(|name| (self.here.clone(), segment(name).0)));
        visit::visit_item(self, item);
    }

    fn visit_item_mod(&mut self, item: &'ast syn::ItemMod) {
        let (name, line) = segment(&item.ident);
        self.here.push(name);
        self.out.modules.push((self.here.clone(), line));
        let outside = self.test;
        self.test |= item.attrs.iter().any(is_cfg_test);
        for item in item.content.iter().flat_map(|(_, items)| items) {
            self.visit_item(item);
        }
        self.test = outside;
        self.here.pop();
    }

    fn visit_item_use(&mut self, item: &'ast syn::ItemUse) {
        if item.leading_colon.is_none() {
            self.import(&item.tree, Vec::new(), !matches!(item.vis, syn::Visibility::Inherited));
        }
    }

    fn visit_path(&mut self, path: &'ast syn::Path) {
        if path.leading_colon.is_none() {
            self.push(path.segments.iter().map(|part| segment(&part.ident)).collect(), None);
        }
        visit::visit_path(self, path);
    }

    fn visit_macro(&mut self, item: &'ast syn::Macro) {
        self.tokens(item.tokens.clone());
        visit::visit_macro(self, item);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn paths(text: &str) -> Vec<(String, usize)> {
        let source = read(text).unwrap();
        source.paths.iter().map(|path| (path.names().join("::"), path.line())).collect()
    }

    #[test]
    fn imports_are_one_path_each() {
        let text = "use a::{self, b::C as D,\n e::*};\npub(crate) use r#type;";
        let names = [("a::self", 1), ("a::b::C", 1), ("a::e::*", 2), ("type", 3)];
        assert_eq!(paths(text), names.map(|(name, line)| (name.to_string(), line)));
        let source = read(text).unwrap();
        let aliases: Vec<_> =
            source.paths.iter().flat_map(|p| &p.import).map(|i| (i.alias.as_str(), i.public)).collect();
        assert_eq!(aliases, [("a", false), ("D", false), ("*", false), ("type", true)]);
    }

    #[test]
    fn expressions_types_and_macros_name_paths() {
        let text =
            "/// crate::a\nfn f(x: &crate::b::C<super::D>) -> u8 {\n \"crate::e\"; x!(g, $crate::h::I, [j::k(l)]) }";
        let found: Vec<String> = paths(text).into_iter().map(|p| p.0).filter(|p| p.contains("::")).collect();
        assert_eq!(found, ["crate::b::C", "super::D", "crate::h::I", "j::k"]);
    }

    #[test]
    fn inline_modules_are_told() {
        let source = read("mod a { mod b { fn f() { c::d(); } } }\nmod e;").unwrap();
        let names: Vec<String> = source.modules.iter().map(|(path, _)| path.join("::")).collect();
        assert_eq!(names, ["a", "a::b", "e"]);
        assert_eq!(source.paths[0].module, ["a", "b"]);
        assert_eq!(source.items, [(vec!["a".to_string(), "b".into()], "f".to_string())]);
    }
}
