//! Keys, the mouse and files, and what they do.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use glam::DVec2;
use winit::dpi::PhysicalPosition;
use winit::event::{ElementState, KeyEvent, MouseButton, MouseScrollDelta};
use winit::event_loop::ActiveEventLoop;
use winit::keyboard::{Key, ModifiersState, NamedKey};
use winit::window::Fullscreen;

use super::super::keys::{self, Action, Choice, Stroke};
use super::super::overlay::{Browser, Gauge, help_pages};
use super::super::record::Recorder;
use super::super::waiting::{Input, Press};
use super::super::watch::Watch;
use super::super::{Options, words};
use super::{App, Rewinding};
use crate::paint::trails::Trails;
use crate::scene::Scene;
use crate::session::{Change, Command};

/// How long it is shown where gravity pulls, once it has changed.
const GRAVITY_SHOWN: Duration = Duration::from_secs(3);
/// For so long, in wall-clock time, what keys ask for is done before the next frame; more waits for the one after.
const LONGEST_ACT: Duration = Duration::from_millis(25);
/// For so long after something took its time, Escape is still meant to stop that, and does not end the program.
const LATE: Duration = Duration::from_millis(700);
/// For so long after a click chose a scene, another is the second half of a double click, and not for the scene.
const DOUBLE_CLICK: Duration = Duration::from_millis(500);
/// Pixels of a smooth wheel that count as one notch.
const NOTCH: f64 = 40.0;

impl App {
    /// From now on nobody tells which keys and buttons are held.
    pub(super) fn lose_focus(&mut self) {
        self.modifiers = ModifiersState::empty();
        self.stop_rewinding();
        // That takes no time: it waits only for a press that came before, or Escape would be taken to stop it.
        if self.waiting.is_empty() {
            self.hands.drop_all();
        } else {
            self.ask(Input::Drop, false);
        }
    }

    pub(super) fn stop_rewinding(&mut self) {
        (self.rewinding, self.rewind_held) = (Rewinding::No, false);
    }

    pub(super) fn key(&mut self, event_loop: &ActiveEventLoop, event: &KeyEvent) {
        if event.state != ElementState::Pressed {
            if event.logical_key == Key::Named(NamedKey::ArrowLeft) {
                self.stop_rewinding();
            }
            return;
        }
        let Some(stroke) = keys::stroke(&event.logical_key, self.modifiers, event.repeat) else { return };
        // What stops others does not wait for them.
        if stroke.action != Some(Action::Leave) {
            self.ask(Input::Key(stroke), event.repeat);
        } else if self.leave(Instant::now()) {
            event_loop.exit();
        }
    }

    /// Does what is asked for, now or, where there is no time left for it or something else waits, before long. Where a
    /// key just goes on being held, it is left out instead: what waited would go on after the key was released.
    pub(super) fn ask(&mut self, input: Input, repeat: bool) {
        self.rewind_held |= matches!(input, Input::Key(Stroke { action: Some(Action::Rewind), .. }));
        if self.waiting.is_empty() && self.has_time() {
            self.obey(input);
        } else if !repeat && !self.waiting.push(input) {
            self.complain("this is more than can be done: some keys were left out".to_owned());
        }
    }

    /// Does what waits, as far as there is time.
    pub(super) fn catch_up(&mut self) {
        let start = Instant::now();
        while !self.session.is_working() && start.elapsed() < LONGEST_ACT {
            let Some(input) = self.waiting.pop() else { return };
            self.obey(input);
        }
    }

    /// Does what was asked for, to what is open now that its turn has come.
    fn obey(&mut self, input: Input) {
        let in_list = self.browser.is_some();
        match input {
            Input::Key(Stroke { choice: Some(choice), .. }) if in_list => self.browse(choice),
            Input::Key(Stroke { action: Some(action), .. }) if !in_list => self.act(action),
            Input::Key(_) => {}
            Input::Button(press) if in_list => self.press_card(press),
            Input::Button(press) => self.press_ball(press),
            Input::File(path) => self.open_file(&path),
            Input::Wheel(notches) => self.turn(notches),
            Input::Drop => self.hands.drop_all(),
        }
        self.request_redraw();
    }

