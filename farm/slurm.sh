#!/bin/sh
# A sequence of nephos as a Slurm array: frames in parallel, then a movie of them.
#
#   sbatch farm/slurm.sh scene.json frames          # frames, in 16 parts
#   sbatch --dependency=afterok:JOB --array=0 farm/slurm.sh scene.json frames   # the movie
#
# The folder must be one that all nodes reach. A job that was cut off goes on where it ended.
#SBATCH --job-name=nephos
#SBATCH --array=1-16
#SBATCH --cpus-per-task=4
#SBATCH --time=04:00:00
#SBATCH --requeue
set -eu

scene=$1
folder=$2
frames=${FRAMES:-1-240}
options=${OPTIONS:---width 1920 --height 1080}

# Options are words.
# shellcheck disable=SC2086
if [ "$SLURM_ARRAY_TASK_ID" -eq 0 ]; then
    nephos sequence "$scene" -o "$folder/sequence.mp4" --from "$folder/frame.####.png" --frames "$frames" $options
else
    nephos sequence "$scene" -o "$folder/frame.####.png" --frames "$frames" \
        --shard "$SLURM_ARRAY_TASK_ID/${SLURM_ARRAY_TASK_COUNT:-16}" $options
fi
