//! Every public `f64` says its unit.
//!
//! Public are: `pub` fields (whatever the struct derives), fields of the variants of a `pub enum`,
//! `pub` constants, and what a `pub` function or a method of a `pub trait` returns. `f64` stands
//! for the number itself, and for an `Option`, `Vec`, `Box`, reference, slice or array of it,
//! nested as may be. What is only visible inside the crate is exempt.

use super::source::{self, SourceFile, Violation};
use hertzscope::quantity::Quantity;
use proc_macro2::Span;
use syn::visit::{self, Visit};
use syn::{
    Attribute, Expr, Field, Fields, ImplItem, Item, Lit, Meta, ReturnType, Signature, TraitItem,
    Type, Visibility,
};

/// What stands for a unit although it is no quantity's: `unit` where another field or argument
/// names it.
const FURTHER_UNITS: [&str; 4] = ["unit", "dB", "rad", "deg"];

/// Every public `f64` whose doc comment does not end with a unit.
pub fn check(files: &[SourceFile]) -> Vec<Violation> {
    let test_modules = source::test_modules(files);
    let mut violations = Vec::new();
    for file in files.iter().filter(|file| !source::is_test_file(file, &test_modules)) {
        let mut walk = Walk { file, violations: Vec::new() };
        walk.visit_file(&file.syntax);
        violations.append(&mut walk.violations);
    }
    violations
}

struct Walk<'a> {
    file: &'a SourceFile,
    violations: Vec<Violation>,
}

impl Walk<'_> {
    /// Asks the first of `docs` that says anything for the unit.
    fn ask(&mut self, what: &str, span: Span, docs: &[&[Attribute]]) {
        let text = docs.iter().map(|attributes| doc_text(attributes)).find(|text| !text.is_empty());
        let message = match text.map(|text| unit_of(&text)) {
            None => format!("{what} is a public f64 without doc comment"),
            Some(Unit::Missing) => {
                format!("{what}: the doc comment of a public f64 ends with its unit, as in `(m/s)`")
            }
            Some(Unit::Unknown(unit)) => format!("{what}: `({unit})` is no unit"),
            Some(Unit::Named) => return,
        };
        self.violations.push(self.file.violation(span, message));
    }

    fn ask_function(&mut self, signature: &Signature, attributes: &[Attribute]) {
        if let ReturnType::Type(_, returned) = &signature.output
            && is_f64(returned)
        {
            self.ask(&format!("`{}`", signature.ident), signature.ident.span(), &[attributes]);
        }
    }

    /// Asks each field of type `f64` that `public` accepts; one without name may leave the word to
    /// `owner`.
    fn ask_fields(
        &mut self,
        fields: &Fields,
        owner: &[Attribute],
        public: impl Fn(&Field) -> bool,
    ) {
        for (index, field) in fields.iter().enumerate() {
            if !public(field) || !is_f64(&field.ty) || source::only_in_tests(&field.attrs) {
                continue;
            }
            if let Some(name) = &field.ident {
                self.ask(&format!("`{name}`"), name.span(), &[&field.attrs]);
            } else {
                let span = syn::spanned::Spanned::span(&field.ty);
                self.ask(&format!("field {index}"), span, &[&field.attrs, owner]);
            }
        }
    }
}

