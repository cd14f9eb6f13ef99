//! Balls that are held against each other come to rest as a group.
//!
//! What lies on others would hit them without end: the load of a pile of n layers comes through n times as many impacts
//! as that of one ball. So a ball that has chattered for long asks for its group, all balls that touch each other
//! there, and two questions are answered for all of them at once. First, what becomes of their velocities when the
//! impacts that are left take all approach: so a ball is stopped in a wedge, and a row between walls. Second, whether
//! forces at their contacts can balance gravity. Balls that are in balance and slow stand still from then on: they are
//! *held*, until something hits them firmly, or one that they touch is freed, or the balance is lost when another ball
//! joins the group.

use glam::DVec2;

use crate::simulation::flight::DEEP;

use super::flights::{Flight, Marks, Matter};
use super::{Exact, LEAN, Needs};

/// The part of gravity that may be left unbalanced on a ball that is held: as if there were so much friction.
const UNBALANCED: f64 = 1e-3;
/// How slow balls that touch, but have not chattered, are beside each other if they are of one group, in rest speeds.
const SLOW: f64 = LEAN;
/// How fast, in rest speeds, what hits a held ball is if it frees it. What is slower bounces off it as off a fixed one.
pub(super) const FIRM: f64 = 2.0;
/// How far below another a ball is, as a part of the distance at which they touch, that cannot lean on it.
const BESIDE: f64 = 0.25;
/// The most balls of a group. Held ones beyond it count as immovable.
const LARGEST: usize = 4096;
/// The part of the approach that may be left when it is taken: what is left, the next impacts see to.
const PRECISION: f64 = 1e-6;
/// How fast a ball leaves the wall that it rests on at least, in rest speeds.
const LIFTED: f64 = 1e-3;
/// How often it is tried to find those contacts that push.
const ROUNDS: usize = 12;
/// Steps of conjugate gradients, over one contact, that are paid for with one event. They take about a hundredth of the
/// time of that, so that the search for groups takes a third of all time at most.
const STEPS_PER_EVENT: usize = 32;
/// So many times as much is paid for a search that finds nothing.
const IN_VAIN: i64 = 4;
/// So many events at one time and more say that balls that overlap have no room to part.
const STUCK: usize = 1000;
/// Balls that are in so many others each are no group that could rest: it would take long to find out.
const MOST_CONTACTS: usize = 8;
/// Forces at so few contacts are found to rounding: in a steep wedge they are many times a ball's weight.
const FEW_CONTACTS: usize = 32;
/// No place in a group.
const NONE: u32 = u32::MAX;

/// A ball of a group.
#[derive(Debug, Clone, Copy)]
struct Member {
    slot: usize,
    position: DVec2,
    /// It overlaps another by more than rounding.
    deep: bool,
    stays: bool,
}

/// Two members that touch, or one and what nothing moves.
#[derive(Debug, Clone, Copy)]
struct Contact {
    one: usize,
    against: Support,
    /// The unit vector to the one.
    normal: DVec2,
    /// The sum of the inverse masses.
    give: f64,
    /// The force, or the momentum, that each gives to the other.
    push: f64,
    /// Whether there is to be no relative motion along the contact; else there is no push.
    pushes: bool,
}

/// What a member touches.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Support {
    Member(usize),
    Wall,
    /// A ball that counts as immovable, by its slot.
    Immovable(usize),
}

/// Balls that touch each other, directly or through others.
#[derive(Debug, Default)]
struct Group {
    members: Vec<Member>,
    inverse_masses: Vec<f64>,
    velocities: Vec<DVec2>,
    /// The members' accelerations, px/s²: gravity, then what the pushes at the contacts leave of it.
    accelerations: Vec<DVec2>,
    contacts: Vec<Contact>,
}

