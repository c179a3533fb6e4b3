"""Opens a recording in ParaView: pvpython open_recording.py FOLDER. Prints what each reader finds at the last frame."""
import sys

from paraview.simple import *  # noqa: F403
import paraview

folder = sys.argv[1]
print("ParaView", paraview.__version__)


def look(name, reader):
    reader.UpdatePipeline()
    times = list(reader.TimestepValues)
    merged = MergeBlocks(Input=reader)  # noqa: F405
    merged.UpdatePipeline(times[-1])
    info = merged.GetDataInformation()
    points = info.GetPointDataInformation()
    arrays = sorted(points.GetArrayInformation(k).GetName() for k in range(points.GetNumberOfArrays()))
    print(f"{name}: {len(times)} times to {times[-1]:g} s, {info.GetNumberOfPoints()} points, {info.GetNumberOfCells()} cells,"
          f" z from {info.GetBounds()[4]:.17g}, arrays {', '.join(arrays)}")


look("XDMF Reader", XDMFReader(FileNames=[folder + "/trajectory.xdmf"]))  # noqa: F405
if tuple(int(k) for k in str(paraview.__version__).split(".")[:2]) >= (5, 12):
    look("VTKHDF Reader", VTKHDFReader(FileName=[folder + "/trajectory.h5"]))  # noqa: F405
else:
    print("VTKHDF Reader: knows steps from 5.12 on")
