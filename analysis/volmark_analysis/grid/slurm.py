"""A Slurm array script for a grid: each task of the array runs some batches one after another."""

from __future__ import annotations

import hashlib
import shlex
from pathlib import Path

from .batches import Batch, by_volume, point_list
from .job import Job

MOST_TASKS = 1000
"""Slurm's MaxArraySize is 1001 by default."""
_OWN_NODE = ["--exclusive"]

_SCRIPT = """#!/bin/bash
# A grid of volmark: {points} points in {batches} batches, as {tasks} tasks of a Slurm array. Submit it with
#   bash {file}
# which also submits a job that writes the index when all have ended. Submitted again it goes on with what is left: which
# points are done is told by their result files alone. All machines must see the folders named here.
#SBATCH --array=0-{last}
#SBATCH --requeue
#SBATCH --open-mode=append
{directives}

name={name}
here={here}
logs={logs}
expand=({expand})
run=({run})
index=({index})
# Points by their numbers in the expansion: batches that are measured together, a line per task.
tasks=(
{lists}
)

if [ -z "${{SLURM_ARRAY_TASK_ID:-}}" ]; then
  mkdir -p "$logs" || exit
  job=$(sbatch --parsable --job-name="$name" --output="$logs/%a.log" "$0") || exit
  last=$(sbatch --parsable --job-name="$name-index" --output="$logs/index.log" \\
    --dependency="afterany:${{job%%;*}}" --wrap "$(printf '%q ' "${{index[@]}}")") || exit
  echo "array ${{job%%;*}}, index ${{last%%;*}}, logs in $logs"
  exit
fi

cd "$here" || exit
# A scenario that has changed since has other points under these numbers.
if [ "$("${{expand[@]}}" 2>/dev/null | sha256sum | cut -d' ' -f1)" != {digest} ]; then
  echo "the scenario's points are not those that this script was made for: make it again" >&2
  exit 2
fi
code=0
for points in ${{tasks[$SLURM_ARRAY_TASK_ID]}}; do
  "${{run[@]}}" --points "$points" || code=$?
  [ $code -le 1 ] || exit $code  # 1: a run failed, which is a result too
done
exit $code
"""


def array_script(job: Job, expansion: str, batches: list[Batch], tasks: int, directives: list[str], file: Path) -> str:
    """`expansion`: what `volmark expand` printed; `directives`: options of sbatch, by default a node for each task."""
    ordered = by_volume(batches)
    tasks = min(tasks, len(ordered))
    parts = [ordered[i * len(ordered) // tasks:(i + 1) * len(ordered) // tasks] for i in range(tasks)]
    return _SCRIPT.format(
        file=shlex.quote(str(file)), points=sum(len(b.points) for b in batches), batches=len(batches), tasks=tasks,
        last=tasks - 1, directives="\n".join(f"#SBATCH {d}" for d in directives or _OWN_NODE),
        name=shlex.quote(f"volmark-{job.folder.name}"), here=shlex.quote(str(Path.cwd())),
        logs=shlex.quote(f"{job.folder}.slurm"), expand=shlex.join(job.expand_command()),
        run=shlex.join(job.run_command()), index=shlex.join(job.index_command()),
        lists="\n".join('  "' + " ".join(point_list(b.points) for b in part) + '"' for part in parts),
        digest=hashlib.sha256(expansion.encode()).hexdigest())
