//! What was played, so that it can be gone back to and played again.
//!
//! A tape holds every frame and every change since the scene began, and every so often the whole state: a *key*. Any
//! moment between is played again from the key before it, and comes to the same bits, since what was done is done again
//! in the same order, frames that were cut short being cut short at the same place.

use std::collections::VecDeque;
use std::num::NonZeroU32;

use super::ROUNDING;
use super::command::Change;
use super::state::State;
use super::thin::every_second;

/// Entries between two keys at first.
const SPACING: usize = 64;
/// Memory for keys, in bytes, about ...
const MOST_BYTES: usize = 256 << 20;
/// ... and one part in so many of that for those between two keys, close to where one goes back.
const FINE_PART: usize = 4;
/// How far back one can go at least, in seconds as they were watched: where memory is short, older keys are forgotten.
const KEPT: f64 = 40.0;
/// The part of a frame that must be gone back for it to show.
const SEEN: f64 = 0.1;
/// The most entries that are kept: more than four hours at 60 frames per second, 34 MB.
const MOST_ENTRIES: usize = 1 << 20;

/// What happened.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Entry {
    Frame(Frame),
    /// In a box, since there are few of them and they are large.
    Change(Box<Change>),
}

/// A frame that took place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Frame {
    /// The seconds that it was asked to move on by.
    pub(super) seconds: f64,
    /// Where it was cut short: the number, from 1, of the call of `go_on` that said no.
    pub(super) cut: Option<NonZeroU32>,
}

impl Frame {
    /// Advances a state by up to `seconds`, for as long as `go_on` says so: the frame that took place, and the seconds
    /// that it moved on.
    pub(super) fn take(
        state: &mut State,
        seconds: f64,
        mut go_on: impl FnMut() -> bool,
    ) -> Result<(Self, f64), crate::OutOfRange> {
        let (mut looks, mut cut) = (0_u32, None);
        state.begin_frame();
        let done = state.advance(seconds, &mut || {
            looks = looks.saturating_add(1);
            if cut.is_none() && !go_on() {
                cut = NonZeroU32::new(looks);
            }
            cut.is_none()
        })?;
        Ok((Self { seconds, cut }, done))
    }

    /// Takes place once more.
    pub(super) fn repeat(self, state: &mut State) -> Result<f64, crate::OutOfRange> {
        let mut looks = 0_u32;
        let last = self.cut.map_or(u32::MAX, NonZeroU32::get);
        Self::take(state, self.seconds, || {
            looks = looks.saturating_add(1);
            looks < last
        })
        .map(|(_, done)| done)
    }
}

/// An entry of a tape.
#[derive(Debug)]
pub(super) struct Taken {
    pub(super) entry: Entry,
    /// The seconds that it moved on: fewer than asked for where a frame was cut short.
    pub(super) done: f64,
}

impl Entry {
    /// Happens once more.
    fn repeat(&self, state: &mut State) {
        // What could not be done, or in part only, could not be done then.
        match self {
            Self::Frame(frame) => drop(frame.repeat(state)),
            Self::Change(change) => drop(state.apply(**change)),
        }
    }

    fn is_frame(&self) -> bool {
        matches!(self, Self::Frame(_))
    }
}

/// The state when so many entries since the beginning had happened.
#[derive(Debug)]
struct Key {
    at: usize,
    /// The seconds that had been watched until then.
    watched: f64,
    state: State,
}

/// The tape. Places on it are counted in entries since the scene began.
#[derive(Debug)]
pub(super) struct Tape {
    entries: VecDeque<Taken>,
    /// The place of the first entry that is kept.
    first: usize,
    /// The place of the present.
    at: usize,
    /// In order; never empty. The first is as far back as one can go.
    keys: VecDeque<Key>,
    /// Between two keys: where one goes back frame by frame.
    fine: Vec<Key>,
    /// Entries between two keys, at least.
    spacing: usize,
    /// The seconds that have been watched since the scene began.
    watched: f64,
}

impl Tape {
    /// A tape that begins with this state.
    pub(super) fn new(state: &State) -> Self {
        let key = Key { at: 0, watched: 0.0, state: state.clone() };
        Self {
            entries: VecDeque::new(),
            first: 0,
            at: 0,
            keys: VecDeque::from([key]),
            fine: Vec::new(),
            spacing: SPACING,
            watched: 0.0,
        }
    }

