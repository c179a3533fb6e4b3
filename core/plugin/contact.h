/* Contact of surfaces: what forces and correctors that keep surfaces apart report of it, for the verdict. */
#ifndef HK_PLUGIN_CONTACT_H
#define HK_PLUGIN_CONTACT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { HK_CONTACT_TEXT = 160 };

/* Several plugins of a run that keep the same surfaces apart may each report them; the host takes the largest count,
 * the least approach, and the sum of the impulses and energies. */
typedef struct hk_contact_report {
  size_t intersections; /* pairs of an edge and a triangle without a common particle that intersect, or touch, at the
                           present positions: counted exactly */
  char first[HK_CONTACT_TEXT]; /* the first such pair in words, "triangle 4 12 5 and edge 77 78 at (0, 0, 1) m", by
                                  particles' ids; "" when there is none */
  double closest;              /* m, the least gap (distance of two surfaces less what their thickness takes) since the
                                  last report; INFINITY: none was near */
  double impulse;              /* N s, sum of the sizes of the impulses of impacts since the start of the run */
  double impact_energy;        /* J, energy that impacts and friction have taken since the start; NAN: not known */
  bool repairs;                /* the plugin removes intersections: a start that has some is not refused */
  const char *remedy;          /* what removes them, for the sentence of a start that has some; NULL: not said */
} hk_contact_report;

/* Places where bodies touch, one by one, for pictures. */
typedef struct hk_contact_points {
  void *context;
  /* At x (m); n: along the force between the two, of length 1, in either sense. */
  void (*add)(void *context, const double x[3], const double n[3]);
} hk_contact_points;

#endif
