//! Embeds what `references/peers` has of runs of other codes: a list of texts that `src/peers.rs` includes.

use std::{env, fs, io, path::Path};

fn main() -> io::Result<()> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../references/peers/records");
    println!("cargo:rerun-if-changed={}", folder.display());
    let mut paths =
        fs::read_dir(&folder)?.map(|entry| Ok(entry?.path())).collect::<io::Result<Vec<_>>>()?;
    paths.sort();
    let texts: Vec<String> = paths.iter().map(|path| format!("include_str!({path:?})")).collect();
    let out = env::var_os("OUT_DIR").unwrap_or_default();
    fs::write(Path::new(&out).join("peers.rs"), format!("&[{}]", texts.join(",\n")))
}
