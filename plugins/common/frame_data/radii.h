/* How thick things are drawn where nobody says it: in pictures and on pages, which get the numbers as data. Lengths are
 * parts of the size of the motion, half the diagonal of its box. */
#ifndef HK_RADII_H
#define HK_RADII_H

#include "core/plugin.h"

enum { HK_TUBE_CLASSES = 4 };

typedef struct hk_drawn_radii {
  /* Of lines, by how many there are: radius[k] up to most[k], the last for all beyond. */
  double tube[HK_TUBE_CLASSES], most[HK_TUBE_CLASSES - 1];
  double on_tubes;              /* particles on lines, over the radius of these */
  double loose, least, largest; /* n particles without lines: loose/sqrt(n + 1) within the two */
  double pin, pin_on_tubes;     /* where there are lines: over the radius of their particles */
} hk_drawn_radii;

extern const hk_drawn_radii hk_drawn;

double hk_drawn_tube(double size, double lines);
double hk_drawn_loose(double size, double n);

/* Radii that strands and rods have of their own: what contact says of a particle, elsewhere the script's. */
typedef struct hk_strand_radii {
  const double *const *contact; /* *contact: n, m, 0 where it says nothing; or NULL */
  const hk_strands *strands;    /* or NULL */
} hk_strand_radii;

/* In `create`. */
hk_strand_radii hk_strand_radii_find(const hk_host *, const hk_model *);
static inline bool hk_strand_radii_any(const hk_strand_radii *r) {
  return r->contact || (r->strands && r->strands->count);
}
/* m, of the particle with this index; 0: it has none. */
double hk_strand_radius(const hk_strand_radii *, const hk_model *, size_t particle);

#endif
