//! Frames one after the other: what is between two tessellations, and what the frames of a job show.

mod animation;
mod common;
mod frames;
