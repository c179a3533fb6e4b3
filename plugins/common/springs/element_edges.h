/* The acting springs of a scene, that is the elements which are plain edges, in flat arrays, and the pins they hang
 * from: what element-wise integrators work on. */
#ifndef HK_ELEMENT_EDGES_H
#define HK_ELEMENT_EDGES_H

#include "core/plugin.h"

#define HK_NO_SLIDE UINT32_MAX

/* Zeroed before the first use. The memory is the instance's and goes with it. */
typedef struct hk_element_edges {
  size_t count;                       /* springs that act, in the order of the scene */
  uint32_t (*pair)[2];                /* count */
  double *stiffness, *damping, *rest; /* count each: N/m, N s/m, m */
  size_t n, slides;                   /* particles, and those on a line or in a plane */
  double *inverse_mass;               /* n, 1/kg */
  uint8_t *pin;                       /* n, hk_pin */
  uint32_t *slide;                    /* n: position in `projector`, HK_NO_SLIDE for others */
  double (*projector)[9];             /* slides: S, which keeps of a vector what the pin allows */
  size_t paths;                       /* particles that follow a path */
  size_t capacity, lists;             /* springs there is room for; element lists seen */
  bool *acts;                         /* lists */
  bool valid;
} hk_element_edges;

/* Splits the forces: those with elements are the method's own, evaluations take in the others. A force that joins
 * particles without saying how is refused by name. Then collects the springs and the pins again where they are others
 * than at the last call, and says so in *changed. scratch: 3n. Allocates when the topology is new only. */
hk_status hk_element_edges_take(hk_element_edges *, hk_system *, double *scratch, bool *changed);
/* For methods that know plain edges only: HK_FAILED, naming the force, when the scene has other elements. */
hk_status hk_element_edges_uncoupled(const hk_system *);
/* To be called in `topology`: indices have changed. */
void hk_element_edges_drop(hk_element_edges *);

#endif
