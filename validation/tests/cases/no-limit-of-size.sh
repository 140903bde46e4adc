# kind: what would take more memory or time than a run may is refused before it is allocated
ulimit -v 4000000
refused() {
    timeout 60 "$@" >out 2>&1
    code=$?
    test $code = 2 || { cat out; echo "$*: $code"; exit 1; }
}
refused touchstone export couette --set rows=2000 --set columns=100000 --out o1
refused touchstone symmetry couette --set rows=2000 --set columns=100000
refused touchstone symmetry taylor_green --set n=2000
refused touchstone export rubber_rings --set spacing=1e-3 --out o2
refused touchstone export cantilever --set n=1000 --out o3
refused touchstone export oscillating_plate --set n=1000 --out o4
refused touchstone export couette --solve --set rows=2000 --set columns=2000 --out o5
small s
sed -i 's|"rows": 4|"rows": 2000|; s|"columns": 0|"columns": 100000|' s/problem.json
refused touchstone submit couette s --store st
