#!/bin/sh
# Plays SLURM for one task of a job array: sbatch.sh SCRIPT TASK SECONDS
# Runs the batch script. After SECONDS it sends SIGTERM to the job step, as --signal=TERM@… does, and, as long as the
# script asks for it with `scontrol requeue`, runs it again, the last time without a signal.
script=$1 task=$2 seconds=$3
mkdir -p slurm-bin
printf '#!/bin/sh\necho $$ > "step.$SLURM_JOB_ID"\nexec "$@"\n' > slurm-bin/srun
printf '#!/bin/sh\n[ "$1" = requeue ] && touch "requeue.$2"\n' > slurm-bin/scontrol
chmod +x slurm-bin/srun slurm-bin/scontrol
export PATH="$PWD/slurm-bin:$PATH" SLURM_JOB_ID="7$task" SLURM_ARRAY_TASK_ID="$task" SLURM_CPUS_PER_TASK=1
runs=0
while :; do
    rm -f "requeue.$SLURM_JOB_ID" "step.$SLURM_JOB_ID"
    runs=$((runs + 1))
    bash "$script" &
    job=$!
    if [ "$runs" -le 2 ]; then
        while [ ! -f "step.$SLURM_JOB_ID" ]; do sleep 0.01; done
        sleep "$seconds"
        kill -TERM "$(cat "step.$SLURM_JOB_ID")" 2> /dev/null
    fi
    wait "$job"
    code=$?
    echo "task $task, run $runs: exit code $code"
    [ -f "requeue.$SLURM_JOB_ID" ] || exit "$code"
done
