/* A recording: the motion in one HDF5 file, in the layout of VTKHDF 2.0 (type UnstructuredGrid, with Steps), and beside
 * it an XDMF file that describes the same data to programs that do not know that layout. What does not change is
 * written once: ids, masses, pins and cells, until particles are born, die or are released.
 *
 *   /VTKHDF/Points, PointData/...    rows of a frame begin at Steps/PointOffsets, at the beginning of a chunk
 *   /VTKHDF/PointData/id, mass, pin  rows begin at Steps/PointDataOffsets/id; likewise group, where the scene has
 *                                    several, and strand_radius (m; 0: it is of no strand), where there are strands
 *   /VTKHDF/Types, Connectivity, Offsets, NumberOf...  of each part; Steps/PartOffsets says which part a frame has
 *   /VTKHDF/FieldData/...            a row per frame: energies, momenta, the last step, measures
 *   /hooke/solids                    what particles bounce off (solid_series.h)
 *   /hooke/marks                     wind and points of contact (mark_series.h)
 *   /hooke                           what VTK does not ask for: scene, origin, fps, the numbers of cells of each kind,
 *                                    the names of groups, one a line
 *
 * PointData of a force or a channel has the attributes `kind` ("force", "channel") and `label`, its name in the scene.
 */
#ifndef HK_RECORDING_H
#define HK_RECORDING_H

#include "plugins/common/frame_data/frame_data.h"

typedef struct hk_recorder hk_recorder;

typedef struct hk_recorder_setup {
  bool single;  /* numbers of particles as 32-bit floats */
  int level;    /* of the compression, 0 to 9 */
  size_t every; /* frames from one that is kept to the next */
} hk_recorder_setup;

/* Both files are made, for frames with the arrays of this one. NULL with a sentence in `why`. */
hk_recorder *hk_recorder_open(const char *path, const char *xdmf, const hk_recorder_setup *, const hk_frame_data *first,
                              const hk_frame *frame, char *why, size_t size);
/* Writes a frame, so that it is on file afterwards. `changed`: ids, masses, pins or cells are others than before. */
bool hk_recorder_add(hk_recorder *, const hk_frame_data *, bool changed, const hk_frame *frame, char *why, size_t size);
/* Writes the verdict, "ok" and so on; NULL: it stays as it is. Frees the recorder. */
bool hk_recorder_close(hk_recorder *, const char *verdict, char *why, size_t size);

#endif
