#!/bin/sh
# `make wheel`, installed in a clean virtual environment of Python without network or numpy: it finds its own program, plugins and
# scenes, runs what tools/python/README.md shows (of a smaller cloth), and its types name what there is.
set -eu
root=${HK_ROOT:?} build=${HK_BUILD:?}
case $build in *sanitize*) echo "skipped: python3 is built without sanitizers"; exit 77 ;; esac
python3 -c 'import venv, ensurepip' 2>/dev/null || { echo "skipped: python3 has no venv: tools/install-deps test gets it"; exit 77; }
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
wheels=$build/wheel target=wheel
if command -v auditwheel >/dev/null 2>&1; then wheels=$build/wheel/manylinux target=manylinux; fi # with its libraries
make -C "$root" -s --no-print-directory CHECKED=1 $target B="${build#"$root"/}" >"$folder/log" 2>&1 || { cat "$folder/log"; exit 1; }
python3 -m venv "$folder/env"
"$folder/env/bin/pip" install --quiet --disable-pip-version-check --no-index "$wheels"/hooke-*.whl
cd "$folder"
cp "$root/scripts/scenes/cloth.lua" .
sed -n '/^```python$/,/^```$/p' "$root/tools/python/README.md" | sed '/^```/d; s/N=32/N=8/; s/(8, 16, 32)/(4, 8)/' >readme.py
cat >first.py <<'PYTHON'
import ast
import hooke

run = hooke.Scene("cloth.lua", N=8).run(until=0.2, accuracy=1e-3)
assert run.verdict == "ok" and run.count == 64 and len(run.positions) == 3 * 64, run
assert hooke.Scene("cloth.lua", N=8).run(until=0.2, integrator="cvode", no_check=True).verdict == "ok"  # a plugin of the wheel
page = run.page("page.html")
assert page._repr_html_().startswith("<iframe"), page
stub = ast.parse(open(hooke.__file__ + "i", encoding="utf-8").read())
named = {node.name for node in stub.body if hasattr(node, "name")}
assert set(hooke.__all__) <= named, set(hooke.__all__) - named
for name, method in (("Scene", "run"), ("Run", "page"), ("State", "channel")):
    assert callable(getattr(getattr(hooke, name), method))
print("passed:", run)
PYTHON
for script in first.py readme.py; do env -u PYTHONPATH -u HOOKE_LIBRARY "$folder/env/bin/python" $script; done
