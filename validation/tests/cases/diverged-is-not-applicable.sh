# kind: a run that diverged fails, with particle, field, value and time
# exit: 1
# says: density
# says: particle 7
# says: 1500|1\.5e3|1\.500000e3
# never: Nothing was judged
honest s couette
edit s 'NR>1&&$2==7{$7=1500} 1'
touchstone submit couette s --all --store st
