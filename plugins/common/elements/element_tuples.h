/* The acting elements of a scene that have an `evaluate`, of any arity, in one array. */
#ifndef HK_ELEMENT_TUPLES_H
#define HK_ELEMENT_TUPLES_H

#include "core/plugin.h"

typedef struct hk_element_tuple {
  const hk_elements *list;
  size_t k;                  /* its place in the list */
  uint32_t member[4];        /* list->node.arity of them */
  double stiffness, damping; /* as in hk_elements */
  size_t first, gradient;    /* of its numbers C and of their gradients among those of all tuples */
} hk_element_tuple;

/* Zeroed before the first use. The memory is the instance's and goes with it. */
typedef struct hk_element_tuples {
  size_t count; /* tuples that act and have stiffness or damping, in the order of the scene */
  hk_element_tuple *item;
  size_t values, gradients;                     /* numbers C of all tuples; gradients, one per number and member */
  size_t capacity, most_values, most_gradients; /* if all lists acted */
  hk_elements *list;                            /* copies */
} hk_element_tuples;

/* Collects them. `fresh`: the topology is new; it allocates then only. HK_NO_MEMORY. */
hk_status hk_element_tuples_take(hk_element_tuples *, const hk_host *host, const hk_model *model, bool fresh);

/* C and its gradients for one tuple, as hk_elements.evaluate. */
static inline void hk_element_tuple_evaluate(const hk_element_tuple *t, const double *x, double *C, double (*dC)[3]) {
  t->list->evaluate(t->list->self, x, t->k, t->k + 1, C, dC);
}

#endif
