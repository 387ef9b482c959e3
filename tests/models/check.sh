#!/usr/bin/env bash
# check.sh BUILD-FOLDER holds|rejects MODEL [-DMACRO…]: explores every state of a model.
#   holds    passes if no state violates a claim or is a deadlock
#   rejects  passes if a state does: the model has an error on purpose, which must be found
set -euo pipefail
folder=$1 expected=$2 model=$3
shift 3
source=$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")
command -v spin >/dev/null || { echo "SKIPPED: the model checker spin is not installed"; exit 77; }

folder=$folder/$(IFS=_; echo "$model${*:+_$*}" | tr -cd 'A-Za-z0-9_=')
mkdir -p "$folder"
cd "$folder"
rm -f -- *.trail pan pan.*
cp "$source/$model.pml" "$source/memory.pml" .
# A table that the compiler reads too, without its C++ comments.
sed '/^\/\//d' "$source/../../controller/src/safety_table.inc" >safety_table.inc
spin -a "$@" "$model.pml" >spin.log || { cat spin.log; exit 1; }
# A broken model fails early: compiling it with optimization would take longer than running it.
optimization=-O1
[ "$expected" = holds ] || optimization=-O0
# At most 512 MiB; does not search for the shortest path to an error.
"${CC:-cc}" $optimization -w -DSAFETY -DMEMLIM=512 -DVECTORSZ=2048 -o pan pan.c
./pan -m200000 -w20 >pan.log || true
grep -E '^pan:|errors:|states, stored|elapsed time' pan.log

grep -q 'Search not completed\|max search depth too small\|out of memory' pan.log && complete= || complete=1
errors=$(sed -n 's/.*errors: \([0-9]*\).*/\1/p' pan.log)
case $expected in
  holds) [ "$errors" = 0 ] && [ -n "$complete" ] || { spin -t -p -g -l "$@" "$model.pml" | tail -n 60; exit 1; } ;;
  rejects) grep -qE '^pan:1: (assertion violated|invalid end state)' pan.log ;;
  *) echo "expected is 'holds' or 'rejects', found '$expected'"; exit 1 ;;
esac
