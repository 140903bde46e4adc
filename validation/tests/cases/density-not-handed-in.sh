# kind: a metric that needs a column which was not handed in is absent, by the name of the column
# says: density
# never: p_l2@?.* pass
honest s hydrostatic
cut -d, -f1-6 s/results.csv >r && mv r s/results.csv
touchstone submit hydrostatic s --all --store st >out 2>&1
cat out
! grep -E 'pass +hydrostatic[^ ]*p_l2' out
