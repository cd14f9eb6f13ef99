//! The keys: what each does, for the window to do and for the help sheet to list.

use glam::DVec2;
use winit::keyboard::{Key, ModifiersState, NamedKey};

use super::overlay::Direction;
use crate::scene::STAGES;
use crate::session::{Change, Command};
use crate::simulation::Solver;

/// What a key asks for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Action {
    /// Something for the simulation.
    Do(Command),
    /// Go back in time for as long as the key is held; a frame at a time while paused.
    Rewind,
    ToggleFigures,
    ToggleTrails,
    ToggleHelp,
    ToggleBrowser,
    ToggleRecording,
    ToggleFullscreen,
    SavePicture,
    SaveScene,
    SaveReplay,
    /// Leave what lies over the picture, or else the program.
    Leave,
}

/// What a key asks for in the list of scenes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Choice {
    /// Select the card that lies there.
    Step(Direction),
    /// Play the scene that is selected.
    Open,
    Close,
    /// What it asks for everywhere.
    Do(Action),
}

/// A key that was pressed. What it does depends on what is open when its turn comes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Stroke {
    /// What it does to what is played.
    pub(super) action: Option<Action>,
    /// What it does in the list of scenes.
    pub(super) choice: Option<Choice>,
}

/// What an arrow key with control adds to gravity, px/s²: a tenth of the Earth's, at 100 px a metre.
const TILT: f64 = 98.0;

/// What a key does, if it does anything. `repeat` is true while it is held.
pub(super) fn stroke(key: &Key, modifiers: ModifiersState, repeat: bool) -> Option<Stroke> {
    let (action, choice) = (action(key, modifiers, repeat), choice(key, modifiers, repeat));
    (action.is_some() || choice.is_some()).then_some(Stroke { action, choice })
}

/// The action of a key, if it has one. `repeat` is true while a key is held: only what can sensibly be done many times
/// over is.
fn action(key: &Key, modifiers: ModifiersState, repeat: bool) -> Option<Action> {
    let shift = modifiers.shift_key();
    let action = match key {
        // Few keys are ours with control, and those with nothing else.
        Key::Named(named) if modifiers == ModifiersState::CONTROL => tilt(*named)?,
        Key::Character(text) if modifiers.difference(ModifiersState::SHIFT) == ModifiersState::CONTROL => {
            match text.as_str() {
                "s" | "S" if shift => Action::SaveReplay,
                "s" | "S" => Action::SaveScene,
                _ => return None,
            }
        }
        _ if belong_to_others(modifiers) => return None,
        Key::Named(named) => named_key(*named, shift)?,
        Key::Character(text) => character(text, shift)?,
        _ => return None,
    };
    let repeats = matches!(
        action,
        Action::Rewind
            | Action::Do(
                Command::Step
                    | Command::StepToImpact
                    | Command::Change(Change::AddRandom(1) | Change::RemoveLast | Change::TiltGravity(_))
                    | Command::Slower
                    | Command::Faster
            )
    );
    (repeats || !repeat).then_some(action)
}

/// What a key does in the list of scenes, if anything. Held, it goes on through the cards, and does nothing else.
fn choice(key: &Key, modifiers: ModifiersState, repeat: bool) -> Option<Choice> {
    if belong_to_others(modifiers) {
        return None;
    }
    let choice = match key {
        Key::Named(NamedKey::ArrowLeft) => Choice::Step(Direction::Left),
        Key::Named(NamedKey::ArrowRight) => Choice::Step(Direction::Right),
        Key::Named(NamedKey::ArrowUp) => Choice::Step(Direction::Up),
        Key::Named(NamedKey::ArrowDown) => Choice::Step(Direction::Down),
        Key::Named(NamedKey::Enter | NamedKey::Space) => Choice::Open,
        Key::Character(text) if matches!(text.as_str(), "m" | "M") => Choice::Close,
        // Full screen, pictures and recordings are for any view; what acts on balls that nobody sees is not.
        Key::Named(NamedKey::F11 | NamedKey::F12) => Choice::Do(action(key, modifiers, repeat)?),
        Key::Character(text) if matches!(text.as_str(), "v" | "V") => {
            Choice::Do(action(key, modifiers, repeat)?)
        }
        _ => return None,
    };
    (!repeat || matches!(choice, Choice::Step(_))).then_some(choice)
}

