/* The bodies of a sum of gravitation. They are copied into arrays of their own, in an order in which those that attract
 * come first, and lengths are multiplied by a power of two that brings their extent near 1: no digit is lost, and
 * squares and cubes stay within the range of floats, which the estimates of some processors need. */
#ifndef HK_GRAVITY_BODIES_H
#define HK_GRAVITY_BODIES_H

#include "core/plugin.h"
#include "plugins/common/gravity/gravity_path.h"

typedef struct hk_gravity_bodies {
  const hk_host *host;
  const hk_gravity_path *path;
  size_t room;
  size_t count;    /* bodies */
  size_t sources;  /* pairs are those of the first so many with the others; count: there are no others */
  bool mutual;     /* and those among the first */
  uint32_t *order; /* count: which particle */
  hk_bodies at;    /* count and a block: scaled places, and masses in kg */
  double *pull[3]; /* count and a block: sums of hk_mutual_pull */
  double scale;    /* 1/m */
  double eps2;     /* scaled square of the softening */
  size_t met;      /* 1 + a body that is at the place of another one, by the last sum; 0: none */
  size_t parts;
  double *part; /* parts: of a sum, one per block or group of targets */
} hk_gravity_bodies;

/* Memory for n bodies. HK_NO_MEMORY, without a message. */
hk_status hk_gravity_reserve(hk_gravity_bodies *, const hk_host *, size_t n);
void hk_gravity_release(hk_gravity_bodies *);
/* Copies the places x (n x 3) and masses of the particles in `order`, whose number is in `count`. */
void hk_gravity_gather(hk_gravity_bodies *, const double *x, const double *mass, double softening);

/* The place in `at` of `count` targets from body `first` on; lanes beyond repeat the first one. */
void hk_gravity_targets(const hk_gravity_bodies *, size_t first, size_t count, hk_targets *);

/* s between two bodies, scaled. */
static inline double hk_gravity_distance(const hk_gravity_bodies *g, size_t j, size_t k) {
  double dx = g->at.x[j] - g->at.x[k], dy = g->at.y[j] - g->at.y[k], dz = g->at.z[j] - g->at.z[k];
  return sqrt(dx * dx + dy * dy + dz * dz + g->eps2);
}

#endif
