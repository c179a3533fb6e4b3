/* Records that the chunks of a parallel loop find, of which nobody knows beforehand how many: each chunk writes into a
 * list of its own, and the lists are joined in the order of the chunks, so that the result does not depend on the
 * number of threads. A list that is full goes on counting; the loop is then run again for its chunk, with room enough.
 * Lists keep their memory, so that in a simulation a second round is rare. */
#ifndef HK_GATHER_H
#define HK_GATHER_H

#include "core/plugin.h"

typedef struct hk_gathered {
  size_t count, room; /* records found, records that fit */
  char *record;
  bool complete; /* all that were found fit */
} hk_gathered;

typedef struct hk_gather {
  size_t record_size; /* bytes; set before the first use */
  size_t chunks;
  hk_gathered *list; /* chunks */
  size_t count, room;
  void *record; /* count: all of them, in the order of the chunks */
} hk_gather;

/* In a body: the place for one more record of the chunk; NULL: it is only counted. */
static inline void *hk_gather_add(hk_gather *g, size_t chunk) {
  hk_gathered *l = &g->list[chunk];
  size_t k = l->count++;
  return k < l->room ? l->record + k * g->record_size : NULL;
}

/* Runs body(context, begin, end, chunk) over 0..count, which adds the chunk's records, and joins them. HK_NO_MEMORY. */
hk_status hk_gather_run(hk_gather *, const hk_host *, size_t count, size_t grain,
                        void (*body)(void *context, size_t begin, size_t end, size_t chunk), void *context);
void hk_gather_free(hk_gather *, const hk_host *);

#endif
