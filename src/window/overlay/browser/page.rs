//! How the cards are painted.

use std::rc::Rc;
use std::time::{Duration, Instant};

use glam::DVec2;
use tiny_skia::{Pixmap, PixmapMut, PixmapPaint, Transform};

use crate::paint::text::{BASELINE, LINE, shorten, text, width, wrap};
use crate::paint::{BACKGROUND, BALL, Colour, paint};
use crate::session::{STEP, Session};
use crate::simulation::Simulation;

use super::super::TEXT_SIZE;
use super::super::sheet::{INK, QUIET, Rounded};
use super::layout::{ABOUT_LINES, Layout, PADDING, SMALL};
use super::{Browser, Card};

/// What is behind the cards.
const WALL: Colour = Colour(0x12, 0x12, 0x12);
/// A card.
const CARD: Colour = Colour(0x1f, 0x1f, 0x1f);
/// A card under the pointer.
const POINTED: Colour = Colour(0x2b, 0x2b, 0x2b);
/// Scenes are shown after so much of their time, s ...
const SHOWN_AT: f64 = 0.7;
/// ... or as far as they come in so much wall-clock time.
const LONGEST_PICTURE: Duration = Duration::from_millis(20);

/// A list that has been painted; equal to another where it is the very same.
#[derive(Debug, Clone)]
pub(in crate::window) struct Page(Rc<Pixmap>);

impl PartialEq for Page {
    fn eq(&self, other: &Self) -> bool {
        Rc::ptr_eq(&self.0, &other.0)
    }
}

impl Page {
    /// The list as it is now; `None` where it has no size.
    pub(super) fn of(browser: &Browser) -> Option<Self> {
        browser.paint().map(|pixmap| Self(Rc::new(pixmap)))
    }

    /// Copies it over a picture of its size.
    pub(in crate::window::overlay) fn paint(&self, pixmap: &mut PixmapMut<'_>) {
        if (pixmap.width(), pixmap.height()) == (self.0.width(), self.0.height()) {
            pixmap.data_mut().copy_from_slice(self.0.data());
        }
    }
}

impl Browser {
    fn paint(&self) -> Option<Pixmap> {
        let Layout { extent, scale, .. } = self.layout;
        let mut pixmap = Pixmap::new(extent.x as u32, extent.y as u32)?;
        pixmap.fill(WALL.into());
        let target = &mut pixmap.as_mut();
        let size = TEXT_SIZE * scale;
        let head = DVec2::new(self.layout.start.x, self.layout.start.y - 1.2 * size);
        text(target, head, 1.2 * size, BALL, "Scenes");
        let room = extent.x - self.layout.start.x - head.x - width("Scenes", 1.2 * size) - size;
        let notes = self.notes();
        if let Some(note) = notes.iter().find(|note| width(note, SMALL * size) < room) {
            let right = extent.x - self.layout.start.x - width(note, SMALL * size);
            text(target, DVec2::new(right, head.y), SMALL * size, QUIET, note);
        }
        for index in self.seen() {
            self.paint_card(target, index);
        }
        Some(pixmap)
    }

    /// What stands beside the heading, the first of these that has room: which cards are seen, where there are more, and
    /// the keys.
    pub(super) fn notes(&self) -> Vec<String> {
        const KEYS: &str = "arrows, Enter: open · Esc: back";
        let (seen, all) = (self.seen(), self.cards.len());
        if seen.len() == all {
            return vec![KEYS.to_owned()];
        }
        let first = seen.start + 1;
        let which = if first == seen.end {
            format!("{first} of {all}")
        } else {
            format!("{first}–{} of {all}", seen.end)
        };
        vec![format!("{which} · wheel, {KEYS}"), format!("{which} · wheel"), which]
    }

    /// Paints the card of this index, which is seen.
    fn paint_card(&self, target: &mut PixmapMut<'_>, index: usize) {
        let Layout { scale, card: extent, picture, size, .. } = self.layout;
        let (card, corner) = (&self.cards[index], self.layout.corner(index - self.first()));
        let sheet = Rounded { corner, extent, radius: 6.0 * scale };
        sheet.fill(target, if self.pointed == Some(index) { POINTED } else { CARD });
        if index == self.selected {
            sheet.edge(target, 2.0 * scale, BALL);
        }
        let inside = corner + PADDING * scale;
        if let Some(painted) = &card.picture {
            let (x, y) = (inside.x.round() as i32, inside.y.round() as i32);
            let paint = PixmapPaint::default();
            target.draw_pixmap(x, y, painted.as_ref(), &paint, Transform::identity(), None);
        }
        let characters = self.layout.characters();
        let mut line = inside.y + picture.y + 0.2 * size;
        let mut write = |colour: Colour, words: &str| {
            text(target, DVec2::new(inside.x, line + BASELINE * size), size, colour, words);
            line += LINE * size;
        };
        let name = if self.played == Some(index) {
            format!("{} · playing", card.scene.name())
        } else {
            card.scene.name().to_owned()
        };
        write(BALL, &shorten(&name, characters));
        let mut lines = wrap(&[card.scene.about()], characters);
        if lines.len() > ABOUT_LINES {
            lines.truncate(ABOUT_LINES);
            if let Some(last) = lines.last_mut() {
                *last = shorten(&format!("{last} …"), characters);
            }
        }
        for words in &lines {
            write(INK, words);
        }
        let balls = match card.balls {
            _ if card.scene.rain().is_some() => "rain".to_owned(),
            1 => "1 ball".to_owned(),
            count => format!("{count} balls"),
        };
        let how = format!("{balls} · {}", card.solver);
        write(QUIET, &shorten(&how, characters));
    }
}

impl Card {
    /// The scene as it is after a moment, all of its world in the middle of a picture of this size, px.
    pub(super) fn paint(&self, size: DVec2) -> Option<Pixmap> {
        let start = Instant::now();
        let Ok(mut session) = Session::new(&self.scene, 1) else {
            return Pixmap::new(size.x as u32, size.y as u32);
        };
        while session.simulation().time() < SHOWN_AT && start.elapsed() < LONGEST_PICTURE {
            if session.advance_while(STEP, || start.elapsed() < LONGEST_PICTURE).is_err() {
                break;
            }
        }
        picture(session.simulation(), size)
    }
}

/// All of a simulation's world in the middle of a picture of this size, px.
pub(super) fn picture(simulation: &Simulation, size: DVec2) -> Option<Pixmap> {
    let mut picture = Pixmap::new(size.x as u32, size.y as u32)?;
    picture.fill(BACKGROUND.into());
    let world = simulation.world().size();
    let scale = (size / world).min_element();
    let covered = (world * scale).round().max(DVec2::ONE).min(size);
    let mut scaled = Pixmap::new(covered.x as u32, covered.y as u32)?;
    paint(simulation, scale, &mut scaled.as_mut());
    let corner = ((size - covered) / 2.0).round();
    let (x, y) = (corner.x as i32, corner.y as i32);
    let copy = PixmapPaint::default();
    picture.draw_pixmap(x, y, scaled.as_ref(), &copy, Transform::identity(), None);
    Some(picture)
}
