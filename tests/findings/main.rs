//! What once broke it, a file each: the input that did, and what is right.

mod deep_tables;
mod long_words;
mod many_fills;
mod more_balls_than_there_may_be;
