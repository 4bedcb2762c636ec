//! The elements of a file, one after the other. Nothing recurses: elements may be nested in any
//! depth.

use std::borrow::Cow;
use std::fmt::Display;
use std::str::FromStr;

use quick_xml::events::{BytesStart, Event};
use quick_xml::{Reader, XmlVersion};

use super::error::TmxError;

/// The start of an element.
pub(super) type Element<'a> = BytesStart<'a>;

/// The text of a file, without a byte-order mark.
pub(super) fn utf8<'a>(bytes: &'a [u8], name: &str) -> Result<&'a str, TmxError> {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let why = "it is not in UTF-8, as which the editor saves maps".to_owned();
    str::from_utf8(bytes).map_err(|_| TmxError::Damaged { file: name.into(), line: 1, why })
}

/// A file that is being read.
pub(super) struct Xml<'a> {
    text: &'a str,
    reader: Reader<&'a [u8]>,
    /// What errors call it.
    name: String,
}

impl<'a> Xml<'a> {
    pub fn new(text: &'a str, name: &str) -> Self {
        let mut reader = Reader::from_str(text);
        // So that each start has an end.
        reader.config_mut().expand_empty_elements = true;
        Self { text, reader, name: name.into() }
    }

    /// A reader of the same file from its start on.
    pub fn again(&self) -> Self {
        Self::new(self.text, &self.name)
    }

    /// A reader of the contents of the element whose start was read last, which moves this one by
    /// nothing; `None` if the element is empty.
    pub fn inside(&self) -> Option<Self> {
        let (before, rest) = self.text.split_at_checked(self.reader.buffer_position() as usize)?;
        if before.ends_with("/>") {
            return None;
        }
        let mut inside = Self::new(rest, &self.name);
        // The element ends without a start here.
        inside.reader.config_mut().allow_unmatched_ends = true;
        Some(inside)
    }

    /// What is wrong here.
    pub fn damaged(&self, why: impl ToString) -> TmxError {
        let read = (self.reader.buffer_position() as usize).min(self.text.len());
        let text = &self.text.as_bytes()[..read];
        // Lines end with a line feed, or with a carriage return alone.
        let ends = |&(i, &b): &(usize, &u8)| b == b'\n' || b == b'\r' && text.get(i + 1) != Some(&b'\n');
        let line = 1 + text.iter().enumerate().filter(ends).count();
        TmxError::Damaged { file: self.name.clone(), line, why: why.to_string() }
    }

    fn next(&mut self) -> Result<Event<'a>, TmxError> {
        match self.reader.read_event() {
            Ok(Event::Eof) => Err(self.damaged("the file ends within an element")),
            Ok(event) => Ok(event),
            Err(why) => Err(self.damaged(why)),
        }
    }

    /// The outermost element, which must have a name.
    pub fn root(&mut self, name: &str) -> Result<Element<'a>, TmxError> {
        match self.child()? {
            Some(root) if root.local_name().as_ref() == name.as_bytes() => Ok(root),
            _ => Err(self.damaged(format!("the file has no element {name}"))),
        }
    }

    /// The next element in the one whose start was read last; `None` at its end, which is then
    /// read.
    pub fn child(&mut self) -> Result<Option<Element<'a>>, TmxError> {
        loop {
            match self.next()? {
                Event::Start(child) => return Ok(Some(child)),
                Event::End(_) => return Ok(None),
                _ => {}
            }
        }
    }

    /// Passes over the rest of an element.
    pub fn skip(&mut self, element: &Element<'_>) -> Result<(), TmxError> {
        match self.reader.read_to_end(element.name()) {
            Ok(_) => Ok(()),
            Err(why) => Err(self.damaged(why)),
        }
    }

    /// The text of the element whose start was read last, up to its end.
    pub fn text(&mut self) -> Result<Cow<'a, str>, TmxError> {
        let mut all = Cow::default();
        loop {
            let text = match self.next()? {
                Event::Text(text) => text.decode(),
                Event::CData(text) => text.decode(),
                Event::End(_) => return Ok(all),
                Event::Comment(_) | Event::PI(_) => continue,
                _ => return Err(self.damaged("there are elements where a text should be")),
            };
            let text = text.map_err(|why| self.damaged(why))?;
            if all.is_empty() { all = text } else { all.to_mut().push_str(&text) }
        }
    }

    /// The value of an attribute.
    pub fn attribute<'e>(
        &self,
        element: &'e Element<'_>,
        name: &str,
    ) -> Result<Option<Cow<'e, str>>, TmxError> {
        // The check for equal names would compare each with all others.
        for attribute in element.attributes().with_checks(false) {
            let attribute = attribute.map_err(|why| self.damaged(why))?;
            if attribute.key.as_ref() == name.as_bytes() {
                let value = attribute.normalized_value(XmlVersion::Implicit1_0);
                return value.map(Some).map_err(|why| self.damaged(why));
            }
        }
        Ok(None)
    }

    /// The value of an attribute that must be there.
    pub fn required<'e>(&self, element: &'e Element<'_>, name: &str) -> Result<Cow<'e, str>, TmxError> {
        let lacks = || {
            let element = String::from_utf8_lossy(element.local_name().into_inner()).into_owned();
            self.damaged(format!("the element {element} has no attribute {name}"))
        };
        self.attribute(element, name)?.ok_or_else(lacks)
    }

    /// The value of an attribute that is a number with decimals; 0 if it is not there.
    pub fn decimal(&self, element: &Element<'_>, name: &str) -> Result<f64, TmxError> {
        let Some(value) = self.attribute(element, name)? else { return Ok(0.0) };
        let number = value.trim().parse().ok().filter(|v: &f64| v.is_finite());
        number.ok_or_else(|| self.damaged(format!("{name}=\"{value:.40}\" is no finite number")))
    }

    /// The value of an attribute that must be there, and a whole number.
    pub fn number<N: FromStr<Err: Display>>(&self, element: &Element<'_>, name: &str) -> Result<N, TmxError> {
        let value = self.required(element, name)?;
        value.trim().parse().map_err(|why| self.damaged(format!("{name}=\"{value:.40}\": {why}")))
    }
}
