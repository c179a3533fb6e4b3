"""Measures over time by matplotlib, which is asked for when a plot is."""
from ._errors import Error

MOST = 8  # lines that can be told apart


def plot(run, names=None, axes=None):
    table = run.measures
    known = [name for name in table if name != "t"]
    wanted = [names] if isinstance(names, str) else list(names) if names is not None else known
    for name in wanted:
        if name not in known:
            raise Error(f"the run has no measure '{name}' to plot: it has {', '.join(known) or 'none; scene:measure adds one'}")
    if not wanted:
        raise Error("the run has no measures to plot: scene:measure adds one")
    try:
        from matplotlib import pyplot
    except ImportError:
        raise Error("plots are drawn by matplotlib, which is not installed: pip install matplotlib") from None
    if axes is None:
        axes = pyplot.figure(figsize=(7, 4), layout="constrained").add_subplot()
    times = table["t"] if "t" in table else table.index
    for k, name in enumerate(wanted):
        axes.plot(times, table[name], label=name if k < MOST else None, color=None if k < MOST else "0.75", zorder=2 if k < MOST else 1)
    axes.set_xlabel("t, s")
    axes.grid(alpha=0.3)
    units = run.summary.get("measure_units") or {}
    common = {units.get(name) for name in wanted}
    if len(wanted) == 1:
        axes.set_ylabel(", ".join(filter(None, [wanted[0], units.get(wanted[0])])))
    else:
        if len(common) == 1 and None not in common:
            axes.set_ylabel(common.pop())
        axes.legend(frameon=False)
    return axes