impl Exact {
    /// Stops the group of a ball that has chattered for long, and lays it to rest as far as it is in balance.
    pub(super) fn settle<N: Needs>(&mut self, slot: usize, now: f64) {
        if self.credit < 0 {
            return;
        }
        let mut group = self.gather::<N>(slot, now);
        if group.contacts.len() > MOST_CONTACTS * group.members.len() {
            self.credit -= IN_VAIN * (group.members.len() + group.contacts.len() / STEPS_PER_EVENT) as i64;
            group.members.iter().for_each(|member| self.marks[member.slot].calm_down());
            return;
        }
        let mut steps = group.take_approach();
        if self.gravity != DVec2::ZERO {
            let gravity = self.gravity.length();
            steps += group.balance(gravity);
            group.choose(gravity, self.rest_speed, self.at_once > STUCK);
        }
        let cost = (group.members.len() + steps * group.contacts.len() / STEPS_PER_EVENT) as i64;
        // Where nothing comes to rest, it is too early.
        let in_vain = group.members.iter().all(|member| !member.stays);
        self.credit -= if in_vain { IN_VAIN * cost } else { cost };
        let among_balls = group.contacts.iter().any(|contact| contact.against != Support::Wall);
        for (&Member { slot, position, stays, .. }, &velocity) in group.members.iter().zip(&group.velocities)
        {
            let held = self.marks[slot].has(Marks::HELD);
            self.marks[slot].calm_down();
            if held && stays {
                continue;
            }
            if held {
                self.let_go::<N>(slot);
            }
            self.marks[slot].set(Marks::HELD, stays);
            if among_balls {
                // What it touches, or as good as, has stopped it, or let it go.
                self.marks[slot].set(Marks::HIT, true);
            }
            let mut velocity = if stays { DVec2::ZERO } else { velocity };
            for axis in 0..2 {
                let rests = Marks::rests_on(axis);
                if stays {
                    self.marks[slot].set(rests, true);
                } else if self.marks[slot].has(rests) {
                    // Lifted off the wall it rested on, or moved by what is left of the approach.
                    let lifted = velocity[axis].abs() > LIFTED * self.rest_speed;
                    self.marks[slot].set(rests, !lifted);
                    velocity[axis] = if lifted { velocity[axis] } else { 0.0 };
                }
            }
            self.set_out(slot, (position, velocity), now);
            self.foresee::<N>(slot, now);
        }
        self.note_leaning(&group);
    }

    /// Notes which balls that are held are shown as touching others.
    fn note_leaning(&mut self, group: &Group) {
        let held = |index: usize| Some(&group.members[index]).filter(|member| member.stays);
        for contact in group.contacts.iter().filter(|contact| contact.push > 0.0) {
            let Some(one) = held(contact.one) else { continue };
            match contact.against {
                Support::Wall => continue,
                Support::Member(other) => self.marks[group.members[other].slot].set(Marks::LEANS, true),
                Support::Immovable(other) => {
                    let pair = (one.slot as u32, other as u32);
                    if !self.propped.contains(&pair) {
                        self.propped.push(pair);
                    }
                }
            }
            self.marks[one.slot].set(Marks::LEANS, true);
        }
    }

    /// How near balls are that touch, px: twice as far as one at the rest speed hops from another.
    fn touch_distance(&self) -> f64 {
        (0.5 * self.rest_speed * self.chatter_time).min(self.chatter_length)
    }

    /// The balls that touch a ball, those that touch these and so on, as far as they are slow beside each other.
    fn gather<N: Needs>(&mut self, slot: usize, now: f64) -> Group {
        let mut group = Group::default();
        let mut found = std::mem::take(&mut self.found);
        found.resize(self.flights.len(), NONE);
        let touch = self.touch_distance();
        let add = |group: &mut Group, slot: usize| {
            group.add(slot, self.state::<N>(slot, now), self.matter::<N>(slot).mass, self.gravity) as u32
        };
        let restless = |slot: usize| 2 * self.marks[slot].chatter() >= Marks::MOST_CHATTER;
        found[slot] = add(&mut group, slot);
        let mut at = 0;
        while at < group.members.len() {
            let Member { slot: one, position, .. } = group.members[at];
            let Matter { radius, restitution, .. } = *self.matter::<N>(one);
            for (axis, high) in [(0, false), (0, true), (1, false), (1, true)] {
                let place = position[axis];
                let gap = if high { self.size[axis] - radius - place } else { place - radius };
                if self.walls.is_some() && gap < touch {
                    group.add_contact(at, Support::Wall, DVec2::AXES[axis] * if high { -1.0 } else { 1.0 });
                }
            }
            let Some(cells) = self.cells.as_ref().filter(|_| !N::DETECT) else { break };
            cells.for_each_near::<N>(one, None, self.flights[one].place, None, |slot| {
                // Those that were looked at before know of this one.
                if (found[slot] as usize) < at {
                    return;
                }
                let (their_position, their_velocity) = self.state::<N>(slot, now);
                let matter = self.matter::<N>(slot);
                let offset = position - their_position;
                let (length, reach) = (offset.length(), radius + matter.radius);
                if length - reach >= touch || length == 0.0 || restitution.min(matter.restitution) == 1.0 {
                    return;
                }
                let normal = offset / length;
                let held = self.marks[slot].has(Marks::HELD);
                let is_new = found[slot] == NONE && !matter.is_fixed();
                if is_new {
                    let speed = (group.velocities[at] - their_velocity).dot(normal).abs();
                    let joins = held || restless(slot) || speed < SLOW * self.rest_speed;
                    if joins && group.members.len() < LARGEST {
                        found[slot] = add(&mut group, slot);
                    } else if !held {
                        return;
                    }
                }
                let place = found[slot];
                let against =
                    if place == NONE { Support::Immovable(slot) } else { Support::Member(place as usize) };
                group.add_contact(at, against, normal);
                if reach - length > DEEP * reach {
                    group.members[at].deep = true;
                    if let Support::Member(other) = against {
                        group.members[other].deep = true;
                    }
                }
            });
            at += 1;
        }
        group.members.iter().for_each(|member| found[member.slot] = NONE);
        self.found = found;
        group
    }

