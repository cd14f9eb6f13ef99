//! What once broke it, a file each: the input that did, and what is right.

mod a_moment_after_a_substep;
mod accounts_within_a_substep;
mod deep_tables;
mod hours_of_rain;
mod long_words;
mod long_words_of_replays;
mod many_fills;
mod more_balls_than_there_may_be;
mod no_answer_in_a_jam;
mod replay_too_narrow;
mod settled_between_walls;
mod sliding_under_strong_gravity;
mod slow_flight_far_out;
mod step_in_a_jam;
mod stopped_at_extreme_speed;
mod waits_beside_unlike_balls;
