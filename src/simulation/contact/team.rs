//! The threads that share the work of a substep. What each piece of work is does not depend on how many they are.

use pool::Pool;

/// Threads; none but the caller's own until they are started, where one is enough, or where carom is built without
/// `parallel`.
#[derive(Debug, Clone, Default)]
pub(super) struct Team {
    started: bool,
    pool: Option<Pool>,
}

impl Team {
    /// Starts so many threads, once. Where the system gives none, the caller's own does all the work.
    pub(super) fn start(&mut self, threads: u32) {
        if !std::mem::replace(&mut self.started, true) && threads > 1 {
            self.pool = Pool::new(threads as usize);
        }
    }

    /// Whether there is no thread but the caller's own.
    pub(super) fn is_one(&self) -> bool {
        self.pool.is_none()
    }

    /// Runs `work` where [`each`](Self::each) finds the threads at once.
    pub(super) fn gather<R: Send>(&self, work: impl FnOnce() -> R + Send) -> R {
        match &self.pool {
            Some(pool) => pool.gather(work),
            None => work(),
        }
    }

    /// Does `work` on each item, on any of the threads and in any order. To be called within [`gather`](Self::gather).
    pub(super) fn each<T: Send>(&self, items: impl Iterator<Item = T>, work: impl Fn(T) + Sync + Send) {
        match &self.pool {
            Some(pool) => pool.each(items.collect(), work),
            None => items.for_each(work),
        }
    }
}

#[cfg(feature = "parallel")]
mod pool {
    use std::sync::Arc;
    use std::sync::atomic::{AtomicBool, Ordering};

    use rayon::{ThreadPool, ThreadPoolBuilder, Yield, current_thread_index, join, scope, yield_now};

    #[derive(Debug, Clone)]
    pub(super) struct Pool {
        threads: Arc<ThreadPool>,
        /// For each thread whether it is at work, on the whole or on parts, or stays awake for others.
        busy: Arc<[AtomicBool]>,
        /// Whether each may have a core of its own.
        pub(super) fits: bool,
    }

    impl Pool {
        pub(super) fn new(count: usize) -> Option<Self> {
            let cores = std::thread::available_parallelism().map_or(1, usize::from);
            let threads = ThreadPoolBuilder::new().num_threads(count).build().ok()?;
            let busy = (0..count).map(|_| AtomicBool::new(false)).collect();
            Some(Self { threads: Arc::new(threads), busy, fits: count <= cores })
        }

        /// While one thread does `work`, the others wait for their parts of it without going to sleep, if there is a core
        /// for each: to be woken takes longer than many a part.
        pub(super) fn gather<R: Send>(&self, work: impl FnOnce() -> R + Send) -> R {
            if !self.fits {
                return self.threads.install(work);
            }
            self.threads.install(|| {
                let over = &AtomicBool::new(false);
                scope(|scope| {
                    scope.spawn_broadcast(move |_, _| {
                        // One that comes here while it waits for others has work unfinished beneath: if it stayed, what
                        // it waits for might never be over.
                        let Some(_busy) = self.begin().filter(|busy| !busy.was) else { return };
                        stay_awake_until(over);
                    });
                    // The others are let go of even where `work` panics.
                    let _over = Over(over);
                    let _busy = self.begin();
                    work()
                })
            })
        }

        pub(super) fn each<T: Send>(&self, items: Vec<T>, work: impl Fn(T) + Sync + Send) {
            let from_behind = current_thread_index().is_some_and(|index| index % 2 == 1);
            if items.len() == 1 {
                items.into_iter().for_each(work);
                return;
            }
            let mut items: Vec<_> = items.into_iter().map(Some).collect();
            let half = items.len() / 2;
            let (low, high) = items.split_at_mut(half);
            self.in_halves(from_behind, || self.share(low, false, &work), || self.share(high, true, &work));
        }

        /// Works on items, from the first on or from the last. Two threads begin at both ends of all, each at the same end
        /// from pass to pass, since its cache still holds what is there, and meet where one of them gets to first.
        fn share<T: Send>(
            &self,
            items: &mut [Option<T>],
            from_behind: bool,
            work: &(impl Fn(T) + Sync + Send),
        ) {
            if let [item] = items {
                item.take().into_iter().for_each(work);
            } else if !items.is_empty() {
                let half = items.len() / 2;
                let (low, high) = items.split_at_mut(half);
                let (low, high) =
                    (|| self.share(low, from_behind, work), || self.share(high, from_behind, work));
                let _busy = self.begin();
                self.in_halves(from_behind, low, high);
            }
        }