    /// Whether something may be done at once: this turn of the event loop has not taken long yet, and the session is
    /// not busy.
    fn has_time(&self) -> bool {
        !self.session.is_working() && self.turn.own(Instant::now()) < LONGEST_ACT
    }

    /// Leaves what is under way, or what lies over the picture; whether that was nothing, so that the program is left.
    pub(super) fn leave(&mut self, now: Instant) -> bool {
        if self.browser.is_some() {
            // What waits came before, and was for the list or for what it would have opened.
            self.waiting.clear();
            self.close_browser();
            self.request_redraw();
        } else if self.is_busy() {
            self.session.stop_working();
            self.waiting.clear();
            // The release of what is held may have waited, too.
            self.hands.drop_all();
            self.say("stopped".to_owned());
        } else if self.hands.are_busy() {
            self.hands.drop_all();
            self.request_redraw();
        } else if self.help {
            self.help = false;
            self.request_redraw();
        } else if self.records_next || self.recorder.as_ref().is_some_and(Recorder::is_recording) {
            self.toggle_recording();
        } else {
            // What the key was to stop may just have ended.
            return self.busy.is_none_or(|at| now.saturating_duration_since(at) > LATE);
        }
        false
    }

    /// Whether something that was asked for is not done yet.
    pub(super) fn is_busy(&self) -> bool {
        self.session.is_working() || !self.waiting.is_empty()
    }

    fn act(&mut self, action: Action) {
        match action {
            Action::Do(command) => self.apply(command),
            Action::Rewind if self.session.is_paused() => self.apply(Command::Back),
            Action::Rewind if self.rewind_held && self.rewinding == Rewinding::No => {
                // Balls may not have been there.
                self.hands.let_go();
                self.rewinding = Rewinding::Back;
            }
            Action::ToggleHelp => {
                let pages = self.room().map_or(1, help_pages);
                let more = self.help && self.help_page + 1 < pages;
                self.help_page = if more { self.help_page + 1 } else { 0 };
                self.help = more || !self.help;
                self.messages.end_hint();
                // The release would act behind it.
                self.hands.drop_all();
            }
            Action::ToggleTrails => {
                self.trails = if self.trails.is_some() { None } else { Some(Trails::default()) };
                self.painter.forget();
                let on = if self.trails.is_some() { "on" } else { "off" };
                self.say(format!("trails {on}"));
            }
            Action::ToggleBrowser => self.open_browser(),
            Action::ToggleFigures => {
                self.gauge = if self.gauge.is_some() { None } else { Some(Gauge::default()) };
            }
            Action::ToggleFullscreen => self.toggle_fullscreen(),
            Action::SavePicture => self.save_picture(),
            Action::SaveScene => self.save_scene(),
            Action::SaveReplay => self.save_replay(),
            Action::ToggleRecording => self.toggle_recording(),
            // Time runs back already, or the key was released before its turn came; to leave is done before it comes here.
            Action::Rewind | Action::Leave => {}
        }
    }

    /// Shows all scenes; time stands still meanwhile.
    pub(super) fn open_browser(&mut self) {
        let mut browser = Browser::open(&self.session, self.own.as_ref());
        if let Some(room) = self.room() {
            // What comes before the first picture of the list is for it all the same.
            browser.lay_out(room);
        }
        self.browser = Some(browser);
        self.help = false;
        self.messages.end_hint();
        // The cards would take the button's release.
        self.hands.drop_all();
        self.stop_clock();
    }

    pub(super) fn close_browser(&mut self) {
        self.browser = None;
        self.painter.forget();
        self.stop_clock();
    }

