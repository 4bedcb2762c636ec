//! The cell method and temporal bounding volumes, over frames, against rays that share no code with the library.

mod frames;
mod rays;
mod scenes;