        /// Does both; the thread that it is called on does `low` first, or `high`.
        fn in_halves(&self, from_behind: bool, low: impl FnOnce() + Send, high: impl FnOnce() + Send) {
            match (self.fits, from_behind) {
                (true, true) => both_awake(high, low),
                (true, false) => both_awake(low, high),
                (false, true) => drop(join(high, low)),
                (false, false) => drop(join(low, high)),
            }
        }

        /// Notes that this thread is busy, until what comes back goes out of scope.
        fn begin(&self) -> Option<Busy<'_>> {
            let flag = self.busy.get(current_thread_index()?)?;
            Some(Busy { flag, was: flag.swap(true, Ordering::Relaxed) })
        }
    }

    /// That a thread is busy, and whether it was before.
    struct Busy<'a> {
        flag: &'a AtomicBool,
        was: bool,
    }

    impl Drop for Busy<'_> {
        fn drop(&mut self) {
            self.flag.store(self.was, Ordering::Relaxed);
        }
    }

    /// Says that something is over when it goes out of scope.
    struct Over<'a>(&'a AtomicBool);

    impl Drop for Over<'_> {
        fn drop(&mut self) {
            self.0.store(true, Ordering::Release);
        }
    }

    /// What [`join`] does, but without going to sleep where the second part is with another thread, which `join` does after
    /// a few microseconds: to be woken takes longer than the rest of that part.
    fn both_awake(first: impl FnOnce() + Send, second: impl FnOnce() + Send) {
        let over = &AtomicBool::new(false);
        scope(|scope| {
            scope.spawn(move |_| {
                let _over = Over(over);
                second();
            });
            first();
            stay_awake_until(over);
        });
    }

    /// Does what there is to do until something is over.
    fn stay_awake_until(over: &AtomicBool) {
        while !over.load(Ordering::Acquire) {
            if yield_now() != Some(Yield::Executed) {
                std::thread::yield_now();
            }
        }
    }
}

#[cfg(not(feature = "parallel"))]
mod pool {
    /// There is none.
    #[derive(Debug, Clone)]
    pub(super) enum Pool {}

    impl Pool {
        pub(super) fn new(_threads: usize) -> Option<Self> {
            None
        }

        pub(super) fn gather<R>(&self, _work: impl FnOnce() -> R) -> R {
            match *self {}
        }

        pub(super) fn each<T>(&self, _items: Vec<T>, _work: impl Fn(T)) {
            match *self {}
        }
    }
}

#[cfg(all(test, feature = "parallel"))]
mod tests {
    use std::panic::{AssertUnwindSafe, catch_unwind};
    use std::sync::Barrier;
    use std::sync::atomic::{AtomicU32, Ordering};

    use super::Team;
    use super::pool::Pool;

    /// So many threads that stay awake, however few cores there are.
    fn awake(threads: usize) -> Team {
        let mut pool = Pool::new(threads).unwrap();
        pool.fits = true;
        Team { started: true, pool: Some(pool) }
    }

    /// Lets each part of a few be done once, with more or less to do.
    fn gather_some(team: &Team, round: u32) {
        let done: Vec<_> = (0..=round % 9).map(|_| AtomicU32::new(0)).collect();
        team.gather(|| {
            for _ in 0..4 {
                team.each((0..).zip(&done), |(at, part)| {
                    (0..(7 * at + round) % 40 * 20).for_each(|_| std::hint::spin_loop());
                    part.fetch_add(1, Ordering::Relaxed);
                });
            }
        });
        assert!(done.iter().all(|part| part.load(Ordering::Relaxed) == 4), "{round}");
    }

    /// Threads that waited for others with a part of theirs unfinished did not, once in some thousands.
    #[test]
    fn every_gathering_comes_to_its_end_with_all_parts_done_once() {
        for threads in [2, 3] {
            let team = awake(threads);
            (0..4000).for_each(|round| gather_some(&team, round));
        }
    }

    /// Without, a thread would wait for ever for a part that is never over.
    #[test]
    fn a_panic_in_any_part_comes_out_of_the_gathering_and_the_next_works() {
        for threads in [2, 3] {
            let team = awake(threads);
            for part in 0..9 {
                let panics = || team.gather(|| team.each(0..9, |at| assert_ne!(at, part, "as it should")));
                assert!(catch_unwind(AssertUnwindSafe(panics)).is_err());
                gather_some(&team, part);
            }
        }
    }

    /// Clones share their threads.
    #[test]
    fn two_that_gather_the_same_threads_at_one_time_both_come_to_their_end() {
        for threads in [2, 3] {
            let (team, together) = (&awake(threads), &Barrier::new(2));
            let gather_all = || {
                for round in 0..1500 {
                    together.wait();
                    gather_some(team, round);
                }
            };
            std::thread::scope(|scope| {
                scope.spawn(gather_all);
                gather_all();
            });
        }
    }
}
