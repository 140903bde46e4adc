# kind: ids under a usual name are read or asked for
for name in id OriginalID Idp gid; do
    touchstone export elastic_bar --solve --out "$name" >log 2>&1 || { cat log; exit 99; }
    # Sorted otherwise: the order of the file is none of ids.
    { head -n 1 "$name/results.csv"; tail -n +2 "$name/results.csv" | sort -r; } >r && mv r "$name/results.csv"
    vtk "$name" vtu UnstructuredGrid 'format="ascii"' Int64 "$name" ''
    touchstone submit elastic_bar "$name" --store "$name.store" >out 2>&1
    code=$?
    cat out
    grep -q "$name" out && test $code = 2 && continue
    metrics id.store >a
    metrics "$name.store" >b
    test -s a && cmp a b || exit 1
done
