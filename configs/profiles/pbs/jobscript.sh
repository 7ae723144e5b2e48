#!/bin/sh
# properties = {properties}
# Leaves its exit code where status.sh looks for it, as schedulers tell it in many ways.
trap 'echo $? > .snakemake/pbs_logs/${{PBS_JOBID:-${{JOB_ID:-$SLURM_JOB_ID}}}}.code' EXIT
{exec_job}
