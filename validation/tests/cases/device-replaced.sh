# kind: pipes and links are not replaced by files
touchstone plan couette --set re=1 --set rows=8 --set end=0.01 >plan.jsonl
mkfifo pipe
timeout 20 cat pipe >from_pipe &
touchstone plan couette --set re=1 --estimates pipe >/dev/null
test -p pipe || exit 1
touch target && ln -s target link
touchstone plan couette --set re=1 --estimates link >/dev/null
test -L link || exit 1
touchstone judge couette --store none --partial --junit link
test -L link
