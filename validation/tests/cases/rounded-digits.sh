# kind: digits that a file lacks are no error of the method
# says: digits
honest s operators --variant quintic-laplacian --set n=24 --set disorder=0 --set h_over_dx=1.5
awk -F, -v OFS=, -v CONVFMT=%.7g 'NR>1{for(k=3;k<=7;k++)$k=sprintf("%.7g",$k)} 1' s/results.csv >r && mv r s/results.csv
touchstone submit operators s --all --store st >out 2>&1
code=$?
cat out
test $code != 1
