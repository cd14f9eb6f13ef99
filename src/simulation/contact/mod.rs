//! The `contact` solver: substeps in which all contacts are solved together, two to eight in a 60th of a second
//! (`substeps`, `demands`).
//!
//! A substep, in the order of its parts:
//! 1. gravity, and what held each ball in the last substep, change the velocities (`Contact::accelerate`); where few balls only fly
//!    and lie on walls then, that is nearly all (`quiet`);
//! 2. pairs that may touch before long are looked for, where the last search no longer covers them (`find`, `near`,
//!    `constraints`, `order`; of single balls `cover`), and which balls are unlike those near them (`unlike`) and what they weigh
//!    where they are held (`weights`), if anything may carry any; the velocity that all have in common where nothing does is noted
//!    (`common`);
//! 3. balls that meet exchange momentum at their time of impact (`turns`, `stripe_turn`, `rewind`, `events`,
//!    `fates`, `impacts`, `ending`, `meeting`, `together`, `walls`); what lies between fixed ones, or one and a wall, is kept out
//!    of them, then and until all is held (`firm`);
//! 4. what then still presses on something is held by soft constraints without restitution, which start from the last
//!    substep's impulses (`prepare`, `support`, `wall_support`), and stopped on what carries it, from the ground up (`carry`, `abreast`,
//!    `wedges`, `floors`); what counts as heavier than it is, and is fast, is slowed down before;
//! 5. balls move, out of overlaps, too, and lose the velocity that took them out of these (`Pass::TRAVEL`, `Pass::RELAX`,
//!    `apart`); those that would end in others go only as far as there is room (`room`, `barred`, `centre`); they are kept from
//!    gaining energy by what holds them, unless they lie still, most strictly unlike ones, and those that were put into each other, until they
//!    have parted (`energy`, `islands`, `parting`), and those that were thrown by what holds them are let go of (`thrown`);
//! 6. those of a row along a wall that has no room for them are moved off it, with what energy that takes (`rows`);
//! 7. those that have rested for a while sleep, and those that are not in balance any more wake (`sleep`,
//!    `wake`, `loads`).
//!
//! Where nothing presses, events take their place (`handover`). What is done from outside is taken up between substeps, or
//! within one (`edits`, `changes`). Frames take as many of them as their time holds (`advance`); at a frame's end the balls are shown
//! as they are then (`show`, `legs`).
//!
//! What all parts need to know of the world stands in one place (`setting`). Each part works on stripes of neighbouring balls
//! (`layout`, `stripes`), which several threads may share (`team`); passes that follow each other go through them as caches like it
//! (`sweep`).
//!
//! Velocities are those half-way between two positions (leapfrog), so that a ball at rest has none. Frames evaluate the
//! substeps and never write back, so the result does not depend on how time is cut into frames.

mod abreast;
mod advance;
mod amount;
mod apart;
mod barred;
mod body;
mod carry;
mod centre;
mod changes;
mod common;
mod constraints;
mod cover;
mod demands;
mod edits;
mod ending;
mod energy;
mod events;
mod fates;
mod find;
mod firm;
mod floors;
mod handover;
mod impacts;
mod islands;
mod layout;
mod legs;
mod loads;
mod meeting;
mod near;
mod order;
mod parting;
mod prepare;
mod quiet;
mod rewind;
mod room;
mod rows;
mod setting;
mod show;
mod sleep;
mod softness;
mod stripe_turn;
mod stripes;
mod substeps;
mod support;
mod sweep;
mod team;
mod thrown;
mod together;
mod turns;
mod unlike;
mod wake;
mod wall_support;
mod walls;
mod wedges;
mod weights;

use glam::DVec2;

use super::ball::Ball;
use super::clock::Clock;
use super::grid::Grid;
use super::world::{Pairs, World};
use super::{Tally, Tuning, within};
use amount::Amount;
use body::Body;
use energy::Keeping;
use find::Cargo;
pub(super) use handover::{is_few, most_substeps};
use layout::{Layer, Layout};
use near::Near;
use parting::Parting;
use quiet::Across;
use room::Room;
use rows::Rows;
pub(super) use setting::can_rest;
use setting::{Setting, least_restitution, takes_energy};
use show::{Held, Start};
use sleep::Rest;
use substeps::Substeps;
use support::{give, two};
use sweep::{Pass, Share};
use team::Team;
use turns::Course;
use wall_support::hold_jammed;

