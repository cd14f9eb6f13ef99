//! Which of the pairs that touch carry a ball, and which only stand abreast, in a row on a wall.
//!
//! A ball is stopped on what carries it as if that were firm (`carry`): what is missing of its momentum has gone into the ground. In a
//! row on the floor neither of two carries the other, and what one gives the other is all there is: a row would lose what hits it. So
//! those are left to what holds them apart, unless the row leans on a heap, or on a wall at its end, and may be pressed for long. Nor
//! where any is unlike those around it: heavy balls would come to lie in light ones, and what that stores comes back.
//!
//! That is looked for among the pairs of one stripe, when what touches or leans there changes: one that only turns meanwhile is held as
//! it was.

use glam::DVec2;

use super::Setting;
use super::constraints::{Beside, Constraint, Pair};
use super::prepare::on_fixed;
use super::sleep::Rest;
use super::stripes::Stripe;

/// Two balls stand abreast up to an angle of this sine.
pub(super) const LEVEL: f64 = 0.1;

impl Stripe {
    /// Keeps of the pairs that touch those in which one ball may carry the other, and gathers where those of each upper ball end.
    pub(super) fn keep_carrying(&mut self, setting: &Setting, rests: &[Rest]) {
        self.find_backed(setting, rests);
        let Self { constraints, carrying, backed, abreast, .. } = self;
        let is_backed = |pair: Pair| backed[pair.first as usize];
        if !abreast.iter().all(|&pair| is_backed(pair)) {
            carrying.retain(|&at| is_backed(constraints[at as usize].pair));
        }
        self.find_uppers();
    }

    /// Gathers where the pairs of each upper ball end, after a 0.
    fn find_uppers(&mut self) {
        let Self { constraints, carrying, uppers, .. } = self;
        uppers.resize(carrying.len() + 1, 0);
        let (ends, mut balls, mut last) = (&mut uppers[..], 0, u32::MAX);
        for (count, &at) in (1..).zip(&*carrying) {
            let upper = constraints[at as usize].pair.first;
            // Without a branch, which a processor could not foresee.
            balls += usize::from(upper != last);
            ends[balls] = count;
            last = upper;
        }
        uppers.truncate(balls + 1);
    }

    /// Finds the bodies that lie on others, or under them, or lean on a wall, or on a fixed one or an unlike one beside them, and all that
    /// stand abreast with such ones: of two abreast both do, or neither does.
    fn find_backed(&mut self, setting: &Setting, rests: &[Rest]) {
        let Self { constraints, carrying, backed, abreast, beside, .. } = self;
        let steep = LEVEL * setting.kick.length();
        backed.clear();
        backed.resize(rests.len(), false);
        abreast.clear();
        leaning(beside, setting.kick).for_each(|body| backed[body as usize] = true);
        for &Constraint { pair, normal, .. } in carrying.iter().map(|&at| &constraints[at as usize]) {
            let unlike = || [pair.first, pair.second].iter().any(|&at| rests[at as usize].unlike.differs());
            if normal.dot(setting.kick).abs() < steep && !on_fixed(rests, pair) && !unlike() {
                abreast.push(pair);
            } else {
                backed[pair.first as usize] = true;
                backed[pair.second as usize] = true;
            }
        }
        let mut spread = |&Pair { first, second }: &Pair| {
            let [one, other] = [first, second].map(|body| backed[body as usize]);
            backed[first as usize] |= other;
            backed[second as usize] |= one;
            one != other
        };
        // To and fro: bodies stand in the order of their places, so that a row takes few turns.
        loop {
            let there = abreast.iter().filter(|pair| spread(pair)).count();
            let back = abreast.iter().rev().filter(|pair| spread(pair)).count();
            if there + back == 0 {
                break;
            }
        }
    }
}

/// The bodies, of those that may touch a wall, that lean on one beside them.
pub(super) fn leaning(beside: &[Beside], kick: DVec2) -> impl Iterator<Item = u32> {
    let steep = LEVEL * kick.length();
    let leans = move |push: DVec2| push.perp_dot(kick).abs() > steep * push.length();
    beside.iter().filter(move |beside| leans(beside.push)).map(|beside| beside.body)
}

#[cfg(test)]
mod tests {
    use super::super::super::ball::Ball;
    use super::super::testing::{TUNING, boxed_world};
    use super::super::{Contact, Tally};
    use super::*;

    /// How many pairs touch of balls that stand touching on the floor, of radius 10, and of one that lies `on` two of them; and how many
    /// of them carry.
    fn pairs(row: &[f64], on: Option<f64>) -> (usize, usize) {
        let row = row.iter().map(|&x| DVec2::new(x, 90.0));
        let on = on.map(|x| DVec2::new(x, 90.0 - 300.0_f64.sqrt()));
        let balls: Vec<_> = row.chain(on).map(|place| Ball::new(place, 10.0).unwrap()).collect();
        let mut contact = Contact::new(&boxed_world(DVec2::new(200.0, 100.0)), &balls, TUNING);
        // What pushes towards the left wall, if any stands there, and what sees that it does.
        for _ in 0..4 {
            for body in &mut contact.bodies {
                body.velocity.x -= 0.5;
            }
            contact.step(&mut Tally::default());
        }
        let stripe = &contact.near.as_ref().unwrap().stripes[0];
        (stripe.touching.len(), stripe.carrying.len())
    }

    #[test]
    fn of_a_row_on_the_floor_none_carries_another_unless_it_leans_on_something() {
        assert_eq!(pairs(&[60.0, 80.0, 100.0], None), (2, 0), "free");
        assert_eq!(pairs(&[10.0, 30.0, 50.0], None), (2, 2), "at a wall");
        assert_eq!(pairs(&[60.0, 80.0, 100.0], Some(70.0)), (4, 4), "under another");
        assert_eq!(pairs(&[60.0, 80.0, 120.0, 140.0], Some(70.0)), (4, 3), "beside others");
    }
}
