# kind: a folder holds one problem, and files of others stay as they are
touchstone export couette --variant interface-wall --format pysph --solve --set rows=8 --set end=0.01 --out o || exit 1
before=$(cat o/*)
touchstone export taylor_green --out o
test $? = 2 || exit 1
test "$before" = "$(cat o/*)" || exit 1
mkdir mine && echo '{"mine": true}' >mine/method.json
touchstone export couette --solve --out mine
test $? = 2 || exit 1
grep -q mine mine/method.json
