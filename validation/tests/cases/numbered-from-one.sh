# kind: a message names the cause
# exit: 2
# says: 0
# says: begin
small s
edit s 'NR>1{$2+=1} 1'
touchstone submit couette s --store st
