//! Templates: files with an object of which others are made.

use std::rc::Rc;

use super::draft::{Checked, Draft};
use super::fault::{BYTES_FOR_A_BYTE, BYTES_FOR_ALL, TmxFault};
use crate::tmx::tileset::Tilesets;
use crate::tmx::xml::{Element, Xml};

/// A template that was read.
#[derive(Debug)]
pub(crate) struct Template {
    /// Its object, or what is amiss with it.
    pub object: Result<TemplateObject, TmxFault>,
    /// The tilesets that its object counts by.
    pub tilesets: Tilesets,
    /// The bytes of the file, which bound the memory of a copy.
    pub bytes: u64,
}

/// The object of a template.
#[derive(Debug)]
pub(crate) struct TemplateObject(pub(super) Draft);

impl Template {
    /// Reads the object of a template, from behind its start.
    pub fn object(xml: &mut Xml<'_>, element: &Element<'_>) -> Checked<TemplateObject> {
        let draft = Draft::read(xml, element)?;
        if let Ok(Draft { template: Some(_), .. }) = &draft {
            return Err(xml.damaged("a template is made of a template"));
        }
        Ok(draft.map(TemplateObject))
    }

    /// The tile of its object, by its own tilesets.
    pub(super) fn tile(&self) -> Option<u32> {
        self.object.as_ref().ok().and_then(|object| object.0.tile)
    }
}

/// Gives the templates of objects.
pub(crate) struct Templates<'t> {
    open: &'t mut dyn FnMut(&str) -> Result<Rc<Template>, TmxFault>,
    /// The bytes that may still be copied.
    left: &'t mut u64,
}

impl<'t> Templates<'t> {
    /// The bytes that templates may give to all objects of a map of some bytes.
    pub fn most(bytes: usize) -> u64 {
        BYTES_FOR_ALL + BYTES_FOR_A_BYTE * bytes as u64
    }

    /// Templates by their paths, which may give `left` bytes.
    pub fn new(open: &'t mut dyn FnMut(&str) -> Result<Rc<Template>, TmxFault>, left: &'t mut u64) -> Self {
        Self { open, left }
    }

    /// Completes an object by its template, and gives this.
    ///
    /// # Errors
    /// Why the object is left out.
    pub(super) fn complete(&mut self, draft: &mut Draft, path: &str) -> Result<Rc<Template>, TmxFault> {
        let template = (self.open)(path)?;
        let TemplateObject(object) = template.object.as_ref().map_err(Clone::clone)?;
        *self.left = self.left.checked_sub(template.bytes).ok_or(TmxFault::Copies)?;
        draft.complete(object);
        Ok(template)
    }
}
