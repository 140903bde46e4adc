#!/bin/sh
# A plan as a job array of Slurm, several lines a task:
#     touchstone plan --tier deep >deep.jsonl
#     slurm.sh deep.jsonl STORE [LINES [options of sbatch, such as --wait --time=2-0]]
# Tasks share nothing but the folder STORE, which every node sees. What was killed is submitted again by the
# same command: it makes what has no record. TOUCHSTONE names the program, if it is not in the PATH.
set -eu
specs=$(realpath "$1") store=$(realpath -m "$2") lines=${3:-20}
shift $(($# < 3 ? $# : 3))
count=$(grep -c . "$specs")
last=$(((count - 1) / lines))
TOUCHSTONE=${TOUCHSTONE:-touchstone}
export TOUCHSTONE
sbatch --array="0-$last" --ntasks=1 --cpus-per-task=1 --requeue --job-name=touchstone "$@" <<END
#!/bin/sh
first=\$((SLURM_ARRAY_TASK_ID * $lines))
# A run that diverges (3) is a result: it has a record.
"\$TOUCHSTONE" run --specs "$specs" --store "$store" --threads 1 --index \$first..\$((first + $lines)) ||
    [ \$? -eq 3 ]
END
