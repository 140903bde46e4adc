# kind: the mean over a section without particles is no flux of zero
# exit: 1
# says: FAIL +periodic_hill[^ ]*section_flux
touchstone export periodic_hill --variant carried --set n=10 --set re=50 --set end=30 --out s >log 2>&1 || { cat log; exit 99; }
# The particles of the start at all times, high above every section.
times=$(awk '/"times"/,/\]/' s/problem.json | grep -oE '^ +[0-9][0-9.e-]*')
{
    echo t,id,x,y,u,v,density
    for t in $times; do
        awk -F, -v OFS=, -v t="$t" 'NR > 1 && $2 == 0 { print t, $1, $3, $4 + 100, 1, 0, 1 }' s/particles.csv
    done
} >s/results.csv
echo '{"code": "other", "version": "1", "scheme": "none", "division": "closed", "settings": {}, "changed": "nothing"}' >s/method.json
echo '{"machine": "unknown", "threads": "unknown", "seconds": "unknown", "steps": "unknown", "interactions": "unknown"}' >s/system.json
touchstone submit periodic_hill s --all --store st
