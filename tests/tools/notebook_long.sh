#!/bin/sh
# tools/python/notebook.ipynb is executed by nbclient, in a virtual environment that has it, from Python's registry or HK_NOTEBOOK_ENV:
# every cell ends without an error, the plot is a picture and the page a frame. Skipped where the registry cannot be reached.
set -eu
root=${HK_ROOT:?} build=${HK_BUILD:?}
case $build in *sanitize*) echo "skipped: python3 is built without sanitizers"; exit 77 ;; esac
python3 -c 'import venv, ensurepip' 2>/dev/null || { echo "skipped: python3 has no venv: tools/install-deps test gets it"; exit 77; }
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
env=${HK_NOTEBOOK_ENV:-$folder/env}
if [ "$env" = "$folder/env" ]; then
  python3 -m venv "$env"
  "$env/bin/pip" install --quiet --disable-pip-version-check --retries 1 nbclient ipykernel matplotlib numpy 2>"$folder/log" ||
    { echo "skipped: pip gets no nbclient: $(tail -n 1 "$folder/log")"; exit 77; }
  "$env/bin/python" -c 'import nbclient, ipykernel, matplotlib, numpy' 2>"$folder/log" ||
    { echo "skipped: pip got not all of them: $(tail -n 1 "$folder/log")"; exit 77; }
fi
cd "$folder"
cat >execute.py <<'PYTHON'
import sys
import nbclient
import nbformat

book = nbformat.read(sys.argv[1], 4)
nbclient.NotebookClient(book, timeout=120, kernel_name="python3").execute()
kinds = [{kind for out in cell.outputs for kind in out.get("data", ())} for cell in book.cells if cell.cell_type == "code"]
assert "text/plain" in kinds[0] and "image/png" in kinds[1] and "text/plain" in kinds[2], kinds
assert "text/html" in kinds[3] and "<iframe" in book.cells[-1].outputs[-1].data["text/html"], kinds
print("passed:", sum(map(len, kinds)), "outputs")
PYTHON
HOOKE_LIBRARY=$build/libhooke.so.0 HOOKE=$build/hooke PYTHONPATH=$root/tools/python PYTHONDONTWRITEBYTECODE=1 \
  IPYTHONDIR="$folder/ipython" JUPYTER_RUNTIME_DIR="$folder/runtime" "$env/bin/python" execute.py "$root/tools/python/notebook.ipynb"
