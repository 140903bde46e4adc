# kind: text of a file is repeated in its first characters
small s
head -c 4000000 /dev/zero | tr '\0' a | sed 's/./a,/g' >s/results.csv
touchstone submit couette s --store st 2>err
test $? = 2 || exit 1
test "$(wc -c <err)" -lt 5000 || exit 1
head -c 4000000 /dev/zero >s/results.csv
touchstone submit couette s --store st 2>err
test $? = 2 || exit 1
test "$(wc -c <err)" -lt 5000
