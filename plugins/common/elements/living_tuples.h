/* Tuples that keep numbers of their own while particles are born and die; and, where these are asked for, their loads,
 * computed by several threads and summed in an order that does not depend on how many. */
#ifndef HK_LIVING_TUPLES_H
#define HK_LIVING_TUPLES_H

#include "core/plugin.h"

/* To be zeroed before the first use. The memory belongs to the instance and is released with it. */
typedef struct hk_living_tuples {
  size_t count;      /* tuples at the start */
  uint32_t *id;      /* of their members, count x arity */
  hk_tuples acting;  /* those all of whose members live and are active, by index */
  uint32_t *number;  /* the acting tuple k is the tuple number[k] of the start */
  double (*load)[3]; /* N, per member of the acting tuples: filled before hk_living_tuples_gather */
  size_t *first;     /* n + 2: the loads on particle i are load[corner[first[i]]] ... load[corner[first[i + 1] - 1]] */
  uint32_t *corner;  /* rising for each particle */
} hk_living_tuples;

/* To be called in `create` with the tuples of a parameter, and hk_living_tuples_find after it; `what` names them in
 * messages. HK_NO_MEMORY. */
hk_status hk_living_tuples_create(hk_living_tuples *, const hk_view *view, const hk_tuples *node, const char *what);
/* Between the two, for tuples that have loads. HK_NO_MEMORY. */
hk_status hk_living_tuples_load(hk_living_tuples *, const hk_view *view, const char *what);
/* To be called in `topology` as well: the tuples whose members live and are active. HK_NO_MEMORY. */
hk_status hk_living_tuples_find(hk_living_tuples *, const hk_view *view);
/* F += loads */
void hk_living_tuples_gather(const hk_living_tuples *, const hk_view *view, double *F);

#endif
