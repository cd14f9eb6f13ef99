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

    use rayon::prelude::*;
    use rayon::{ThreadPool, ThreadPoolBuilder};

    #[derive(Debug, Clone)]
    pub(super) struct Pool(Arc<ThreadPool>);

    impl Pool {
        pub(super) fn new(threads: usize) -> Option<Self> {
            ThreadPoolBuilder::new().num_threads(threads).build().ok().map(|pool| Self(Arc::new(pool)))
        }

        pub(super) fn gather<R: Send>(&self, work: impl FnOnce() -> R + Send) -> R {
            self.0.install(work)
        }

        #[expect(clippy::unused_self, reason = "rayon finds the pool by the thread that it is called on")]
        pub(super) fn each<T: Send>(&self, items: Vec<T>, work: impl Fn(T) + Sync + Send) {
            if items.len() > 1 {
                items.into_par_iter().with_max_len(1).for_each(work);
            } else {
                items.into_iter().for_each(work);
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
