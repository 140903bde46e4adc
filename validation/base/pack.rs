//! For build scripts: texts in one compressed file, which `touchstone_base::pack` reads.

use std::io::{self, Write};
use std::{env, fs, path::Path, path::PathBuf};

use flate2::{Compression, write::DeflateEncoder};

/// The entries of a folder, sorted.
pub fn entries(folder: &Path) -> io::Result<Vec<PathBuf>> {
    println!("cargo:rerun-if-changed={}", folder.display());
    let mut paths: Vec<PathBuf> =
        fs::read_dir(folder)?.map(|entry| Ok(entry?.path())).collect::<io::Result<_>>()?;
    paths.sort();
    Ok(paths)
}

/// Writes the texts of these files, each after its folder and name.
pub fn write(name: &str, paths: &[PathBuf]) -> io::Result<()> {
    let out = Path::new(&env::var_os("OUT_DIR").unwrap_or_default()).join(name);
    let mut into = DeflateEncoder::new(fs::File::create(out)?, Compression::best());
    for path in paths {
        let [folder, file] = [path.parent(), Some(path)].map(|at| at?.file_name()?.to_str());
        let text = fs::read_to_string(path)?;
        write!(into, "{}/{}\0{text}\0", folder.unwrap_or(""), file.unwrap_or(""))?;
    }
    into.finish().map(drop)
}
