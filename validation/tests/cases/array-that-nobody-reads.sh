# kind: an array that no metric needs is not decoded
# says: complete
small s
vtk s vtu UnstructuredGrid 'format="ascii"' Int64 id '<DataArray type="Wrong" Name="mk" format="lz4">???</DataArray>'
touchstone submit couette s --check
