# kind: a density or speed that no run has which did not diverge fails, in whatever frame and case
diverged() {
    touchstone submit "$1" "$2" --store st >out 2>&1
    code=$?
    test $code = 1 && grep -q "diverged at t = .* $3 of particle" out && return
    cat out
    echo "$1: $code"
    exit 1
}
honest still hydrostatic
cp -r still slow
edit still 'NR > 1 && $1 != t { t = $1; frame++ } frame == 2 { $5 = 1e9 } 1'
diverged hydrostatic still velocity
edit slow 'NR > 1 && $1 != t { t = $1; frame++ } frame == 2 { $7 = 1e-9 } 1'
diverged hydrostatic slow density
honest round taylor_couette
edit round 'NR > 1 { $7 /= 1000 } 1'
diverged taylor_couette round density
honest bar elastic_bar
edit bar 'NR > 1 { $7 /= 1000 } 1'
diverged elastic_bar bar density
honest drop elliptic_drop
edit drop 'NR > 1 { $7 = 1e300 } 1'
diverged elliptic_drop drop density
