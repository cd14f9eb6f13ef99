//! All scenes, as cards with small pictures, to choose one from.

use std::rc::Rc;
use std::time::{Duration, Instant};

use glam::DVec2;
use tiny_skia::{Pixmap, PixmapMut, PixmapPaint, Transform};

use crate::paint::text::{BASELINE, LINE, shorten, text, width, wrap};
use crate::paint::{BACKGROUND, BALL, Colour, paint};
use crate::scene::{self, Scene};
use crate::session::{STEP, Session};

use super::TEXT_SIZE;
use super::sheet::{INK, QUIET, Rounded};

/// Behind the cards, and a card.
const WALL: Colour = Colour(0x12, 0x12, 0x12);
const CARD: Colour = Colour(0x1f, 0x1f, 0x1f);
/// A card under the pointer.
const POINTED: Colour = Colour(0x2b, 0x2b, 0x2b);
/// The width of a card at most, and of a picture in it by its height.
const CARD_MOST: f64 = 190.0;
const ASPECT: f64 = 16.0 / 9.0;
/// Around the cards, between two, and inside of one, px.
const MARGIN: f64 = 24.0;
const GAP: f64 = 14.0;
const PADDING: f64 = 8.0;
/// Of the text on a card, beside that on other sheets.
const SMALL: f64 = 0.8;
/// Lines of text on a card: its name, what it is about, how it is moved.
const ABOUT_LINES: usize = 2;
/// Scenes are shown after so much of their time, s, or as far as they come in so much of ours.
const SHOWN_AT: f64 = 0.7;
const PICTURE_MOST: Duration = Duration::from_millis(20);

/// Which way an arrow key goes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::window) enum Direction {
    Left,
    Right,
    Up,
    Down,
}

/// A card, and its picture, for the size that it has, once that is painted.
#[derive(Debug)]
struct Card {
    scene: Scene,
    balls: usize,
    picture: Option<Pixmap>,
}

/// The list of scenes, while it is open.
#[derive(Debug)]
pub(in crate::window) struct Browser {
    cards: Vec<Card>,
    /// The card of the scene that is played, the selected one, and the one under the pointer.
    played: Option<usize>,
    selected: usize,
    pointed: Option<usize>,
    /// The first row that is shown.
    row: usize,
    layout: Layout,
    painted: Option<Page>,
}

/// A list that has been painted; equal to another where it is the very same.
#[derive(Debug, Clone)]
pub(in crate::window) struct Page(Rc<Pixmap>);

impl PartialEq for Page {
    fn eq(&self, other: &Self) -> bool {
        Rc::ptr_eq(&self.0, &other.0)
    }
}

impl Page {
    pub(super) fn paint(&self, pixmap: &mut PixmapMut<'_>) {
        if (pixmap.width(), pixmap.height()) == (self.0.width(), self.0.height()) {
            pixmap.data_mut().copy_from_slice(self.0.data());
        }
    }
}

/// Where the cards are, in pixels.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Layout {
    extent: DVec2,
    scale: f64,
    columns: usize,
    /// Whole rows that are seen at once; at least one.
    rows: usize,
    /// The first card's corner, a card's size, and that of its picture, which may have none.
    start: DVec2,
    card: DVec2,
    picture: DVec2,
    gap: f64,
    size: f64,
}

