//! The objects of a layer.

use std::rc::Rc;
use std::sync::Arc;

use glam::DVec2;

use super::draft::{Draft, Form};
use super::fault::TmxFault;
use super::object::TmxObject;
use super::role::Roles;
use super::shape::{Frame, Outline, TmxShape};
use super::template::{Template, Templates};
use crate::editor::Role;
use crate::tmx::TmxError;
use crate::tmx::space::Space;
use crate::tmx::tileset::{Alignment, Opaque, Tilesets};
use crate::tmx::xml::Xml;

/// What all objects of a layer share.
pub(in crate::tmx) struct ObjectLayer<'l> {
    pub space: &'l Space,
    pub tilesets: &'l Tilesets,
    pub name: Arc<str>,
    /// Its shift in pixels, that of its groups included.
    pub shift: [f64; 2],
    /// Whether it and its groups are switched on.
    pub visible: bool,
    pub roles: Roles<'l>,
}

/// The tile of an object with a picture.
struct Tile<'t> {
    set: &'t Rc<Opaque>,
    /// Its number in the tileset.
    number: u32,
    /// Its id in the map.
    id: Option<u32>,
}

impl ObjectLayer<'_> {
    /// Reads the objects of a layer, from behind its start. `fault` is told the id of an object and
    /// what is amiss with it.
    pub fn read(
        &self,
        xml: &mut Xml<'_>,
        templates: &mut Templates<'_>,
        objects: &mut Vec<TmxObject>,
        fault: &mut dyn FnMut(u32, TmxFault),
    ) -> Result<(), TmxError> {
        let mut faults = Vec::new();
        while let Some(child) = xml.child()? {
            if child.local_name().as_ref() != b"object" {
                xml.skip(&child)?;
                continue;
            }
            let id = xml.attribute(&child, "id")?.and_then(|id| id.trim().parse().ok()).unwrap_or(0);
            let draft = Draft::read(xml, &child)?;
            match draft.and_then(|draft| self.object(draft, id, templates, &mut faults)) {
                Ok(object) => objects.extend(object),
                Err(why) => faults.push(why),
            }
            faults.drain(..).for_each(|why| fault(id, why));
        }
        Ok(())
    }

    /// The object of an element. `None` for a text.
    fn object(
        &self,
        mut draft: Draft,
        id: u32,
        templates: &mut Templates<'_>,
        faults: &mut Vec<TmxFault>,
    ) -> Result<Option<TmxObject>, TmxFault> {
        let template = match draft.template.take() {
            Some(path) => Some(templates.complete(&mut draft, &path)?),
            None => None,
        };
        faults.append(&mut draft.faults);
        let outline = match &draft.form {
            Some(Form::Text) => return Ok(None),
            Some(Form::Outline(outline)) => outline,
            None => &Outline::Box,
        };
        let tile = self.tile(&draft, template.as_deref())?;
        let shape = self.frame(&draft, tile.as_ref())?.shape(outline)?;
        let is_point = matches!(shape, TmxShape::Point(_)) && !matches!(outline, Outline::Point);
        let mut object = TmxObject {
            id,
            name: draft.name,
            class: draft.class,
            layer: self.name.clone(),
            visible: self.visible && draft.visible.unwrap_or(true),
            tile: tile.as_ref().and_then(|tile| tile.id),
            shape,
            role: Role::Plain,
            properties: draft.properties,
        };
        let of_tile = |tile: &Tile<'_>| tile.set.says(tile.number, object.class.is_empty());
        let of_tile = tile.as_ref().map(of_tile).unwrap_or_default();
        object.role = self.roles.role(&object.properties, &object.class, of_tile, faults);
        if object.class.is_empty()
            && let Some(class) = tile.as_ref().and_then(|tile| tile.set.class(tile.number))
        {
            object.class = class;
        }
        if is_point || matches!(object.shape, TmxShape::Point(_)) && object.role != Role::Plain {
            faults.push(TmxFault::NoSize);
        }
        faults.extend(object.shape.fault());
        Ok(Some(object))
    }

    /// The tile of an object, or else of its template, which counts by its own tilesets.
    fn tile<'t>(
        &'t self,
        draft: &Draft,
        template: Option<&'t Template>,
    ) -> Result<Option<Tile<'t>>, TmxFault> {
        let of_template = || template.and_then(|template| template.tile().map(|id| (&template.tilesets, id)));
        let Some((tilesets, id)) = draft.tile.map(|id| (self.tilesets, id)).or_else(of_template) else {
            return Ok(None);
        };
        let (set, number) = tilesets.find(id).ok_or(TmxFault::UnknownTile(id))?;
        let id = match draft.tile {
            Some(id) => Some(id),
            None => self.tilesets.id(set, number, id),
        };
        Ok(Some(Tile { set, number, id }))
    }

    /// Where the coordinates of an object lie.
    fn frame(&self, draft: &Draft, tile: Option<&Tile<'_>>) -> Result<Frame<'_>, TmxFault> {
        let screen = self.space.screen();
        let turn = draft.turn();
        let at = screen * draft.at + DVec2::from_array(self.shift);
        let [width, height] = draft.size;
        let Some(tile) = tile else {
            let size = DVec2::new(width.unwrap_or(0.0), height.unwrap_or(0.0));
            return Ok(Frame { space: self.space, at, turn: turn * screen, least: DVec2::ZERO, size });
        };
        let (alignment, own) = tile.set.picture(tile.number);
        let size = DVec2::new(width.unwrap_or(own[0]), height.unwrap_or(own[1]));
        let Alignment(share) = alignment.unwrap_or(match self.space.isometric {
            true => Alignment::BOTTOM,
            false => Alignment::BOTTOM_LEFT,
        });
        // Pictures lie along the screen, also in isometric maps.
        Ok(Frame { space: self.space, at, turn, least: -DVec2::from_array(share) * size, size })
    }
}
