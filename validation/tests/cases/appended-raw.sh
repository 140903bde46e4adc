# kind: appended data, the default of VTK, are read or refused in words
# says: column u
small s
vtk s vtu UnstructuredGrid 'format="ascii"' Int64 id ''
sed -i 's|</UnstructuredGrid>|</UnstructuredGrid><AppendedData encoding="raw">_@@@@</AppendedData>|;
    s|Name="velocity" NumberOfComponents="3" format="ascii">[^<]*<|Name="velocity" NumberOfComponents="3" format="appended" offset="0"><|' s/f_0.vtu
# A length that is none in UTF-8.
awk '{ at = index($0, "@@@@"); if (at) { printf "%s", substr($0, 1, at - 1); fflush(); system("printf \"\\340\\001\\000\\000\""); print substr($0, at + 4) } else print }' s/f_0.vtu >t && mv t s/f_0.vtu
touchstone submit couette s --store st
test $? = 2
