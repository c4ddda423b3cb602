//! Every path that a source names: in `use` declarations, in expressions, types and patterns, in
//! the tokens of macro calls, and in the texts of attributes (`#[serde(with = "crate::...")]`).

use super::source::{self, SourceFile};
use proc_macro2::{Span, TokenStream, TokenTree};
use syn::visit::{self, Visit};
use syn::{
    Attribute, ImplItem, Item, ItemMod, Macro, TraitItem, UseTree, VisRestricted, Visibility,
};

/// The library's name, by which `main.rs` reaches it.
pub const CRATE: &str = "hertzscope";

/// One path as written.
pub struct PathUse {
    /// Its names; `*` at the end of a glob.
    pub segments: Vec<String>,
    /// The module that it is written in, from the crate's root.
    pub module_path: Vec<String>,
    pub span: Span,
    /// Whether only test builds see it.
    pub in_test: bool,
    /// The name that it gives to what it names, for a leaf of a `use` declaration.
    pub binding: Option<Binding>,
}

/// What a leaf of a `use` declaration makes known in its module.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Binding {
    /// The name; `*` for a glob.
    pub name: String,
    /// Whether the declaration has a visibility, `pub use` or `pub(crate) use`.
    pub exported: bool,
}

impl PathUse {
    /// The path from the crate's root; `None` for one that begins with a local or a foreign name.
    pub fn resolve(&self) -> Option<Vec<String>> {
        // `main.rs` is a crate of its own, whose root is not the library's.
        let own_root = usize::from(self.module_path.first().is_some_and(|module| module == "main"));
        let (first, rest) = self.segments.split_first()?;
        let mut absolute = match first.as_str() {
            CRATE => Vec::new(),
            "crate" | "$crate" => self.module_path[..own_root].to_vec(),
            "self" => self.module_path.clone(),
            "super" => self.module_path[..self.module_path.len().saturating_sub(1)].to_vec(),
            _ => return None,
        };
        for segment in rest {
            match segment.as_str() {
                "self" => {}
                "super" => {
                    absolute.pop();
                }
                name => absolute.push(name.to_owned()),
            }
        }
        Some(absolute)
    }
}

/// All paths of `file`; `in_test` where the whole file is test code.
pub fn of(file: &SourceFile, in_test: bool) -> Vec<PathUse> {
    let module_path = file.module_path.clone();
    let mut walk = Walk { module_path, in_test, binding: None, exported: false, found: Vec::new() };
    walk.visit_file(&file.syntax);
    walk.found
}

struct Walk {
    /// The module that the walk is in, from the crate's root.
    module_path: Vec<String>,
    in_test: bool,
    /// What the path that is noted next makes known.
    binding: Option<String>,
    /// Whether the `use` declaration that the walk is in has a visibility.
    exported: bool,
    found: Vec<PathUse>,
}

impl Walk {
    /// Walks on with `walk`, in test code if `attributes` say so.
    fn guarded(&mut self, attributes: &[Attribute], walk: impl FnOnce(&mut Self)) {
        let before = self.in_test;
        self.in_test |= source::only_in_tests(attributes);
        walk(self);
        self.in_test = before;
    }

    /// Notes one path as written.
    fn note(&mut self, segments: &[String], span: Span) {
        let exported = self.exported;
        self.found.push(PathUse {
            segments: segments.to_vec(),
            module_path: self.module_path.clone(),
            span,
            in_test: self.in_test,
            binding: self.binding.take().map(|name| Binding { name, exported }),
        });
    }

    /// Notes each leaf of a `use` declaration.
    fn note_use(&mut self, prefix: &[String], tree: &UseTree) {
        let with = |name: String| [prefix, &[name]].concat();
        let (leaf, name, span) = match tree {
            UseTree::Path(path) => {
                return self.note_use(&with(path.ident.to_string()), &path.tree);
            }
            UseTree::Group(group) => {
                return group.items.iter().for_each(|part| self.note_use(prefix, part));
            }
            UseTree::Name(name) => {
                let leaf = name.ident.to_string();
                let known =
                    if leaf == "self" { prefix.last().cloned() } else { Some(leaf.clone()) };
                (leaf, known, name.ident.span())
            }
            UseTree::Rename(rename) => {
                (rename.ident.to_string(), Some(rename.rename.to_string()), rename.ident.span())
            }
            UseTree::Glob(glob) => ("*".to_owned(), Some("*".to_owned()), glob.star_token.spans[0]),
        };
        self.binding = name;
        self.note(&with(leaf), span);
    }

