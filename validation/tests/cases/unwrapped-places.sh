# kind: a place is inside the period before anything is measured
touchstone export periodic_hill --variant modern --set n=5 --set end=3 --out s --solve >log 2>&1 || { cat log; exit 99; }
touchstone submit periodic_hill s --store st >one 2>&1
for shift in '$3+=9' '$3-=18' 'if(NR%2)$3+=9'; do
    cp -r s t
    edit t "NR>1{$shift} 1"
    touchstone submit periodic_hill t --store "st.t" >two 2>&1
    grep '^error' one >a
    grep '^error' two >b
    test -s a && cmp a b || { cat one two; exit 1; }
    rm -r t st.t
done