    /// Everything since the scene began; `None` where that is too long ago.
    pub(super) fn whole(&self) -> Option<impl Iterator<Item = &Entry>> {
        (self.first == 0).then(|| self.entries.iter().take(self.at).map(|taken| &taken.entry))
    }

    /// Whether one can go back to where the scene began.
    pub(super) fn reaches_start(&self) -> bool {
        self.keys.front().is_some_and(|key| key.at == 0)
    }

    /// The entry that comes next, where the present is not the end of the tape.
    pub(super) fn next(&self) -> Option<&Taken> {
        self.entries.get(self.at - self.first)
    }

    /// Simulated seconds from the present to the end of the tape.
    pub(super) fn left(&self) -> f64 {
        // The sum of nothing is -0, which would be shown.
        self.entries.range(self.at - self.first..).fold(0.0, |left, taken| left + taken.done)
    }

    /// Adds what has happened in the present, and led to `state`; what came after it before is forgotten. `watched` are
    /// the seconds for which the frame is seen.
    pub(super) fn add(&mut self, taken: Taken, watched: f64, state: &State) {
        self.cut_off_future();
        let is_frame = taken.entry.is_frame();
        self.entries.push_back(taken);
        self.at += 1;
        self.watched += watched;
        let last = self.keys.back().map_or(0, |key| key.at);
        if is_frame && self.at >= last + self.spacing {
            self.keys.push_back(Key { at: self.at, watched: self.watched, state: state.clone() });
            self.forget();
        }
        if self.entries.len() > MOST_ENTRIES {
            // From the first key on all can still be gone back to; a replay from the beginning cannot be had any more.
            let reached = self.keys.front().map_or(self.at, |key| key.at).max(self.first + 1);
            self.entries.drain(..reached - self.first);
            self.first = reached;
            self.keys.retain(|key| key.at >= reached);
            if self.keys.is_empty() {
                self.keys.push_back(Key { at: self.at, watched: self.watched, state: state.clone() });
                self.entries.clear();
                self.first = self.at;
            }
        }
    }

    fn cut_off_future(&mut self) {
        let future = self.entries.drain(self.at - self.first..).count();
        self.keys.retain(|key| key.at <= self.at);
        if let Some(key) = self.keys.back().filter(|_| future > 0) {
            // At least so long: how long single frames were watched is not kept.
            self.watched = key.watched;
        }
        self.fine.clear();
    }

    /// Keeps to the memory that keys may take: the oldest go as long as one can then still go back far enough, and else
    /// every second.
    fn forget(&mut self) {
        let bytes = |keys: &VecDeque<Key>| keys.iter().map(|key| key.state.bytes()).sum::<usize>();
        while self.keys.len() > 2 && bytes(&self.keys) > MOST_BYTES {
            if self.watched - self.keys[1].watched > KEPT {
                self.keys.pop_front();
                continue;
            }
            let last = self.keys.pop_back();
            self.keys.retain(every_second());
            self.keys.extend(last);
            self.spacing *= 2;
        }
    }

    /// Plays the next entry, where the present is not the end of the tape.
    pub(super) fn play(&mut self, state: &mut State) {
        if let Some(taken) = self.next() {
            taken.entry.repeat(state);
            self.at += 1;
        }
    }

    /// The way to the end of the frame before the present, or to before the changes since; or further, until that is so many
    /// simulated seconds ago. `None` where that is not remembered, or there is none.
    ///
    /// At once, since frames that hardly moved on took as long as others, and each that is gone back takes some of them again. Of
    /// those that were cut short, it goes back by so many that it shows.
    pub(super) fn back(&mut self, seconds: f64) -> Option<Way> {
        let oldest = self.keys.front()?.at;
        let (mut passed, mut shows, mut to) = (0.0, false, None);
        for at in (oldest..self.at).rev().filter(|&at| at > self.first) {
            let Taken { entry, done } = &self.entries[at - self.first];
            passed += done;
            shows |= match entry {
                Entry::Frame(Frame { seconds, cut: Some(_) }) => passed >= SEEN * seconds,
                Entry::Frame(_) | Entry::Change(_) => true,
            };
            if self.entries[at - 1 - self.first].entry.is_frame() {
                to = Some(at);
                if shows && passed >= seconds - ROUNDING {
                    break;
                }
            }
        }
        Some(self.way(to?))
    }

