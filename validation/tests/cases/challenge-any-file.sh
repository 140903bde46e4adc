# kind: a document that no submission can have is refused where it is sealed
for text in '<script>' '' '[]' '{"code": "a", "version": "1", "scheme": "s", "division": "none", "settings": {}, "changed": "no"}'; do
    echo "$text" >method.json
    touchstone export couette --sealed 1 --method method.json --out out
    test $? = 2 || exit 1
done
test ! -e out/problem.json
