//! What lives in a window.

mod inspector;