    /// Ends the hold on a ball; whoever does it lets it set out, and finds out what comes next.
    fn let_go<N: Needs>(&mut self, slot: usize) {
        let radius = self.matter::<N>(slot).radius;
        for axis in 0..2 {
            let jams = self.jams(radius, axis);
            self.marks[slot].set(Marks::rests_on(axis), jams);
        }
        let marks = &mut self.marks[slot];
        marks.set(Marks::HELD, false);
        marks.calm_down();
        // It touched others until now, and does so no more where the next frame is shown.
        marks.set(Marks::HIT, true);
        self.propped.retain(|&(ball, _)| ball as usize != slot);
    }

    /// Frees a held ball that is hit, with the held ones that it touches, and in turn those that lie on them or beside
    /// them. Whoever hits it finds out what comes next for the ball itself.
    pub(super) fn free<N: Needs>(&mut self, hit: usize, now: f64) {
        let mut freed = vec![hit];
        let touch = 2.0 * self.touch_distance();
        let mut at = 0;
        while at < freed.len() {
            let one = freed[at];
            if self.marks[one].has(Marks::HELD) {
                let Flight { position, place, .. } = self.flights[one];
                self.let_go::<N>(one);
                self.set_out(one, (position, DVec2::ZERO), now);
                let radius = self.matter::<N>(one).radius;
                let Some(cells) = &self.cells else { break };
                cells.for_each_near::<N>(one, None, place, None, |other| {
                    if self.marks[other].has(Marks::HELD) {
                        let offset = self.flights[other].position - position;
                        let reach = radius + self.matter::<N>(other).radius;
                        let below = offset.dot(self.gravity) > BESIDE * reach * self.gravity.length();
                        if offset.length() - reach < touch && (one == hit || !below) {
                            freed.push(other);
                        }
                    }
                });
            }
            at += 1;
        }
        for slot in freed.into_iter().filter(|&slot| slot != hit) {
            self.foresee::<N>(slot, now);
        }
    }
}

impl Contact {
    /// How fast the two part, or are driven apart.
    fn parting(&self, motions: &[DVec2]) -> f64 {
        let other = if let Support::Member(other) = self.against { motions[other] } else { DVec2::ZERO };
        (motions[self.one] - other).dot(self.normal)
    }

    /// Changes the motions of the two by a push.
    fn apply(&self, push: f64, motions: &mut [DVec2], inverse_masses: &[f64]) {
        motions[self.one] += self.normal * (push * inverse_masses[self.one]);
        if let Support::Member(other) = self.against {
            motions[other] -= self.normal * (push * inverse_masses[other]);
        }
    }
}

impl Group {
    /// Takes a ball in, and returns its place in the group.
    fn add(&mut self, slot: usize, (position, velocity): (DVec2, DVec2), mass: f64, gravity: DVec2) -> usize {
        self.members.push(Member { slot, position, deep: false, stays: false });
        self.inverse_masses.push(mass.recip());
        self.velocities.push(velocity);
        self.accelerations.push(gravity);
        self.members.len() - 1
    }

    fn add_contact(&mut self, one: usize, against: Support, normal: DVec2) {
        let theirs = if let Support::Member(other) = against { self.inverse_masses[other] } else { 0.0 };
        let give = self.inverse_masses[one] + theirs;
        self.contacts.push(Contact { one, against, normal, give, push: 0.0, pushes: false });
    }

    /// Takes the approach from velocities, as impacts without restitution would in the end, and returns how many steps
    /// it took.
    fn take_approach(&mut self) -> usize {
        let approaches = self.contacts.iter().map(|contact| -contact.parting(&self.velocities));
        let most = approaches.fold(0.0, f64::max);
        let (mut velocities, mut contacts) = (self.velocities.clone(), self.contacts.clone());
        let steps = relieve(&mut velocities, &self.inverse_masses, &mut contacts, PRECISION * most);
        // Where no answer was found, not even that they lose energy is sure.
        if self.energy(&velocities) <= self.energy(&self.velocities) {
            self.velocities = velocities;
        }
        steps
    }

