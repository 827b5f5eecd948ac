//! The oracle: its surface, its distances and its dicing, against closed forms and brute force.

mod distances;
mod surfaces;
