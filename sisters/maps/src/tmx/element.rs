//! The elements of a file of XML or JSON, as a tree.

use std::borrow::Cow;
use std::fmt::Display;
use std::str::FromStr;

use roxmltree::{Document, Node, ParsingOptions};

use super::json::{Json, line};
use crate::{MapError, utf8};

/// Signs `=` between two tags, and words `xmlns` in a file, at most. Each attribute is compared with
/// all others of its element, and each element in a namespace may list those around it once more.
const MOST_ATTRIBUTES: usize = 1000;
const MOST_NAMESPACES: usize = 100;

/// What to do where tiles are stored in another way.
pub const FORMATS: &str = "choose CSV or base64 (Map, Map Properties, Tile Layer Format)";

/// What a file holds.
pub enum Tree<'a> {
    Xml(Document<'a>),
    Json(Json<'a>, &'a str),
}

/// Makes the tree of a file. Costs about a hundred bytes for each byte of it, at most, in any depth.
pub fn tree<'a>(bytes: &'a [u8], file: &str) -> Result<Tree<'a>, MapError> {
    let text = utf8(bytes, file)?;
    let refused = |why: &str| Err(MapError::damaged(file, 1, why));
    if text.trim_start().starts_with('{') {
        return Ok(Tree::Json(Json::read(text, file)?, text));
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
    let tree = Document::parse_with_options(text, options);
    tree.map(Tree::Xml).map_err(|why| MapError::damaged(file, why.pos().row, format!("it is no XML: {why}")))
}

/// An element of a file.
#[derive(Clone, Copy)]
pub struct Element<'a> {
    pub name: &'a str,
    part: Part<'a>,
    /// What errors call the file.
    file: &'a str,
}

#[derive(Clone, Copy)]
enum Part<'a> {
    Xml(Node<'a, 'a>),
    /// With the text of the file.
    Json(&'a Json<'a>, &'a str),
}

impl<'a> Element<'a> {
    /// The outermost element, which must have a name.
    pub fn root(tree: &'a Tree<'a>, file: &'a str, name: &str) -> Result<Self, MapError> {
        let root = match tree {
            Tree::Xml(tree) => Self::xml(tree.root_element(), file),
            Tree::Json(json, text) => {
                Self { name: json.get("type").unwrap_or_default(), part: Part::Json(json, text), file }
            }
        };
        if root.name == name {
            Ok(root)
        } else {
            Err(root.damaged(format!("it is no file of Tiled: it has no element {name}")))
        }
    }

    fn xml(node: Node<'a, 'a>, file: &'a str) -> Self {
        Self { name: node.tag_name().name(), part: Part::Xml(node), file }
    }

    /// The elements in it.
    pub fn children(self) -> Box<dyn Iterator<Item = Self> + 'a> {
        match self.part {
            Part::Xml(node) => {
                let inner = node.children().filter(Node::is_element);
                Box::new(inner.map(move |node| Self::xml(node, self.file)))
            }
            Part::Json(json, text) => {
                let inner = json.children().into_iter();
                Box::new(inner.map(move |(name, json)| Self { name, part: Part::Json(json, text), ..self }))
            }
        }
    }

    /// The elements in it of a name.
    pub fn all(self, name: &str) -> impl Iterator<Item = Self> {
        self.children().filter(move |child| child.name == name)
    }

    /// The text of tiles, and how it is stored: the encoding and the compression.
    pub fn tiles(self, data: Self) -> Result<(Cow<'a, str>, [&'a str; 2]), MapError> {
        let stored = ["encoding", "compression"].map(|name| data.attribute(name).unwrap_or_default());
        let other = |at: Self| at.damaged(format!("there are elements where a text should be: {FORMATS}"));
        match self.part {
            Part::Xml(node) => match self.children().next() {
                Some(child) => Err(other(child)),
                None => Ok((
                    node.children().filter(Node::is_text).filter_map(|part| part.text()).collect(),
                    stored,
                )),
            },
            Part::Json(json, _) => {
                let text = json.get("data").ok_or_else(|| other(self))?;
                let is_list = stored[0].is_empty();
                Ok((text.into(), if is_list { ["csv", ""] } else { stored }))
            }
        }
    }

    /// The corners of a polygon or a line of this element: `x,y x,y`.
    pub fn points(self) -> Cow<'a, str> {
        match self.part {
            Part::Xml(_) => self.attribute("points").unwrap_or_default().into(),
            Part::Json(json, _) => {
                let of = |point: &Json, axis| point.get(axis).unwrap_or_default().to_owned();
                let points = json.children().into_iter().map(|(_, p)| of(p, "x") + "," + &of(p, "y"));
                points.collect::<Vec<_>>().join(" ").into()
            }
        }
    }

    /// What is wrong here.
    pub fn damaged(self, why: impl Display) -> MapError {
        let line = match self.part {
            Part::Xml(node) => node.document().text_pos_at(node.range().start).row,
            Part::Json(json, text) => line(text, json.at),
        };
        MapError::damaged(self.file, line, why)
    }

    /// The value of an attribute.
    pub fn attribute(self, name: &str) -> Option<&'a str> {
        match self.part {
            Part::Xml(node) => node.attribute(name),
            Part::Json(json, _) => json.get(name),
        }
    }

    /// The value of an attribute that must be there.
    pub fn required(self, name: &str) -> Result<&'a str, MapError> {
        let lacks = || self.damaged(format!("the element {} has no attribute {name}", self.name));
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
