# kind: gates of the dam break see heights
honest s dam_break
cp -r s tall
edit s 'NR>1{$4=0.001} 1'
touchstone submit dam_break s --store st
test $? = 1 || exit 1
edit tall 'NR>1{$4*=10} 1'
touchstone submit dam_break tall --store st
test $? = 1
