/* The connected components of a symmetric matrix's graph, and which of them have the same graph. */
#ifndef HK_COMPONENTS_H
#define HK_COMPONENTS_H

#include "core/plugin.h"

typedef struct hk_components {
  size_t count;
  size_t classes;
  size_t *start;   /* count + 1: the rows of component c are row[start[c]..start[c + 1]] */
  uint32_t *row;   /* A->rows; rising within a component */
  uint32_t *local; /* A->rows: the position of a row in its component */
  uint32_t *kind;  /* count: the class of a component; those of one class have the same graph of positions */
  uint32_t *first; /* classes: the first component of a class */
  hk_status status;
} hk_components;

/* Finds the components of A, which has at least one row; status HK_NO_MEMORY: it failed. */
hk_components hk_components_find(const hk_host *, const hk_matrix *A);
void hk_components_free(hk_components *, const hk_host *);

#endif
