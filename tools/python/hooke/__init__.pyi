from os import PathLike
from typing import Any, Callable, Dict, Iterable, List, Mapping, Optional, Union

Value = Union[str, int, float, bool]

class Error(Exception):
    run: Optional["Run"]
class ParameterError(Error, ValueError): ...
class PluginError(Error): ...
class FileError(Error, OSError): ...
class Diverged(Error, ArithmeticError): ...
class ScriptError(Error): ...
class Interrupted(Error): ...
class Crashed(Error): ...

class State:
    time: float
    count: int
    energy: Dict[str, float]
    @property
    def positions(self) -> Any: ...
    @property
    def velocities(self) -> Any: ...
    @property
    def masses(self) -> Any: ...
    @property
    def ids(self) -> Any: ...
    @property
    def channels(self) -> List[str]: ...
    def channel(self, name: str) -> Any: ...

class Frame(State):
    measures: Dict[str, float]

class Page:
    path: str

class Run(State):
    scene: "Scene"
    verdict: str
    reason: str
    summary: Dict[str, Any]
    warnings: List[str]
    @property
    def measures(self) -> Any: ...
    def page(self, path: Optional[Union[str, "PathLike[str]"]] = None) -> Page: ...

class Scene:
    path: str
    text: Optional[str]
    parameters: Dict[str, str]
    def __init__(self, path: Optional[Union[str, "PathLike[str]"]] = None, /, *, text: Optional[str] = None, **parameters: Value) -> None: ...
    def run(
        self, *, on_frame: Optional[Callable[[Frame], Optional[bool]]] = None, in_process: bool = False, **options: Union[None, Value, List[Value]]
    ) -> Run: ...

def sweep(
    scene: Union[str, "PathLike[str]", Scene], cases: Iterable[Mapping[str, Value]], *, processes: Optional[int] = None,
    **options: Union[None, Value, List[Value]]
) -> List[Union[Run, Error, MemoryError]]: ...
