//! All scenes, as cards with small pictures, to choose one from.
//!
//! - `layout`: where the cards are;
//! - `page`: how they are painted.

mod layout;
mod page;

use glam::DVec2;
use tiny_skia::Pixmap;

use crate::scene::{self, Scene};
use crate::session::Session;
use crate::simulation::{Simulation, Solver};

use super::Room;
use layout::Layout;
pub(in crate::window) use page::Page;

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
    solver: Solver,
    picture: Option<Pixmap>,
}

impl Card {
    /// The card of the scene that is played, as it is now.
    fn played(scene: Scene, now: &Simulation) -> Self {
        Self { scene, balls: now.balls().len(), solver: now.solver(), picture: None }
    }
}

/// The list of scenes, while it is open.
#[derive(Debug)]
pub(in crate::window) struct Browser {
    cards: Vec<Card>,
    /// The card of the scene that is played.
    played: Option<usize>,
    selected: usize,
    /// The card under the pointer.
    pointed: Option<usize>,
    /// The first row that is shown.
    row: usize,
    /// What the wheel has turned beyond whole notches.
    turned: f64,
    layout: Layout,
    painted: Option<Page>,
}

impl Browser {
    /// The built-in scenes, and before them that which is played, where it is another, or else the user's `own`, if there is one.
    ///
    /// The card of what is played shows it as it is now: a scene of the user's own may take seconds to build once more.
    /// They have no places yet: see [`Browser::lay_out`].
    pub(in crate::window) fn open(session: &Session, own: Option<&Scene>) -> Self {
        let played = session.scene();
        let mut scenes: Vec<Scene> =
            scene::names().iter().filter_map(|name| Scene::load(name).ok()).collect();
        let same = |scene: &Scene| scene.argument() == played.argument();
        if scenes.iter().any(same) {
            scenes.splice(..0, own.cloned());
        } else {
            scenes.insert(0, played.clone());
        }
        let index = scenes.iter().position(same);
        let cards = scenes.into_iter().enumerate().map(|(place, scene)| {
            if index == Some(place) {
                return Card::played(scene, session.simulation());
            }
            let balls = scene.build().map_or(0, |simulation| simulation.balls().len());
            Card { balls, solver: scene.solver(), scene, picture: None }
        });
        Self {
            cards: cards.collect(),
            played: index,
            selected: index.unwrap_or(0),
            pointed: None,
            row: 0,
            turned: 0.0,
            layout: Layout::default(),
            painted: None,
        }
    }

