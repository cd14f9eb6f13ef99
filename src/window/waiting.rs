//! What was asked for faster than it can be done.

use std::collections::VecDeque;
use std::path::PathBuf;

use glam::DVec2;
use winit::event::{ElementState, MouseButton};

use super::keys::{Action, Stroke};
use crate::session::{Change, Command};

/// The most that may wait: more than anybody types.
const MOST: usize = 1 << 14;

/// What was asked for. What it is for is known when its turn comes: what comes before may open something, or close it.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Input {
    Key(Stroke),
    Button(Press),
    /// A file was dropped on the window.
    File(PathBuf),
    /// The wheel was turned by so many notches.
    Wheel(f64),
    /// What is held, or about to be thrown, is to be dropped.
    Drop,
}

/// A button of the mouse that went down, or up.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Press {
    pub(super) button: MouseButton,
    pub(super) state: ElementState,
    /// Where the pointer was, in pixels.
    pub(super) pixel: DVec2,
    /// Where that was in the world, px; none where the pointer was not over the window.
    pub(super) place: Option<DVec2>,
}

/// What waits for its turn, in order.
#[derive(Debug, Default)]
pub(super) struct Waiting {
    inputs: VecDeque<Input>,
}

impl Waiting {
    /// Lets something wait, and tells whether there is room for it. Where it begins a scene, it is pointless to add
    /// balls before: keys that wait to do so are forgotten.
    pub(super) fn push(&mut self, input: Input) -> bool {
        if begins_scene(&input) {
            self.forget_balls();
        }
        let room = self.inputs.len() < MOST;
        if room {
            self.inputs.push_back(input);
        }
        room
    }

    /// Forgets keys that add or remove balls, for a key that begins a scene. Not those before something is saved, which
    /// shows them, or before the list of scenes, where that key does nothing. Clicks stay, which may choose a scene, or
    /// drag on when that has begun.
    fn forget_balls(&mut self) {
        let needed = self.inputs.iter().rposition(needs_balls).map_or(0, |index| index + 1);
        let mut index = 0..;
        self.inputs.retain(|input| index.next() < Some(needed) || !changes_balls(input));
    }

    pub(super) fn pop(&mut self) -> Option<Input> {
        self.inputs.pop_front()
    }

    pub(super) fn is_empty(&self) -> bool {
        self.inputs.is_empty()
    }

    pub(super) fn clear(&mut self) {
        self.inputs.clear();
    }
}

/// What a key does to what is played.
fn action(input: &Input) -> Option<Action> {
    match input {
        Input::Key(stroke) => stroke.action,
        Input::Button(_) | Input::File(_) | Input::Wheel(_) | Input::Drop => None,
    }
}

fn begins_scene(input: &Input) -> bool {
    matches!(
        action(input),
        Some(Action::Do(
            Command::Change(Change::Reset)
                | Command::Reseed
                | Command::Scene(_)
                | Command::NextScene
                | Command::PreviousScene
        ))
    )
}

fn changes_balls(input: &Input) -> bool {
    matches!(action(input), Some(Action::Do(Command::Change(Change::AddRandom(_) | Change::RemoveLast))))
}

/// Whether it makes a difference which balls there are when its turn comes, whatever comes after.
fn needs_balls(input: &Input) -> bool {
    matches!(
        action(input),
        Some(
            Action::ToggleBrowser
                | Action::ToggleRecording
                | Action::SavePicture
                | Action::SaveScene
                | Action::SaveReplay
        )
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    const ADD: Action = Action::Do(Command::Change(Change::AddRandom(100)));
    const RESET: Action = Action::Do(Command::Change(Change::Reset));

    fn key(action: Action) -> Input {
        Input::Key(Stroke { action: Some(action), choice: None })
    }

    /// What is left to do of these, one after the other.
    fn left(asked: &[Action]) -> Vec<Action> {
        let mut waiting = Waiting::default();
        for &action in asked {
            assert!(waiting.push(key(action)));
        }
        std::iter::from_fn(|| waiting.pop()).map(|input| action(&input).unwrap()).collect()
    }

    #[test]
    fn what_waits_is_done_in_its_order() {
        let asked = [ADD, Action::SavePicture, Action::Do(Command::Faster), ADD];
        assert_eq!(left(&asked), asked);
    }

    #[test]
    fn a_scene_that_begins_leaves_out_the_balls_before_it_and_nothing_else() {
        let slower = Action::Do(Command::Slower);
        assert_eq!(left(&[ADD, slower, ADD, RESET, ADD]), [slower, RESET, ADD]);
    }

    #[test]
    fn balls_before_something_that_is_saved_are_added_for_that() {
        for save in [Action::SavePicture, Action::SaveScene, Action::SaveReplay, Action::ToggleRecording] {
            assert_eq!(left(&[ADD, save, ADD, RESET]), [ADD, save, RESET]);
        }
    }

    #[test]
    fn balls_before_the_list_of_scenes_are_added_since_a_key_that_would_begin_a_scene_may_do_nothing_there() {
        let list = Action::ToggleBrowser;
        assert_eq!(left(&[ADD, list, ADD, RESET, ADD]), [ADD, list, RESET, ADD]);
    }

    #[test]
    fn what_waits_is_bounded() {
        let mut waiting = Waiting::default();
        let taken = (0..2 * MOST).filter(|_| waiting.push(key(ADD))).count();
        assert_eq!(taken, MOST);
        assert!(!waiting.push(key(Action::ToggleHelp)));
        // Room again.
        waiting.pop();
        assert!(waiting.push(key(Action::ToggleHelp)));
    }
}