/// Whether a key with these means something to the system, or to nobody.
fn belong_to_others(modifiers: ModifiersState) -> bool {
    modifiers.control_key() || modifiers.alt_key() || modifiers.super_key()
}

fn tilt(key: NamedKey) -> Option<Action> {
    let direction = match key {
        NamedKey::ArrowLeft => DVec2::NEG_X,
        NamedKey::ArrowRight => DVec2::X,
        NamedKey::ArrowUp => DVec2::NEG_Y,
        NamedKey::ArrowDown => DVec2::Y,
        _ => return None,
    };
    Some(Action::Do(Change::TiltGravity(TILT * direction).into()))
}

fn named_key(key: NamedKey, shift: bool) -> Option<Action> {
    Some(match key {
        NamedKey::Space => Action::Do(Command::TogglePause),
        NamedKey::ArrowRight if shift => Action::Do(Command::StepToImpact),
        NamedKey::ArrowRight => Action::Do(Command::Step),
        NamedKey::ArrowLeft => Action::Rewind,
        NamedKey::Backspace => Action::Do(Change::RemoveLast.into()),
        NamedKey::Tab if shift => Action::Do(Command::PreviousScene),
        NamedKey::Tab => Action::Do(Command::NextScene),
        NamedKey::F1 => Action::ToggleHelp,
        NamedKey::F11 => Action::ToggleFullscreen,
        NamedKey::F12 => Action::SavePicture,
        NamedKey::Escape => Action::Leave,
        _ => return None,
    })
}

fn character(text: &str, shift: bool) -> Option<Action> {
    Some(match text {
        "." => Action::Do(Command::Step),
        "r" | "R" if shift => Action::Do(Command::Reseed),
        "r" | "R" => Action::Do(Change::Reset.into()),
        // Not by the capital: Caps Lock makes one, too.
        "a" | "A" => Action::Do(Change::AddRandom(if shift { 100 } else { 1 }).into()),
        "s" | "S" if Solver::ALL.len() > 1 => Action::Do(Command::NextSolver),
        "g" | "G" => Action::Do(Change::ToggleGravity.into()),
        "[" => Action::Do(Command::Slower),
        "]" => Action::Do(Command::Faster),
        "x" | "X" => Action::Do(Command::ToggleComparison),
        "d" | "D" => Action::ToggleFigures,
        "t" | "T" => Action::ToggleTrails,
        "h" | "H" => Action::ToggleHelp,
        "m" | "M" => Action::ToggleBrowser,
        "v" | "V" => Action::ToggleRecording,
        _ => {
            let stage = text.parse::<usize>().ok().filter(|stage| (1..=STAGES).contains(stage))?;
            Action::Do(Command::Scene(stage - 1))
        }
    })
}

/// Keys that belong together, under a name: each key, and what it does.
#[derive(Debug)]
pub(super) struct Group {
    pub(super) name: &'static str,
    pub(super) keys: &'static [(&'static str, &'static str)],
}

/// The two columns of the help sheet.
pub(super) const HELP: [&[Group]; 2] = [
    &[
        Group {
            name: "Time",
            keys: &[
                ("Space", "pause, go on"),
                (". or →", "one step while paused"),
                ("Shift+→", "to the next impact (exact)"),
                ("←", "a frame back; held: rewind"),
                ("[ ]", "slower, faster"),
                ("R", "reset the scene"),
                ("Shift+R", "with other random balls"),
            ],
        },
        Group {
            name: "Balls",
            keys: &[
                ("A", "add a random ball"),
                ("Shift+A", "add a hundred"),
                ("Backspace", "remove the last"),
                ("Click", "add a ball there"),
                ("Drag", "throw it; on a ball: carry"),
                ("Right click", "remove a ball"),
                ("Wheel", "size of the next ball"),
                ("G", "gravity on, off"),
                ("Ctrl+arrow", "tilt gravity"),
            ],
        },
    ],
    &[
        Group {
            name: "View",
            keys: &[
                ("D", "figures"),
                ("X", "compare with exact"),
                ("T", "trails"),
                ("H or F1", "this help"),
                ("F11", "full screen"),
                ("F12", "save a picture"),
                ("V", "record a GIF, end it"),
            ],
        },
        Group {
            name: "Scenes",
            keys: &[
                ("M", "all scenes"),
                ("1 – 8", "the demo's stages"),
                ("Tab", "next; with Shift: previous"),
                ("S", "next solver"),
                ("Drop a file", "open a scene"),
                ("Ctrl+S", "save as a scene"),
                ("Ctrl+Shift+S", "save as a replay"),
                ("Esc", "stop, back, quit"),
            ],
        },
    ],
];

