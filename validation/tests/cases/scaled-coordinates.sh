# kind: fractions of the box are places by the bounds of the box, or refused by name
small s
cp -r s plain
dump plain '' 'x y vx vy c_rho' '$3, $4'
touchstone submit couette plain --store plain.store
dump s '' 'xs ys vx vy c_rho' '$3 / 1.25e-3, ($4 + 1e-3) / 3e-3'
touchstone submit couette s --map x=xs,y=ys --store st >out 2>&1
code=$?
cat out
grep -q xs out && test $code = 2 && exit 0
metrics plain.store | grep -E '^(l2|linf|v_rms)' >a
metrics st | grep -E '^(l2|linf|v_rms)' >b
cat a b
test -s a && cmp a b
