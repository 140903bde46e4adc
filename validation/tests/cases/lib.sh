# Functions of the scripts in this folder; POSIX shell and awk.

# A small submission in folder $1: Couette flow, 4 rows, 20 particles, one frame. No gate judges these settings.
small() {
    touchstone export couette --variant seed --set rows=4 --set end=0.02 --solve --out "$1" >export.log 2>&1 || {
        cat export.log
        exit 99
    }
}

# A submission in folder $1 that a gate judges and that passes: case $2 with the options after it.
honest() {
    folder=$1 case=$2
    shift 2
    touchstone export "$case" --out "$folder" --solve "$@" >export.log 2>&1 || {
        cat export.log
        exit 99
    }
    touchstone submit "$case" "$folder" --store honest.store >honest.log 2>&1 || {
        cat honest.log
        exit 98
    }
}

# Replaces the table of folder $1 by what the awk program $2 makes of it.
edit() {
    awk -F, -v OFS=, "$2" "$1/results.csv" >edited && mv edited "$1/results.csv"
}

# Writes the one frame of folder $1 as a file of the VTK family, ending $2, kind of grid $3, format attribute $4,
# with the ids as an array of type $5 and name $6, and further elements $7 of the point data; the table goes.
vtk() {
    awk -F, -v kind="$3" -v format="$4" -v type="$5" -v id="$6" -v more="$7" '
        NR > 1 {
            t = $1; ids = ids " " $2; x = x " " $3 " " $4 " 0"; u = u " " $5 " " $6 " 0"; n++
        }
        function array(type, name, components, values) {
            printf "<DataArray type=\"%s\" Name=\"%s\" NumberOfComponents=\"%s\" %s>%s</DataArray>\n", \
                type, name, components, format, values
        }
        END {
            printf "<VTKFile type=\"%s\" version=\"0.1\" byte_order=\"LittleEndian\">\n<%s>\n<FieldData>\n", kind, kind
            printf "<DataArray type=\"Float64\" Name=\"TimeValue\" NumberOfTuples=\"1\" %s>%s</DataArray>\n", format, t
            printf "</FieldData>\n<Piece NumberOfPoints=\"%d\" NumberOfCells=\"0\">\n<Points>\n", n
            array("Float64", "Points", 3, x)
            print "</Points>\n<PointData>"
            array(type, id, 1, ids)
            array("Float64", "velocity", 3, u)
            printf "%s</PointData>\n</Piece>\n</%s>\n</VTKFile>\n", more, kind
        }' "$1/results.csv" >"$1/f_0.$2" && rm "$1/results.csv"
}

# Writes the one frame of folder $1 as a LAMMPS dump with the lines $2 before it, the columns $3 after id and
# type, and the rows that the awk expressions $4 print; the table goes.
dump() {
    {
        printf '%b' "$2"
        printf 'ITEM: TIME\n0.02\nITEM: TIMESTEP\n9\nITEM: NUMBER OF ATOMS\n20\n'
        printf 'ITEM: BOX BOUNDS pp ss pp\n0 1.25e-3\n-1e-3 2e-3\n-1 1\n'
        echo "ITEM: ATOMS id type $3"
        awk -F, "NR > 1 { printf \"%d 1 %.17g %.17g %s %s %s\n\", \$2 + 1, $4, \$5, \$6, \$7 }" "$1/results.csv"
    } >"$1/f_0.dump" && rm "$1/results.csv"
}

# The metrics in the only record of store $1, a line each: name and value with six digits.
metrics() {
    sed -n '/"metrics"/,/^  }/p' "$1"/*.json |
        awk -F'"' '/": \{/ { name = $2 } /"value"/ { split($0, v, ": "); printf "%s %.6g\n", name, v[2] }'
}
