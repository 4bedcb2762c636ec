//! The elements of a file, as a tree.

use std::fmt::Display;
use std::str::FromStr;

use roxmltree::{Document, Node, ParsingOptions};

use crate::{MapError, utf8};

/// Signs `=` between two tags, and words `xmlns` in a file, at most. Each attribute is compared with
/// all others of its element, and each element in a namespace may list those around it once more.
const MOST_ATTRIBUTES: usize = 1000;
const MOST_NAMESPACES: usize = 100;

/// What to do where tiles are stored in another way.
pub const FORMATS: &str = "choose CSV or base64 (Map, Map Properties, Tile Layer Format)";

/// Makes the tree of a file. Costs about a hundred bytes for each byte of it, at most, in any depth.
pub fn tree<'a>(bytes: &'a [u8], file: &str) -> Result<Document<'a>, MapError> {
    let text = utf8(bytes, file)?;
    let refused = |why: &str| Err(MapError::damaged(file, 1, why));
    if text.trim_start().starts_with('{') {
        return refused("it is JSON: save it as .tmx or .tsx (File, Save As)");
    }
    if text.split('<').any(|part| part.matches('=').count() > MOST_ATTRIBUTES) {
        return refused("an element has more than 1000 attributes");
    }
    // An entity is a text that a few letters repeat.
    if text.contains("<!ENTITY") || text.matches("xmlns").count() > MOST_NAMESPACES {
        return refused("files with entities or more than 100 namespaces are not read");
    }
    // Old versions of the editor name a DTD.
    let options = ParsingOptions { allow_dtd: true, ..ParsingOptions::default() };
    Document::parse_with_options(text, options)
        .map_err(|why| MapError::damaged(file, why.pos().row, format!("it is no XML: {why}")))
}

/// An element of a file.
#[derive(Clone, Copy)]
pub struct Element<'a> {
    node: Node<'a, 'a>,
    /// What errors call the file.
    file: &'a str,
}

impl<'a> Element<'a> {
    /// The outermost element, which must have a name.
    pub fn root(tree: &'a Document<'a>, file: &'a str, name: &str) -> Result<Self, MapError> {
        let root = Self { node: tree.root_element(), file };
        if root.name() == name {
            Ok(root)
        } else {
            Err(root.damaged(format!("the file has no element {name}")))
        }
    }

    pub fn name(self) -> &'a str {
        self.node.tag_name().name()
    }

    /// The elements in it.
    pub fn children(self) -> impl Iterator<Item = Self> {
        self.node.children().filter(Node::is_element).map(move |node| Self { node, ..self })
    }

    /// The elements in it of a name.
    pub fn all(self, name: &str) -> impl Iterator<Item = Self> {
        self.children().filter(move |child| child.name() == name)
    }

    /// Its text, which has no elements inside.
    pub fn text(self) -> Result<String, MapError> {
        match self.children().next() {
            Some(child) => {
                Err(child.damaged(format!("there are elements where a text should be: {FORMATS}")))
            }
            None => Ok(self.node.children().filter(Node::is_text).filter_map(|part| part.text()).collect()),
        }
    }

    /// What is wrong here.
    pub fn damaged(self, why: impl Display) -> MapError {
        let line = self.node.document().text_pos_at(self.node.range().start).row;
        MapError::damaged(self.file, line, why)
    }

    /// The value of an attribute.
    pub fn attribute(self, name: &str) -> Option<&'a str> {
        self.node.attribute(name)
    }

    /// The value of an attribute that must be there.
    pub fn required(self, name: &str) -> Result<&'a str, MapError> {
        let lacks = || self.damaged(format!("the element {} has no attribute {name}", self.name()));
        self.attribute(name).ok_or_else(lacks)
    }

    /// The value of an attribute that must be there, and a whole number.
    pub fn number<N: FromStr<Err: Display>>(self, name: &str) -> Result<N, MapError> {
        let value = self.required(name)?;
        value.trim().parse().map_err(|why| self.damaged(format!("{name}=\"{value:.40}\": {why}")))
    }

    /// The value of an attribute that is a number with decimals; 0 if it is not there.
    pub fn decimal(self, name: &str) -> Result<f64, MapError> {
        let Some(value) = self.attribute(name) else { return Ok(0.0) };
        finite(value).ok_or_else(|| self.damaged(format!("{name}=\"{value:.40}\" is no finite number")))
    }

    /// The class of an object or a tile. Version 1.9 of the editor calls it `class`, those before
    /// and after it `type`.
    pub fn class(self) -> &'a str {
        let kind = self.attribute("type").filter(|kind| !kind.is_empty());
        kind.or(self.attribute("class")).unwrap_or_default()
    }
}

/// The number of a text, if it is finite.
pub fn finite(text: &str) -> Option<f64> {
    text.trim().parse().ok().filter(|v: &f64| v.is_finite())
}