    /// The file of the scene that is played was loaded again: its card stands for that.
    pub(in crate::window) fn renew(&mut self, session: &Session) {
        if let Some(card) = self.played.and_then(|played| self.cards.get_mut(played)) {
            *card = Card::played(session.scene().clone(), session.simulation());
            self.painted = None;
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

    /// Scrolls up by a row for each notch of the wheel, or down. Parts of notches add up.
    pub(in crate::window) fn turn(&mut self, notches: f64) {
        let turned = self.turned + notches;
        self.turned = turned.fract();
        if turned.abs() >= 1.0 {
            self.scroll(-turned.trunc() as i32);
        }
    }

    /// Scrolls down by so many rows, or up.
    fn scroll(&mut self, rows: i32) {
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

    /// Selects the card at this place, in pixels, and tells whether there is one.
    pub(in crate::window) fn select_at(&mut self, place: DVec2) -> bool {
        let Some(index) = self.hit(place) else { return false };
        self.selected = index;
        self.painted = None;
        true
    }

    /// The card at this place, in pixels.
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

    /// The first row that is shown when the last one is seen.
    fn last_row(&self) -> usize {
        self.cards.len().div_ceil(self.layout.columns.max(1)).saturating_sub(self.layout.rows)
    }

    /// Scrolls no farther than it takes to see the selected card.
    fn show_selected(&mut self) {
        let row = self.selected / self.layout.columns.max(1);
        let least = (row + 1).saturating_sub(self.layout.rows);
        self.row = self.row.clamp(least.min(row), row).min(self.last_row());
    }

    /// Lays the cards out in this room.
    ///
    /// Keys and clicks find them there; they may come before the list is painted.
    pub(in crate::window) fn lay_out(&mut self, room: Room) {
        let layout = Layout::new(room.picture, room.scale);
        if layout == self.layout {
            return;
        }
        if layout.picture != self.layout.picture {
            self.cards.iter_mut().for_each(|card| card.picture = None);
        }
        self.layout = layout;
        self.show_selected();
        self.painted = None;
    }

    /// The list in this room; and whether there are small pictures still to be painted: one is painted with each call.
    /// `now` is what is played.
    pub(in crate::window) fn page(&mut self, room: Room, now: &Simulation) -> (Option<Page>, bool) {
        self.lay_out(room);
        let layout = self.layout;
        let seen = self.seen();
        let cards = self.cards.iter_mut().enumerate().take(seen.end).skip(seen.start);
        let mut missing = cards.filter(|(_, card)| card.picture.is_none());
        if layout.picture.min_element() >= 1.0
            && let Some((index, card)) = missing.next()
        {
            card.picture = if self.played == Some(index) {
                page::picture(now, layout.picture)
            } else {
                card.paint(layout.picture)
            };
            self.painted = None;
        }
        let missing = layout.picture.min_element() >= 1.0 && missing.next().is_some();
        if self.painted.is_none() {
            self.painted = Page::of(self);
        }
        (self.painted.clone(), missing)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::paint::text::wrap;
    use crate::session::Change;

    const SIZES: [(f64, f64, f64); 7] = [
        (1280.0, 720.0, 1.0),
        (2560.0, 1440.0, 2.0),
        (640.0, 480.0, 1.0),
        (400.0, 300.0, 1.0),
        (320.0, 240.0, 1.5),
        (3840.0, 400.0, 1.0),
        (1.0, 1.0, 1.0),
    ];

    fn session(scene: &Scene) -> Session {
        Session::new(scene, 1).unwrap()
    }

    fn room((width, height, scale): (f64, f64, f64)) -> Room {
        Room { picture: DVec2::new(width, height), scale }
    }

    fn browser(size: (f64, f64, f64)) -> Browser {
        let mut browser = Browser::open(&session(&Scene::load("gravity").unwrap()), None);
        browser.lay_out(room(size));
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
    fn what_a_built_in_scene_is_about_is_all_on_its_card() {
        for (width, height) in [(1280.0, 720.0), (1920.0, 1080.0), (640.0, 480.0)] {
            let browser = browser((width, height, 1.0));
            for card in &browser.cards {
                let lines = wrap(&[card.scene.about()], browser.layout.characters());
                assert!(lines.len() <= layout::ABOUT_LINES, "{width}x{height}: {lines:?}");
            }
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
        let (mut browser, session) = (browser(SIZES[0]), session(&Scene::load("gravity").unwrap()));
        let now = session.simulation();
        let painted = |browser: &Browser| browser.cards.iter().filter(|card| card.picture.is_some()).count();
        let seen = browser.seen().len();
        for count in 1..=seen {
            let (page, missing) = browser.page(room(SIZES[0]), now);
            assert_eq!((painted(&browser), missing), (count, count < seen));
            assert!(page.is_some());
        }
        let (once, _) = browser.page(room(SIZES[0]), now);
        let (again, _) = browser.page(room(SIZES[0]), now);
        assert!(once == again, "nothing is painted where nothing has changed");
    }

    #[test]
    fn lists_of_any_size_are_painted_and_all_rows_can_be_scrolled_to() {
        let session = session(&Scene::load("gravity").unwrap());
        for size in SIZES {
            let mut browser = browser(size);
            browser.page(room(size), session.simulation());
            browser.scroll(1000);
            assert_eq!(browser.seen().end, browser.cards.len(), "{size:?}");
            browser.page(room(size), session.simulation());
            browser.scroll(-1000);
            assert_eq!(browser.seen().start, 0);
        }
    }

    #[test]
    fn parts_of_notches_scroll_when_they_add_up_to_a_whole_one() {
        let mut browser = browser(SIZES[2]);
        browser.scroll(-1000);
        let mut turn = |notches: f64| {
            browser.turn(notches);
            browser.row
        };
        assert_eq!([-0.25; 8].map(&mut turn), [0, 0, 0, 1, 1, 1, 1, 2]);
        assert_eq!([0.5, 0.5, -1.0].map(&mut turn), [2, 1, 2]);
        assert_eq!(turn(1e300), 0);
    }

    #[test]
    fn where_there_are_more_cards_than_are_seen_it_is_said_which_these_are() {
        let mut browser = browser(SIZES[2]);
        browser.scroll(-1000);
        let (seen, all) = (browser.seen().len(), browser.cards.len());
        assert!(seen < all);
        assert!(browser.notes().iter().all(|note| note.starts_with(&format!("1–{seen} of {all}"))));
        browser.scroll(1000);
        assert!(browser.notes().iter().all(|note| note.contains(&format!("–{all} of {all}"))));
        browser.layout = Layout::new(DVec2::new(4000.0, 3000.0), 1.0);
        browser.row = 0;
        assert!(browser.notes().iter().all(|note| !note.contains(" of ")));
    }

    #[test]
    fn a_window_for_one_card_says_which_of_all_it_is() {
        let browser = browser((260.0, 200.0, 1.0));
        let count = browser.cards.len();
        assert_eq!(browser.seen().len(), 1);
        let said = format!("{} of {count}", browser.seen().end);
        assert!(browser.notes().iter().all(|note| note.starts_with(&said)), "{:?}", browser.notes());
    }

    #[test]
    fn a_scene_of_ones_own_comes_first_and_is_marked_as_playing() {
        let mine = Scene::parse("mine.toml", "[[ball]]\nposition = [50, 50]\nradius = 9\n").unwrap();
        let browser = Browser::open(&session(&mine), None);
        assert_eq!((browser.selected().unwrap().name(), browser.played), ("mine", Some(0)));
        assert_eq!(browser.cards.len(), scene::names().len() + 1);
    }

    #[test]
    fn the_card_of_what_is_played_shows_it_as_it_is_now() {
        let mine = Scene::parse("mine.toml", "[[ball]]\nposition = [50, 50]\nradius = 9\n").unwrap();
        let mut session = session(&mine);
        let browser = Browser::open(&session, None);
        assert_eq!((browser.cards[0].balls, browser.cards[0].solver), (1, mine.solver()));
        session.apply(Change::AddRandom(30).into()).unwrap();
        session.apply(Change::Solver(Solver::Contact).into()).unwrap();
        let mut browser = Browser::open(&session, None);
        assert_eq!((browser.cards[0].balls, browser.cards[0].solver), (31, Solver::Contact));
        browser.page(room(SIZES[0]), session.simulation());
        assert_eq!(browser.cards[0].picture, page::picture(session.simulation(), browser.layout.picture));
    }
}
