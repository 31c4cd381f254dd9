//! Walks TOML by hand, so that every error knows its file, key, line and column.

use super::quantity::{self, Kind};
use super::unit::quoted;
use crate::Error;
use crate::error::Place;
use nalgebra::Vector3;
use std::ops::Range;
use toml::de::{DeTable, DeValue};

/// A text that the user wrote.
#[derive(Debug)]
pub(super) struct Source<'t> {
    pub file: String,
    pub text: &'t str,
}

/// A value, and where it was written.
#[derive(Clone, Debug)]
pub(super) struct Node<'s> {
    source: &'s Source<'s>,
    span: Range<usize>,
    /// Dotted path, such as `section.proximal.length`.
    pub key: String,
    pub value: Value<'s>,
}

#[derive(Clone, Debug)]
pub(super) enum Value<'s> {
    Text(String),
    Number(f64),
    /// Booleans and dates, which no key takes.
    Other(&'static str),
    List(Vec<Node<'s>>),
    Table(Vec<Entry<'s>>),
}

#[derive(Clone, Debug)]
pub(super) struct Entry<'s> {
    pub name: String,
    span: Range<usize>,
    pub node: Node<'s>,
}

impl<'t> Source<'t> {
    pub(super) fn new(file: &str, text: &'t str) -> Self {
        Source { file: file.to_string(), text }
    }

    /// The table of the whole file.
    pub(super) fn parse(&'t self) -> Result<Node<'t>, Error> {
        let table = DeTable::parse(self.text).map_err(|error| {
            let place = self.place(error.span().unwrap_or(0..0), "");
            let bare_unit = place.text.contains('=') && !place.text.contains(['"', '\'']);
            let error = Error::new(format!("not TOML: {}", error.message().replace('\n', ", ")));
            let hint = "texts and values with a unit stand in quotes: \"390 mm\"";
            if bare_unit { error.at(place).hint(hint) } else { error.at(place) }
        })?;
        if table.get_ref().is_empty() {
            return Err(Error::new("the file is empty")
                .at(self.place(0..0, ""))
                .hint("`hydrostat new rod NAME`, `hydrostat new tendon NAME` and `hydrostat new bench NAME` write first files"));
        }
        Ok(self.table(table.into_inner(), 0..0, String::new()))
    }

    fn table(&'t self, table: DeTable<'_>, span: Range<usize>, key: String) -> Node<'t> {
        let child = |name: &str| {
            if key.is_empty() { name.to_string() } else { format!("{key}.{name}") }
        };
        let mut entries: Vec<Entry<'t>> = table
            .into_iter()
            .map(|(name, value)| Entry {
                name: name.get_ref().to_string(),
                span: name.span(),
                node: self.node(value.span(), child(name.get_ref()), value.into_inner()),
            })
            .collect();
        entries.sort_by_key(|entry| entry.span.start); // as written
        Node { source: self, span, key, value: Value::Table(entries) }
    }

    fn node(&'t self, span: Range<usize>, key: String, value: DeValue<'_>) -> Node<'t> {
        let value = match value {
            DeValue::Table(table) => return self.table(table, span, key),
            DeValue::String(text) => Value::Text(text.into_owned()),
            DeValue::Float(number) => Value::Number(number.as_str().parse().unwrap_or(f64::NAN)),
            DeValue::Integer(number) => {
                let integer = i64::from_str_radix(number.as_str(), number.radix());
                Value::Number(integer.map_or(f64::NAN, |integer| integer as f64))
            }
            DeValue::Boolean(_) => Value::Other("true or false"),
            DeValue::Datetime(_) => Value::Other("a date"),
            DeValue::Array(items) => {
                let item = |(i, item): (usize, toml::Spanned<DeValue<'_>>)| {
                    let name = element_name(item.get_ref()).unwrap_or_else(|| (i + 1).to_string());
                    self.node(item.span(), format!("{key}.{name}"), item.into_inner())
                };
                Value::List(items.into_iter().enumerate().map(item).collect())
            }
        };
        Node { source: self, span, key, value }
    }

    /// Turns bytes from..to of the text into a place to show.
    pub(super) fn place(&self, span: Range<usize>, key: &str) -> Place {
        let text = self.text;
        let floor = |mut at: usize| {
            at = at.min(text.len());
            while !text.is_char_boundary(at) {
                at -= 1;
            }
            at
        };
        let (start, end) = (floor(span.start), floor(span.end));
        let line_start = text[..start].rfind('\n').map_or(0, |at| at + 1);
        let line_end = text[start..].find('\n').map_or(text.len(), |at| start + at);
        Place {
            file: self.file.clone(),
            line: text[..start].matches('\n').count() + 1,
            column: text[line_start..start].chars().count() + 1,
            width: text[start..end.clamp(start, line_end)].trim_end().chars().count().max(1),
            text: text[line_start..line_end].trim_end().to_string(),
            key: key.to_string(),
        }
    }
}

