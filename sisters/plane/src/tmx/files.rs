//! The files that a map names: each is read once.

use std::collections::HashMap;
use std::io;
use std::rc::Rc;

use super::TmxError;
use super::objects::{Template, TmxFault};
use super::paths::{folder, joined};
use super::tileset::{Opaque, Tilesets};
use super::xml::{Element, Xml};
use crate::editor::Rule;
use crate::files::text;

/// Opens a file by the path that the map has for it.
pub(super) type Open<'f> = &'f mut dyn FnMut(&str) -> io::Result<Vec<u8>>;

/// The files that were read.
pub(super) struct Files<'f> {
    open: Open<'f>,
    pub rule: &'f Rule,
    /// Those of an encoding that was guessed.
    pub odd: Vec<String>,
    tilesets: HashMap<String, Rc<Opaque>>,
    templates: HashMap<String, Result<Rc<Template>, TmxFault>>,
}

impl<'f> Files<'f> {
    pub fn new(open: Open<'f>, rule: &'f Rule) -> Self {
        Self { open, rule, odd: Vec::new(), tilesets: HashMap::new(), templates: HashMap::new() }
    }

    /// The bytes of a file whose text is then taken.
    fn bytes(&mut self, path: &str) -> Result<Vec<u8>, TmxError> {
        let bytes = (self.open)(path).map_err(|why| TmxError::File { file: path.to_owned(), why })?;
        if text(&bytes).1 {
            self.odd.push(path.to_owned());
        }
        Ok(bytes)
    }

    /// Adds a tileset, from behind its start: one in the file at hand, or one in a file of its own,
    /// whose path counts from `folder`.
    pub fn tileset(
        &mut self,
        xml: &mut Xml<'_>,
        element: &Element<'_>,
        folder: &str,
        into: &mut Tilesets,
    ) -> Result<(), TmxError> {
        let first = xml.number(element, "firstgid")?;
        let tiles = match xml.attribute(element, "source")? {
            Some(source) => {
                xml.skip(element)?;
                self.external(joined(folder, &source))?
            }
            None => Rc::new(Opaque::read(xml, element, folder, self.rule)?),
        };
        into.push(first, tiles);
        Ok(())
    }

    fn external(&mut self, source: String) -> Result<Rc<Opaque>, TmxError> {
        if let Some(tiles) = self.tilesets.get(&source) {
            return Ok(tiles.clone());
        }
        let bytes = self.bytes(&source)?;
        let text = text(&bytes).0;
        let mut xml = Xml::new(&text, &source);
        let root = xml.root("tileset")?;
        let tiles = Rc::new(Opaque::read(&mut xml, &root, folder(&source), self.rule)?);
        self.tilesets.insert(source, tiles.clone());
        Ok(tiles)
    }

    /// The template of an object.
    ///
    /// # Errors
    /// Why there is none: the objects that are made of it are left out, and the map is read.
    pub fn template(&mut self, path: &str) -> Result<Rc<Template>, TmxFault> {
        if let Some(known) = self.templates.get(path) {
            return known.clone();
        }
        let read = self.read_template(path).map_err(|why| TmxFault::template(path, &why.to_string()));
        self.templates.insert(path.to_owned(), read.clone());
        read
    }

    fn read_template(&mut self, path: &str) -> Result<Rc<Template>, TmxError> {
        // Its tilesets count from its own folder.
        let folder = folder(path);
        let bytes = self.bytes(path)?;
        let text = text(&bytes).0;
        let mut xml = Xml::new(&text, path);
        xml.root("template")?;
        let (mut tilesets, mut object) = (Tilesets::default(), None);
        while let Some(child) = xml.child()? {
            match child.local_name().as_ref() {
                b"tileset" => self.tileset(&mut xml, &child, folder, &mut tilesets)?,
                b"object" => object = Some(Template::object(&mut xml, &child)?),
                _ => xml.skip(&child)?,
            }
        }
        let object = object.ok_or_else(|| xml.damaged("the template has no object"))?;
        Ok(Rc::new(Template { object, tilesets, bytes: bytes.len() as u64 }))
    }
}
