/* Which springs of a scene are worth steps of their own. */
#ifndef HK_STIFF_EDGES_H
#define HK_STIFF_EDGES_H

#include "core/plugin.h"

/* Zeroed before the first use; all memory is the instance's. */
typedef struct hk_stiff_edges {
  size_t count;        /* 0: none is worth it */
  uint32_t (*pair)[2]; /* count */
  double *k, *c, *L;   /* count each: N/m, N s/m, m */
  double shift;        /* s of local_filter.h */
  size_t edges;        /* springs of the scene that act */
} hk_stiff_edges;

/* Chooses among the acting elements that are plain edges. It depends on masses, stiffnesses and dampings alone, not on
 * positions, so that it need be called again only where these or the topology change. HK_NO_MEMORY. */
hk_status hk_stiff_edges_choose(hk_stiff_edges *, const hk_host *, const hk_model *);
void hk_stiff_edges_free(hk_stiff_edges *, const hk_host *);

#endif
