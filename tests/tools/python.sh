#!/bin/sh
# The Python package, from the sources and with the built library: tests/tools/python/runs.py.
root=${HK_ROOT:?} build=${HK_BUILD:?}
python=$(for p in python3 /usr/bin/python3; do "$p" -c 'import numpy' 2>/dev/null && echo "$p" && break; done)
[ -n "$python" ] || python=$(command -v python3) || { echo "skipped: no python3"; exit 77; }
# The sanitizers' own library has to be the first of a process.
case $build in *sanitize*) echo "skipped: python3 is built without sanitizers"; exit 77 ;; esac
HOOKE_LIBRARY=$build/libhooke.so.0 HOOKE=$build/hooke PYTHONPATH=$root/tools/python PYTHONDONTWRITEBYTECODE=1 \
  exec "$python" "$root/tests/tools/python/runs.py"
