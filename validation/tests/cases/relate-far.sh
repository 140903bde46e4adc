# kind: no relation is found between numbers that have no digits left
touchstone export taylor_green --set n=8 --relation same --solve --out same >log 2>&1 || { cat log; exit 99; }
touchstone export taylor_green --set n=8 --relation shifted --solve --out other >log 2>&1 || { cat log; exit 99; }
touchstone symmetry taylor_green --results same other || exit 1
cp -r same steps
cp -r other near
edit other 'NR>1{$3=1e16} 1'
touchstone symmetry taylor_green --results same other
test $? != 0 || exit 1
edit near 'NR==2{$3+=1e-6} 1'
sed -i 's|"steps": .*|"steps": 1e9,|' steps/system.json
touchstone symmetry taylor_green --results steps near
test $? != 0
