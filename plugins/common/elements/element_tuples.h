/* The acting elements of a scene that have an `evaluate`, of any arity, in one array. */
#ifndef HK_ELEMENT_TUPLES_H
#define HK_ELEMENT_TUPLES_H

#include "core/plugin.h"

typedef struct hk_element_tuple {
  const hk_elements *list;
  size_t k;                  /* its position in the list */
  uint32_t member[4];        /* list->node.arity of them */
  double stiffness, damping; /* as in hk_elements */
  size_t first, gradient;    /* position of its numbers C and of their gradients in the arrays over all tuples */
} hk_element_tuple;

/* To be zeroed before the first use. The memory belongs to the instance and is released with it. */
typedef struct hk_element_tuples {
  size_t count; /* tuples that act and have stiffness or damping, in the order of the scene */
  hk_element_tuple *item;
  size_t values, gradients; /* number of numbers C of all tuples; number of gradients, one per number C and member */
  size_t capacity, most_values, most_gradients; /* the largest of these counts, when all lists act */
  hk_elements *list;                            /* copies of the lists */
} hk_element_tuples;

/* Collects the tuples. `fresh`: the topology is new; memory is allocated only then. HK_NO_MEMORY. */
hk_status hk_element_tuples_take(hk_element_tuples *, const hk_host *host, const hk_model *model, bool fresh);

/* C and its gradients for one tuple, as hk_elements.evaluate computes them. */
static inline void hk_element_tuple_evaluate(const hk_element_tuple *t, const double *x, double *C, double (*dC)[3]) {
  t->list->evaluate(t->list->self, x, t->k, t->k + 1, C, dC);
}

#endif