impl<'ast> Visit<'ast> for Walk<'_> {
    fn visit_item(&mut self, item: &'ast Item) {
        if source::only_in_tests(source::item_attributes(item)) {
            return;
        }
        match item {
            Item::Struct(item) => {
                self.ask_fields(&item.fields, &item.attrs, |field| is_public(&field.vis));
            }
            Item::Enum(item) if is_public(&item.vis) => {
                for variant in &item.variants {
                    self.ask_fields(&variant.fields, &variant.attrs, |_| true);
                }
            }
            Item::Fn(item) if is_public(&item.vis) => self.ask_function(&item.sig, &item.attrs),
            Item::Const(item) if is_public(&item.vis) && is_f64(&item.ty) => {
                self.ask(&format!("`{}`", item.ident), item.ident.span(), &[&item.attrs]);
            }
            Item::Static(item) if is_public(&item.vis) && is_f64(&item.ty) => {
                self.ask(&format!("`{}`", item.ident), item.ident.span(), &[&item.attrs]);
            }
            Item::Trait(item) if is_public(&item.vis) => {
                for method in &item.items {
                    if let TraitItem::Fn(method) = method {
                        self.ask_function(&method.sig, &method.attrs);
                    }
                }
            }
            _ => {}
        }
        visit::visit_item(self, item);
    }

    fn visit_impl_item(&mut self, item: &'ast ImplItem) {
        if source::only_in_tests(source::impl_item_attributes(item)) {
            return;
        }
        match item {
            ImplItem::Fn(method) if is_public(&method.vis) => {
                self.ask_function(&method.sig, &method.attrs);
            }
            ImplItem::Const(constant) if is_public(&constant.vis) && is_f64(&constant.ty) => {
                self.ask(
                    &format!("`{}`", constant.ident),
                    constant.ident.span(),
                    &[&constant.attrs],
                );
            }
            _ => {}
        }
        visit::visit_impl_item(self, item);
    }
}

fn is_public(visibility: &Visibility) -> bool {
    matches!(visibility, Visibility::Public(_))
}

/// Whether a type is `f64`, or holds nothing but.
fn is_f64(ty: &Type) -> bool {
    match ty {
        Type::Path(path) => path.path.segments.last().is_some_and(|last| {
            last.ident == "f64"
                || (["Option", "Vec", "Box"].iter().any(|holder| last.ident == holder)
                    && matches!(&last.arguments, syn::PathArguments::AngleBracketed(arguments)
                        if arguments.args.iter().any(|argument|
                            matches!(argument, syn::GenericArgument::Type(inner) if is_f64(inner)))))
        }),
        Type::Reference(reference) => is_f64(&reference.elem),
        Type::Slice(slice) => is_f64(&slice.elem),
        Type::Array(array) => is_f64(&array.elem),
        Type::Paren(inner) => is_f64(&inner.elem),
        Type::Group(inner) => is_f64(&inner.elem),
        _ => false,
    }
}

/// The lines of a doc comment.
fn doc_text(attributes: &[Attribute]) -> String {
    let mut text = String::new();
    for attribute in attributes.iter().filter(|attribute| attribute.path().is_ident("doc")) {
        if let Meta::NameValue(pair) = &attribute.meta
            && let Expr::Lit(literal) = &pair.value
            && let Lit::Str(line) = &literal.lit
        {
            // Not `lines`: an empty line is a paragraph's end and must stay.
            for part in line.value().split('\n') {
                text.push_str(part.trim());
                text.push('\n');
            }
        }
    }
    text.trim().to_owned()
}

#[derive(Debug, PartialEq)]
enum Unit {
    Named,
    Missing,
    Unknown(String),
}

/// Looks for the unit at the end of the first paragraph, then at the end of the whole text.
fn unit_of(doc: &str) -> Unit {
    let first_paragraph = doc.split("\n\n").next().unwrap_or_default();
    let mut unknown = None;
    for text in [first_paragraph, doc] {
        let Some(brackets) = last_brackets(text) else {
            continue;
        };
        // Behind a comma or semicolon stands what holds in another case: `(s; Hz for an FFT)`.
        let unit = brackets.split([',', ';']).next().unwrap_or_default().trim();
        let known =
            FURTHER_UNITS.contains(&unit) || format!("1 {unit}").parse::<Quantity>().is_ok();
        if known && !unit.is_empty() {
            return Unit::Named;
        }
        unknown.get_or_insert_with(|| unit.to_owned());
    }
    unknown.map_or(Unit::Missing, Unit::Unknown)
}

/// What the round brackets hold that end the text; a full stop may follow them.
fn last_brackets(text: &str) -> Option<&str> {
    let text = text.trim_end();
    let inner = text.strip_suffix('.').unwrap_or(text).strip_suffix(')')?;
    let mut depth = 1;
    for (at, character) in inner.char_indices().rev() {
        match character {
            ')' => depth += 1,
            '(' => depth -= 1,
            _ => {}
        }
        if depth == 0 {
            return Some(&inner[at + 1..]);
        }
    }
    None
}

