//! Packs the runs and answers of other codes in `references/peers`, for `src/peers.rs` and `src/probes.rs`.

use std::{io, path::Path};

#[path = "../base/pack.rs"]
mod pack;

fn main() -> io::Result<()> {
    let peers = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../references/peers");
    println!("cargo:rerun-if-changed=../base/pack.rs");
    pack::write("probes", &pack::entries(&peers.join("probes"))?)?;
    pack::write("peers", &pack::entries(&peers.join("records"))?)
}
