//! Balls that hold each other, or may come to each other, directly or through others.

/// The islands of more than one ball that pairs of so many balls make of these (disjoint-set forest; Galler & Fischer 1964).
pub(super) fn islands(balls: usize, pairs: impl Iterator<Item = (usize, usize)>) -> Vec<Vec<usize>> {
    // Each ball points to another one of its island, or to itself.
    let mut towards: Vec<usize> = (0..balls).collect();
    for (first, second) in pairs {
        let (one, other) = (root(&mut towards, first), root(&mut towards, second));
        towards[one.max(other)] = one.min(other);
    }
    // The first of an island stands for it.
    let mut islands: Vec<Vec<usize>> = Vec::new();
    let mut places = vec![None; balls];
    for ball in 0..balls {
        let first = root(&mut towards, ball);
        if first != ball {
            let place = *places[first].get_or_insert_with(|| {
                islands.push(vec![first]);
                islands.len() - 1
            });
            islands[place].push(ball);
        }
    }
    islands
}

/// The ball that stands for a ball's island.
fn root(towards: &mut [usize], mut ball: usize) -> usize {
    while towards[ball] != ball {
        towards[ball] = towards[towards[ball]];
        ball = towards[ball];
    }
    ball
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn balls_are_on_one_island_with_all_that_they_hold_through_others() {
        let pairs = [(6, 2), (4, 5), (2, 1), (1, 6)];
        assert_eq!(islands(8, pairs.into_iter()), [vec![1, 2, 6], vec![4, 5]]);
    }

    #[test]
    fn balls_that_hold_nothing_are_on_no_island() {
        assert!(islands(3, [].into_iter()).is_empty());
    }
}
