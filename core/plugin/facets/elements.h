/* Facet of forces that are sums over elements with an energy 1/2 k C^2: strain, pictures, and the methods that work
 * element by element use them. */
#ifndef HK_PLUGIN_ELEMENTS_H
#define HK_PLUGIN_ELEMENTS_H

#include "core/plugin/force.h"

enum { HK_ELEMENT_VALUES = 16 }; /* largest number of values C per tuple */

/* The energy is, up to a constant, E = 1/2 sum_k stiffness C^2 over elements, each on a tuple of particles, and the
 * damping is -damping dC/dt dC/dx. All pointers are valid until the next change of topology. */
typedef struct hk_elements {
  hk_tuples node;
  unsigned values; /* numbers C per tuple, from 1 to HK_ELEMENT_VALUES; all share the tuple's stiffness and damping */
  hk_per_tuple stiffness; /* J per unit of C squared; N/m where C is a length */
  hk_per_tuple damping;   /* J s per unit of C squared; N s/m where C is a length; count 0: none */
  hk_per_tuple rest;      /* reference of the strain, in the unit of C (a length, an area); count 0: no strain */
  /* C and its gradient for the tuples [begin, end): C[(k - begin) * values + e], and
   * dC[((k - begin) * values + e) * arity + member] (3 numbers). Of x it reads the tuples' members alone, and it may be
   * called by several threads at once. NULL: the distance of an edge (arity 2) less its rest length. */
  void (*evaluate)(const void *self, const double *x, size_t begin, size_t end, double *C, double (*dC)[3]);
  const void *self; /* argument of `evaluate` */
} hk_elements;

/* Whether the elements are plain edges, whose C is the length of the edge less the rest length. */
static inline bool hk_elements_are_edges(const hk_elements *e) { return e->node.arity == 2 && !e->evaluate; }

#define HK_ELEMENTS_ID "elements/1"
#define HK_ELEMENTS_FACET(...) HK_FACET(HK_ELEMENTS_ID, hk_elements_facet, __VA_ARGS__)

typedef struct hk_elements_facet {
  size_t size;
  unsigned lists; /* number of hk_elements that `list` fills, such as triangles and edges; 0: one */
  /* All elements that act; with `values` 0 in the first list the force has none with the parameters of this run.
   * Required. */
  void (*list)(void *self, const hk_view *view, hk_elements *out);
} hk_elements_facet;

/* One of hk_model.element_list. */
typedef struct hk_element_list {
  const char *force; /* the force's label */
  hk_elements elements;
  size_t index; /* position of the force in hk_system.force */
  bool acts;    /* whether the force acts at present, by its `from` and `to` */
} hk_element_list;

#endif
