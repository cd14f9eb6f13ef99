//! What is said over the picture, and for how long.

use std::time::{Duration, Instant};

/// How long a message stands before it fades.
const STANDS: Duration = Duration::from_secs(3);
/// How long the hint at the start does.
const HINT_STANDS: Duration = Duration::from_secs(5);
/// How long a message takes to fade ...
const FADES: Duration = Duration::from_millis(480);
/// ... in so many steps.
const STEPS: u32 = 8;
/// What beginners need to know.
const HINT: &str = "H: all keys";

/// What kind of message it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Tone {
    /// What a key did.
    Said,
    /// What could not be done.
    Wrong,
}

/// A message, and how much of it is to be seen.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Message {
    pub(super) text: String,
    pub(super) tone: Tone,
    /// From 0 to 1.
    pub(super) opacity: f64,
}

/// What is said in the title bar.
#[derive(Debug)]
struct Title {
    text: String,
    since: Instant,
    /// Whether it stays true whatever is said after it.
    lasts: bool,
}

/// The last messages, over the picture and in the title bar, and the hint at the start.
#[derive(Debug)]
pub(super) struct Messages {
    /// Whether nothing is to be said over the picture.
    quiet: bool,
    /// What was said over the picture last, and when.
    last: Option<(String, Tone, Instant)>,
    /// What was said in the title bar last.
    title: Option<Title>,
    /// Since when the hint has stood.
    hint: Option<Instant>,
}

impl Messages {
    /// No message yet, but, unless all is to be `quiet`, the hint from `now` on.
    pub(super) fn new(quiet: bool, now: Instant) -> Self {
        Self { quiet, last: None, title: None, hint: (!quiet).then_some(now) }
    }

    /// Says something over the picture, in place of what was said before, and in the title bar, too, where that does not
    /// last.
    pub(super) fn say(&mut self, text: String, tone: Tone, now: Instant) {
        self.hint = None;
        self.title.take_if(|title| !title.lasts);
        self.last = (!self.quiet).then_some((text, tone, now));
    }

    /// Says no more what beginners need to know: they do.
    pub(super) fn end_hint(&mut self) {
        self.hint = None;
    }

    /// Says something in the title bar, too, until something else is said or, where it `lasts`, for as long as it stands.
    pub(super) fn entitle(&mut self, mut text: String, lasts: bool, now: Instant) {
        // A title is one line.
        text.truncate(text.find('\n').unwrap_or(text.len()));
        self.title = Some(Title { text, since: now, lasts });
    }

    /// What is to be seen over the picture now.
    pub(super) fn shown(&self, now: Instant) -> Option<Message> {
        let opacity = |since: Instant, stands| opacity(now.saturating_duration_since(since), stands);
        if let Some((text, tone, since)) = &self.last {
            let opacity = opacity(*since, STANDS)?;
            return Some(Message { text: text.clone(), tone: *tone, opacity });
        }
        let opacity = opacity(self.hint?, HINT_STANDS)?;
        Some(Message { text: HINT.to_owned(), tone: Tone::Said, opacity })
    }

    /// What the title bar is to say now.
    pub(super) fn title(&self, now: Instant) -> Option<&str> {
        let Title { text, since, .. } = self.title.as_ref()?;
        (now.saturating_duration_since(*since) < STANDS).then_some(text)
    }

    /// When something about what is said changes next by itself.
    pub(super) fn next_change(&self, now: Instant) -> Option<Instant> {
        let fades =
            |since: Instant, stands| (0..=STEPS).map(move |step| since + stands + FADES * step / STEPS);
        let last = self.last.iter().flat_map(|&(_, _, since)| fades(since, STANDS));
        let hint = self.hint.into_iter().flat_map(|since| fades(since, HINT_STANDS));
        let title = self.title.iter().map(|title| title.since + STANDS);
        last.chain(hint).chain(title).filter(|&at| at > now).min()
    }
}

/// How much is to be seen of a message of this age, where anything is.
fn opacity(age: Duration, stands: Duration) -> Option<f64> {
    let Some(fading) = age.checked_sub(stands) else { return Some(1.0) };
    let step = (fading.as_secs_f64() / FADES.as_secs_f64() * f64::from(STEPS)).floor() as u32;
    (step < STEPS).then(|| 1.0 - f64::from(step + 1) / f64::from(STEPS + 1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_message_stands_fades_and_is_gone_and_each_change_is_foretold() {
        let start = Instant::now();
        let mut messages = Messages::new(false, start);
        assert_eq!(messages.shown(start).unwrap().text, HINT);
        messages.say("so".to_owned(), Tone::Wrong, start);
        let (mut now, mut seen) = (start, Vec::new());
        while let Some(next) = messages.next_change(now) {
            seen.push(messages.shown(now).unwrap().opacity);
            let shortly_before = now + (next - now) * 9 / 10;
            assert_eq!(messages.shown(shortly_before), messages.shown(now), "nothing changes before");
            now = next;
        }
        assert!(
            seen[0] == 1.0 && seen.is_sorted_by(|a, b| a > b) && seen.len() == STEPS as usize + 1,
            "{seen:?}"
        );
        assert_eq!(now, start + STANDS + FADES);
        assert!(messages.shown(now).is_none());
    }

    #[test]
    fn a_quiet_window_says_things_in_its_title_alone_and_for_as_long() {
        let start = Instant::now();
        let mut messages = Messages::new(true, start);
        assert!(messages.shown(start).is_none() && messages.next_change(start).is_none());
        messages.say("so".to_owned(), Tone::Said, start);
        messages.entitle("so".to_owned(), false, start);
        assert!(messages.shown(start).is_none());
        assert_eq!(messages.title(start), Some("so"));
        let end = messages.next_change(start).unwrap();
        assert_eq!((end, messages.title(end)), (start + STANDS, None));
    }

    #[test]
    fn the_title_says_one_line_and_no_longer_what_something_else_was_said_after() {
        let now = Instant::now();
        for (lasts, after) in [(false, None), (true, Some("saved a"))] {
            let mut messages = Messages::new(false, now);
            messages.say("saved a\nand more".to_owned(), Tone::Said, now);
            messages.entitle("saved a\nand more".to_owned(), lasts, now);
            assert_eq!(messages.title(now), Some("saved a"));
            messages.say("reset".to_owned(), Tone::Said, now);
            assert_eq!(messages.title(now), after);
        }
    }
}
