# kind: a metric that is not finite fails
# exit: 1
# never: Nothing was judged
honest s poiseuille
edit s 'NR>1&&$2==7{$4=1e300} 1'
touchstone submit poiseuille s --all --store st
