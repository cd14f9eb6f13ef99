//! The figures of a simulation while it runs, in a panel over the picture.

mod chart;
mod gauge;
mod number;
mod panel;

pub(in crate::window) use gauge::{Frame, Gauge};
pub(in crate::window) use panel::{Panel, Room};
