//! Tests of the command, in one program that is linked once.

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