/// A ball that an impact shifts by less than this part of its radius counts as not shifted.
const SHIFT: f64 = 0.02;
/// Balls that all give back more than this part of a speed are let off walls that would throw them, however many they are. Impacts of
/// others take again what they get so; and where many are let off, deep piles come to rest later.
const LIVELY: f64 = 0.9;

/// The solver.
#[derive(Debug, Clone)]
pub(super) struct Contact {
    setting: Setting,
    tuning: Tuning,
    substeps: Substeps,
    bodies: Vec<Body>,
    restitutions: Vec<f64>,
    /// Which ball each body is: bodies stand in the order of their places.
    ids: Vec<u32>,
    /// Which body each ball was when it was last shown.
    places: Vec<u32>,
    /// Whether each body sleeps.
    rests: Vec<Rest>,
    /// Whether all do.
    all_asleep: bool,
    /// How many did when that was last looked at.
    asleep: usize,
    near: Option<Near>,
    team: Team,
    /// Whether balls notice each other.
    pairs: bool,
    /// What holds each body.
    held: Vec<Held>,
    course: Course,
    room: Room,
    parting: Parting,
    rows: Rows,
    /// Where they are few, their order across the world.
    across: Across,
    /// Where contacts are only shown.
    shown: Option<Grid>,
    /// What happened to each body since the last frame.
    hit: Vec<bool>,
    /// How many of the steps in which time is counted are over.
    steps: u64,
    /// By how much the first substep is shorter than others because balls were there only after it had begun, s.
    late: f64,
    /// Whether it stops once nothing has pressed for so long that events suit what it does better.
    hands_back: bool,
    /// How many substeps in a row were quiet.
    quiet: u32,
    /// Each body one substep ago, while the frame lies within the last substep.
    before: Vec<Start>,
    clock: Clock,
}

impl Contact {
    pub(super) fn new(world: &World, balls: &[Ball], tuning: Tuning) -> Self {
        let pairs = has_pairs(world, balls);
        let substeps = Substeps::new(world, balls, tuning);
        let setting = Setting::new(world, balls, &substeps, tuning);
        let kick = setting.kick;
        let bodies: Vec<_> = balls.iter().map(|ball| Body::new(ball, kick)).collect();
        Self {
            setting,
            tuning,
            substeps,
            rests: bodies.iter().map(Rest::new).collect(),
            all_asleep: false,
            asleep: 0,
            bodies,
            restitutions: balls.iter().map(|ball| ball.restitution).collect(),
            ids: (0..balls.len() as u32).collect(),
            places: Vec::new(),
            near: (pairs || world.walls.is_some()).then(|| Near::new(pairs)),
            team: Team::default(),
            pairs,
            held: Vec::new(),
            course: Course::default(),
            room: Room::default(),
            parting: Parting::new(),
            rows: Rows::default(),
            across: Across::default(),
            shown: (world.pairs == Some(Pairs::Detect)).then(|| Grid::new(balls, world.size)),
            hit: vec![false; balls.len()],
            steps: 0,
            late: 0.0,
            hands_back: false,
            quiet: 0,
            before: Vec::new(),
            clock: Clock::default(),
        }
    }

    /// One substep.
    #[inline]
    fn step(&mut self, tally: &mut Tally) {
        self.change_length();
        self.accelerate();
        if self.pass_quietly(tally) {
            self.quiet += 1;
        } else {
            self.quiet = if self.is_quiet_among_fixed() { self.quiet + 1 } else { 0 };
            self.meet_and_hold(tally);
        }
        self.end_step();
    }

