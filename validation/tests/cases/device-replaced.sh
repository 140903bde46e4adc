# kind: pipes and links are not replaced by files
touchstone plan couette --set re=1 --set rows=8 --set end=0.01 >plan.jsonl
mkfifo pipe
timeout 20 cat pipe >from_pipe &
touchstone plan couette --set re=1 --estimates pipe >/dev/null
test -p pipe || exit 1
touch target && ln -s target link
touchstone plan couette --set re=1 --estimates link >/dev/null
test -L link || exit 1
mkdir store
touchstone verify --no-runs couette --store store --junit link >out 2>&1
test $? -lt 2 || { cat out; exit 1; }
test -L link && grep -q '<testsuite' target
