//! Balls that hold each other, directly or through others.

/// Sets of balls (disjoint-set forest; Galler & Fischer 1964).
pub(super) struct Islands {
    /// Each ball points to another one of its island, or to itself.
    towards: Vec<u32>,
}

impl Islands {
    /// The islands that pairs of so many balls make of these; those that are in no pair are in none.
    pub(super) fn new(balls: usize, pairs: impl Iterator<Item = (usize, usize)>) -> Self {
        let mut islands = Self { towards: (0..balls as u32).collect() };
        for (first, second) in pairs {
            let (one, other) = (islands.root(first), islands.root(second));
            islands.towards[one.max(other)] = one.min(other) as u32;
        }
        islands
    }

    /// The balls of each that has more than one.
    pub(super) fn into_lists(mut self) -> Vec<Vec<usize>> {
        let balls = self.towards.len();
        let mut lists = vec![Vec::new(); balls];
        for ball in 0..balls {
            lists[self.root(ball)].push(ball);
        }
        lists.retain(|list| list.len() > 1);
        lists
    }

    /// The ball that stands for a ball's island.
    fn root(&mut self, mut ball: usize) -> usize {
        while self.towards[ball] as usize != ball {
            self.towards[ball] = self.towards[self.towards[ball] as usize];
            ball = self.towards[ball] as usize;
        }
        ball
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn balls_are_on_one_island_with_all_that_they_hold_through_others() {
        let pairs = [(6, 2), (4, 5), (2, 1), (1, 6)];
        assert_eq!(Islands::new(8, pairs.into_iter()).into_lists(), [vec![1, 2, 6], vec![4, 5]]);
    }

    #[test]
    fn balls_that_hold_nothing_are_on_no_island() {
        assert!(Islands::new(3, [].into_iter()).into_lists().is_empty());
    }
}
