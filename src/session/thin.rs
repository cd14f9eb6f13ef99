//! How what grows with time is thinned out, so that it keeps to its room.

/// Keeps the first of what it is asked about, and from there on every second.
pub(super) fn every_second<T>() -> impl FnMut(&T) -> bool {
    let mut keep = false;
    move |_| {
        keep = !keep;
        keep
    }
}
