//! Passes the compiler and the target to the library, `unknown` if not known, and packs the references.

use std::{env, fs, io, path::Path};

use hmac_sha256::Hash;

mod pack;
mod tell;

use tell::{output, set};

fn main() -> io::Result<()> {
    set("RUSTC", env::var("RUSTC").ok().and_then(|rustc| output(&rustc, &["--version"])));
    for (name, variable) in [
        ("PROFILE", "PROFILE"),
        ("OPT_LEVEL", "OPT_LEVEL"),
        ("TARGET", "TARGET"),
        ("FEATURES", "CARGO_CFG_TARGET_FEATURE"),
    ] {
        set(name, env::var(variable).ok());
    }
    for watched in ["build.rs", "pack.rs", "tell.rs"] {
        println!("cargo:rerun-if-changed={watched}");
    }
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../references");
    let is = |path: &Path, kind| path.extension().is_some_and(|of| of == kind);
    let mut list = String::new();
    for folder in pack::entries(&root)? {
        if folder.join("datapackage.json").exists() {
            let mut packed = Vec::new();
            for path in pack::entries(&folder)? {
                if is(&path, "json") || is(&path, "csv") && is_described(&path)? {
                    packed.push(path);
                }
            }
            let name = folder.file_name().and_then(|name| name.to_str()).unwrap_or_default();
            pack::write(name, &packed)?;
            list += &format!("({name:?}, include_bytes!({name:?})),\n");
        }
    }
    let out = env::var_os("OUT_DIR").unwrap_or_default();
    fs::write(Path::new(&out).join("references.rs"), format!("&[\n{list}]"))
}

/// Whether a package describes this table. A hash that it does not state is refused: here, so that no run has
/// to find out.
fn is_described(table: &Path) -> io::Result<bool> {
    let name = table.file_name().and_then(|name| name.to_str()).unwrap_or_default();
    let package = fs::read_to_string(table.with_file_name("datapackage.json"))?;
    // The rest of a resource, which has its hash, follows its path.
    let resources =
        package.split("\"path\"").skip(1).map(|rest| rest.trim_start_matches([' ', ':']));
    let is_this = |rest: &&str| rest.starts_with(&format!("\"{name}\""));
    let Some(resource) = resources.into_iter().find(is_this) else { return Ok(false) };
    let hash = Hash::hash(&fs::read(table)?).map(|byte| format!("{byte:02x}")).concat();
    if resource.contains(&format!("\"sha256:{hash}\"")) {
        return Ok(true);
    }
    let table = table.display();
    let words =
        format!("the hash of reference {table} is {hash}, which its package does not state");
    Err(io::Error::other(words))
}
