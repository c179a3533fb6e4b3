"""Pages by `hooke view`."""
import html
import os
import pathlib
import subprocess
import tempfile

from . import _errors
from ._library import prefix


def _program():
    named, inside = os.environ.get("HOOKE"), prefix()
    built = pathlib.Path(__file__).resolve().parents[3] / "build" / "hooke"
    return named or (str(inside / "bin" / "hooke") if inside else str(built) if built.exists() else "hooke")


class Page:
    """One HTML file that needs no network."""

    def __init__(self, path):
        self.path = path

    def _repr_html_(self):
        text = html.escape(pathlib.Path(self.path).read_text(encoding="utf-8"), quote=True)
        return f'<iframe srcdoc="{text}" style="width:100%;height:560px;border:0"></iframe>'

    def __repr__(self):
        return f"<hooke.Page {self.path}>"


def make(scene, options, path):
    folder = pathlib.Path(tempfile.mkdtemp(prefix="hooke-page-"))
    script = scene.path
    if scene.text is not None:
        script = str(folder / (pathlib.Path(scene.path).stem + ".lua"))
        pathlib.Path(script).write_text(scene.text, encoding="utf-8")
    page = os.fspath(path) if path else str(folder / "page.html")
    words = [_program(), "view", script, *(f"{name}={value}" for name, value in scene.parameters.items())]
    words += ["--page", page, "--out", str(folder / "run"), "--quiet"]
    words += ["--trust"] if "trust" in options else []
    rest = [f"--{name}={value}" if value else f"--{name}" for name, values in options.items() for value in values
            if name not in ("trust", "out")]
    try:
        done = subprocess.run(words + (["--", *rest] if rest else []), capture_output=True, text=True, check=False)
    except FileNotFoundError:
        raise _errors.FileError(f"the program {words[0]}, which makes pages, is not there: build it (make), or name it in HOOKE") from None
    if not os.path.exists(page):
        raise _errors.Error(done.stderr.strip() or f"hooke view ended with code {done.returncode} and made no page")
    return Page(page)