    /// Twice their kinetic energy.
    fn energy(&self, velocities: &[DVec2]) -> f64 {
        let each = velocities.iter().zip(&self.inverse_masses);
        each.map(|(velocity, inverse_mass)| velocity.length_squared() / inverse_mass).sum()
    }

    /// Looks for forces that balance gravity, and returns how many steps it took.
    fn balance(&mut self, gravity: f64) -> usize {
        let precision = if self.contacts.len() <= FEW_CONTACTS { 1e-14 } else { 0.1 * UNBALANCED };
        relieve(&mut self.accelerations, &self.inverse_masses, &mut self.contacts, precision * gravity)
    }

    /// Chooses the members that stay: slow, in balance, and neither supported nor pressed by any but such as stay.
    /// What overlaps is to part first, unless it is `stuck`: there is no room.
    fn choose(&mut self, gravity: f64, rest_speed: f64, stuck: bool) {
        let Self { members, velocities, accelerations, contacts, .. } = self;
        let enough = UNBALANCED * gravity;
        for ((member, velocity), acceleration) in members.iter_mut().zip(velocities).zip(&*accelerations) {
            let still = if member.deep { stuck } else { velocity.length() <= rest_speed };
            member.stays = still && acceleration.length() <= enough;
        }
        let mut found = false;
        while !found {
            found = true;
            for contact in &*contacts {
                let Support::Member(other) = contact.against else { continue };
                let counts = contact.push > 0.0 || contact.parting(accelerations) < -enough;
                if counts && members[contact.one].stays != members[other].stays {
                    (members[contact.one].stays, members[other].stays) = (false, false);
                    found = false;
                }
            }
        }
    }
}

/// Solves the linear complementarity problem of the contacts: finds pushes, none of which pulls, that leave the
/// members' motions without approach, and returns how many steps it took. At first all contacts push that do not part,
/// then those that would pull do not, and those that approach do, and again (block pivoting; Portugal, Júdice & Vicente
/// 1994).
fn relieve(motions: &mut [DVec2], inverse_masses: &[f64], contacts: &mut [Contact], enough: f64) -> usize {
    let mut steps = 0;
    for contact in &mut *contacts {
        contact.pushes = contact.parting(motions) <= 0.0;
    }
    for _ in 0..ROUNDS {
        contacts.sort_by_key(|contact| !contact.pushes);
        let pushing = contacts.partition_point(|contact| contact.pushes);
        steps += 1 + solve(motions, inverse_masses, &mut contacts[..pushing], enough);
        let mut found = true;
        for contact in &mut *contacts {
            if contact.push < 0.0 {
                contact.apply(-contact.push, motions, inverse_masses);
                (contact.push, contact.pushes, found) = (0.0, false, false);
            }
        }
        for contact in &mut contacts[pushing..] {
            if contact.parting(motions) < -enough {
                (contact.pushes, found) = (true, false);
            }
        }
        if found {
            break;
        }
    }
    steps
}

/// Finds the pushes after which there is no relative motion along any contact, up to `enough`, from those that there
/// are, by preconditioned conjugate gradients (Hestenes & Stiefel 1952), and returns how many steps it took.
fn solve(motions: &mut [DVec2], inverse_masses: &[f64], contacts: &mut [Contact], enough: f64) -> usize {
    let most = 2 * contacts.len() + 20;
    let mut residuals: Vec<f64> = contacts.iter().map(|contact| -contact.parting(motions)).collect();
    let mut directions = vec![0.0; contacts.len()];
    let mut moved = vec![DVec2::ZERO; motions.len()];
    let mut before = f64::INFINITY;
    for taken in 0..most {
        if residuals.iter().all(|residual| residual.abs() <= enough) {
            return taken;
        }
        let squares =
            contacts.iter().zip(&residuals).map(|(contact, residual)| residual * residual / contact.give);
        let square = squares.sum::<f64>();
        moved.fill(DVec2::ZERO);
        for ((contact, residual), direction) in contacts.iter().zip(&residuals).zip(&mut directions) {
            *direction = residual / contact.give + square / before * *direction;
            contact.apply(*direction, &mut moved, inverse_masses);
        }
        before = square;
        let curvatures =
            contacts.iter().zip(&directions).map(|(contact, direction)| contact.parting(&moved) * direction);
        let curvature = curvatures.sum::<f64>();
        if curvature <= 0.0 {
            return taken;
        }
        let step = square / curvature;
        for ((contact, residual), direction) in contacts.iter_mut().zip(&mut residuals).zip(&directions) {
            contact.push += step * direction;
            *residual -= step * contact.parting(&moved);
        }
        motions.iter_mut().zip(&moved).for_each(|(motion, moved)| *motion += *moved * step);
    }
    most
}
