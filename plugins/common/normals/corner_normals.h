/* Normals of bodies that have both round and sharp parts: at each corner of a triangle that of its own side of the
 * crease. */
#ifndef HK_CORNER_NORMALS_H
#define HK_CORNER_NORMALS_H

#include "core/plugin.h"

typedef struct hk_corner_normals { /* a zeroed one is empty */
  size_t vertices, faces;          /* for which there is room */
  uint32_t *start, *user; /* the faces at vertex v: user[start[v]] to user[start[v + 1] - 1], as 3 face + corner */
  float (*face)[3];       /* normals of faces, as long as twice their areas */
} hk_corner_normals;

/* HK_NO_MEMORY. */
hk_status hk_corner_normals_reserve(hk_corner_normals *, const hk_host *, size_t vertices, size_t faces);
/* Fills normal[3 k + i] for corner i of face k: the sum of the normals of the faces there that are turned from k's by
 * less than 40 degrees, of any length. */
void hk_corner_normals_find(hk_corner_normals *, const float (*x)[3], size_t vertices, const uint32_t (*face)[3],
                            size_t faces, float (*normal)[3]);
void hk_corner_normals_free(hk_corner_normals *, const hk_host *);

#endif
