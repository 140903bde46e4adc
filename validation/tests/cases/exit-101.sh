# kind: a thread that cannot start is no bug of the program
for stack in 1 99999999999999; do
    RUST_MIN_STACK=$stack touchstone list >out 2>&1
    code=$?
    test $code = 0 || test $code = 2 || exit 1
    ! grep -q 'a bug' out || exit 1
done