impl Layout {
    fn new(extent: DVec2, scale: f64) -> Self {
        // What does not fit at its size is smaller.
        let room = (extent - 2.0 * MARGIN * scale).max(DVec2::ONE);
        let scale = scale.min(room.x / 150.0).min(room.y / 120.0);
        let (gap, size) = (GAP * scale, SMALL * TEXT_SIZE * scale);
        let columns = ((room.x + gap) / (CARD_MOST * scale + gap)).floor().max(1.0);
        let across = ((room.x + gap) / columns - gap).min(CARD_MOST * 1.15 * scale);
        let written = (2 + ABOUT_LINES) as f64 * LINE * size + 2.0 * PADDING * scale;
        let head = 2.6 * TEXT_SIZE * scale;
        let inside = across - 2.0 * PADDING * scale;
        let mut picture = DVec2::new(inside, inside / ASPECT).round();
        if picture.y + written > room.y - head {
            picture = DVec2::ZERO;
        }
        let card = DVec2::new(across, written + picture.y);
        let rows = ((room.y - head + gap) / (card.y + gap)).floor().max(1.0);
        let used = columns * (across + gap) - gap;
        let start = DVec2::new((extent.x - used) / 2.0, (extent.y - room.y) / 2.0 + head).round();
        Self {
            extent,
            scale,
            columns: columns as usize,
            rows: rows as usize,
            start,
            card,
            picture,
            gap,
            size,
        }
    }

    /// The corner of the card in this place of those that are seen.
    fn corner(&self, place: usize) -> DVec2 {
        let cell = DVec2::new((place % self.columns) as f64, (place / self.columns) as f64);
        (self.start + cell * (self.card + self.gap)).round()
    }
}

impl Browser {
    /// The built-in scenes, and before them that which is played, where it is another.
    pub(in crate::window) fn open(played: &Scene) -> Self {
        let mut scenes: Vec<Scene> =
            scene::names().iter().filter_map(|name| Scene::load(name).ok()).collect();
        let same = |scene: &Scene| scene.argument() == played.argument();
        if !scenes.iter().any(same) {
            scenes.insert(0, played.clone());
        }
        let index = scenes.iter().position(same);
        let cards = scenes.into_iter().map(|scene| Card {
            balls: scene.build().map_or(0, |simulation| simulation.balls().len()),
            scene,
            picture: None,
        });
        Self {
            cards: cards.collect(),
            played: index,
            selected: index.unwrap_or(0),
            pointed: None,
            row: 0,
            layout: Layout::default(),
            painted: None,
        }
    }

    /// The scene that is selected.
    pub(in crate::window) fn selected(&self) -> Option<&Scene> {
        self.cards.get(self.selected).map(|card| &card.scene)
    }

    /// Selects the card beside, above or below; at an end, the last one there is.
    pub(in crate::window) fn step(&mut self, direction: Direction) {
        let (columns, last) = (self.layout.columns.max(1), self.cards.len().saturating_sub(1));
        self.selected = match direction {
            Direction::Left => self.selected.saturating_sub(1),
            Direction::Right => (self.selected + 1).min(last),
            Direction::Up => self.selected.checked_sub(columns).unwrap_or(self.selected),
            Direction::Down if self.selected / columns == last / columns => self.selected,
            Direction::Down => (self.selected + columns).min(last),
        };
        self.show_selected();
        self.painted = None;
    }

    /// Scrolls down by so many rows, or up.
    pub(in crate::window) fn scroll(&mut self, rows: i32) {
        self.row = self.row.saturating_add_signed(rows as isize).min(self.last_row());
        self.pointed = None;
        self.painted = None;
    }

    /// The pointer is here, in pixels.
    pub(in crate::window) fn point_at(&mut self, place: DVec2) {
        let pointed = self.hit(place);
        if pointed != self.pointed {
            self.pointed = pointed;
            self.painted = None;
        }
    }

    /// Selects the card at this place, in pixels; whether there is one.
    pub(in crate::window) fn select_at(&mut self, place: DVec2) -> bool {
        let Some(index) = self.hit(place) else { return false };
        self.selected = index;
        self.painted = None;
        true
    }

    fn hit(&self, place: DVec2) -> Option<usize> {
        let inside = |&index: &usize| {
            let from = place - self.layout.corner(index - self.first());
            from.cmpge(DVec2::ZERO).all() && from.cmplt(self.layout.card).all()
        };
        self.seen().find(inside)
    }

    /// The first card that is seen.
    fn first(&self) -> usize {
        self.row * self.layout.columns
    }

