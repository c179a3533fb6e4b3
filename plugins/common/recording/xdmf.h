/* The XDMF file (version 2, the one of "XDMF Reader" in ParaView; those of version 3 know no hyperslabs) beside a
 * recording: for every frame it says which rows of the HDF5 file are whose. It ends
 * properly after every frame: the frames' text is put over the closing lines of the one before, with new ones. */
#ifndef HK_XDMF_H
#define HK_XDMF_H

#include "plugins/common/frame_data/frame_data.h"

typedef struct hk_xdmf_array {
  const char *name, *path; /* of the dataset, "VTKHDF/PointData/velocity" */
  size_t width;
  bool fixed; /* its rows are those of ids */
} hk_xdmf_array;

typedef struct hk_xdmf_frame {
  double t;
  uint64_t n, points, fixed, connectivity, connectivity_rows, points_rows, fixed_rows; /* first rows; rows so far */
  uint64_t vertices, segments, triangles;
} hk_xdmf_frame;

typedef struct hk_xdmf hk_xdmf;

/* `h5`: the name of the HDF5 file as it stands in the XDMF file. `bytes`: of a number of a moving array. NULL with
 * errno.
 */
hk_xdmf *hk_xdmf_create(const char *path, const char *h5, unsigned bytes);
bool hk_xdmf_add(hk_xdmf *, const hk_xdmf_frame *, const hk_xdmf_array *array, size_t arrays); /* false with errno */
bool hk_xdmf_close(hk_xdmf *);

#endif
