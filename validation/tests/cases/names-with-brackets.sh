# kind: advice of a message works when it is followed
# says: complete
small s
dump s '' 'x y c_vel[1] c_vel[2] c_rho' '$3, $4'
touchstone submit couette s --map 'u=c_vel[1],v=c_vel[2]' --check
