"""A plan on HyperQueue, several lines a task, on this machine with two workers of one core each:

    touchstone plan --tier deep > deep.jsonl
    python hyperqueue_tasks.py deep.jsonl STORE [LINES]

On a cluster, start `hq server` and workers there, and put Client() in place of the LocalCluster. Tasks share
nothing but the folder STORE; a task whose worker is lost is given to another, and the same command makes what
has no record. TOUCHSTONE names the program, if it is not in the PATH.
"""

import os
import sys
from pathlib import Path

from hyperqueue import Job, LocalCluster
from hyperqueue.cluster import WorkerConfig



def refused(why):
    print(f"hyperqueue_tasks.py: {why}", file=sys.stderr)
    sys.exit(2)


if len(sys.argv) not in (3, 4):
    refused("expected PLAN STORE [LINES]")
specs, store = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve()
lines = sys.argv[3] if len(sys.argv) > 3 else "20"
if not (lines.isascii() and lines.isdigit() and int(lines) > 0):
    refused(f"LINES is {lines!r}; expected a whole number above 0")
lines = int(lines)
program = os.environ.get("TOUCHSTONE", "touchstone")
with open(specs, encoding="utf-8") as file:
    count = sum(1 for line in file if line.strip())
if count == 0:
    refused(f"the plan {str(specs)!r} describes no run")
# A run that diverges (3) is a result: it has a record. A line that is refused ends with 2 all the same.
script = '"$@" || [ $? -eq 3 ]'

job = Job(max_fails=None)
for first in range(0, count, lines):
    run = [program, "run", "--specs", str(specs), "--store", str(store)]
    run += ["--threads", "1", "--index", f"{first}..{first + lines}"]
    job.program(["sh", "-c", script, "sh", *run], name=str(first))

with LocalCluster() as cluster:
    for _ in range(2):
        cluster.start_worker(WorkerConfig(cores=1))
    client = cluster.client()
    submitted = client.submit(job)
    if not client.wait_for_jobs([submitted], raise_on_error=False):
        sys.exit("some tasks failed: touchstone report --store STORE --partial lists them")