    /// Does what a key asks for in the list of scenes.
    fn browse(&mut self, choice: Choice) {
        match (choice, &mut self.browser) {
            (Choice::Step(direction), Some(browser)) => browser.step(direction),
            (Choice::Step(_), None) => {}
            (Choice::Open, _) => self.open_selected(),
            (Choice::Close, _) => self.close_browser(),
            (Choice::Do(action), _) => self.act(action),
        }
    }

    pub(super) fn open_selected(&mut self) {
        if let Some(scene) = self.browser.as_ref().and_then(Browser::selected).cloned() {
            self.close_browser();
            self.open_scene(&scene);
        }
    }

    pub(super) fn apply(&mut self, command: Command) {
        let was_paused = self.session.is_paused();
        let start = Instant::now();
        match self.session.apply_while(command, || start.elapsed() < LONGEST_ACT) {
            Ok(()) => self.tell_done(command),
            Err(error) => self.complain(error.to_string()),
        }
        let keeps_balls = matches!(
            command,
            Command::TogglePause
                | Command::Step
                | Command::StepToImpact
                | Command::Slower
                | Command::Faster
                | Command::NextSolver
                | Command::ToggleComparison
                | Command::Change(
                    Change::AddRandom(_)
                        | Change::AddBall { .. }
                        | Change::ToggleGravity
                        | Change::TiltGravity(_)
                )
        );
        if !keeps_balls {
            self.hands.let_go();
        }
        // A frame that was painted while paused has started the clock again.
        if was_paused || self.session.is_paused() {
            self.stop_clock();
        }
        self.set_title();
    }

    /// Tells what a command did, and follows it where it plays another scene.
    fn tell_done(&mut self, command: Command) {
        if matches!(command, Command::Scene(_) | Command::NextScene | Command::PreviousScene) {
            self.watch = watch(self.session.scene(), &self.options);
        }
        let Some(text) = words::done(command, &self.session) else { return };
        if matches!(command, Command::Change(Change::ToggleGravity | Change::TiltGravity(_))) {
            self.gravity_until = Some(Instant::now() + GRAVITY_SHOWN);
            self.entitle(text);
        } else {
            self.say(text);
        }
    }

    /// A file was dropped on the window.
    pub(super) fn drop_file(&mut self, path: PathBuf) {
        self.ask(Input::File(path), false);
    }

    /// Plays the scene file at this path.
    fn open_file(&mut self, path: &Path) {
        match Scene::load_os(path.as_os_str()) {
            Ok(scene) => {
                if self.browser.is_some() {
                    // As where one of its scenes is chosen.
                    self.close_browser();
                }
                self.open_scene(&scene);
            }
            Err(error) => self.complain(error.to_string()),
        }
    }

    /// Plays another scene, or tells why it cannot be played.
    pub(super) fn open_scene(&mut self, scene: &Scene) {
        match self.session.open(scene) {
            Ok(()) => {
                self.hands.let_go();
                self.stop_clock();
                if scene.file().is_some() {
                    self.own = Some(scene.clone());
                }
                self.watch = watch(scene, &self.options);
                self.say(words::scene(&self.session));
            }
            Err(error) => self.complain(error.to_string()),
        }
        self.set_title();
        self.request_redraw();
    }

    /// Plays the scene file anew where it was saved; one that is wrong is told, and what is played goes on.
    pub(super) fn look_at_file(&mut self, now: Instant) {
        match self.watch.as_mut().and_then(|watch| watch.poll(now)) {
            None => {}
            Some(Ok(scene)) => match self.session.open(&scene) {
                Ok(()) => {
                    self.hands.let_go();
                    self.stop_clock();
                    self.own = Some(scene);
                    if let Some(browser) = &mut self.browser {
                        browser.renew(&self.session);
                    }
                    self.entitle(format!("{} loaded again", self.session.name()));
                }
                Err(error) => self.complain(error.to_string()),
            },
            Some(Err(error)) => self.complain(error.to_string()),
        }
    }

