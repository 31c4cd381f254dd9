//! The one error type of the crate.

use std::fmt;

/// What went wrong, where, and what to try.
#[derive(Clone, Debug, PartialEq)]
pub struct Error {
    message: String,
    place: Option<Box<Place>>,
    hint: Option<String>,
}

/// A place in a text that the user wrote.
#[derive(Clone, Debug, PartialEq)]
pub struct Place {
    /// Name of the file, as the user gave it.
    pub file: String,
    /// From 1.
    pub line: usize,
    /// From 1, in characters.
    pub column: usize,
    /// Characters to underline.
    pub width: usize,
    /// The line itself.
    pub text: String,
    /// Dotted path of the key, such as `material.niti54.density`; empty where there is none.
    pub key: String,
}

impl Error {
    /// An error with a message of one sentence: what was found, what was expected.
    pub fn new(message: impl Into<String>) -> Self {
        Error { message: message.into(), place: None, hint: None }
    }

    /// Says where.
    #[must_use]
    pub fn at(mut self, place: Place) -> Self {
        self.place = Some(Box::new(place));
        self
    }

    /// Says where, unless a place is known already.
    #[must_use]
    pub fn or_at(mut self, place: impl FnOnce() -> Place) -> Self {
        self.place.get_or_insert_with(|| Box::new(place()));
        self
    }

    /// Says in which part of a larger job it happened.
    #[must_use]
    pub fn within(mut self, part: &str) -> Self {
        self.message = format!("{part}: {}", self.message);
        self
    }

    /// The sentence alone.
    pub fn message(&self) -> &str {
        &self.message
    }

    /// Where it is, if it comes from a text.
    pub fn place(&self) -> Option<&Place> {
        self.place.as_deref()
    }

    /// Says what else to try.
    #[must_use]
    pub fn or_hint(mut self, other: &str) -> Self {
        self.hint = Some(self.hint.map_or_else(|| other.to_owned(), |first| format!("{first}; {other}")));
        self
    }

    /// Says what to try.
    #[must_use]
    pub fn hint(mut self, hint: impl Into<String>) -> Self {
        self.hint = Some(hint.into());
        self
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.message)?;
        if let Some(place) = &self.place {
            let gutter = " ".repeat(place.line.to_string().len());
            write!(f, "\n{gutter}--> {}:{}:{}", place.file, place.line, place.column)?;
            if !place.key.is_empty() {
                write!(f, ", key {}", place.key)?;
            }
            let indent: String = place
                .text
                .chars()
                .take(place.column - 1)
                .map(|c| if c == '\t' { '\t' } else { ' ' })
                .collect();
            write!(f, "\n{gutter} |\n{} | {}", place.line, place.text)?;
            write!(f, "\n{gutter} | {indent}{}", "^".repeat(place.width.max(1)))?;
        }
        if let Some(hint) = &self.hint {
            write!(f, "\nhint: {hint}")?;
        }
        Ok(())
    }
}

impl std::error::Error for Error {}
