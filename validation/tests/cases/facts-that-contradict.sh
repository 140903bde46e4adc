# kind: a mass or role that contradicts the problem is refused
small s
cp -r s r
edit s 'NR==1{print $0,"mass[kg/m]"} NR>1{print $0,1e-9}'
touchstone submit couette s --store st
test $? = 2 || exit 1
edit r 'NR==1{print $0,"role[-]"} NR>1{print $0,1}'
touchstone submit couette r --store st
test $? = 2