    /// The way to a place that is not before the first key: from the key before it.
    fn way(&mut self, to: usize) -> Way {
        let before = |key: &&Key| key.at <= to;
        let coarse = self.keys.iter().rev().find(before);
        let fine = self.fine.iter().filter(before).max_by_key(|key| key.at);
        let nearest = coarse.into_iter().chain(fine).max_by_key(|key| key.at).unwrap_or(&self.keys[0]);
        let (from, state) = (nearest.at, nearest.state.clone());
        if to - from > SPACING / 4 {
            self.fine.clear();
        }
        Way { from, at: from, to, state }
    }

    /// Goes a way for as long as `go_on` says so, at least by one entry; whether it is at its end, where the present is
    /// then.
    pub(super) fn go(&mut self, way: &mut Way, go_on: &mut dyn FnMut() -> bool) -> bool {
        // Keys on the way, as many as there are entries between two of them: going on backwards costs as little.
        let gap = ((way.to - way.from) as f64).sqrt().ceil().max(1.0) as usize;
        let most = MOST_BYTES / FINE_PART / way.state.bytes();
        while way.at < way.to {
            self.entries[way.at - self.first].entry.repeat(&mut way.state);
            way.at += 1;
            let done = way.at - way.from;
            if done.is_multiple_of(gap) && way.at < way.to && self.fine.len() < most {
                self.fine.push(Key { at: way.at, watched: 0.0, state: way.state.clone() });
            }
            if way.at < way.to && !go_on() {
                return false;
            }
        }
        self.at = way.to;
        true
    }
}

/// On the way back to a place on a tape, from a key before it.
#[derive(Debug)]
pub(super) struct Way {
    from: usize,
    at: usize,
    to: usize,
    /// The state at `at`.
    pub(super) state: State,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Scene;

    /// The state a frame before, and the present there.
    fn back(tape: &mut Tape) -> Option<State> {
        let mut way = tape.back(0.0)?;
        assert!(tape.go(&mut way, &mut || true));
        Some(way.state)
    }

    fn going(tape: &mut Tape, to: usize) -> State {
        let mut way = tape.way(to);
        assert!(tape.go(&mut way, &mut || true));
        way.state
    }

    fn recorded(frames: usize) -> (Tape, State, Vec<Vec<crate::Ball>>) {
        let mut state = State::new(&Scene::load("gravity").unwrap(), 1).unwrap();
        let mut tape = Tape::new(&state);
        let mut shown = Vec::new();
        for _ in 0..frames {
            let (frame, done) = Frame::take(&mut state, 1.0 / 60.0, || true).unwrap();
            tape.add(Taken { entry: Entry::Frame(frame), done }, 1.0 / 60.0, &state);
            shown.push(state.simulation.balls().to_vec());
        }
        (tape, state, shown)
    }

    #[test]
    fn going_back_shows_every_frame_again_to_the_first() {
        let (mut tape, _, shown) = recorded(300);
        for expected in shown.iter().rev().skip(1) {
            assert_eq!(back(&mut tape).unwrap().simulation.balls(), expected);
        }
        // The state before the first frame is no frame.
        assert!(back(&mut tape).is_none() && tape.reaches_start());
        let mut state = going(&mut tape, 1);
        for expected in &shown[1..] {
            tape.play(&mut state);
            assert_eq!(state.simulation.balls(), expected);
        }
        assert!(tape.next().is_none());
        tape.keys.pop_front();
        assert!(!tape.reaches_start(), "what was before the second key is forgotten");
    }

    #[test]
    fn a_way_back_that_is_gone_bit_by_bit_ends_in_the_same_state() {
        let (mut tape, _, shown) = recorded(100);
        for _ in 0..30 {
            back(&mut tape);
        }
        // From the key at 64 to 69, by an entry each time.
        let mut way = tape.back(0.0).unwrap();
        tape.fine.clear();
        way = Way { state: tape.keys[1].state.clone(), from: 64, at: 64, to: way.to };
        let mut parts = 1;
        while !tape.go(&mut way, &mut || false) {
            assert_eq!(tape.at, 70, "the present stays until the way is gone");
            parts += 1;
        }
        assert_eq!((parts, tape.at), (5, 69));
        assert_eq!(way.state.simulation.balls(), shown[68]);
    }

