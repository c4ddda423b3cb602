//! Walls that move: drives, rods and plates, against closed forms, tables of independent codes and
//! a solver that shares nothing with the program.

mod drives;
mod random;
mod scenes;
mod walls;
