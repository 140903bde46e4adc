# kind: a table that was cut within its last number is refused
# says: does not end
small s
size=$(wc -c <s/results.csv)
head -c $((size - 4)) s/results.csv >cut && mv cut s/results.csv
touchstone submit couette s --store st
test $? = 2 || exit 1
honest c couette --variant modern --set rows=20
printf 't[s],y[m],u[m/s]\n0.1,0.00025,1e-5' >c/curve.csv && rm c/results.csv
touchstone submit couette c --store st
test $? = 2
