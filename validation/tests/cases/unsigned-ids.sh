# kind: whole numbers of any width and sign are whole numbers
# says: complete
# The ids 0 to 19 in base64: a head of 4 bytes, then so many bytes each, the least significant first.
whole() {
    {
        printf "\\$(printf %o $((20 * $1)))\\000\\000\\000"
        for id in 0 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19; do
            printf "\\$(printf %o $id)"
            for byte in 2 3 4 5 6 7 8; do test $byte -gt "$1" || printf '\000'; done
        done
    } | base64 -w 0
}
for type in Int8 UInt8 Int16 UInt16 Int32 UInt32 Int64 UInt64; do
    small "$type"
    vtk "$type" vtu UnstructuredGrid 'format="ascii"' "$type" id ''
    bytes=$((${type#*t} / 8))
    sed -i "s|Name=\"id\" NumberOfComponents=\"1\" format=\"ascii\">[^<]*<|Name=\"id\" NumberOfComponents=\"1\" format=\"binary\">$(whole $bytes)<|" "$type/f_0.vtu"
    touchstone submit couette "$type" --check || exit 1
done