    /// The cards that are seen.
    fn seen(&self) -> std::ops::Range<usize> {
        let first = self.first().min(self.cards.len());
        first..(first + self.layout.rows * self.layout.columns).min(self.cards.len())
    }

    /// The first row when the last one is seen.
    fn last_row(&self) -> usize {
        self.cards.len().div_ceil(self.layout.columns.max(1)).saturating_sub(self.layout.rows)
    }

    fn show_selected(&mut self) {
        let row = self.selected / self.layout.columns.max(1);
        let least = (row + 1).saturating_sub(self.layout.rows);
        self.row = self.row.clamp(least.min(row), row).min(self.last_row());
    }

    /// The list for a picture of this size, px, with `scale` pixels per px of the world; and whether there are small
    /// pictures still to be painted: one is painted with each call.
    pub(in crate::window) fn page(&mut self, extent: DVec2, scale: f64) -> (Option<Page>, bool) {
        let layout = Layout::new(extent, scale);
        if layout != self.layout {
            if layout.picture != self.layout.picture {
                self.cards.iter_mut().for_each(|card| card.picture = None);
            }
            self.layout = layout;
            self.show_selected();
            self.painted = None;
        }
        let seen = self.seen();
        let mut missing = self.cards[seen].iter_mut().filter(|card| card.picture.is_none());
        if layout.picture.min_element() >= 1.0
            && let Some(card) = missing.next()
        {
            card.picture = card.paint(layout.picture);
            self.painted = None;
        }
        let missing = layout.picture.min_element() >= 1.0 && missing.next().is_some();
        if self.painted.is_none() {
            self.painted = self.paint().map(|pixmap| Page(Rc::new(pixmap)));
        }
        (self.painted.clone(), missing)
    }

    fn paint(&self) -> Option<Pixmap> {
        let Layout { extent, scale, .. } = self.layout;
        let mut pixmap = Pixmap::new(extent.x as u32, extent.y as u32)?;
        pixmap.fill(WALL.into());
        let target = &mut pixmap.as_mut();
        let size = TEXT_SIZE * scale;
        let head = DVec2::new(self.layout.start.x, self.layout.start.y - 1.2 * size);
        text(target, head, 1.2 * size, BALL, "Scenes");
        let keys = "arrows, Enter: open · Esc: back";
        let right = extent.x - self.layout.start.x - width(keys, SMALL * size);
        if right > head.x + width("Scenes", 1.2 * size) + size {
            text(target, DVec2::new(right, head.y), SMALL * size, QUIET, keys);
        }
        for index in self.seen() {
            self.paint_card(target, index);
        }
        Some(pixmap)
    }

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
        let characters = ((extent.x - 2.0 * PADDING * scale) / width("m", size)).floor() as usize;
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
        let how = format!("{balls} · {}", card.scene.solver());
        write(QUIET, &shorten(&how, characters));
    }
}

