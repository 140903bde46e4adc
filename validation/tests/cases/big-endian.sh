# kind: an attribute that changes the meaning of bytes is honoured or refused by name
small s
vtk s vtu UnstructuredGrid 'format="ascii"' Int64 id ''
# 0.02 s, with the most significant byte first.
sed -i 's|LittleEndian|BigEndian|; s|NumberOfTuples="1" format="ascii">[^<]*<|NumberOfTuples="1" format="binary">AAAACD+UeuFHrhR7<|' s/f_0.vtu
touchstone submit couette s --check >out 2>&1 && grep -q complete out && exit 0
cat out
grep -q 'BigEndian' out
