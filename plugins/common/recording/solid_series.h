/* The solids of a recording, what particles bounce off, in the group /hooke/solids:
 *
 *   kind (solids)          hk_shape_kind: 0 plane, 1 sphere, 2 box, 3 cylinder, 4 capsule, 5 mesh
 *   hollow (solids)        1: particles are inside; 2: it is the surface of a rigid body
 *   group (solids)         1 + the group of a rigid body; 0: it has none
 *   place (frames x 12 solids)  m, of each solid its centre and three axes from there to its surface; of a plane the
 * third axis is its normal, of a cylinder or a capsule it is the long one, and the vertices of a mesh are in units of
 * the axes mesh (solids x 2)      numbers of vertices and faces vertex, face (x 3)     of all meshes, one after the
 * other; corners count from each mesh's first vertex
 *
 * There is no group where there are no solids. */
#ifndef HK_SOLID_SERIES_H
#define HK_SOLID_SERIES_H

#include "plugins/common/hdf5/h5_series.h"
#include "plugins/common/frame_data/solid.h"

typedef struct hk_solid_series {
  size_t count;
  hk_h5_series place;
  double *row; /* scratch */
} hk_solid_series;

/* False: the library failed, or no memory. What is zeroed may be closed. */
bool hk_solid_series_create(hk_solid_series *, hid_t own, const hk_frame_solid *, size_t count);
bool hk_solid_series_add(hk_solid_series *, const hk_frame_solid *);
void hk_solid_series_close(hk_solid_series *);

typedef struct hk_recorded_solids {
  size_t count;
  hk_frame_solid *solid; /* kinds and meshes */
  double *vertex;
  uint32_t (*face)[3];
  hid_t place; /* 0: there are none */
} hk_recorded_solids;

/* False: the group contradicts itself. */
bool hk_recorded_solids_open(hk_recorded_solids *, hid_t file);
/* Of frame k (from 0): 12 count numbers. */
bool hk_recorded_solids_place(const hk_recorded_solids *, size_t k, double *to);
/* Moves the solids to where they are in frame k. False: no memory, or the file is damaged. */
bool hk_recorded_solids_move(hk_recorded_solids *, size_t k);
void hk_recorded_solids_close(hk_recorded_solids *);

#endif
