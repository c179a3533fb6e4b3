/* The datasets of a recording, shared by what makes them (layout.c) and what writes to them (recorder.c). */
#ifndef HK_RECORDING_LAYOUT_H
#define HK_RECORDING_LAYOUT_H

#include "plugins/common/hdf5/h5_file.h"
#include "plugins/common/hdf5/h5_series.h"
#include "plugins/common/recording/mark_series.h"
#include "plugins/common/recording/recording.h"
#include "plugins/common/recording/solid_series.h"
#include "plugins/common/recording/xdmf.h"

enum { SCALARS = 6, FIGURES = 8 }; /* FieldData: single numbers, then vectors */

enum { /* /VTKHDF/Steps, a row per frame */
       VALUES,
       PART_OFFSETS,
       NUMBER_OF_PARTS,
       POINT_OFFSETS,
       CELL_OFFSETS,
       CONNECTIVITY_OFFSETS,
       FIXED_OFFSETS,
       STRAIN_OFFSETS,
       ROW,
       STEPS
};

struct hk_recorder {
  hk_h5_file *file;
  hid_t root, steps, own;
  size_t frames, parts, arrays, measures;
  hk_h5_series points, velocity, strain, id, mass, pin, group, strand_radius, *array;
  hk_h5_series types, connectivity, offsets, cell_strain, counts[3], kinds;
  hk_h5_series step[STEPS], figure[FIGURES], *measure;
  hk_solid_series solids;
  hk_mark_series marks;
  int cause;                                              /* errno of a failure that was not the HDF5 file's */
  hsize_t points_at, fixed_at, cells_at, connectivity_at; /* rows of the present part */
  int64_t *number;                                        /* scratch */
  size_t room;
  hk_xdmf *xdmf;
  hk_xdmf_array *shown; /* what the XDMF file has of the arrays */
  size_t showns;
};

/* Makes all groups and datasets, for frames with the arrays of `first`. False: the library failed, or no memory. */
bool hk_recording_layout(hk_recorder *, const hk_recorder_setup *, const hk_frame_data *first, const hk_frame *frame);

#endif
