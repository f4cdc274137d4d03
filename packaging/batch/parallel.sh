#!/bin/sh
# parallel.sh PLAN: runs the lines of a plan on this machine, one for each processor, with GNU parallel. Run it
# again after a failure: finished outputs are verified and kept, half-written ones made anew.
exec parallel --joblog "$1.log" --halt soon,fail=20% <"$1"
