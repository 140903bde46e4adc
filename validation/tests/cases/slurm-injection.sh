# kind: a path is text to the engines
name='g$(touch pwned) `touch pwned` "q"'
mkdir "$name" bin
printf '#!/bin/sh\nfor last; do :; done\nSLURM_ARRAY_TASK_ID=0 exec sh "$last"\n' >bin/sbatch
chmod +x bin/sbatch
PATH="$PWD/bin:$PATH"
touchstone plan couette --set re=1 --set rows=8 --set end=0.01 >"$name/p.jsonl"
sh "$CONTRIB/slurm.sh" "$name/p.jsonl" "$name/store" 2
test ! -e pwned || exit 1
: >empty.jsonl
sh "$CONTRIB/slurm.sh" empty.jsonl store 2 >out 2>&1
test $? = 2 && test -s out || exit 1
for lines in 0 x -1; do
    sh "$CONTRIB/slurm.sh" "$name/p.jsonl" store "$lines" >out 2>&1
    test $? = 2 && test -s out || exit 1
done
