//! Where the frames' time went, for `--timings`.

use std::fmt;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Where the time of a window's frames went; its [`Display`](fmt::Display) tells it. The window is given a clone, so that
/// what it took so far can be told where something ends the program at once.
#[derive(Debug, Clone, Default)]
pub struct Timings(Arc<Mutex<Taken>>);

impl Timings {
    pub(super) fn lock(&self) -> MutexGuard<'_, Taken> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl fmt::Display for Timings {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.lock().fmt(f)
    }
}

/// The times of each frame's four parts, of the program's own share of each turn, and what the longest turns went on.
#[derive(Debug)]
pub(super) struct Taken {
    began: Instant,
    parts: [Spread; 4],
    own: Spread,
    processor: Spread,
    /// The processor time without what was stolen meanwhile: what certainly is the program's.
    certain: Spread,
    /// What the turn under way has spent processor time on, where that can be had.
    spending: Spending,
    /// What had been stolen when it began.
    stolen: Duration,
    /// The turns that certainly took most of it, the longest first.
    longest: Vec<Long>,
}

/// A turn that took long.
#[derive(Debug)]
struct Long {
    /// When it ended, counted from the beginning.
    at: Duration,
    spending: Spending,
    /// The program's own time by the clock.
    own: Duration,
    /// What was stolen meanwhile, and the processor time without it.
    stolen: Duration,
    certain: Duration,
    /// What the window showed then.
    shown: String,
}

/// So many of the longest turns are told.
const MOST_LONG: usize = 5;

/// The names of a frame's parts.
const PARTS: [&str; 4] = ["advance", "paint", "upload", "present"];

impl Default for Taken {
    /// Nothing has been timed yet.
    fn default() -> Self {
        Self {
            began: Instant::now(),
            parts: Default::default(),
            own: Spread::default(),
            processor: Spread::default(),
            certain: Spread::default(),
            spending: Spending::default(),
            stolen: Duration::ZERO,
            longest: Vec::new(),
        }
    }
}

impl Taken {
    /// Adds a frame that was presented.
    pub(super) fn add(&mut self, parts: [Duration; 4]) {
        for (spread, part) in self.parts.iter_mut().zip(parts) {
            spread.add(part);
        }
    }

    /// Begins a turn of the event loop.
    pub(super) fn begin_turn(&mut self) {
        self.stolen = stolen_time();
        self.spending = Spending { parts: Vec::new(), until: processor_time() };
    }

    /// Tells what the processor time since the last time that this was told went on.
    pub(super) fn spent(&mut self, on: &'static str) {
        self.spending.add(on, processor_time());
    }

    /// Adds a turn of the event loop: all that the program did from when it woke until it slept, without what the
    /// graphics library took; and the processor time of the window's thread, which a machine that does other things
    /// does not lengthen, with what the graphics library took of it. `shown` tells what the window shows.
    pub(super) fn add_turn(&mut self, own: Duration, shown: impl FnOnce() -> String) {
        self.own.add(own);
        self.spent("the rest");
        if self.spending.until.is_none() {
            return;
        }
        let spending = std::mem::take(&mut self.spending);
        let (processor, stolen) = (spending.sum(), stolen_time().saturating_sub(self.stolen));
        let certain = processor.saturating_sub(stolen);
        self.processor.add(processor);
        self.certain.add(certain);
        let place = self.longest.partition_point(|long| long.certain >= certain);
        if place < MOST_LONG {
            let at = self.began.elapsed();
            self.longest.insert(place, Long { at, spending, own, stolen, certain, shown: shown() });
            self.longest.truncate(MOST_LONG);
        }
    }
}

