//! Properties that cross the crates, as one program: a scheme that several of them use is compiled once.

mod consistent;
mod cost;
mod dam_power;
mod extremes;
mod frozen_lattice;
mod gate_power;
mod gate_power_runs;
mod hill_power;
mod identities;
mod integration;
mod invariance;
mod layers;
mod new_case;
mod pairs;
mod plans;
mod restart;
mod ring_power;
mod shifting;
mod snapshots;
mod solid;
mod threads;
mod tidy;
mod walls;
