/* Records that the bodies of a parallel loop find, of which nobody knows beforehand how many. They belong to rows: each
 * row is filled by one body, and rows are joined in their order, so that the result depends neither on the number of
 * threads nor on the order in which rows are worked on. Each chunk of the loop writes into a list of its own; one that
 * is full goes on counting, and the chunk is run again with room enough. Lists keep their memory, so that in a
 * simulation a second round is rare. */
#ifndef HK_GATHER_H
#define HK_GATHER_H

#include "core/plugin.h"

typedef struct hk_gathered_row {
  uint32_t chunk, count;
  size_t first; /* in the list of its chunk */
  size_t at;    /* in `record`, after joining */
} hk_gathered_row;

typedef struct hk_gathered {
  size_t count, room; /* records found, records that fit */
  char *record;
  hk_gathered_row *row; /* the one that is filled */
  bool complete;        /* all that were found fit */
} hk_gathered;

typedef struct hk_gather {
  size_t record_size; /* bytes; set before the first use */
  size_t chunks, rows, row_room;
  hk_gathered *list; /* chunks */
  hk_gathered_row *row;
  size_t count, room;
  void *record; /* count: all of them, row by row */
} hk_gather;

/* In a body: the records that follow are of this row, which no other body fills. */
static inline void hk_gather_row(hk_gather *g, size_t chunk, size_t row) {
  hk_gathered *l = &g->list[chunk];
  l->row = &g->row[row];
  *l->row = (hk_gathered_row){.chunk = (uint32_t)chunk, .first = l->count};
}

/* In a body: the place for one more record; NULL: it is only counted. */
static inline void *hk_gather_add(hk_gather *g, size_t chunk) {
  hk_gathered *l = &g->list[chunk];
  size_t k = l->count++;
  l->row->count++;
  return k < l->room ? l->record + k * g->record_size : NULL;
}

/* The records of a row, before they are joined; NULL: there was no room for all. */
static inline void *hk_gather_records(const hk_gather *g, size_t row) {
  const hk_gathered_row *r = &g->row[row];
  const hk_gathered *l = &g->list[r->chunk];
  return r->first + r->count <= l->room ? l->record + r->first * g->record_size : NULL;
}

/* Runs body(context, begin, end, chunk) over 0..count. Rows that no body fills are empty. HK_NO_MEMORY. */
hk_status hk_gather_run(hk_gather *, const hk_host *, size_t rows, size_t count, size_t grain,
                        void (*body)(void *context, size_t begin, size_t end, size_t chunk), void *context);
hk_status hk_gather_join(hk_gather *, const hk_host *);
void hk_gather_free(hk_gather *, const hk_host *);

#endif
