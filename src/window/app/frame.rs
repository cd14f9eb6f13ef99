//! A frame: measure, advance, paint, present.

use std::time::{Duration, Instant};

use glam::DVec2;
use winit::dpi::PhysicalSize;

use super::super::WindowError;
use super::super::clock::FrameRate;
use super::{App, Rewinding};
use crate::session::CommandError;

/// How long to wait before looking whether a window that could not be seen can.
const LOOK_AGAIN: Duration = Duration::from_millis(250);
/// The longest that a frame simulates, in wall-clock time: with the time that painting takes, thirty frames a second or
/// so remain. Where more happens than can be computed in it, time runs slower and the window still answers.
const LONGEST_ADVANCE: Duration = Duration::from_millis(25);
/// How long to wait for the next frame where this one was not presented, which would have waited for the screen.
const STILL: Duration = Duration::from_micros(16_667);

/// When a frame is presented.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Present {
    /// Now: the system asks for it, and the window may have lost what it showed.
    Now,
    /// Where it looks other than the one before, and then when the system asks for it. On Wayland that is once the last
    /// picture was seen: given one before, drivers wait for that, without end where the window is hidden.
    WhenAsked,
}

impl App {
    /// One frame: measure, advance, paint, present; the last two where they are needed.
    ///
    /// The world is the window, in px that are as large on every screen: with a scale factor of 2, four pixels to one.
    pub(super) fn frame(&mut self, present: Present) -> Result<(), WindowError> {
        self.next_frame = None;
        if self.retry.is_some_and(|at| Instant::now() < at) {
            // Pictures that are asked for sooner would not give the driver the time that it needs.
            self.look_again = self.retry;
            return Ok(());
        }
        self.retry = None;
        let Some((window, screen)) = &mut self.screen else { return Ok(()) };
        let (size, scale) = (window.inner_size(), window.scale_factor());
        if self.occluded || size.width == 0 || size.height == 0 || window.is_minimized() == Some(true) {
            // Nothing can be seen: time stands still, and goes on from there.
            self.stop_clock();
            self.look_again = Some(Instant::now() + LOOK_AGAIN);
            return Ok(());
        }
        self.look_again = None;
        if screen.size() != size {
            let start = Instant::now();
            screen.resize(size)?;
            self.turn.without(start.elapsed());
        }
        self.spent("events");
        let start = Instant::now();
        let measured = self.advance(start, world_size(size, scale))?;
        let advanced = Instant::now();
        self.spent("advance");
        let changed = self.paint(scale, measured, start) || self.unseen;
        let painted = Instant::now();
        self.spent("paint");
        let Some((window, screen)) = &mut self.screen else { return Ok(()) };
        if window.inner_size() != size {
            // This picture is the wrong size already; the next will not be.
            window.request_redraw();
            return Ok(());
        }
        if present == Present::WhenAsked {
            self.unseen = changed;
            if changed {
                window.request_redraw();
            } else {
                self.stand_still(start);
            }
            return Ok(());
        }
        self.unseen = false;
        let presented = screen.present()?;
        if presented.again.is_none()
            && let Some(recorder) = &mut self.recorder
        {
            recorder.shown();
        }
        self.spent("present");
        self.turn.without(presented.upload + presented.present);
        if let Some(wait) = presented.again {
            self.retry = Some(Instant::now() + wait);
            self.look_again = self.retry;
            return Ok(());
        }
        self.split = [advanced - start, painted - advanced, presented.upload + presented.present];
        if let Some(timings) = &self.options.timings {
            timings.lock().add([advanced - start, painted - advanced, presented.upload, presented.present]);
        }
        if !changed {
            self.stand_still(start);
            return Ok(());
        }
        if self.is_moving() {
            self.request_redraw();
        } else {
            // The last of the frames that were asked for: balls may have come in it.
            self.set_title();
        }
        if let Some(rate) = self.rate.count(Instant::now()) {
            self.frames_per_second = Some(rate);
            self.set_title();
        }
        Ok(())
    }

    /// Whether a frame now would move anything.
    pub(super) fn is_moving(&self) -> bool {
        self.browser.is_none() && (self.rewinding != Rewinding::No || self.session.is_moving())
    }

    /// Brings the session to the time `now`, in a world of this size. Returns the seconds since the last frame.
    pub(super) fn advance(&mut self, now: Instant, size: DVec2) -> Result<f64, WindowError> {
        let measured = self.clock.tick(now);
        let resized = self.session.resize(size);
        resized.or_else(|error| match error {
            CommandError::OutOfRange(error) => Err(error),
            error => {
                self.complain(error.to_string());
                Ok(())
            }
        })?;
        let mut go_on = || now.elapsed() < LONGEST_ADVANCE;
        if let Err(error) = self.session.work_while(&mut go_on) {
            self.complain(error.to_string());
        }
        if !self.session.is_working() {
            let change = self.hands.hold(&self.session);
            self.bring(change);
        }
        if self.browser.is_some() {
            return Ok(measured);
        }
        if self.rewinding == Rewinding::No {
            // In the past, a comparison ends where it did.
            let compared = self.session.truth().is_some() && !self.session.is_in_the_past();
            self.session.advance_while(measured, go_on)?;
            if compared && self.session.truth().is_none() {
                self.complain("exact cannot follow here in real time: no longer compared".to_owned());
            }
        } else if !self.session.rewind_while(measured, go_on) && self.rewinding == Rewinding::Back {
            self.rewinding = Rewinding::AtStart;
            self.complain(self.session.nothing_before().to_string());
        }
        Ok(measured)
    }

    /// After a frame that began at `start` and looked as the one before: asks for the next where time runs, and tells
    /// no frame rate.
    fn stand_still(&mut self, start: Instant) {
        self.next_frame = self.is_moving().then_some(start + STILL);
        self.rate = FrameRate::default();
        self.frames_per_second = None;
        // Balls may have come where nobody sees them.
        self.set_title();
    }
}

/// The world that a window of this size shows, px.
fn world_size(size: PhysicalSize<u32>, scale_factor: f64) -> DVec2 {
    let size = size.to_logical(scale_factor);
    DVec2::new(size.width, size.height)
}
