//! Tests of the command, in one program that is linked once.

#![allow(clippy::unwrap_used)] // clippy allows it in tests, not in their helpers

mod baselines;
mod cases;
mod cli;
mod common;
mod comparisons;
mod doors;
mod engines;
mod exports;
mod openings;
mod others;
mod pages;
mod probes;
mod readers;
mod schemas;
mod stores;
mod submissions;
mod verdicts;