fn found(text: &str) -> Vec<String> {
    check(&[source::example("src/scope.rs", text)]).iter().map(ToString::to_string).collect()
}

#[test]
fn the_unit_ends_the_first_paragraph_or_the_comment() {
    for doc in [
        "Speed (m/s).",
        "Speed (m/s)",
        "Ratio (1).",
        "Stiffness (N/m^1.5).\n\nAs Hertz has it.",
        "Stiffness.\n\nAs Hertz has it (N/m^1.5).",
        "Time base\n(s/div; Hz/div for an FFT).",
        "Level (V, or dB for an FFT).",
        "The values (unit).",
        "Power per frequency (V^2/Hz).",
    ] {
        assert_eq!(unit_of(doc), Unit::Named, "{doc}");
    }
    for doc in ["Speed.", "Speed (m/s) of the bead.", "Speed [m/s].", "Speed m/s)."] {
        assert_eq!(unit_of(doc), Unit::Missing, "{doc}");
    }
    for (doc, unit) in
        [("Speed (of the bead).", "of the bead"), ("Speed ().", ""), ("Speed (f(x)).", "f(x)")]
    {
        assert_eq!(unit_of(doc), Unit::Unknown(unit.to_owned()), "{doc}");
    }
}

#[test]
fn every_public_f64_is_seen() {
    for code in [
        "pub struct A { pub a: f64 }",
        "struct A { pub a: f64 }",
        "pub struct A { pub a: Option<f64> }",
        "pub struct A { pub a: std::vec::Vec<[f64; 3]> }",
        "pub struct A<'a> { pub a: &'a [f64] }",
        "#[derive(Deserialize)] pub struct A { pub a: f64 }",
        "#[derive(prost::Message)] pub struct A { #[prost(double, tag = \"1\")] pub a: f64 }",
        "pub struct A(pub f64);",
        "pub enum A { B { c: f64 } }",
        "pub enum A { B(f64) }",
        "pub const A: f64 = 1.0;",
        "pub static A: [f64; 2] = [1.0, 2.0];",
        "pub fn a() -> f64 { 0.0 }",
        "pub fn a() -> Vec<f64> { vec![] }",
        "impl A { pub fn a(&self) -> &[f64] { &self.a } }",
        "impl A { pub const B: f64 = 1.0; }",
        "pub trait A { fn a(&self) -> Option<f64>; }",
        "mod inner { pub fn a() -> f64 { 0.0 } }",
    ] {
        let found = found(&format!("\n{code}"));
        assert!(found.len() == 1 && found[0].starts_with("src/scope.rs:2: "), "{code}: {found:?}");
        assert!(found[0].ends_with("without doc comment"), "{code}: {found:?}");
    }
    assert_eq!(
        found(
            "pub struct A {\n  /// Speed.\n  pub speed: f64,\n  /// Mass (heavy).\n  pub mass: f64 }"
        ),
        [
            "src/scope.rs:3: `speed`: the doc comment of a public f64 ends with its unit, as in `(m/s)`",
            "src/scope.rs:5: `mass`: `(heavy)` is no unit"
        ]
    );
}

#[test]
fn what_is_not_public_or_not_a_number_is_exempt() {
    for code in [
        "pub struct A { a: f64, pub(crate) b: f64, pub(super) c: Vec<f64>, pub d: f32, pub e: Vec<u8> }",
        "pub(crate) fn a() -> f64 { 0.0 } fn b() -> f64 { 0.0 } pub fn c(x: f64) {}",
        "pub fn a() -> Result<f64, E> { Ok(0.0) }",
        "enum A { B(f64) } trait C { fn d() -> f64; } const E: f64 = 1.0;",
        "impl C for A { fn d() -> f64 { 0.0 } }",
        "#[cfg(test)] pub fn a() -> f64 { 0.0 }",
        "/// Mass (kg).\npub struct A(pub f64);",
        "pub enum A { /// Level (V).\n B(f64) }",
    ] {
        assert_eq!(found(code), [""; 0], "{code}");
    }
}
