//! The objects of a layer.

use std::rc::Rc;
use std::sync::Arc;

use glam::{DMat2, DVec2};

use super::draft::{Draft, Form};
use super::fault::{TmxFault, shortened};
use super::object::TmxObject;
use super::properties::TmxValue;
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
    /// The names of the properties that say that an object hides, and that it is a door.
    pub names: [&'l str; 2],
    /// Whether all its objects hide.
    pub walls: bool,
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
        if object.class.is_empty()
            && let Some(class) = tile.as_ref().and_then(|tile| tile.set.class(tile.number))
        {
            object.class = class;
        }
        object.role = self.role(&object, tile.as_ref(), faults);
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

    /// What the object says of itself, or else its tile, its class and its layer.
    fn role(&self, object: &TmxObject, tile: Option<&Tile<'_>>, faults: &mut Vec<TmxFault>) -> Role {
        let mut says = |which: usize| {
            let name = self.names[which];
            match object.properties.get(name) {
                Some(TmxValue::Bool(says)) => return Some(*says),
                Some(other) => {
                    let (property, kind) = (shortened(name), other.kind());
                    faults.push(TmxFault::PropertyType { property, kind });
                }
                None => {}
            }
            let of_tile = tile.is_some_and(|tile| tile.set.says(tile.number, which));
            (of_tile || &*object.class == name).then_some(true)
        };
        let (hides, door) = (says(0), says(1));
        match (door, hides) {
            (Some(true), _) => Role::Door,
            (_, Some(true)) => Role::Wall,
            (_, None) if self.walls => Role::Wall,
            _ => Role::Plain,
        }
    }

    /// Where the coordinates of an object lie.
    fn frame(&self, draft: &Draft, tile: Option<&Tile<'_>>) -> Result<Frame<'_>, TmxFault> {
        let screen = self.space.screen();
        let angle = draft.rotation.unwrap_or(0.0).rem_euclid(360.0);
        // Right angles keep rectangles along the axes.
        let (sin, cos) = match angle {
            0.0 => (0.0, 1.0),
            90.0 => (1.0, 0.0),
            180.0 => (0.0, -1.0),
            270.0 => (-1.0, 0.0),
            _ => angle.to_radians().sin_cos(),
        };
        // Clockwise, for y goes down.
        let turn = DMat2::from_cols(DVec2::new(cos, sin), DVec2::new(-sin, cos));
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
