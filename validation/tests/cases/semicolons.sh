# kind: a message names the separator
# exit: 2
# says: ;
# says: separat
small s
sed -i 's/,/;/g' s/results.csv
touchstone submit couette s --store st
