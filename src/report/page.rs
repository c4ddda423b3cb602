//! A page of results: headings, paragraphs, tables, notes and pictures, as text for a terminal, as
//! Markdown, or as a page of HTML that needs no other file.

use std::fmt::Write as _;

use super::escape;
use super::plot::{Sheet, Theme, svg};
use super::table;
use crate::quantity::printable_line;

/// A part of a page.
#[derive(Debug, Clone, PartialEq)]
pub enum Part {
    /// A heading of a level from 1.
    Heading(u8, String),
    /// A paragraph.
    Paragraph(String),
    /// A named statement: `verdict`, `pass`.
    Fact(&'static str, String),
    /// Items of a list, each called by the label.
    List(&'static str, Vec<String>),
    /// A table whose first row is its heading, and its columns that are flush left.
    Table(Vec<Vec<String>>, &'static [usize]),
    /// A picture: file name, what it shows, its content.
    Picture(String, String, Sheet),
}

impl Part {
    /// A section with a table, if the table has rows below its heading.
    pub fn section(
        title: &str,
        rows: Vec<Vec<String>>,
        left: &'static [usize],
    ) -> impl Iterator<Item = Self> {
        let parts = [Self::Heading(2, title.to_owned()), Self::Table(rows, left)];
        let has_rows = matches!(&parts[1], Self::Table(rows, _) if rows.len() > 1);
        parts.into_iter().filter(move |_| has_rows)
    }
}

/// All pictures of a page as one.
pub fn picture(title: &str, parts: &[Part]) -> Sheet {
    let panels = parts.iter().filter_map(|part| match part {
        Part::Picture(_, _, sheet) => Some(&sheet.panels),
        _ => None,
    });
    Sheet::stack(title, panels.flatten().cloned().collect())
}

/// `parts` as lines of text, without pictures.
pub fn text(parts: &[Part]) -> String {
    let mut lines = Vec::new();
    for part in parts {
        match part {
            Part::Heading(1, heading) => lines.push(heading.clone()),
            Part::Heading(_, heading) => lines.extend([String::new(), heading.clone()]),
            Part::Paragraph(paragraph) => lines.push(format!("  {paragraph}")),
            Part::Fact(label, fact) => lines.extend([String::new(), format!("{label}  {fact}")]),
            Part::List(label, items) => {
                lines.extend(items.iter().map(|item| format!("  {label}  {item}")));
            }
            Part::Table(rows, left) => lines.extend(table::lines(rows, left)),
            Part::Picture(..) => {}
        }
    }
    lines.join("\n")
}

/// `parts` as Markdown; pictures are files beside it.
pub fn markdown(parts: &[Part]) -> String {
    let cell = |text: &String| plain(text).replace('|', "\\|");
    let row =
        |row: &[String]| format!("| {} |\n", row.iter().map(cell).collect::<Vec<_>>().join(" | "));
    let mut text = String::new();
    for part in parts {
        match part {
            Part::Heading(level, heading) => {
                let _ = writeln!(text, "{} {}", "#".repeat(usize::from(*level)), plain(heading));
            }
            Part::Paragraph(paragraph) => {
                let _ = writeln!(text, "{}", plain(paragraph));
            }
            Part::Fact(label, fact) => {
                let _ = writeln!(text, "{label}: {}", plain(fact));
            }
            Part::List(_, items) => items.iter().for_each(|item| {
                let _ = writeln!(text, "- {}", plain(item));
            }),
            Part::Table(rows, _) => {
                let Some((heading, rest)) = rows.split_first() else { continue };
                text.push_str(&row(heading));
                text.push_str(&row(&vec!["---".to_owned(); heading.len()]));
                text.push_str(&rest.iter().map(|cells| row(cells)).collect::<Vec<_>>().concat());
            }
            Part::Picture(file, shown, _) => {
                let _ = writeln!(text, "![{}]({})", plain(shown), link(file));
            }
        }
        text.push('\n');
    }
    text.truncate(text.trim_end().len());
    text.push('\n');
    text
}

/// Text as Markdown takes it: no tags, links or line ends of its own.
fn plain(text: &str) -> String {
    let text = printable_line(text);
    text.replace('&', "&amp;").replace('<', "&lt;").replace('[', "\\[").replace(']', "\\]")
}

/// The name of a file in a link, in angle brackets if it has blanks or brackets.
fn link(file: &str) -> String {
    let is_simple = |c: char| c.is_alphanumeric() || "-_./".contains(c);
    if file.chars().all(is_simple) {
        file.to_owned()
    } else {
        format!("<{}>", printable_line(file).replace('<', "%3C").replace('>', "%3E"))
    }
}

/// `parts` as a page of HTML, pictures included.
pub fn html(title: &str, parts: &[Part]) -> String {
    let mut body = String::new();
    for part in parts {
        let _ = match part {
            Part::Heading(level, heading) => {
                writeln!(body, "<h{level}>{}</h{level}>", escape(heading))
            }
            Part::Paragraph(paragraph) => writeln!(body, "<p>{}</p>", escape(paragraph)),
            Part::Fact(label, fact) => writeln!(body, "<p>{label}: {}</p>", escape(fact)),
            Part::List(_, items) => {
                let items = items
                    .iter()
                    .map(|item| format!("<li>{}</li>\n", escape(item)))
                    .collect::<Vec<_>>()
                    .concat();
                writeln!(body, "<ul>\n{items}</ul>")
            }
            Part::Table(rows, _) => {
                let line = |(index, row): (usize, &Vec<String>)| {
                    let tag = if index == 0 { "th" } else { "td" };
                    let cells = row
                        .iter()
                        .map(|c| format!("<{tag}>{}</{tag}>", escape(c)))
                        .collect::<Vec<_>>()
                        .concat();
                    format!("<tr>{cells}</tr>\n")
                };
                let lines: String = rows.iter().enumerate().map(line).collect();
                writeln!(body, "<table>\n{lines}</table>")
            }
            Part::Picture(_, shown, sheet) => {
                let (svg, shown) = (svg(sheet, Theme::Light), escape(shown));
                writeln!(body, "<figure>\n{svg}<figcaption>{shown}</figcaption>\n</figure>")
            }
        };
    }
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<title>{}</title>\n<style>\n\
         body {{ font-family: sans-serif; max-width: 60em; margin: 2em auto; padding: 0 1em; }}\n\
         table {{ border-collapse: collapse; }} th, td {{ border: 1px solid #c0c0c0; padding: 0.2em 0.6em; text-align: left; }}\n\
         figure {{ margin: 1em 0; }} td {{ overflow-wrap: anywhere; }}\n\
         </style>\n</head>\n<body>\n{body}</body>\n</html>\n",
        escape(title)
    )
}