    /// Lets balls meet, holds what presses, and moves all.
    fn meet_and_hold(&mut self, tally: &mut Tally) {
        self.find();
        self.note_common();
        self.note_start();
        self.note_room();
        let between = self.find_between();
        self.impacts(tally);
        if self.setting.can_rest {
            self.slow_counted();
            let between = self.look_onward(between);
            self.find_keeping();
            self.support();
            // Without what has nothing to do: threads would wait for each other to find that out.
            let presses = self.setting.kick != DVec2::ZERO;
            let shaken = self.near.as_ref().is_some_and(|near| near.is_shaken(self.bodies.len()));
            let hold_again = if presses && shaken { Pass::HOLD_AGAIN } else { Pass::NOTHING };
            let [carry, hold_again] = self.stop_between(&between, [self.carry(), hold_again]);
            let add_up = if self.setting.keeping == Keeping::Nothing { Pass::NOTHING } else { Pass::ADD_UP };
            let moves = [carry, hold_again, Pass::TRAVEL];
            let others = self.relaxing().chain([Pass::FIND_THROWN, add_up]);
            self.move_on(&moves.into_iter().chain(others).collect::<Vec<_>>(), moves.len());
            self.keep_energy();
            self.let_go_of_deep();
            self.let_go_of_thrown();
            self.wake_unbalanced();
        } else {
            self.move_on(&[Pass::TRAVEL], 1);
        }
        if self.near.is_none() {
            self.fly();
        }
    }

    /// What is to do once all have moved.
    fn end_step(&mut self) {
        self.steps += self.substeps.length();
        if self.late > 0.0 {
            self.late = 0.0;
            self.begin_substeps_of_new_length();
        }
        self.part_rows();
        self.look_for_calm();
        self.fall_asleep();
    }

    /// Sweeps through these passes, and keeps balls out of others once so many of them have moved them.
    fn move_on(&mut self, passes: &[Pass<'_>], moves: usize) {
        if self.any_unfollowed() {
            let (moves, others) = passes.split_at(moves);
            self.sweep(moves);
            self.keep_to_room();
            self.keep_centres();
            self.sweep(others);
            if self.bounce_off_barred() && self.setting.keeping != Keeping::Nothing {
                // What was added up before they bounced says nothing any more.
                self.sweep(&[Pass::ADD_UP]);
            }
        } else {
            self.sweep(passes);
            self.keep_centres();
        }
    }

    /// Gravity, and what held each ball in the last substep.
    #[inline]
    fn accelerate(&mut self) {
        let Self { setting, bodies, team, .. } = self;
        let setting = &*setting;
        if !setting.can_rest {
            // Nothing changes a velocity but impacts.
            return;
        }
        let (kick, few) = (setting.kick, setting.amount == Amount::Few);
        // Not that of the last search: balls may have been added since.
        let layout = Layout::of(bodies.len());
        team.each(layout.share(Layer::Own, bodies), |bodies| {
            for body in bodies {
                if kick == DVec2::ZERO {
                    // Nothing presses: what held balls when they met is of no use any more.
                    body.free = body.velocity;
                    continue;
                }
                if few {
                    // What flies is followed in closed form, again and again: of few balls each flight counts.
                    body.forget_rounding(kick);
                }
                let change = body.change(kick);
                body.free = body.velocity + if body.inverse_mass > 0.0 { kick } else { DVec2::ZERO };
                body.velocity += change;
                if setting.jammed.any() {
                    hold_jammed(setting, body);
                }
            }
        });
    }

    /// Looks for pairs anew where what was found no longer covers this substep.
    #[inline]
    fn find(&mut self) {
        let Self { setting, bodies, restitutions, ids, rests, near: Some(near), team, hit, before, .. } =
            self
        else {
            return;
        };
        let searched = !near.keep_up(bodies, setting, team);
        if searched {
            near.search(Cargo { bodies, restitutions, ids, hit, rests, before }, setting, team);
        }
        let on_walls = near.beside().next().is_some();
        let grounded = setting.has_fixed || on_walls;
        let landed = std::mem::replace(&mut setting.grounded, grounded) != grounded;
        let presses = setting.can_rest && setting.kick != DVec2::ZERO;
        let lets_off = on_walls && (setting.amount == Amount::Few || setting.least_restitution > LIVELY);
        if (self.weigh_balls(searched, landed) || searched) && presses {
            self.sweep(&[Pass::LET_GO, Pass::PUSH_AGAIN]);
            self.take_back_thrown();
        }
        if searched && presses {
            self.find_parting();
        }
        if lets_off && presses {
            self.sweep(&[Pass::LET_OFF_WALLS]);
        }
    }

    /// Goes on to the end of the substep that this step is in, while nothing moves.
    fn sleep_until(&mut self, step: u64) {
        self.steps = step.next_multiple_of(self.substeps.next_length());
    }

    /// The share of the last substep that has passed at the clock's time.
    fn share(&self) -> f64 {
        let Substeps { rate, .. } = self.substeps;
        let (over, rest) = self.clock.steps(rate);
        // It may be over by then or not.
        let began = self.steps.saturating_sub(self.substeps.length());
        let passed = over.saturating_sub(began) as f64 + rest * f64::from(rate);
        passed / self.substeps.length() as f64
    }

    /// Moves balls that meet nothing.
    fn fly(&mut self) {
        for body in &mut self.bodies {
            body.position += body.velocity * self.setting.substep;
        }
    }
}

impl Pass<'_> {
    /// Does nothing.
    pub(super) const NOTHING: Self = Self { layers: &[], only_busy: true, work: &|_, _, _| () };