/// The name by which an element of `[[section]]` is addressed.
fn element_name(value: &DeValue<'_>) -> Option<String> {
    match value.as_table()?.get("name")?.get_ref() {
        DeValue::String(name) if is_name(name) => Some(name.to_string()),
        _ => None,
    }
}

/// Names that can stand in a dotted path, a column header and a flag.
pub(super) fn is_name(text: &str) -> bool {
    !text.is_empty() && text.chars().all(|c| c.is_alphanumeric() || c == '_' || c == '-')
}

impl<'s> Node<'s> {
    pub(super) fn place(&self) -> Place {
        self.source.place(self.span.clone(), &self.key)
    }

    pub(super) fn error(&self, message: impl Into<String>) -> Error {
        Error::new(message).at(self.place())
    }

    /// `found ..., expected ...`
    pub(super) fn refuse(&self, expected: &str) -> Error {
        let found = match &self.value {
            Value::Text(text) => quoted(text),
            Value::Number(_) => self.source.text[self.span.clone()].to_string(),
            Value::Other(found) => (*found).to_string(),
            Value::List(_) => "a list".to_string(),
            Value::Table(_) => "a table".to_string(),
        };
        self.error(format!("found {found}, expected {expected}"))
    }

    /// The table with only these keys in it.
    pub(super) fn table(&self, keys: &'static [&'static str]) -> Result<Table<'_, 's>, Error> {
        let entries = self.entries("a table")?;
        for entry in entries {
            if !keys.contains(&entry.name.as_str()) {
                let error = Error::new(format!("unknown key {}", quoted(&entry.name)));
                let place = entry.node.source.place(entry.span.clone(), &entry.node.key);
                return Err(error.at(place).hint(match nearest(&entry.name, keys) {
                    Some(key) => format!("did you mean \"{key}\"?"),
                    None => format!("known keys here: {}", keys.join(", ")),
                }));
            }
        }
        Ok(Table { node: self, entries })
    }

    /// The entries of a table whose keys the user chooses.
    pub(super) fn entries(&self, expected: &str) -> Result<&[Entry<'s>], Error> {
        match &self.value {
            Value::Table(entries) => Ok(entries),
            _ => Err(self.refuse(expected)),
        }
    }

    /// The tables of `[[name]]`.
    pub(super) fn tables(&self, name: &str) -> Result<&[Node<'s>], Error> {
        match &self.value {
            Value::List(items) => Ok(items),
            _ => Err(self.refuse(&format!("[[{name}]] in double brackets, since there can be several"))),
        }
    }

    pub(super) fn text(&self, expected: &str) -> Result<&str, Error> {
        match &self.value {
            Value::Text(text) if !text.trim().is_empty() => Ok(text),
            Value::Text(_) => Err(self.error(format!("found an empty text, expected {expected}"))),
            _ => Err(self.refuse(expected)),
        }
    }

    /// A pure number, such as Poisson's ratio.
    pub(super) fn number(&self, expected: &str) -> Result<f64, Error> {
        match &self.value {
            Value::Number(number) if number.is_finite() => Ok(*number),
            Value::Text(text) if text.trim().parse::<f64>().is_ok() => {
                Err(self.refuse(expected).hint("a number without a unit is written without quotes"))
            }
            _ => Err(self.refuse(expected)),
        }
    }

    /// A direction: three pure numbers, not all zero; returned with length 1.
    pub(super) fn direction(&self) -> Result<Vector3<f64>, Error> {
        let expected = "three numbers, such as [0, 0, 1]";
        let Value::List(items) = &self.value else {
            return Err(self.refuse(expected));
        };
        let numbers: Vec<f64> = items.iter().map(|item| item.number("a number")).collect::<Result<_, _>>()?;
        let &[x, y, z] = &numbers[..] else {
            return Err(self.error(format!("found a list of {}, expected {expected}", numbers.len())));
        };
        let vector = Vector3::new(x, y, z);
        let largest = vector.amax();
        if largest == 0.0 {
            return Err(self.error("found a direction of length zero"));
        }
        Ok((vector / largest).normalize()) // scaled first: the squares may overflow
    }

    pub(super) fn quantity(&self, kind: &Kind) -> Result<f64, Error> {
        let text = self.quantity_text(&kind.expected())?;
        quantity::scalar(text, kind).map_err(|error| error.at(self.place()))
    }

    /// A quantity that passes a test; `range` says which, as in "above 0 m".
    pub(super) fn quantity_where(
        &self,
        kind: &Kind,
        range: &str,
        test: impl Fn(f64) -> bool,
    ) -> Result<f64, Error> {
        let value = self.quantity(kind)?;
        if test(value) { Ok(value) } else { Err(self.refuse(&format!("{} {range}", kind.name))) }
    }

    pub(super) fn positive(&self, kind: &Kind) -> Result<f64, Error> {
        self.quantity_where(kind, &format!("above 0 {}", kind.unit), |value| value > 0.0)
    }

    pub(super) fn not_negative(&self, kind: &Kind) -> Result<f64, Error> {
        self.quantity_where(kind, &format!("of at least 0 {}", kind.unit), |value| value >= 0.0)
    }

    pub(super) fn vector(&self, kind: &Kind) -> Result<Vector3<f64>, Error> {
        let text = self.quantity_text(&kind.expected_vector())?;
        quantity::vector(text, kind).map_err(|error| error.at(self.place()))
    }

    pub(super) fn list(&self, kind: &Kind) -> Result<Vec<f64>, Error> {
        let text = self.quantity_text(&kind.expected_list())?;
        quantity::list(text, kind).map_err(|error| error.at(self.place()))
    }

    fn quantity_text(&self, expected: &str) -> Result<&str, Error> {
        match &self.value {
            Value::Text(text) => Ok(text),
            Value::List(_) => Err(self.error(format!("found a list without a unit, expected {expected}"))),
            Value::Number(_) => {
                Err(self.error(format!("found a number without a unit, expected {expected}")))
            }
            _ => Err(self.refuse(expected)),
        }
    }

    /// Puts a value, written elsewhere, below this table at the dotted path that is its key there.
    pub(super) fn set(&mut self, new: &Entry<'s>) -> Result<(), Error> {
        let path = new.name.as_str();
        let missing = |part: &str| {
            new.node.error(format!("the robot has no {} to set {} in", quoted(part), quoted(path)))
        };
        let (parents, last) =
            path.rsplit_once('.').map_or((None, path), |(parents, last)| (Some(parents), last));
        let mut node = self;
        for part in parents.iter().flat_map(|parents| parents.split('.')) {
            node = node.child_mut(part).ok_or_else(|| missing(part))?;
        }
        let Value::Table(entries) = &mut node.value else {
            return Err(missing(last));
        };
        entries.retain(|entry| entry.name != last);
        entries.push(Entry { name: last.to_string(), ..new.clone() });
        Ok(())
    }

    /// An entry of a table, or an element of a list by its name or its number from 1.
    fn child_mut(&mut self, part: &str) -> Option<&mut Node<'s>> {
        match &mut self.value {
            Value::Table(entries) => {
                entries.iter_mut().find(|entry| entry.name == part).map(|entry| &mut entry.node)
            }
            Value::List(items) => {
                let named = items.iter().position(|item| item.key.rsplit('.').next() == Some(part));
                let index = named.or_else(|| part.parse::<usize>().ok()?.checked_sub(1))?;
                items.get_mut(index)
            }
            _ => None,
        }
    }
}

