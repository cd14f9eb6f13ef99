//! The threads that share the work of a substep. What each piece of work is does not depend on how many they are.

#[cfg(feature = "parallel")]
use std::sync::Arc;

#[cfg(feature = "parallel")]
use rayon::prelude::*;

/// Threads; none but the caller's own where one is enough, or where carom is built without `parallel`.
#[derive(Debug, Clone, Default)]
pub(super) struct Team {
    #[cfg(feature = "parallel")]
    pool: Option<Arc<rayon::ThreadPool>>,
}

impl Team {
    /// A team of so many threads. Where the system gives none, the caller's own does all the work.
    #[cfg(feature = "parallel")]
    pub(super) fn new(threads: usize) -> Self {
        let pool = || rayon::ThreadPoolBuilder::new().num_threads(threads).build().ok().map(Arc::new);
        Self { pool: if threads > 1 { pool() } else { None } }
    }

    /// The same without threads.
    #[cfg(not(feature = "parallel"))]
    pub(super) fn new(_threads: usize) -> Self {
        Self {}
    }

    /// Runs `work` where [`each`](Self::each) finds the threads at once.
    pub(super) fn gather<R: Send>(&self, work: impl FnOnce() -> R + Send) -> R {
        #[cfg(feature = "parallel")]
        if let Some(pool) = &self.pool {
            return pool.install(work);
        }
        work()
    }

    /// Does `work` on each item, on any of the threads and in any order. To be called within [`gather`](Self::gather).
    pub(super) fn each<T: Send>(&self, items: impl Iterator<Item = T>, work: impl Fn(T) + Sync + Send) {
        #[cfg(feature = "parallel")]
        if self.pool.is_some() {
            let items: Vec<T> = items.collect();
            return items.into_par_iter().with_max_len(1).for_each(work);
        }
        items.for_each(work);
    }
}
