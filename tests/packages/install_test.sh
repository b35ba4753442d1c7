#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
#
# usage: install_test.sh PACKAGES ROOT
#
# Makes a new, minimal Debian 12 in the folder ROOT, installs the packages of the folder PACKAGES with apt, uses each of
# them as its users do, and purges them: nothing of them may be left. Then the same of the wheel, with pip. The way from
# the package to the report of a real recording, where there is one, takes five minutes at most. Runs as root, needs
# debootstrap and a network, and takes some minutes. ROOT is removed first, and stays for a look when it fails.
#
# environment
#   PLIANT_DEBIAN_MIRROR   the archive to install from (default: http://deb.debian.org/debian)
#   PLIANT_RECORDINGS      the folder with the recording laparoscopy/endo.mp4 and its camera.yaml (experiments/recordings)
set -euo pipefail

source=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
packages=$(realpath "$1")
root=$(realpath -m "$2")
mirror=${PLIANT_DEBIAN_MIRROR:-http://deb.debian.org/debian}
recording=${PLIANT_RECORDINGS:-}/laparoscopy
names=(pliant python3-pliant libpliant-dev pliant-doc)

say() { printf '\n== %s\n' "$*"; }
inside() { env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin LC_ALL=C.UTF-8 HOME=/root DEBIAN_FRONTEND=noninteractive chroot "$root" "$@"; }
package() { (cd "$packages" && echo "/tmp/$(ls "$1"_*.deb)"); }
install() { inside apt-get -qq install -y --no-install-recommends "$@" >>"$root/tmp/apt.log" 2>&1 || { tail -30 "$root/tmp/apt.log"; return 1; }; }
# Runs a command; `took` is the seconds that it needed.
timed() { local start=$SECONDS; "$@"; took=$((SECONDS - start)); }
# What Bash offers for the last of the words.
completed() {
  inside bash -c '. /usr/share/bash-completion/completions/pliant; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _pliant
    echo "${COMPREPLY[*]}"' bash "$@"
}
# The package's own tests that need nothing but it, with this Python.
test_python() {
  local name
  for name in {camera,convert_arrays,cost,errors_and_options,extensions,jobs,kernels,reading,sequence,track_arrays,tracking}_test.py; do
    inside env PLIANT_TEST_SEQUENCE=/tmp/rigid PLIANT_TEST_RUN=/tmp/rigid_run "$1" -B "/tmp/tests/$name" \
      >"$root/tmp/test.log" 2>&1 || { tail -n 30 "$root/tmp/test.log"; exit 1; }
    echo "$name: $(grep -E '^Ran ' "$root/tmp/test.log")"
  done
}
installed_kb() { inside dpkg-query -W -f '${Installed-Size}\n' | awk '{sum += $1} END {print sum}'; }

if ((EUID != 0)); then
  echo "install_test.sh: only root can make a Debian to install into" >&2
  exit 1
fi

leave_proc() { if mountpoint -q "$root/proc"; then umount "$root/proc"; fi; }
leave_proc
rm -rf --one-file-system "$root"

say "a minimal Debian 12 in $root"
mkdir -p "$(dirname "$root")"
debootstrap --variant=minbase bookworm "$root" "$mirror" >"$root.log" || { tail "$root.log"; exit 1; }
rm "$root.log"
trap leave_proc EXIT
mount -t proc proc "$root/proc"
inside apt-get -qq update
cp "$packages"/*.deb "$root/tmp"

say "pliant"
before_kb=$(installed_kb)
timed install --download-only "$(package pliant)"
download_s=$took
timed install "$(package pliant)"
install_s=$took
after_kb=$(installed_kb)
echo "$(((after_kb - before_kb) / 1024)) MB installed, with everything that it depends on"
inside pliant --version
inside pliant demo --output_path /tmp/demo
inside bash -c '. /usr/share/bash-completion/completions/pliant && complete -p pliant'
offered=$(completed pliant calibrate --ri)
echo "pliant calibrate --ri is completed to: $offered"
test "$offered" = --right_path

say "from the package to a report"
if [[ -f $recording/endo.mp4 && -f $recording/camera.yaml ]]; then
  mkdir "$root/tmp/recording"
  cp "$recording"/{endo.mp4,camera.yaml} "$root/tmp/recording"
  timed inside env -C /tmp/recording pliant track endo.mp4
  track_s=$took
  run=$(cd "$root/tmp/recording" && ls -d endo*/)
  timed inside env -C /tmp/recording pliant report "$run" -o page.html
  report_s=$took
  test -s "$root/tmp/recording/page.html"
  all_s=$((install_s + track_s + report_s))
  echo "apt-get install: $install_s s ($download_s s of download before), track: $track_s s, report: $report_s s"
  if ((all_s > 300)); then echo "these are $all_s s, more than five minutes" && exit 1; fi
