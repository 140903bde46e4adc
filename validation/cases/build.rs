//! Packs what `references/peers` has of runs of other codes, for `src/peers.rs`.

use std::{io, path::Path};

#[path = "../base/pack.rs"]
mod pack;

fn main() -> io::Result<()> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../references/peers/records");
    println!("cargo:rerun-if-changed=../base/pack.rs");
    pack::write("peers", &pack::entries(&folder)?)
}
