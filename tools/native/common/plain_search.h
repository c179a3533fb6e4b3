/* What services find (core/plugin/service.h, plugins/common/space/bvh.h) against a search over all. A comparison
 * returns NULL, or what is wrong in a sentence, which stays until the next one. */
#ifndef HK_TOOLS_PLAIN_SEARCH_H
#define HK_TOOLS_PLAIN_SEARCH_H

#include "core/plugin.h"
#include "plugins/common/space/bvh.h"

/* Rows at the places x have every pair closer than `radius`, in both rows, rising. */
const char *hk_compare_rows(const hk_neighbour_rows *, const double *x, size_t n, double radius);

/* The rows of the last time. */
typedef struct hk_kept_rows {
  size_t n;
  uint64_t number;
  size_t *row_start;
  uint32_t *other;
} hk_kept_rows;

/* `number` changes when rows do. Keeps these. */
const char *hk_compare_with_kept(hk_kept_rows *, const hk_neighbour_rows *);
void hk_kept_rows_free(hk_kept_rows *);

/* The tree has the particles of the list (NULL: all) once each, in cells that are within each other, with their boxes.
 * n: of particles in all. */
const char *hk_compare_octree(const hk_octree *, const double *x, const uint32_t *list, size_t count, size_t n);

/* Searches of the tree find what overlaps, and what is nearest. */
const char *hk_compare_bvh(const hk_bvh *, const hk_box *box, size_t items);

#endif