    pub(super) fn toggle_fullscreen(&self) {
        if let Some((window, _)) = &self.screen {
            let fullscreen = window.fullscreen().is_none().then_some(Fullscreen::Borderless(None));
            window.set_fullscreen(fullscreen);
        }
    }

    pub(super) fn point_at(&mut self, position: PhysicalPosition<f64>) {
        let scale = self.screen.as_ref().map_or(1.0, |(window, _)| window.scale_factor());
        // For balls and cards alike, whatever is open: a click may come without a move after the list of scenes was
        // opened, or closed.
        self.pointer = DVec2::new(position.x, position.y);
        let moved = self.hands.point_at(self.pointer / scale);
        if let Some(browser) = &mut self.browser {
            browser.point_at(self.pointer);
        } else if moved {
            self.pointed = Some(Instant::now());
        } else {
            return;
        }
        self.request_redraw();
    }

    /// A button goes down, or up, where the pointer is.
    pub(super) fn press(&mut self, button: MouseButton, state: ElementState) {
        let press = Press { button, state, pixel: self.pointer, place: self.hands.pointer() };
        self.ask(Input::Button(press), false);
    }

    /// A button does its part in the list of scenes.
    fn press_card(&mut self, press: Press) {
        let Some(browser) = &mut self.browser else { return };
        let down = (press.button, press.state) == (MouseButton::Left, ElementState::Pressed);
        if down && browser.select_at(press.pixel) {
            self.open_selected();
            self.clicked = Some(Instant::now());
        }
    }

    /// A button does its part to balls.
    fn press_ball(&mut self, press: Press) {
        if self.help && press.state == ElementState::Pressed {
            // The balls behind it are not what is clicked on.
            self.help = false;
            return;
        }
        let now = Instant::now();
        self.pointed = Some(now);
        let again = self.clicked.is_some_and(|at| now.saturating_duration_since(at) < DOUBLE_CLICK);
        match (press.button, press.state, press.place) {
            (MouseButton::Left, ElementState::Pressed, Some(place)) if !again => {
                if let Err(error) = self.hands.press(place, &self.session) {
                    self.complain(error.to_string());
                }
            }
            (MouseButton::Left, ElementState::Released, place) => {
                match self.hands.release(place, &self.session) {
                    Some(change @ Change::AddBall { .. }) => self.apply(change.into()),
                    held => self.bring(held),
                }
            }
            (MouseButton::Right, ElementState::Pressed, place) => {
                if let Some(index) = self.hands.pick(place, &self.session) {
                    self.apply(Change::Remove(index).into());
                }
            }
            _ => {}
        }
    }

    /// Does to a held ball what the hand wants, if anything.
    pub(super) fn bring(&mut self, change: Option<Change>) {
        if let Some(change) = change {
            // A ball that has no room where the hand is stays where it was.
            let _ = self.session.apply(change.into());
        }
    }

    pub(super) fn turn_wheel(&mut self, delta: MouseScrollDelta) {
        let notches = match delta {
            MouseScrollDelta::LineDelta(_, lines) => f64::from(lines),
            MouseScrollDelta::PixelDelta(pixels) => pixels.y / NOTCH,
        };
        self.ask(Input::Wheel(notches), false);
    }

    /// The wheel does its part: it scrolls the list of scenes, or sets how large the next ball is.
    fn turn(&mut self, notches: f64) {
        // A wheel may turn sideways only.
        if !notches.is_normal() {
            return;
        }
        if let Some(browser) = &mut self.browser {
            return browser.turn(notches);
        }
        let radius = self.hands.turn(notches);
        self.pointed = Some(Instant::now());
        // A notch is less than a pixel of small ones.
        let digits = usize::from(radius < 10.0);
        self.say(format!("next ball: radius {radius:.digits$} px"));
    }
}

/// What tells that the file of a scene was saved, where it has one and that is asked for.
pub(super) fn watch(scene: &Scene, options: &Options) -> Option<Watch> {
    scene.file().filter(|_| options.watch).map(|file| Watch::new(file, scene.source()))
}
