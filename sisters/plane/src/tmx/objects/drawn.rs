//! Shapes as tilesets draw them on their tiles.

use super::draft::Draft;
use super::fault::TmxFault;
use crate::tmx::TmxError;
use crate::tmx::xml::Xml;

/// An object that a tileset draws on a tile.
#[derive(Debug)]
pub(crate) struct Drawn {
    /// Its number in the tileset; 0 if the file gives none.
    pub id: u32,
    pub(super) draft: Result<Draft, TmxFault>,
}

impl Drawn {
    /// Reads the objects of a tile, from behind the start of their group. `path` gives the path of
    /// a template from the folder of the map.
    pub fn read(xml: &mut Xml<'_>, path: impl Fn(&str) -> String) -> Result<Vec<Self>, TmxError> {
        let mut all = Vec::new();
        while let Some(child) = xml.child()? {
            if child.local_name().as_ref() != b"object" {
                xml.skip(&child)?;
                continue;
            }
            let id = xml.attribute(&child, "id")?.and_then(|id| id.trim().parse().ok()).unwrap_or(0);
            let mut draft = Draft::read(xml, &child)?;
            if let Ok(draft) = &mut draft {
                draft.template = draft.template.take().map(|template| path(&template));
            }
            all.push(Self { id, draft });
        }
        Ok(all)
    }
}
