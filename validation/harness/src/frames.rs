//! Frames for ParaView, written between the steps of a run. Writing them must not change the run, so no step
//! is shortened to reach the time of a frame.

use std::path::PathBuf;

use base::{
    files::{FileError, OutputFolder},
    vtk::{Collection, Particles, VtkError},
};
use solver::{Flow, Numbers, Stepper};

/// Writes `count` frames at equal intervals, each after the first step that reaches its time, and the last
/// one at the end. In a leapfrog the velocities of a frame are half a step behind the places.
pub struct Frames<'a> {
    folder: OutputFolder,
    collection: Collection,
    /// Pressure \[Pa\] of a density \[kg/m³\].
    pressure: &'a dyn Fn(f64) -> f64,
    end: f64,
    count: usize,
    written: usize,
    failed: Option<FrameError>,
}

impl<'a> Frames<'a> {
    /// Frames of a run to time `end` \[s\] in this folder.
    ///
    /// # Errors
    /// If the folder cannot be made.
    pub fn new(
        (folder, count): &(PathBuf, usize),
        end: f64,
        pressure: &'a dyn Fn(f64) -> f64,
    ) -> Result<Self, FileError> {
        let folder = OutputFolder::create(folder)?;
        let (collection, count) = (Collection::default(), (*count).max(1));
        Ok(Self { folder, collection, pressure, end, count, written: 0, failed: None })
    }

    /// The frame of the end, if the run reached it, and what went wrong with any of them.
    ///
    /// # Errors
    /// The first frame that could not be written.
    pub fn finish<X, D>(mut self, end: Option<&D>) -> Result<(), FrameError>
    where
        X: Numbers,
        D: Stepper<X> + ?Sized,
    {
        match (self.failed.take(), end) {
            (Some(error), _) => Err(error),
            (None, Some(simulation)) => self.write(simulation),
            (None, None) => Ok(()),
        }
    }

    /// Writes the frames whose time has come.
    pub fn after_step<X: Numbers>(&mut self, simulation: &dyn Stepper<X>) -> Flow {
        while self.failed.is_none() && self.is_due(simulation.time()) {
            self.failed = self.write(simulation).err();
        }
        if self.failed.is_some() { Flow::Stop } else { Flow::Continue }
    }

    fn is_due(&self, time: f64) -> bool {
        let next = self.written + 1;
        next < self.count && time >= self.end * next as f64 / self.count as f64
    }

    fn write<X: Numbers>(
        &mut self,
        simulation: &(impl Stepper<X> + ?Sized),
    ) -> Result<(), FrameError> {
        let particles = simulation.particles();
        let column = |f: &dyn Fn(&solver::Particle<X>) -> f64| -> Vec<f64> {
            particles.iter().map(f).collect()
        };
        let xy = |v: nalgebra::Vector2<f64>| [v.x, v.y];
        let positions: Vec<_> = particles.iter().map(|p| xy(p.position)).collect();
        let velocities: Vec<_> = particles.iter().map(|p| xy(p.velocity)).collect();
        let number: Vec<f64> = (0..particles.len()).map(|k| k as f64).collect();
        let frame = Particles::new(simulation.time(), &positions)?
            .vector("velocity", &velocities)?
            .scalar("density", &column(&|p| p.density))?
            .scalar("pressure", &column(&|p| (self.pressure)(p.density)))?
            .scalar("mass", &column(&|p| p.mass))?
            .scalar("role", &column(&|p| f64::from(p.role as u8)))?
            .scalar("id", &number)?;
        let name = format!("particles_{:04}.vtp", self.written);
        self.folder.write(&name, frame.to_xml().as_bytes())?;
        self.collection.push(simulation.time(), &name);
        self.folder.write("particles.pvd", self.collection.to_xml().as_bytes())?;
        self.written += 1;
        Ok(())
    }
}

/// Why a frame was not written.
#[derive(Debug, thiserror::Error)]
pub enum FrameError {
    /// Its numbers.
    #[error(transparent)]
    Vtk(#[from] VtkError),
    /// Its file.
    #[error(transparent)]
    File(#[from] base::files::FileError),
}
