//! Tables of measurements: CSV with the unit in each header, as in `mass [g]`.

use super::quantity::Kind;
use super::reader::{Node, Source, nearest};
use super::unit::{Unit, quoted};
use crate::Error;
use std::ops::Range;

/// The cells of a CSV file, as written.
#[derive(Debug)]
pub(super) struct Data<'s> {
    source: &'s Source<'s>,
    headers: Vec<Cell>,
    rows: Vec<Vec<Cell>>,
}

#[derive(Debug)]
pub(super) struct Cell {
    pub text: String,
    pub span: Range<usize>,
}

/// One column of numbers.
#[derive(Clone, Debug)]
pub(super) struct Column {
    /// Header without its unit.
    pub name: String,
    pub unit_text: String,
    pub unit: Unit,
    /// SI, one per row.
    pub values: Vec<f64>,
    /// Half a unit of the last printed digit, SI.
    pub rounding: f64,
}

impl<'s> Data<'s> {
    pub(super) fn parse(source: &'s Source<'s>) -> Result<Self, Error> {
        let mut lines = lines(source.text);
        let headers = headers(source, &mut lines)?;
        let mut rows = Vec::new();
        for line in lines {
            let row = cells(source, line)?;
            if row.len() != headers.len() {
                let (found, expected) = (row.len(), headers.len());
                let span = row[0].span.start..row[row.len() - 1].span.end;
                let error = Error::new(format!("found {found} cells, but the header has {expected}"));
                return Err(error
                    .at(source.place(span, ""))
                    .hint("cells are separated by commas; decimals are written with a point"));
            }
            rows.push(row);
        }
        if rows.is_empty() {
            return Err(no_rows(source));
        }
        Ok(Data { source, headers, rows })
    }

    pub(super) fn rows(&self) -> usize {
        self.rows.len()
    }

    /// The column that a key of the experiment file names, by its name or its whole header; `unit` is for a header without one.
    pub(super) fn column(&self, key: &Node, kind: &Kind, unit: Option<&Node>) -> Result<Column, Error> {
        let index = self.find(key)?;
        let header = &self.headers[index];
        let (name, own) = split_header(&header.text);
        let (unit_text, unit) = match (unit, own) {
            (None, _) => (own, unit_of(&header.text, kind).map_err(|error| error.at(self.place(header)))?),
            (Some(node), None) => {
                let text = node.text("a unit, such as \"mm\"")?;
                let unit = Unit::parse(text).and_then(|unit| kind.check(&unit, text).map(|()| unit));
                (Some(text), unit.map_err(|error| error.at(node.place()))?)
            }
            (Some(node), Some(own)) => {
                return Err(node.error(format!("column \"{name}\" has its unit in the header, {own}")));
            }
        };
        let values = self.rows.iter().map(|row| self.number(&row[index], name, &unit));
        let values = values.collect::<Result<Vec<f64>, Error>>()?;
        let decimals = self.rows.iter().map(|row| decimals(&row[index].text)).max().unwrap_or(0);
        Ok(Column {
            name: name.to_string(),
            unit_text: unit_text.unwrap_or_default().to_string(),
            unit,
            values,
            rounding: unit.to_si(&format!("5e{}", -decimals - 1)),
        })
    }

    fn find(&self, key: &Node) -> Result<usize, Error> {
        let wanted = key.text("the name of a column")?.trim();
        let headers: Vec<&str> = self.headers.iter().map(|cell| cell.text.as_str()).collect();
        let all = |test: &dyn Fn(&str) -> bool| -> Vec<usize> {
            (0..headers.len()).filter(|i| test(headers[*i])).collect()
        };
        let mut named = all(&|header| header == wanted);
        if named.is_empty() {
            named = all(&|header| split_header(header).0 == wanted);
        }
        match named[..] {
            [index] => Ok(index),
            [] => {
                let names: Vec<&str> = headers.iter().map(|header| split_header(header).0).collect();
                let message = format!("{} has no column {}", self.source.file, quoted(wanted));
                Err(key.error(message).hint(match nearest(wanted, &names) {
                    Some(name) => format!("did you mean \"{name}\"?"),
                    None => format!("its columns: {}", headers.join(", ")),
                }))
            }
            _ => {
                let named: Vec<&str> = named.iter().map(|i| headers[*i]).collect();
                Err(key
                    .error(format!("{} has several columns {}", self.source.file, quoted(wanted)))
                    .hint(format!("give the whole header, which must be unique: {}", named.join(" or "))))
            }
        }
    }

