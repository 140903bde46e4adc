# kind: a mass that no volume can follow from is refused
touchstone export couette --variant modern --set rows=8 --solve --out s >log 2>&1 || { cat log; exit 99; }
sed -i 's|"division": "closed"|"division": "open"|' s/method.json
# The particles of the problem at the start, as own ones.
head -n 1 s/results.csv >start
awk -F, -v OFS=, 'NR > 1 && $2 == 0 { print 0, $1, $3, $4, 0, 0, 1000 }' s/particles.csv >>start
{ cat start; tail -n +2 s/results.csv; } >r && mv r s/results.csv
for pair in '1e-323 1000' '1e-310 1e20' '1e-200 1e200'; do
    cp -r s o
    edit o "NR==1{print \$0,\"mass[kg/m]\",\"role[-]\"} NR>1{\$7=\"${pair#* }\"; print \$0,\"${pair% *}\",0}"
    timeout 30 touchstone submit couette o --store st >out 2>&1
    code=$?
    cat out
    test $code = 2 || exit 1
    grep -q mass out || exit 1
    rm -r o
done
