# kind: a name from outside is plain text on the page, and characters that XML lacks are refused
honest s couette
for name in '[our paper](javascript:alert%281%29)' '[x](https://a.example/)' '[x](#nowhere)' '`x` **y** <b>z</b>'; do
    sed -i "s|\"code\": .*|\"code\": \"$name\",|" s/method.json
    touchstone submit couette s --store st >out 2>&1
    code=$?
    test $code = 0 || test $code = 2 || { cat out; exit 1; }
done
if test -d st; then
    touchstone report --store st --partial --out page >out 2>&1
    code=$?
    { test $code -lt 2 && test -f page/index.html; } || { cat out; exit 1; }
    ! grep -E 'href="(javascript|https://a\.example|#nowhere)' page/index.html || exit 1
    ! grep -F '<b>z</b>' page/index.html || exit 1
fi
for char in '\\ufffe' '\\u202e' '\\u200b' '\\ufeff' '\\u0007'; do
    sed -i "s|\"code\": .*|\"code\": \"a${char}b\",|" s/method.json
    touchstone submit couette s --store st
    test $? = 2 || exit 1
done
