# kind: a file costs in proportion to its length
small s
small v
rm s/results.csv v/results.csv
awk 'BEGIN { print "ITEM: TIME\n0"; for (k = 0; k < 50000; k++) print "ITEM: NUMBER OF ATOMS\n1\nITEM: ATOMS id x y vx vy\n1 0 0 0 0" }' >s/r.dump
timeout 20 touchstone submit couette s --store st
test $? = 2 || exit 1
awk 'BEGIN { printf "<VTKFile>"; for (k = 0; k < 10000; k++) printf "<a xmlns:n%d=\"u%d\">", k, k
    for (k = 0; k < 10000; k++) printf "</a>"; print "</VTKFile>" }' >v/r.vtu
timeout 20 touchstone submit couette v --store st
test $? = 2
