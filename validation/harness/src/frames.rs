//! Frames for ParaView, written between the steps of a run. Writing them must not change the run, so no step
//! is shortened to reach the time of a frame.

use std::path::PathBuf;

use touchstone_base::{
    files::{FileError, OutputFolder},
    record::Profile,
    vtk,
};
use touchstone_solver::{Numbers, Particle, Stepper, Symmetric};

/// Writes `count` frames at equal intervals, each after the first step that reaches its time, and the last
/// one at the end. In a leapfrog the velocities of a frame are half a step behind the places.
pub struct Frames<'a> {
    folder: OutputFolder,
    /// Pressure \[Pa\] of a density \[kg/m³\].
    pressure: &'a dyn Fn(f64) -> f64,
    end: f64,
    count: usize,
    /// Names by time \[s\].
    written: Vec<(f64, String)>,
    /// Frames that are due, whether or not they could be written.
    come: usize,
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
        let folder = OutputFolder::create_inside(folder)?;
        Ok(Self { folder, pressure, end, count: (*count).max(1), written: Vec::new(), come: 0 })
    }

    /// The frames so far by time \[s\], and how many were tried.
    pub fn written(&self) -> (Vec<(f64, String)>, usize) {
        (self.written.clone(), self.come)
    }

    /// Goes on after these frames of an earlier run; some may have been removed. One whose time had
    /// come when that run was interrupted may be still to be written.
    pub fn go_on(&mut self, (mut written, come): (Vec<(f64, String)>, usize)) {
        written.retain(|(_, name)| self.folder.path().join(name).is_file());
        (self.written, self.come) = (written, come);
    }

    /// Whether the next frame is due. The last one is due at the end.
    pub fn is_due(&self, time: f64) -> bool {
        let next = self.come + 1;
        next < self.count && time >= self.end * next as f64 / self.count as f64
    }

    /// Writes a frame: between steps one whose time has come, at the end the last one.
    ///
    /// # Errors
    /// If the frame cannot be written; later frames still can.
    pub fn write<X: Numbers>(&mut self, simulation: &dyn Stepper<X>) -> Result<(), FileError> {
        let name = format!("particles_{:04}.vtu", self.come);
        self.come += 1;
        let columns = columns(&simulation.particles(), self.pressure);
        let refused = |reason| FileError::File { path: self.folder.path().join(&name), reason };
        let frame = vtk::particles(simulation.time(), &columns).map_err(refused)?;
        self.folder.write(&name, frame.as_bytes())?;
        self.written.push((simulation.time(), name));
        self.folder.write("particles.pvd", vtk::collection(&self.written).as_bytes())?;
        Ok(())
    }
}

/// Name of the deviatoric stress of a solid: xx, yy, xy \[Pa\].
const STRESS: &str = "deviatoric stress";

/// All fields of the particles at one time, as columns. A particle keeps its number through a run.
pub fn columns<X: Numbers>(particles: &[Particle<X>], pressure: &dyn Fn(f64) -> f64) -> Profile {
    let column = |f: &dyn Fn(&Particle<X>) -> f64| particles.iter().map(f).collect();
    let profile = Profile::default()
        .with("id", "-", (0..particles.len()).map(|k| k as f64).collect())
        .with("role", "-", column(&|p| f64::from(p.role as u8)))
        .with("x", "m", column(&|p| p.position.x))
        .with("y", "m", column(&|p| p.position.y))
        .with("u", "m/s", column(&|p| p.velocity.x))
        .with("v", "m/s", column(&|p| p.velocity.y))
        .with("density", "kg/m^3", column(&|p| p.density))
        .with("pressure", "Pa", column(&|p| pressure(p.density)));
    let stress: Vec<_> =
        particles.iter().filter_map(|p| p.extra.stress()).map(Symmetric::components).collect();
    let names = ["xx", "yy", "xy"].into_iter().enumerate().filter(|_| !stress.is_empty());
    let profile = names.fold(profile, |profile, (k, name)| {
        profile.with(&format!("{STRESS} {name}"), "Pa", stress.iter().map(|s| s[k]).collect())
    });
    profile.with("mass", "kg/m", column(&|p| p.mass))
}