    #[test]
    fn what_was_watched_and_then_undone_does_not_count_as_watched() {
        let (mut tape, ..) = recorded(300);
        let mut state = going(&mut tape, 130);
        let (frame, done) = Frame::take(&mut state, 0.5, || true).unwrap();
        tape.add(Taken { entry: Entry::Frame(frame), done }, 0.5, &state);
        // The key before is at 128.
        assert!((tape.watched - (128.0 / 60.0 + 0.5)).abs() < 1e-9, "{}", tape.watched);
    }

    #[test]
    fn what_happens_in_the_past_takes_the_place_of_what_came_after_it() {
        let (mut tape, _, shown) = recorded(100);
        for _ in 0..40 {
            back(&mut tape);
        }
        assert!((tape.left() - 40.0 / 60.0).abs() < 1e-9);
        let mut state = going(&mut tape, 60);
        state.apply(Change::RemoveLast).unwrap();
        tape.add(Taken { entry: Entry::Change(Box::new(Change::RemoveLast)), done: 0.0 }, 0.0, &state);
        assert_eq!((tape.left(), tape.whole().unwrap().count()), (0.0, 61));
        // Taking a change back is a step of its own.
        assert_eq!(back(&mut tape).unwrap().simulation.balls(), shown[59]);
        assert_eq!(back(&mut tape).unwrap().simulation.balls(), shown[58]);
    }

    #[test]
    fn keys_keep_to_their_memory_and_reach_back_far_enough_all_the_same() {
        let (mut tape, state, _) = recorded(1);
        let mut large = state.clone();
        large.apply(Change::AddRandom(3000)).ok();
        let frame = Frame { seconds: 0.0, cut: None };
        let watched = 1.0 / 60.0;
        for _ in 0..60 * 120 {
            tape.add(Taken { entry: Entry::Frame(frame), done: 0.0 }, watched, &large);
        }
        let bytes: usize = tape.keys.iter().map(|key| key.state.bytes()).sum();
        assert!(bytes <= MOST_BYTES, "{bytes}");
        let reach = tape.watched - tape.keys[0].watched;
        assert!(reach >= KEPT, "{reach}");
        assert!(tape.keys.iter().zip(tape.keys.iter().skip(1)).all(|(one, next)| one.at < next.at));
    }

    #[test]
    fn a_step_back_from_where_time_stood_still_goes_on_to_where_it_moved() {
        let (mut tape, state, shown) = recorded(100);
        let stall = |tape: &mut Tape, done: f64| {
            let entry = Entry::Frame(Frame { seconds: 1.0 / 60.0, cut: NonZeroU32::new(1) });
            tape.add(Taken { entry, done }, 1.0 / 60.0, &state);
        };
        for _ in 0..10 {
            stall(&mut tape, 0.0);
        }
        assert_eq!(back(&mut tape).unwrap().simulation.balls(), shown[98]);
        assert_eq!(tape.at, 99);
        // What moved at all is gone back once it amounts to something: here, a tenth of a frame in five.
        let mut state = going(&mut tape, 99);
        tape.play(&mut state);
        for _ in 0..10 {
            stall(&mut tape, 0.021 / 60.0);
        }
        back(&mut tape);
        assert_eq!(tape.at, 105);
        // A change is taken back, however little time went by since.
        tape.add(Taken { entry: Entry::Change(Box::new(Change::RemoveLast)), done: 0.0 }, 0.0, &state);
        stall(&mut tape, 0.0);
        back(&mut tape);
        assert_eq!(tape.at, 105);
    }

    #[test]
    fn a_frame_that_was_cut_short_is_cut_short_again_at_the_same_place() {
        let scene = Scene::load("pile").unwrap().with_solver(crate::Solver::Contact);
        let mut state = State::new(&scene, 1).unwrap();
        let mut again = state.clone();
        let mut left = 2;
        let (frame, done) = Frame::take(&mut state, 0.1, || {
            left -= 1;
            left > 0
        })
        .unwrap();
        assert!(frame.cut.is_some() && done < 0.1);
        assert_eq!(frame.repeat(&mut again).unwrap(), done);
        assert_eq!(state.simulation.balls(), again.simulation.balls());
    }
}