    /// Notes the paths in tokens that are not parsed: what stands inside a macro call or an
    /// attribute.
    fn note_tokens(&mut self, tokens: TokenStream) {
        let trees: Vec<TokenTree> = tokens.into_iter().collect();
        let mut at = 0;
        while at < trees.len() {
            match &trees[at] {
                TokenTree::Group(group) => {
                    self.note_tokens(group.stream());
                    at += 1;
                }
                TokenTree::Ident(ident) if !follows_path_separator(&trees, at) => {
                    let span = ident.span();
                    at = self.note_token_path(&trees, at, &[], span);
                }
                TokenTree::Literal(literal) => {
                    self.note_text(&literal.to_string(), literal.span());
                    at += 1;
                }
                _ => at += 1,
            }
        }
    }

    /// Notes the path that begins with the name at `at`; returns where it ends.
    fn note_token_path(
        &mut self,
        trees: &[TokenTree],
        mut at: usize,
        prefix: &[String],
        span: Span,
    ) -> usize {
        let mut segments = prefix.to_vec();
        while let Some(TokenTree::Ident(ident)) = trees.get(at) {
            segments.push(ident.to_string());
            at += 1;
            if !is_path_separator(trees, at) {
                break;
            }
            at += 2;
        }
        if let Some(TokenTree::Group(group)) =
            trees.get(at).filter(|_| follows_path_separator(trees, at))
        {
            // A `use` with a group inside a macro: each part continues the path.
            let parts: Vec<TokenTree> = group.stream().into_iter().collect();
            for part in parts
                .split(|tree| matches!(tree, TokenTree::Punct(punct) if punct.as_char() == ','))
            {
                self.note_token_path(part, 0, &segments, span);
            }
            return at + 1;
        }
        self.note(&segments, span);
        at
    }

    /// Notes a text that reads as a path, as `serde` takes them.
    fn note_text(&mut self, literal: &str, span: Span) {
        if let Ok(path) =
            syn::parse_str::<syn::LitStr>(literal).and_then(|text| text.parse::<syn::Path>())
        {
            // A text of one word is far more often a name than a path.
            if path.segments.len() > 1 {
                self.note(&names(&path), span);
            }
        }
    }
}

fn names(path: &syn::Path) -> Vec<String> {
    path.segments.iter().map(|segment| segment.ident.to_string()).collect()
}

fn is_colon(tree: Option<&TokenTree>) -> bool {
    matches!(tree, Some(TokenTree::Punct(punct)) if punct.as_char() == ':')
}

fn is_path_separator(trees: &[TokenTree], at: usize) -> bool {
    is_colon(trees.get(at)) && is_colon(trees.get(at + 1))
}

fn follows_path_separator(trees: &[TokenTree], at: usize) -> bool {
    at >= 2 && is_path_separator(trees, at - 2)
}

impl<'ast> Visit<'ast> for Walk {
    fn visit_item(&mut self, item: &'ast Item) {
        self.guarded(source::item_attributes(item), |walk| {
            visit::visit_item(walk, item);
        });
    }

    fn visit_impl_item(&mut self, item: &'ast ImplItem) {
        self.guarded(source::impl_item_attributes(item), |walk| {
            visit::visit_impl_item(walk, item);
        });
    }

    fn visit_trait_item(&mut self, item: &'ast TraitItem) {
        self.guarded(source::trait_item_attributes(item), |walk| {
            visit::visit_trait_item(walk, item);
        });
    }

    fn visit_local(&mut self, local: &'ast syn::Local) {
        self.guarded(&local.attrs, |walk| visit::visit_local(walk, local));
    }

    fn visit_field(&mut self, field: &'ast syn::Field) {
        self.guarded(&field.attrs, |walk| visit::visit_field(walk, field));
    }

    fn visit_item_mod(&mut self, module: &'ast ItemMod) {
        self.module_path.push(module.ident.to_string());
        visit::visit_item_mod(self, module);
        self.module_path.pop();
    }

    fn visit_item_use(&mut self, item: &'ast syn::ItemUse) {
        self.exported = !matches!(item.vis, Visibility::Inherited);
        self.note_use(&[], &item.tree);
    }

    fn visit_path(&mut self, path: &'ast syn::Path) {
        if let Some(first) = path.segments.first() {
            self.note(&names(path), first.ident.span());
        }
        visit::visit_path(self, path);
    }

    fn visit_macro(&mut self, call: &'ast Macro) {
        visit::visit_macro(self, call);
        self.note_tokens(call.tokens.clone());
    }

    fn visit_attribute(&mut self, attribute: &'ast Attribute) {
        if let syn::Meta::List(list) = &attribute.meta {
            self.note_tokens(list.tokens.clone());
        }
    }

    /// `pub(crate)` says who may look in, which is no use; only `super::super` is looked for.
    fn visit_vis_restricted(&mut self, visibility: &'ast VisRestricted) {
        let before = std::mem::replace(&mut self.in_test, true);
        visit::visit_vis_restricted(self, visibility);
        self.in_test = before;
    }
}
