#!/bin/sh
# What became of a job: running, success or failed, as Snakemake asks of a status command.
# A job that has left no exit code and that the scheduler does not know was killed: twice asked,
# as a file system may be slow to show what a node wrote, and a scheduler too busy to answer.
code=.snakemake/pbs_logs/$1.code
for wait in 0 10; do
  sleep $wait
  if [ -s "$code" ]; then
    if [ "$(cat "$code")" = 0 ]; then echo success; else echo failed; fi
    exit
  fi
  if qstat "$1" || qstat -j "$1"; then  # of PBS, of Grid Engine
    echo running >&3
    exit
  fi >/dev/null 2>&1
done 3>&1
echo failed