/// A table whose keys are known.
#[derive(Clone, Copy, Debug)]
pub(super) struct Table<'n, 's> {
    pub node: &'n Node<'s>,
    entries: &'n [Entry<'s>],
}

impl<'n, 's> Table<'n, 's> {
    pub(super) fn get(&self, key: &str) -> Option<&'n Node<'s>> {
        self.entries.iter().find(|entry| entry.name == key).map(|entry| &entry.node)
    }

    /// The value of a key that must be there; `expected` as in `a length, such as "390 mm"`.
    pub(super) fn require(&self, key: &str, expected: &str) -> Result<&'n Node<'s>, Error> {
        self.get(key).ok_or_else(|| self.node.error(format!("missing key \"{key}\", expected {expected}")))
    }

    pub(super) fn quantity(&self, key: &str, kind: &Kind) -> Result<&'n Node<'s>, Error> {
        self.require(key, &kind.expected())
    }

    /// Refuses two keys that say the same thing.
    pub(super) fn either(&self, one: &str, other: &str) -> Result<(), Error> {
        match (self.get(one), self.get(other)) {
            (Some(_), Some(second)) => Err(second
                .error(format!("\"{one}\" and \"{other}\" are two ways to give the same thing"))
                .hint("keep one of them")),
            _ => Ok(()),
        }
    }
}

/// The known name that a misspelt one most likely means.
pub(super) fn nearest<'k>(name: &str, known: &[&'k str]) -> Option<&'k str> {
    let distance = |other: &str| strsim::damerau_levenshtein(name, other);
    let close = known.iter().copied().min_by_key(|other| distance(other))?;
    (name.len() <= 64 && distance(close) <= (close.len() / 3).max(1)).then_some(close)
}