else
  echo "left out: there is no recording (PLIANT_RECORDINGS)"
fi

# The example of the manual, on the images that it speaks of.
say "a ChArUco board"
example=$(inside pliant calibrate --help | sed -n 's/^ *\(pliant calibrate .*charuco:.*\)/\1/p')
inside pliant simulate --quiet --output_path /tmp/charuco --Scene.kind board --Scene.board charuco:8x5:10:7:5X5_100 \
  --Trajectory.kind board --Trajectory.fps 1 --Trajectory.frames 24 --Camera.model OPENCV_FISHEYE \
  --Camera.params 400,400,319.5,239.5,0.01,0,0,0
mv "$root/tmp/charuco/images" "$root/tmp/boards"
echo "$example"
inside env -C /tmp bash -c "$example" | grep '^error'
test -s "$root/tmp/camera.png"
grep -E '^params: \[(399|400)\.' "$root/tmp/camera.yaml"

say "man pages"
install man-db
pages=("$root"/usr/share/man/man1/pliant*.1.gz)
for page in "${pages[@]}"; do
  page=${page#"$root"}
  warnings=$(inside env MANROFFSEQ= man --warnings=w -E UTF-8 -l -Tutf8 -Z "$page" 2>&1 >/dev/null) || warnings+="man failed"
  if [[ -n $warnings ]]; then printf '%s: %s\n' "$page" "$warnings" && exit 1; fi
done
inside man --where pliant pliant-track pliant-dataset-info
echo "${#pages[@]} pages without a warning"

say "python3-pliant"
install "$(package python3-pliant)"
inside python3 -c '
import pliant
run = pliant.open_run("/tmp/demo/run")
print(pliant.__version__, pliant.__file__, run)
pliant.simulate("/tmp/from_python", {"Trajectory.frames": 2})
'

# Its own tests, on a sequence and a run as those of tests/e2e: nothing of the build tree is here.
cp -r "$source/tests/python" "$root/tmp/tests"
inside pliant simulate --quiet --output_path /tmp/rigid --Trajectory.frames 60
inside pliant track /tmp/rigid --quiet --output_path /tmp/rigid_run
test_python python3

say "pliant-doc"
install "$(package pliant-doc)"
cp "$source/tests/docs/site_test.py" "$root/tmp"
inside env PYTHONPATH=/tmp python3 -B -c '
import pathlib, site_test, sys
html = pathlib.Path("/usr/share/doc/pliant/html")
broken = list(site_test.broken_links(html))
print(len(list(html.rglob("*.html"))), "pages,", len(broken), "links lead nowhere", *broken)
sys.exit(1 if broken else 0)
'

say "libpliant-dev"
install "$(package libpliant-dev)" cmake g++ make
cp -r "$source/tests/consumer/project" "$root/tmp/project"
inside cmake -S /tmp/project -B /tmp/project/build >/dev/null
inside cmake --build /tmp/project/build
inside /tmp/project/build/consumer /tmp/demo/sequence /tmp/consumer_run | tail -n 1

say "purge"
for name in "${names[@]}"; do inside dpkg -L "$name"; done | sort -u >"$root/tmp/files"
inside apt-get -qq purge -y "${names[@]}" >>"$root/tmp/apt.log" 2>&1
status=0
while read -r file; do
  # A folder may belong to other packages too.
  if [[ ! -d $root$file && (-e $root$file || -L $root$file) ]]; then
    echo "left: $file" && status=1
  fi
done <"$root/tmp/files"
left=$(find "$root" -xdev -iname '*pliant*' -not -path "$root/tmp/*" -not -path "$root/proc/*" -printf '/%P\n')
if [[ -n $left ]]; then echo "left: $left" && status=1; fi
if inside dpkg-query -W "${names[@]}" 2>/dev/null; then status=1; fi
if ((status != 0)); then exit "$status"; fi
echo "nothing is left of them"

# The libraries that the packages brought are still there, as docs/building.md asks of who installs the wheel.
say "the wheel"
install python3-venv
cp "$packages"/*.whl "$root/tmp"
inside python3 -m venv --system-site-packages /tmp/environment
inside bash -c '/tmp/environment/bin/pip install --quiet --no-index /tmp/pliant-*.whl'
inside /tmp/environment/bin/python -c 'import pliant; print(pliant.__version__, pliant.__file__)'
test_python /tmp/environment/bin/python
inside /tmp/environment/bin/pip uninstall --quiet --yes pliant
left=$(find "$root/tmp/environment" -iname '*pliant*' -printf '/%P\n')
if [[ -n $left ]]; then echo "left: $left" && exit 1; fi
echo "nothing is left of it"

leave_proc
rm -rf --one-file-system "$root"
