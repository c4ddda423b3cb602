//! A page of results: headings, paragraphs, tables, notes and pictures, as text for a terminal, as
//! Markdown, or as a page of HTML that needs no other file; as PDF in `report/a4.rs`.

use std::fmt::Write as _;

use super::escape;
use super::plot::{Sheet, Theme, svg, with_minus_signs};
use super::table;
use crate::quantity::printable_line;

/// Frames narrower than this are side by side in HTML and PDF (pixels).
const NARROW: f64 = 400.0;

/// A part of a page.
#[derive(Debug, Clone, PartialEq)]
pub enum Part {
    /// A heading of a level from 1.
    Heading(u8, String),
    /// A paragraph.
    Paragraph(String),
    /// A line to sign on, below room for a signature.
    Signature,
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

/// The line of [`Part::Signature`].
pub(super) const SIGNATURE: &str = "Signature: ______________________________";

/// Whether two pictures are side by side where a page is wide.
pub(super) fn is_narrow(sheet: &Sheet) -> bool {
    sheet.columns == 1 && sheet.size.0 < NARROW
}

/// All pictures of a page as one. Panels over the same quantity have the same abscissa.
pub fn picture(title: &str, parts: &[Part]) -> Sheet {
    let panels = parts.iter().filter_map(|part| match part {
        Part::Picture(_, _, sheet) => Some(&sheet.panels),
        _ => None,
    });
    let mut sheet = Sheet::stack(title, panels.flatten().cloned().collect());
    sheet.share_abscissa();
    sheet
}

/// `parts` as lines of text, without pictures.
pub fn text(parts: &[Part]) -> String {
    let mut lines = Vec::new();
    for part in parts {
        match part {
            Part::Heading(1, heading) => lines.push(heading.clone()),
            Part::Heading(_, heading) => lines.extend([String::new(), heading.clone()]),
            Part::Paragraph(paragraph) => lines.push(format!("  {paragraph}")),
            Part::Signature => lines.push(format!("  {SIGNATURE}")),
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
            Part::Signature => {
                let _ = writeln!(text, "{SIGNATURE}");
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
    let escape = |text: &str| escape(&with_minus_signs(text));
    let mut body = String::new();
    for part in parts {
        let _ = match part {
            Part::Heading(level, heading) => {
                writeln!(body, "<h{level}>{}</h{level}>", escape(heading))
            }
            Part::Paragraph(paragraph) => writeln!(body, "<p>{}</p>", escape(paragraph)),
            Part::Signature => writeln!(body, "<p class=\"s\">{SIGNATURE}</p>"),
            Part::Fact(label, fact) => writeln!(body, "<p>{label}: {}</p>", escape(fact)),
            Part::List(_, items) => {
                let items = items
                    .iter()
                    .map(|item| format!("<li>{}</li>\n", escape(item)))
                    .collect::<Vec<_>>()
                    .concat();
                writeln!(body, "<ul>\n{items}</ul>")
            }
            Part::Table(rows, left) => {
                let line = |tag: &str, row: &Vec<String>| {
                    let cell = |(column, text): (usize, &String)| {
                        let class = if left.contains(&column) { " class=\"l\"" } else { "" };
                        format!("<{tag}{class}>{}</{tag}>", escape(text))
                    };
                    format!("<tr>{}</tr>\n", row.iter().enumerate().map(cell).collect::<String>())
                };
                let head = rows.first().filter(|row| row.iter().any(|cell| !cell.is_empty()));
                let head = head
                    .map_or(String::new(), |row| format!("<thead>{}</thead>\n", line("th", row)));
                let lines: String = rows.iter().skip(1).map(|row| line("td", row)).collect();
                writeln!(body, "<table>\n{head}<tbody>{lines}</tbody>\n</table>")
            }
            Part::Picture(_, shown, sheet) => {
                let (svg, shown) = (svg(sheet, Theme::Light), escape(shown));
                // Narrow ones are side by side.
                let class = if is_narrow(sheet) { " class=\"n\"" } else { "" };
                writeln!(body, "<figure{class}>\n{svg}<figcaption>{shown}</figcaption>\n</figure>")
            }
        };
    }
    // Text between the quotes of CSS in HTML: no quote, no backslash, no line end, no tag.
    let foot = printable_line(title).replace(['"', '\\', '<'], "'");
    let title = escape(title);
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<title>{title}</title>\n<style>\n\
         body {{ font-family: sans-serif; max-width: 60em; margin: 2em auto; padding: 0 1em; }}\n\
         table {{ border-collapse: collapse; }} th, td {{ border: 1px solid #c0c0c0; padding: 0.2em 0.6em; text-align: right; }}\n\
         .s {{ margin-top: 15mm; }}\n\
         .l {{ text-align: left; }} td.l:first-child {{ white-space: nowrap; width: 1%; }}\n\
         .n {{ display: inline-block; width: 49%; margin: 0; vertical-align: top; }} figure {{ margin: 0.5em 0; }} figcaption {{ font-size: 85%; }} td {{ overflow-wrap: anywhere; }} td:not(.l) {{ white-space: nowrap; }}\n\
         @page {{ size: A4; margin: 18mm 16mm 20mm;\n\
         @bottom-left {{ content: \"{foot}\"; font: 8pt sans-serif; }}\n\
         @bottom-right {{ content: \"page \" counter(page) \" of \" counter(pages); font: 8pt sans-serif; }} }}\n\
         @media print {{ body {{ font-size: 9pt; max-width: none; margin: 0; padding: 0; }} table {{ font-size: 8pt; width: 100%; }}\n\
         h1 {{ font-size: 16pt; }} h2 {{ font-size: 11pt; break-after: avoid; }} thead {{ display: table-header-group; }}\n\
         tr, figure {{ break-inside: avoid; }} figcaption {{ font-size: 7pt; }} }}\n\
         </style>\n</head>\n<body>\n{body}</body>\n</html>\n"
    )
}
