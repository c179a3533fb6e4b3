"""What goes wrong, as exceptions with the engine's own sentences."""


class Error(Exception):
    """Of all that hooke says; `run` is what there is of the run, or None."""

    run = None


class ParameterError(Error, ValueError):
    """A value, a name or an option is wrong."""


class PluginError(Error):
    """A plugin cannot do what it was asked."""


class FileError(Error, OSError):
    """A file cannot be read or written."""


class Diverged(Error, ArithmeticError):
    """The run diverged; `run` has the state up to there."""


class ScriptError(Error):
    """The scene's script has an error."""


class Interrupted(Error):
    """The run was stopped by its on_frame; `run` has the state up to there."""


class Crashed(Error):
    """The process of the run ended by itself: a plugin crashed."""


_CLASSES = {1: ParameterError, 2: PluginError, 3: Error, 4: FileError, 5: Diverged, 6: Diverged, 7: ScriptError, 8: Interrupted}


def of_status(status, sentence):
    if status == 3:
        return MemoryError(sentence)
    return _CLASSES.get(status, Error)(sentence)
