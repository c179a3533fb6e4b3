"""hooke: particles, strings, hair, cloth, bodies and liquids. Scenes are Lua scripts; this runs them.

    import hooke
    run = hooke.Scene("cloth.lua", N=64).run(until=2, accuracy=1e-3)
    print(run.verdict, run.positions.mean(axis=0))
"""
from ._errors import Crashed, Diverged, Error, FileError, Interrupted, ParameterError, PluginError, ScriptError
from ._page import Page
from ._scene import Frame, Run, Scene, State, sweep

__all__ = ["Crashed", "Diverged", "Error", "FileError", "Frame", "Interrupted", "Page", "ParameterError", "PluginError", "Run",
           "Scene", "ScriptError", "State", "sweep"]