impl fmt::Display for Taken {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "frame times in ms, {} frames", self.parts[0].count())?;
        let parts = PARTS.iter().zip(&self.parts);
        let turns = [(&"own", &self.own), (&"processor", &self.processor), (&"certain", &self.certain)];
        for (name, spread) in parts.chain(turns).filter(|(_, spread)| spread.count() > 0) {
            let [median, most, longest] =
                [spread.share(0.5), spread.share(0.99), spread.longest].map(milliseconds);
            write!(f, "\n{name:<9} median {median:.4}, 99 % under {most:.4}, longest {longest:.4}")?;
        }
        for Long { at, spending, own, stolen, shown, .. } in &self.longest {
            let [time, own, stolen] = [spending.sum(), *own, *stolen].map(milliseconds);
            let at = at.as_secs_f64();
            write!(
                f,
                "\nat {at:.1} s {time:.1}, {own:.1} by the clock, {stolen:.0} stolen ({shown}): {spending}"
            )?;
        }
        Ok(())
    }
}

fn milliseconds(time: Duration) -> f64 {
    time.as_secs_f64() * 1e3
}

/// What the processor time of a turn went on.
#[derive(Debug, Default)]
struct Spending {
    parts: Vec<(&'static str, Duration)>,
    /// Up to when, in the thread's processor time, it is told.
    until: Option<Duration>,
}

impl Spending {
    /// Adds what went on since the last time until `now` to what went on the same before.
    fn add(&mut self, on: &'static str, now: Option<Duration>) {
        let Some((before, now)) = self.until.zip(now) else { return };
        let spent = now.saturating_sub(before);
        self.until = Some(now);
        match self.parts.iter_mut().find(|(name, _)| *name == on) {
            Some((_, sum)) => *sum += spent,
            None => self.parts.push((on, spent)),
        }
    }

    fn sum(&self) -> Duration {
        self.parts.iter().map(|(_, time)| time).sum()
    }
}

impl fmt::Display for Spending {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, (name, time)) in self.parts.iter().enumerate() {
            let comma = if index == 0 { "" } else { ", " };
            write!(f, "{comma}{name} {:.1}", milliseconds(*time))?;
        }
        Ok(())
    }
}

/// The processor time that this thread has taken so far.
#[cfg(unix)]
fn processor_time() -> Option<Duration> {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
    Duration::try_from(time).ok()
}

#[cfg(not(unix))]
fn processor_time() -> Option<Duration> {
    None
}

/// The processor time that a hypervisor has given to others while this machine wanted it, of all processors together;
/// none where that cannot be had.
///
/// Part of it counts as that of the thread that it was taken from: on a machine of which nearly all was stolen for
/// seconds, painting sixteen balls was charged with 300 ms.
fn stolen_time() -> Duration {
    // The eighth number, in hundredths of a second: proc_stat(5). No other system has that file.
    let times = std::fs::read_to_string("/proc/stat").unwrap_or_default();
    let stolen = times.lines().next().and_then(|all| all.split_whitespace().nth(8)?.parse().ok());
    Duration::from_millis(10 * stolen.unwrap_or(0))
}

/// How often times came, in steps of a sixteenth of a doubling (4 %), and the longest: a histogram that takes as much
/// memory for days of frames as for one.
#[derive(Debug)]
struct Spread {
    counts: [u64; STEPS],
    longest: Duration,
}

/// Steps in all: 32 doublings.
const STEPS: usize = 16 * 32;
/// The shortest time that is told from shorter ones, s; with so many steps, the longest is more than an hour.
const SHORTEST: f64 = 1e-6;

impl Default for Spread {
    fn default() -> Self {
        Self { counts: [0; STEPS], longest: Duration::ZERO }
    }
}

impl Spread {
    fn add(&mut self, time: Duration) {
        let step = (time.as_secs_f64() / SHORTEST).max(1.0).log2() * 16.0;
        self.counts[(step as usize).min(STEPS - 1)] += 1;
        self.longest = self.longest.max(time);
    }

    fn count(&self) -> u64 {
        self.counts.iter().sum()
    }

