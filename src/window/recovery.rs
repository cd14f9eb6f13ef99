//! What to do when a picture could not be shown: look again, make the device anew, or give up.

use std::time::Duration;

use pixels::Error;
use pixels::wgpu::SurfaceError;

/// What came of showing a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Outcome {
    Shown,
    /// The surface gave no texture in time: nobody shows it.
    Timeout,
    /// The surface no longer fits the window; it was configured again, and that was not enough yet.
    Outdated,
    /// The surface is gone.
    Lost,
    /// There is no memory for the next texture.
    OutOfMemory,
    /// The graphics library told of an error, or that the device is gone; or there has been no device since that.
    DeviceFailed,
}

impl Outcome {
    /// What the graphics library says came of it. `device_failed`: whether it has told of an error meanwhile.
    pub(super) fn of(rendered: Option<&Result<(), Error>>, device_failed: bool) -> Self {
        match rendered {
            _ if device_failed => Self::DeviceFailed,
            Some(Ok(())) => Self::Shown,
            Some(Err(Error::Surface(SurfaceError::Timeout))) => Self::Timeout,
            Some(Err(Error::Surface(SurfaceError::Outdated))) => Self::Outdated,
            Some(Err(Error::Surface(SurfaceError::Lost))) => Self::Lost,
            Some(Err(Error::Surface(SurfaceError::OutOfMemory))) => Self::OutOfMemory,
            Some(Err(_)) | None => Self::DeviceFailed,
        }
    }
}

/// What to do about it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Remedy {
    Nothing,
    /// Try again with what there is, after so long.
    Again(Duration),
    /// Make surface and device anew, and try again after so long.
    Renew(Duration),
    /// It has failed again and again.
    GiveUp,
}

/// After so many failures in a row with the same surface, it is made anew.
const RENEWED_AFTER: u32 = 3;
/// After so many in a row, carom gives up: some ten seconds after the first.
const MOST: u32 = 10;
/// From the second renewal on, a driver that starts anew is given time: this long, then twice as long each time, but no
/// longer than the second figure.
const WAITS: (Duration, Duration) = (Duration::from_millis(50), Duration::from_secs(2));
/// Where nobody shows the surface, there is no hurry.
const UNSEEN: Duration = Duration::from_millis(250);

/// Counts failures in a row, and decides.
#[derive(Debug, Default)]
pub(super) struct Recovery {
    failures: u32,
}

impl Recovery {
    /// What to do after this.
    pub(super) fn after(&mut self, outcome: Outcome) -> Remedy {
        match outcome {
            Outcome::Shown => {
                self.failures = 0;
                return Remedy::Nothing;
            }
            // Not a failure: this may last for as long as another workspace is looked at.
            Outcome::Timeout => return Remedy::Again(UNSEEN),
            _ => self.failures += 1,
        }
        let again = outcome == Outcome::Outdated && self.failures <= RENEWED_AFTER;
        match self.failures {
            failures if failures > MOST => Remedy::GiveUp,
            _ if again => Remedy::Again(Duration::ZERO),
            1 => Remedy::Renew(Duration::ZERO),
            failures => Remedy::Renew((WAITS.0 * 2_u32.pow(failures - 2)).min(WAITS.1)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FAILURES: [Outcome; 4] =
        [Outcome::Outdated, Outcome::Lost, Outcome::OutOfMemory, Outcome::DeviceFailed];

    #[test]
    fn each_error_of_the_graphics_library_is_told_from_the_others() {
        let surface = |error| Some(Err(Error::Surface(error)));
        for (rendered, expected) in [
            (Some(Ok(())), Outcome::Shown),
            (surface(SurfaceError::Timeout), Outcome::Timeout),
            (surface(SurfaceError::Outdated), Outcome::Outdated),
            (surface(SurfaceError::Lost), Outcome::Lost),
            (surface(SurfaceError::OutOfMemory), Outcome::OutOfMemory),
            (surface(SurfaceError::Other), Outcome::DeviceFailed),
            (None, Outcome::DeviceFailed),
        ] {
            assert_eq!(Outcome::of(rendered.as_ref(), false), expected);
            // Whatever came of the picture, the device is no good any more.
            assert_eq!(Outcome::of(rendered.as_ref(), true), Outcome::DeviceFailed);
        }
    }

    #[test]
    fn a_surface_that_is_outdated_is_tried_again_and_then_made_anew() {
        let mut recovery = Recovery::default();
        for _ in 0..RENEWED_AFTER {
            assert_eq!(recovery.after(Outcome::Outdated), Remedy::Again(Duration::ZERO));
        }
        assert!(matches!(recovery.after(Outcome::Outdated), Remedy::Renew(_)));
        assert_eq!(recovery.after(Outcome::Shown), Remedy::Nothing);
        assert_eq!(recovery.after(Outcome::Outdated), Remedy::Again(Duration::ZERO), "counted anew");
    }

    #[test]
    fn what_is_lost_is_made_anew_at_once_and_then_after_ever_longer_waits() {
        for outcome in [Outcome::Lost, Outcome::OutOfMemory, Outcome::DeviceFailed] {
            let mut recovery = Recovery::default();
            assert_eq!(recovery.after(outcome), Remedy::Renew(Duration::ZERO));
            let mut waits = Vec::new();
            while let Remedy::Renew(wait) = recovery.after(outcome) {
                waits.push(wait);
            }
            assert!(waits.is_sorted() && waits[0] > Duration::ZERO && waits.len() == MOST as usize - 1);
            let all: Duration = waits.iter().sum();
            assert!((5..15).contains(&all.as_secs()), "a driver has time to start anew: {all:?}");
        }
    }

    #[test]
    fn whatever_fails_again_and_again_ends_and_nothing_that_recovers_does() {
        for first in FAILURES {
            for second in FAILURES {
                let mut recovery = Recovery::default();
                let fails = [first, second].into_iter().cycle().take(MOST as usize);
                assert!(fails.map(|outcome| recovery.after(outcome)).all(|remedy| remedy != Remedy::GiveUp));
                assert_eq!(recovery.after(second), Remedy::GiveUp);
            }
            let mut recovery = Recovery::default();
            for _ in 0..1000 {
                assert_ne!(recovery.after(first), Remedy::GiveUp);
                assert_eq!(recovery.after(Outcome::Shown), Remedy::Nothing);
            }
        }
    }

    #[test]
    fn a_surface_that_nobody_shows_is_waited_for_for_ever() {
        let mut recovery = Recovery::default();
        for _ in 0..1000 {
            assert_eq!(recovery.after(Outcome::Timeout), Remedy::Again(UNSEEN));
        }
    }
}
