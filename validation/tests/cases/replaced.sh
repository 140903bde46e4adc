# kind: a second submission does not take the place of the first
honest s couette
touchstone submit couette s --store st || exit 1
cp -r s worse
edit worse 'NR>1{$5*=1.5} 1'
touchstone submit couette worse --store st
code=$?
test $code = 2 && test "$(ls st | wc -l)" = 1 && exit 0
test $code = 1 && test "$(ls st | wc -l)" = 2
