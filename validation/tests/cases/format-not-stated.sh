# kind: text is the default of the format, and its name has no case
# says: complete
small s
cp -r s r
vtk s vtp PolyData 'Format="ascii"' Int64 id ''
touchstone submit couette s --check || exit 1
vtk r vtu UnstructuredGrid 'format="ASCII"' Int64 id ''
touchstone submit couette r --check
