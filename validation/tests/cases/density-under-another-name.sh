# kind: a column under another name is read, listed as not read or refused; nothing is put in its place
honest s hydrostatic
edit s 'NR==1{$7="rho[kg/m^3]"} NR>1{$7=1000} 1'
touchstone submit hydrostatic s --all --store st >out 2>&1
cat out
grep -qE 'not read: rho|FAIL +hydrostatic[^ ]*p_l2' out || exit 1
! grep -E 'pass +hydrostatic[^ ]*p_l2' out || exit 1
touchstone submit hydrostatic s --map density=Rho --store st
test $? = 2
