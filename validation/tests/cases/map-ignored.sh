# kind: a new name that the file lacks is refused
small s
edit s 'NR==1{$7="rho2"} 1'
touchstone submit couette s --map density=rhoo --store st
test $? = 2 || exit 1
touchstone submit couette s --map id=nosuch --store st
test $? = 2 || exit 1
sed -i 's|"steps": .*|"steps": 0.5,|' s/system.json
touchstone submit couette s --store st
test $? = 2
