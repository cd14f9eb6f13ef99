//! What was asked for faster than it can be done.

use std::collections::VecDeque;

use super::keys::Action;
use crate::session::{Change, Command};

/// The most that may wait: more than anybody types.
const MOST: usize = 1 << 14;

/// Actions that wait for their turn, in order.
#[derive(Debug, Default)]
pub(super) struct Waiting {
    actions: VecDeque<Action>,
}

impl Waiting {
    /// Lets an action wait, and tells whether there is room for it. Where it begins a scene, it is pointless to add
    /// balls before: those that wait to be added or taken away are forgotten.
    pub(super) fn push(&mut self, action: Action) -> bool {
        let begins = matches!(
            action,
            Action::Do(
                Command::Change(Change::Reset)
                    | Command::Reseed
                    | Command::Scene(_)
                    | Command::NextScene
                    | Command::PreviousScene
            )
        );
        if begins {
            self.actions.retain(|waiting| {
                !matches!(
                    waiting,
                    Action::RemoveAt(_)
                        | Action::Do(Command::Change(
                            Change::AddRandom(_)
                                | Change::AddBall { .. }
                                | Change::RemoveLast
                                | Change::Place { .. }
                        ))
                )
            });
        }
        let room = self.actions.len() < MOST;
        if room {
            self.actions.push_back(action);
        }
        room
    }

    pub(super) fn pop(&mut self) -> Option<Action> {
        self.actions.pop_front()
    }

    pub(super) fn is_empty(&self) -> bool {
        self.actions.is_empty()
    }

    pub(super) fn clear(&mut self) {
        self.actions.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ADD: Action = Action::Do(Command::Change(Change::AddRandom(100)));

    #[test]
    fn what_waits_is_done_in_its_order() {
        let mut waiting = Waiting::default();
        let asked = [ADD, Action::SavePicture, Action::Do(Command::Faster), ADD];
        for action in asked {
            assert!(waiting.push(action));
        }
        assert_eq!(std::iter::from_fn(|| waiting.pop()).collect::<Vec<_>>(), asked);
        assert!(waiting.is_empty());
    }

    #[test]
    fn a_scene_that_begins_leaves_out_the_balls_before_it_and_nothing_else() {
        let mut waiting = Waiting::default();
        let reset = Action::Do(Change::Reset.into());
        for action in [ADD, Action::SaveScene, ADD, Action::Do(Command::Slower), reset, ADD] {
            waiting.push(action);
        }
        let left: Vec<_> = std::iter::from_fn(|| waiting.pop()).collect();
        assert_eq!(left, [Action::SaveScene, Action::Do(Command::Slower), reset, ADD]);
    }

    #[test]
    fn what_waits_is_bounded() {
        let mut waiting = Waiting::default();
        let taken = (0..2 * MOST).filter(|_| waiting.push(ADD)).count();
        assert_eq!(taken, MOST);
        assert!(!waiting.push(Action::ToggleHelp));
        // Room again.
        waiting.pop();
        assert!(waiting.push(Action::ToggleHelp));
    }
}
