#!/bin/sh
# A plan as a job array of Slurm, several lines a task:
#     touchstone plan --tier deep >deep.jsonl
#     slurm.sh deep.jsonl STORE [LINES [options of sbatch, such as --wait --time=2-0]]
# Tasks share nothing but the folder STORE, which every node sees. What was killed is submitted again by the
# same command: it makes what has no record. TOUCHSTONE names the program, if it is not in the PATH.
set -eu
refused() { echo "slurm.sh: $1" >&2; exit 2; }
[ $# -ge 2 ] || refused "expected PLAN STORE [LINES [options of sbatch]]"
lines=${3-20}
case $lines in
'' | 0* | *[!0-9]* | ??????????*) refused "LINES is '$lines'; expected a whole number from 1 to 999999999" ;;
esac
count=$(grep -c '[^[:space:]]' -- "$1") || [ $? -eq 1 ] || refused "the plan '$1' cannot be read"
[ "$count" -gt 0 ] || refused "the plan '$1' describes no run"
# Whatever a path contains, the shell of a task takes it as it is.
quoted() { printf "'%s'" "$(printf %s "$1" | sed "s/'/'\\\\''/g")"; }
program=$(quoted "${TOUCHSTONE:-touchstone}")
specs=$(quoted "$(realpath -- "$1")") store=$(quoted "$(realpath -m -- "$2")")
shift $(($# < 3 ? $# : 3))
last=$(((count - 1) / lines))
sbatch --array="0-$last" --ntasks=1 --cpus-per-task=1 --requeue --job-name=touchstone "$@" <<END
#!/bin/sh
first=\$((SLURM_ARRAY_TASK_ID * $lines))
# A run that diverges (3) is a result: it has a record. A line that is refused ends with 2 all the same.
$program run --specs $specs --store $store --threads 1 --index \$first..\$((first + $lines)) ||
    [ \$? -eq 3 ]
END
