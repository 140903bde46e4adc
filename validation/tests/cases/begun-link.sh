# kind: nothing is written through a link, and no pipe is waited for
touchstone plan couette --variant modern --set rows=8 --set end=0.01 >plan.jsonl
touchstone run --specs plan.jsonl --store first >log 2>&1
name=$(ls first | head -n 1)
mkdir st && echo precious >victim && ln -s "$PWD/victim" "st/.begun-$name"
touchstone run --specs plan.jsonl --store st || true
test "$(cat victim)" = precious
rm -rf st && mkdir st && mkfifo "st/.begun-$name"
timeout 20 touchstone run --specs plan.jsonl --store st || test $? != 124