impl Card {
    /// The scene as it is after a moment, all of its world in the middle of a picture of this size, px.
    fn paint(&self, size: DVec2) -> Option<Pixmap> {
        let mut picture = Pixmap::new(size.x as u32, size.y as u32)?;
        picture.fill(BACKGROUND.into());
        let Ok(mut session) = Session::new(&self.scene, 1) else { return Some(picture) };
        let start = Instant::now();
        while session.simulation().time() < SHOWN_AT && start.elapsed() < PICTURE_MOST {
            if session.advance_while(STEP, || start.elapsed() < PICTURE_MOST).is_err() {
                break;
            }
        }
        let world = session.simulation().world().size();
        let scale = (size / world).min_element();
        let covered = (world * scale).round().max(DVec2::ONE).min(size);
        let mut scaled = Pixmap::new(covered.x as u32, covered.y as u32)?;
        paint(session.simulation(), scale, &mut scaled.as_mut());
        let corner = ((size - covered) / 2.0).round();
        let (x, y) = (corner.x as i32, corner.y as i32);
        let copy = PixmapPaint::default();
        picture.draw_pixmap(x, y, scaled.as_ref(), &copy, Transform::identity(), None);
        Some(picture)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZES: [(f64, f64, f64); 7] = [
        (1280.0, 720.0, 1.0),
        (2560.0, 1440.0, 2.0),
        (640.0, 480.0, 1.0),
        (400.0, 300.0, 1.0),
        (320.0, 240.0, 1.5),
        (3840.0, 400.0, 1.0),
        (1.0, 1.0, 1.0),
    ];

    fn browser(size: (f64, f64, f64)) -> Browser {
        let mut browser = Browser::open(&Scene::load("gravity").unwrap());
        browser.layout = Layout::new(DVec2::new(size.0, size.1), size.2);
        browser.show_selected();
        browser
    }

    #[test]
    fn arrow_keys_reach_every_card_and_it_is_seen() {
        for size in SIZES {
            let mut browser = browser(size);
            let count = browser.cards.len();
            let mut reached = vec![false; count];
            for direction in [Direction::Up, Direction::Left, Direction::Right, Direction::Down] {
                for _ in 0..count {
                    browser.step(direction);
                    assert!(browser.seen().contains(&browser.selected), "{size:?}");
                    reached[browser.selected] = true;
                }
                if direction == Direction::Up {
                    browser.selected = browser.selected.min(count - 1);
                    for _ in 0..count {
                        browser.step(Direction::Left);
                    }
                    assert_eq!(browser.selected, 0);
                }
            }
            assert!(reached.iter().all(|&reached| reached), "{size:?}");
        }
    }

    #[test]
    fn the_middle_of_a_card_hits_it_and_what_lies_between_hits_nothing() {
        for size in &SIZES[..6] {
            let mut browser = browser(*size);
            for place in 0..browser.seen().len() {
                let layout = browser.layout;
                let corner = layout.corner(place);
                assert_eq!(browser.hit(corner + layout.card / 2.0), Some(browser.first() + place));
                assert_eq!(browser.hit(corner - layout.gap / 2.0), None);
            }
            let before = browser.selected;
            assert!(!browser.select_at(DVec2::ZERO) && browser.selected == before);
        }
    }

    #[test]
    fn pictures_are_painted_one_a_call_until_all_that_are_seen_are_there() {
        let mut browser = browser(SIZES[0]);
        let painted = |browser: &Browser| browser.cards.iter().filter(|card| card.picture.is_some()).count();
        let seen = browser.seen().len();
        for count in 1..=seen {
            let (page, missing) = browser.page(DVec2::new(1280.0, 720.0), 1.0);
            assert_eq!((painted(&browser), missing), (count, count < seen));
            assert!(page.is_some());
        }
        let (once, _) = browser.page(DVec2::new(1280.0, 720.0), 1.0);
        let (again, _) = browser.page(DVec2::new(1280.0, 720.0), 1.0);
        assert!(once == again, "nothing is painted where nothing has changed");
    }

    #[test]
    fn lists_of_any_size_are_painted_and_all_rows_can_be_scrolled_to() {
        for (x, y, scale) in SIZES {
            let mut browser = browser((x, y, scale));
            browser.page(DVec2::new(x, y), scale);
            browser.scroll(1000);
            assert_eq!(browser.seen().end, browser.cards.len(), "{x}x{y}");
            browser.page(DVec2::new(x, y), scale);
            browser.scroll(-1000);
            assert_eq!(browser.seen().start, 0);
        }
    }

    #[test]
    fn a_scene_of_ones_own_comes_first_and_is_marked_as_playing() {
        let mine = Scene::parse("mine.toml", "[[ball]]\nposition = [50, 50]\nradius = 9\n").unwrap();
        let browser = Browser::open(&mine);
        assert_eq!((browser.selected().unwrap().name(), browser.played), ("mine", Some(0)));
        assert_eq!(browser.cards.len(), scene::names().len() + 1);
    }
}
