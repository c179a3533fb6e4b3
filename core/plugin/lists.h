/* Lists that parameters fill: tuples of particles, and numbers. */
#ifndef HK_PLUGIN_LISTS_H
#define HK_PLUGIN_LISTS_H

#include <stddef.h>
#include <stdint.h>

/* `count` tuples of `arity` particles: member c of tuple k is index[arity*k + c]. The members of one tuple differ. */
typedef struct hk_tuples {
  size_t count;
  unsigned arity; /* 1 to 4; set also where the list is empty */
  const uint32_t *index;
} hk_tuples;

static inline const uint32_t *hk_tuple(const hk_tuples *t, size_t k) { return t->index + t->arity * k; }

/* One number for all tuples (count 1) or one number per tuple. When HK_OPTIONAL and not given: count 0. */
typedef struct hk_per_tuple {
  size_t count;
  double *value;
} hk_per_tuple;

static inline double hk_tuple_value(const hk_per_tuple *p, size_t k) { return p->value[p->count > 1 ? k : 0]; }

typedef struct hk_numbers {
  size_t count;
  const double *value;
} hk_numbers;

#endif