    /// Where a value of a column stands, for an error found later.
    pub(super) fn error_in(&self, key: &Node, row: usize, message: &str) -> Error {
        match self.find(key) {
            Ok(index) => self.error(&self.rows[row][index], message),
            Err(error) => error,
        }
    }

    fn number(&self, cell: &Cell, column: &str, unit: &Unit) -> Result<f64, Error> {
        let found = || {
            if cell.text.is_empty() { "an empty cell".to_string() } else { quoted(&cell.text) }
        };
        match cell.text.parse::<f64>() {
            Ok(value) if value.is_finite() && unit.to_si(&cell.text).is_finite() => {
                Ok(unit.to_si(&cell.text))
            }
            _ => {
                Err(self.error(cell, &format!("found {} in column \"{column}\", expected a number", found())))
            }
        }
    }

    fn place(&self, cell: &Cell) -> crate::error::Place {
        self.source.place(cell.span.clone(), "")
    }

    fn error(&self, cell: &Cell, message: &str) -> Error {
        Error::new(message).at(self.place(cell))
    }
}

/// The cells of the first line with data.
pub(super) fn headers(
    source: &Source,
    mut lines: impl Iterator<Item = Range<usize>>,
) -> Result<Vec<Cell>, Error> {
    let headers = cells(source, lines.next().ok_or_else(|| no_rows(source))?)?;
    if let [only] = &headers[..]
        && let Some(separator) = only.text.chars().find(|c| [';', '\t'].contains(c))
    {
        let error = Error::new(format!("cells are separated by {separator:?}, expected ','"));
        return Err(error.at(source.place(only.span.clone(), "")).hint("decimals are written with a point"));
    }
    Ok(headers)
}

pub(super) fn no_rows(source: &Source) -> Error {
    Error::new("the file has no rows of data").at(source.place(0..0, ""))
}

/// The unit of a header, which must be of a kind.
pub(super) fn unit_of(header: &str, kind: &Kind) -> Result<Unit, Error> {
    let (name, unit_text) = split_header(header);
    let unit_text = unit_text.ok_or_else(|| {
        Error::new(format!("the column \"{name}\" has no unit, expected {}", kind.expected()))
            .hint(format!("write the unit in brackets, as in \"{name} [{}]\"", kind.unit))
    })?;
    let unit = Unit::parse(unit_text)?;
    kind.check(&unit, unit_text)?;
    Ok(unit)
}

/// The lines with data: not blank, no `#` comment.
pub(super) fn lines(text: &str) -> impl Iterator<Item = Range<usize>> {
    let text_start = if text.starts_with('\u{feff}') { 3 } else { 0 }; // byte order mark of spreadsheets
    let mut end = text_start;
    text[text_start..].split_inclusive('\n').filter_map(move |line| {
        let start = end;
        end += line.len();
        let content = line.trim();
        (!content.is_empty() && !content.starts_with('#')).then(|| start..start + line.trim_end().len())
    })
}

/// The cells of one line; the csv crate reads quotes, and a quoted cell ends with its line.
pub(super) fn cells(source: &Source, line: Range<usize>) -> Result<Vec<Cell>, Error> {
    let text = &source.text[line.clone()];
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .terminator(csv::Terminator::Any(b'\n'))
        .from_reader(text.as_bytes());
    let record = match reader.records().next() {
        Some(Ok(record)) => record,
        _ => return Err(Error::new("this line is not CSV").at(source.place(line, ""))),
    };
    let mut from = line.start;
    let cell = |field: &str| {
        let field = field.trim();
        // A cell with doubled quotes is not found as written: then only its start is underlined.
        let found = source.text[from..line.end].find(field).map(|at| from + at);
        let span = found.map_or(from..from, |start| start..start + field.len());
        from = source.text[span.end..line.end].find(',').map_or(span.end, |at| span.end + at + 1);
        Cell { text: field.to_string(), span }
    };
    Ok(record.iter().map(cell).collect())
}

/// `mass [g]` -> (`mass`, `g`).
pub(super) fn split_header(header: &str) -> (&str, Option<&str>) {
    match header.strip_suffix(']').and_then(|header| header.rsplit_once('[')) {
        Some((name, unit)) => (name.trim(), Some(unit.trim())),
        None => (header, None),
    }
}

/// Digits after the point; an exponent shifts them.
fn decimals(number: &str) -> i32 {
    let (mantissa, exponent) = number.split_once(['e', 'E']).unwrap_or((number, "0"));
    let digits = mantissa.split_once('.').map_or(0, |(_, decimals)| decimals.len()) as i32;
    digits.saturating_sub(exponent.parse().unwrap_or(0)).clamp(-300, 300)
}