    /// Takes from balls what held them: pairs that are not near any more hold nothing.
    const LET_GO: Self = Self {
        layers: &[Layer::Own],
        only_busy: false,
        work: &|_, _, Share { bodies, .. }| bodies.iter_mut().for_each(|body| body.velocity = body.free),
    };

    /// Gives it back to those that something still holds.
    const PUSH_AGAIN: Self = Self {
        layers: Layer::OUTWARD,
        only_busy: true,
        work: &|_, stripe, Share { bodies, .. }| {
            for constraint in stripe.constraints.iter().filter(|constraint| constraint.impulse > 0.0) {
                let push = constraint.normal * constraint.impulse + constraint.grip;
                let (first, second) = two(bodies, constraint.pair);
                give(push, first, second);
            }
            for beside in &stripe.beside {
                let body = &mut bodies[beside.body as usize];
                if body.inverse_mass > 0.0 {
                    body.velocity += beside.push;
                }
            }
        },
    };

    /// Moves the balls, none farther than the search for pairs has covered, and none through a wall.
    const TRAVEL: Self = Self {
        layers: &[Layer::Own],
        only_busy: false,
        work: &|setting, stripe, Share { bodies, homes, .. }| {
            let Setting { substep, size, .. } = *setting;
            for ((at, body), home) in (0..).zip(bodies.iter_mut()).zip(homes.iter()) {
                body.position += body.velocity * substep;
                if !home.covers(body.position) {
                    body.position = home.limit(body.position);
                    stripe.strays.push(at);
                }
            }
            // No others can be at a wall; where there is none, none is beside one.
            for beside in &stripe.beside {
                let body = &mut bodies[beside.body as usize];
                if body.inverse_mass > 0.0 {
                    body.position = within(body.position, body.radius, size);
                }
            }
        },
    };
}

/// Whether there are balls that notice each other.
fn has_pairs(world: &World, balls: &[Ball]) -> bool {
    world.pairs == Some(Pairs::Impulse) && balls.len() > 1
}

/// What the tests of the parts begin with.
#[cfg(test)]
mod testing {
    use super::{DVec2, Pairs, Tuning, World};

    pub(super) const TUNING: Tuning = Tuning { rest_speed: 1.0, substeps: None, sleep: true, threads: 1 };

    /// A world of this size with gravity, walls and pairs.
    pub(super) fn boxed_world(size: DVec2) -> World {
        let world = World::new(size).unwrap().with_gravity(DVec2::new(0.0, 980.0)).unwrap();
        world.with_walls(0.5).unwrap().with_pairs(Pairs::Impulse)
    }
}