    /// A time that this share of all is under, by no more than a step.
    fn share(&self, share: f64) -> Duration {
        let wanted = share * self.count() as f64;
        let mut passed = 0;
        let step = self.counts.iter().position(|&count| {
            passed += count;
            passed as f64 >= wanted
        });
        let upper = SHORTEST * f64::exp2((step.unwrap_or(STEPS - 1) + 1) as f64 / 16.0);
        Duration::from_secs_f64(upper).min(self.longest)
    }
}

/// Measures the program's own time in a turn of the event loop.
#[derive(Debug)]
pub(super) struct Turn {
    since: Instant,
    /// What the graphics library took of it.
    others: Duration,
}

impl Turn {
    /// A turn that begins now.
    pub(super) fn begin(now: Instant) -> Self {
        Self { since: now, others: Duration::ZERO }
    }

    /// Takes out what the graphics library took.
    pub(super) fn without(&mut self, others: Duration) {
        self.others += others;
    }

    /// The program's own time so far.
    pub(super) fn own(&self, now: Instant) -> Duration {
        now.saturating_duration_since(self.since).saturating_sub(self.others)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_of_the_times_are_under_the_median_and_none_is_over_the_longest() {
        let mut spread = Spread::default();
        for microseconds in (1..=1000).rev() {
            spread.add(Duration::from_micros(microseconds));
        }
        assert_eq!((spread.count(), spread.longest), (1000, Duration::from_millis(1)));
        for share in [0.01, 0.5, 0.99] {
            let ratio = spread.share(share).as_secs_f64() / (share * 1e-3);
            assert!((0.99..1.06).contains(&ratio), "{share}: {ratio}");
        }
        assert_eq!(spread.share(1.0), spread.longest);
    }

    #[test]
    fn times_beyond_all_steps_are_counted_and_the_longest_is_told_as_it_was() {
        let mut spread = Spread::default();
        for time in [Duration::ZERO, Duration::from_secs(86_400)] {
            spread.add(time);
        }
        assert_eq!((spread.count(), spread.longest.as_secs()), (2, 86_400));
    }

    #[test]
    fn what_a_turn_spent_its_time_on_adds_up_to_all_of_it() {
        let at = |milliseconds| Some(Duration::from_millis(milliseconds));
        let mut spending = Spending { parts: Vec::new(), until: at(100) };
        for (on, now) in [("events", 103), ("advance", 128), ("events", 130), ("paint", 190)] {
            spending.add(on, at(now));
        }
        assert_eq!(spending.sum(), Duration::from_millis(90));
        assert_eq!(spending.to_string(), "events 5.0, advance 25.0, paint 60.0");
    }

    // Elsewhere no processor time can be had.
    #[cfg(unix)]
    #[test]
    fn every_word_that_is_printed_is_explained() {
        let explained = include_str!("../../docs/command-line.md");
        let mut taken = Taken::default();
        taken.add([Duration::from_millis(1); 4]);
        taken.begin_turn();
        for on in ["events", "advance", "overlay", "paint", "present", "what waited"] {
            taken.spent(on);
        }
        taken.add_turn(Duration::from_millis(1), || "elastic".to_owned());
        let text = taken.to_string();
        let names =
            text.lines().filter(|line| line.contains("median")).filter_map(|line| line.split(' ').next());
        let (_, spending) = text.rsplit_once("): ").unwrap();
        let spent = spending.split(", ").filter_map(|part| part.rsplit_once(' ')).map(|(on, _)| on);
        let words: Vec<&str> = names.chain(spent).chain(["stolen"]).collect();
        assert_eq!(words.len(), 15, "{text}");
        for word in words {
            assert!(text.contains(word) && explained.contains(&format!("`{word}`")), "{word}");
        }
    }

    #[test]
    fn a_turn_is_the_time_since_it_began_without_what_others_took() {
        let start = Instant::now();
        let mut turn = Turn::begin(start);
        turn.without(Duration::from_millis(30));
        assert_eq!(turn.own(start + Duration::from_millis(50)), Duration::from_millis(20));
        assert_eq!(turn.own(start), Duration::ZERO, "nor does a clock that steps back end it");
    }
}
