//! A session that was told to add `usize::MAX` balls asked for all the memory there is, and panicked.

use carom::simulation::limits::MAX_BALLS;
use carom::{BuildError, Change, Scene, Session};

#[test]
fn balls_beyond_the_most_are_refused_before_any_memory_is_taken() {
    let mut session = Session::new(&Scene::load("gravity").unwrap(), 1).unwrap();
    for count in [usize::MAX, MAX_BALLS - 14, 1 << 40] {
        let error = session.apply(Change::AddRandom(count).into()).unwrap_err();
        assert_eq!(
            error.to_string(),
            BuildError::TooManyBalls { count: count.saturating_add(15) }.to_string()
        );
        assert_eq!(session.simulation().balls().len(), 15);
    }
    session.apply(Change::AddRandom(1).into()).unwrap();
    session.advance(0.1).unwrap();
}
