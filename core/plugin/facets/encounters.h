/* Facet of forces of short range, for what steps miss of them.
 *
 * A method knows a force at a few points of a step only. A particle that goes by a force of short range between two of
 * them misses its impulse, with the energy conserved, and with half the step, too. A force of short range therefore
 * names the moves that come near, for the verdict. Forces that do not end with the distance (elements between given
 * particles, uniform fields, drag) need not: at the ends of a step they are never absent, and half the step shows their
 * errors. */
#ifndef HK_PLUGIN_ENCOUNTERS_H
#define HK_PLUGIN_ENCOUNTERS_H

#include "core/plugin/force.h"

/* The straight move of the vector from what acts to particle i in a step. */
typedef struct hk_encounter {
  uint32_t i;
  uint32_t other; /* the particle on which -F acts; i: none */
  double r[3];    /* m, at the start of the step */
  double dr[3];   /* m, its change */
  double range;   /* m, the length over which F changes by its own size, where r is least: r/p for F = r^-p */
} hk_encounter;

/* Collects encounters. The host integrates F along them; moves of 4 ranges or less are none and may be left out. */
typedef struct hk_encounters hk_encounters;
struct hk_encounters {
  /* `F` gives the force on particle i, N, at any r; self is its argument. */
  void (*add)(hk_encounters *, const hk_encounter *, void (*F)(const void *self, const double r[3], double force[3]),
              const void *self);
};

/* m^2, the least square of r + u dr for 0 <= u < 1; INFINITY: it is least before or after the move. */
static inline double hk_nearest_square(const double r[3], const double dr[3]) {
  double along = -(r[0] * dr[0] + r[1] * dr[1] + r[2] * dr[2]), length2 = dr[0] * dr[0] + dr[1] * dr[1] + dr[2] * dr[2];
  if (!(along >= 0 && along < length2)) return INFINITY;
  return fmax(0, r[0] * r[0] + r[1] * r[1] + r[2] * r[2] - along * along / length2);
}

#define HK_ENCOUNTERS_ID "encounters/1"
#define HK_ENCOUNTERS_FACET(...) HK_FACET(HK_ENCOUNTERS_ID, hk_encounters_facet, __VA_ARGS__)

typedef struct hk_encounters_facet {
  size_t size;
  /* Adds the encounters of the straight moves from x_from (n x 3, the positions at the start of a step) to `to`, the
   * state after it. Called after every step; it should drop a particle with a few operations where it can. False: this
   * run has none, and the force is not asked again. Required. */
  bool (*find)(const void *self, const hk_view *to, const double *x_from, hk_encounters *encounters);
} hk_encounters_facet;

#endif
