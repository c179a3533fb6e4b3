/* What forces of a liquid by particles have in common: which particles are liquid and which are walls, the mass that
 * each counts with in sums over neighbours, and the neighbours themselves, from the service neighbours/1.
 *
 * A particle of the liquid counts with its mass. Walls are particles too, and make up for the liquid that is missing
 * behind them: each counts with density x volume, its volume 1 / sum W over the walls around it (Akinci, Ihmsen,
 * Akinci, Solenthaler, Teschner 2012, ACM Trans. Graphics 31, article 62, equation 4), of the time when it became one.
 * That makes one layer do for a half-space; layers as thick as the kernel do without, `wall_volume`. All forces act
 * between particles, so walls that are points of bodies, or of cloth, move by what the liquid does to them. */
#ifndef HK_SPH_PARTICLES_H
#define HK_SPH_PARTICLES_H

#include "core/plugin.h"
#include "plugins/common/sph/sph_kernel.h"

#include <string.h>

enum { HK_SPH_GRAIN = 256 };

typedef enum hk_sph_role { HK_SPH_NONE, HK_SPH_LIQUID, HK_SPH_WALL } hk_sph_role;

typedef struct hk_sph {
  double density, spacing, reach; /* kg/m^3, m, kernel's radius by the spacing */
  double wall_volume;             /* m^3; NAN: from the walls around */
  int64_t dimensions;             /* 3, or 2: a plane, one spacing deep */
  hk_tuples particles, walls;
  bool takes_joined; /* for heat: what edges and triangles join is as the liquid; to be set before hk_sph_open */
  double *volume;    /* n, m^3; 0: not known yet */
  hk_sph_kernel kernel;
  uint8_t *role;      /* n, hk_sph_role */
  double (*point)[4]; /* n: x, y, z and the mass that counts, kg; 0 of those that take no part */
  double *sums;       /* of a chunk; room for two of each */
  const hk_neighbours *service;
  const hk_host *host;
} hk_sph;

/* clang-format off */
#define HK_SPH_PARAMS(type, sph)                                                                                       \
  {"density", "kg/m^3", "of the liquid at rest; in a plane, by a depth of one spacing",                                \
     .number = HK_AT(type, sph.density), .initial = {1000}, .limits = HK_ABOVE(0)},                                    \
  {"spacing", "m", "of the particles; their mass is density x spacing^3",                                              \
     .number = HK_AT(type, sph.spacing), .limits = HK_ABOVE(0), .flags = HK_REQUIRED},                                 \
  {"reach", "", "radius of the kernel, by the spacing; 3: 92 neighbours, in a plane 24",                               \
     .number = HK_AT(type, sph.reach), .initial = {3}, .limits = HK_WITHIN(1.8, 6)},                                   \
  {"dimensions", "", "3, or 2 for a liquid in a plane",                                                                \
     .integer = HK_AT(type, sph.dimensions), .initial = {3}, .limits = HK_WITHIN(2, 3)},                               \
  {"particles", "", "that are the liquid; left out: all that are not walls, nor fixed, nor of a rigid body, nor in an "    \
     "edge or triangle of the scene: what is freed of these joins it",                                                \
     .particles = HK_AT(type, sph.particles), .flags = HK_OPTIONAL | HK_NOT_EMPTY},                                    \
  {"walls", "", "particles that hold the liquid; left out: those that are pinned, points of rigid bodies, and what is "    \
     "in an edge or triangle of the scene",                                                                           \
     .particles = HK_AT(type, sph.walls), .flags = HK_OPTIONAL},                                                       \
  {"wall_volume", "m^3", "of a particle of walls: spacing^3 where they are layers of the liquid's lattice as thick as "  \
     "the kernel; left out: by the walls around it, also for one layer (Akinci 2012)",                                 \
     .number = HK_AT(type, sph.wall_volume), .limits = HK_ABOVE(0), .flags = HK_OPTIONAL}

#define HK_SPH_FIELDS(type, sph)                                                                                       \
  {"volume", .per_particle = HK_AT(type, sph.volume), .width = 1}
/* clang-format on */

/* In `create`: the kernel and the roles. HK_BAD_PARAM: the kernel is too wide for the periodic box; HK_FAILED: no
 * service; HK_NO_MEMORY. */
hk_status hk_sph_open(hk_sph *, const hk_host *, const hk_view *view);
hk_status hk_sph_topology(hk_sph *, const hk_view *view); /* HK_NO_MEMORY */
/* In `update`: volumes of walls that are new. HK_FAILED: two particles are in the same place. */
hk_status hk_sph_update(hk_sph *, const hk_view *view);
/* Before sums: the rows, and `point` of all particles. */
hk_status hk_sph_begin(hk_sph *, const hk_view *view, hk_neighbour_rows *rows);
/* d = x_i - x_j, m, to the nearest image; returns its square. */
double hk_sph_between(const hk_view *view, size_t i, size_t j, double d[3]);
double hk_sph_total(const hk_sph *, const hk_view *view); /* of `sums`, in their order */
/* In `stiffness_bound`, where neighbours cannot be had: no step is known to be stable. */
void hk_sph_bound_unknown(const hk_view *view, double (*block)[6]);

/* Whether a particle has the energy of the liquid: one of it has, and one of a wall that is laid like it, which presses
 * back as the liquid that it stands for would. One whose volume makes up for what is missing has none. */
HK_INLINE bool hk_sph_presses(const hk_sph *s, size_t i) {
  return s->role[i] == HK_SPH_LIQUID || (s->role[i] == HK_SPH_WALL && s->wall_volume > 0);
}

/* m^3, at rest, of what counts; after hk_sph_begin. */
HK_INLINE double hk_sph_volume(const hk_sph *s, size_t i) { return s->point[i][3] / s->density; }

HK_INLINE size_t hk_sph_acting(const hk_view *view, size_t k) { return view->active ? view->active[k] : k; }

/* Neighbours of a particle within the kernel, some at a time. */
enum { HK_SPH_NEAR = 128 };
typedef struct hk_sph_near {
  size_t count;
  uint32_t other[HK_SPH_NEAR];
  double d[3][HK_SPH_NEAR], r2[HK_SPH_NEAR]; /* from the other to the particle, m; m^2 */
  double mass[HK_SPH_NEAR];                  /* that counts, kg */
} hk_sph_near;

/* From *at on, as many as there is room for; `end` is that of the row. Those out of reach are written and passed over,
 * which takes no branch. `box` NULL: space is open. */
HK_INLINE void hk_sph_gather(const hk_sph *s, const hk_periodic_box *box, const uint32_t *row, size_t end, size_t i,
                             size_t *at, hk_sph_near *near) {
  const double *x = s->point[i];
  size_t count = 0, e = *at;
  for (; e < end && count < HK_SPH_NEAR; e++) {
    const double *p = s->point[row[e]];
    double d[3] = {x[0] - p[0], x[1] - p[1], x[2] - p[2]};
    if (box) hk_nearest_image(box, d);
    double r2 = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
    for (int c = 0; c < 3; c++) near->d[c][count] = d[c];
    near->r2[count] = r2;
    near->mass[count] = p[3];
    near->other[count] = row[e];
    count += r2 < s->kernel.radius2;
  }
  near->count = count;
  *at = e;
}

#endif
