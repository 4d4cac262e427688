//! What is seen and done in a window, driven without one.

mod inspector;
mod schedules;
