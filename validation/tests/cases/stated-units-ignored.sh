# kind: a unit that a file states is honoured in every format
# exit: 2
# says: cgs
small s
dump s 'ITEM: UNITS\ncgs\n' 'x y vx vy c_rho' '$3, $4'
touchstone submit couette s --store st