#[cfg(test)]
mod tests {
    use super::*;

    fn pressed(key: &Key, modifiers: ModifiersState) -> Option<Action> {
        action(key, modifiers, false)
    }

    #[test]
    fn digits_are_the_stages_and_nothing_else() {
        let none = ModifiersState::empty();
        assert_eq!(pressed(&Key::Character("8".into()), none), Some(Action::Do(Command::Scene(7))));
        for text in ["0", "9", "12", "-1", "q", ""] {
            assert_eq!(pressed(&Key::Character(text.into()), none), None, "{text}");
        }
    }

    #[test]
    fn a_held_key_does_not_toggle() {
        let none = ModifiersState::empty();
        assert_eq!(action(&Key::Named(NamedKey::Space), none, true), None);
        assert!(action(&Key::Named(NamedKey::ArrowRight), none, true).is_some());
        assert_eq!(action(&Key::Character("A".into()), ModifiersState::SHIFT, true), None);
    }

    #[test]
    fn in_the_list_of_scenes_what_is_held_goes_through_the_cards_and_does_not_toggle() {
        let none = ModifiersState::empty();
        let held = |key: &Key| (choice(key, none, false), choice(key, none, true));
        let step = Some(Choice::Step(Direction::Down));
        assert_eq!(held(&Key::Named(NamedKey::ArrowDown)), (step, step));
        assert_eq!(held(&Key::Character("m".into())), (Some(Choice::Close), None));
        assert_eq!(held(&Key::Named(NamedKey::Enter)), (Some(Choice::Open), None));
        assert_eq!(held(&Key::Named(NamedKey::F12)), (Some(Choice::Do(Action::SavePicture)), None));
        assert_eq!(held(&Key::Character("v".into())), (Some(Choice::Do(Action::ToggleRecording)), None));
        for key in [Key::Character("a".into()), Key::Named(NamedKey::Tab)] {
            assert_eq!(held(&key), (None, None), "{key:?}");
        }
    }

    #[test]
    fn modifiers_that_make_a_key_do_nothing_make_it_do_nothing_in_the_list_of_scenes() {
        for others in [ModifiersState::CONTROL, ModifiersState::ALT, ModifiersState::SUPER] {
            assert_eq!(stroke(&Key::Character("m".into()), others, false), None);
            assert_eq!(stroke(&Key::Named(NamedKey::Enter), others, false), None);
        }
        let capital = stroke(&Key::Character("M".into()), ModifiersState::SHIFT, false);
        assert_eq!(
            capital,
            Some(Stroke { action: Some(Action::ToggleBrowser), choice: Some(Choice::Close) })
        );
    }

    #[test]
    fn arrows_with_control_tilt_gravity_their_way_and_repeat() {
        for (key, x, y) in [
            (NamedKey::ArrowLeft, -98.0, 0.0),
            (NamedKey::ArrowRight, 98.0, 0.0),
            (NamedKey::ArrowUp, 0.0, -98.0),
            (NamedKey::ArrowDown, 0.0, 98.0),
        ] {
            let tilt = Some(Action::Do(Change::TiltGravity(DVec2::new(x, y)).into()));
            assert_eq!(action(&Key::Named(key), ModifiersState::CONTROL, true), tilt);
            assert_eq!(pressed(&Key::Named(key), ModifiersState::CONTROL), tilt);
        }
    }

    #[test]
    fn other_keys_with_control_belong_to_others() {
        assert_eq!(pressed(&Key::Character("r".into()), ModifiersState::CONTROL), None);
        assert_eq!(pressed(&Key::Named(NamedKey::Space), ModifiersState::CONTROL), None);
        for others in [ModifiersState::SHIFT, ModifiersState::ALT, ModifiersState::SUPER] {
            assert_eq!(pressed(&Key::Named(NamedKey::ArrowUp), ModifiersState::CONTROL | others), None);
        }
        assert_eq!(pressed(&Key::Named(NamedKey::ArrowRight), ModifiersState::ALT), None);
    }
}
