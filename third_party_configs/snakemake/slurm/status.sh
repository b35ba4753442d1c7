#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
#
# usage: status.sh JOB        says running, success or failed, as Snakemake wants to know it
#
# Asks the controller, which forgets a job some minutes after its end, then the accounting, which not every cluster has.
# A controller that does not answer says nothing about the job: it is asked again later.
state=$(scontrol --oneliner show job "$1" 2>&1)
case $state in
  *JobState=*) state=${state##*JobState=} state=${state%% *} ;;
  *"Invalid job id"*) state=$(sacct --jobs "$1" --allocations --noheader --parsable2 --format State 2>/dev/null | head -1) ;;
  *) state=UNKNOWN ;;
esac
case $state in
  COMPLETED) echo success ;;
  PENDING | CONFIGURING | RUNNING | COMPLETING | SUSPENDED | STOPPED | REQUEUED | RESIZING | UNKNOWN) echo running ;;
  *) echo failed ;;
esac
