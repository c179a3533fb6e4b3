/* The hinges of a surface: its edges that two triangles share. */
#ifndef HK_HINGE_LIST_H
#define HK_HINGE_LIST_H

#include "core/plugin.h"

typedef struct hk_hinge_list {
  size_t count;
  uint32_t (*member)[4]; /* indices: the edge from a to b, and the corners c and d opposite to it; the host's memory */
} hk_hinge_list;

/* Finds the hinges of the triangles whose corners all act, in the order of their edges. HK_BAD_PARAM names an edge of
 * three triangles or more, and two triangles on the same corners; HK_NO_MEMORY. */
hk_status hk_hinge_list_find(hk_hinge_list *, const hk_view *, const hk_tuples *triangles);
/* Copies the quadruples whose members all act. HK_NO_MEMORY. */
hk_status hk_hinge_list_copy(hk_hinge_list *, const hk_view *, const hk_tuples *hinges);

#endif
