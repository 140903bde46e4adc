# kind: the worse the results, the more gates fail
honest s couette
cp -r s far
edit s 'NR>1&&!done{$5=1;done=1} 1'
touchstone submit couette s --all --store st
test $? = 1 || exit 1
edit far 'NR>1{$4=1e200} 1'
touchstone submit couette far --all --store st
test $? = 1 || exit 1
# Settings that no gate judges.
small none
touchstone submit couette none --store st >out 2>&1
code=$?
cat out
test $code = 2 && grep -q 'Nothing was judged' out && grep -q 'nearest run with a bound' out
