/* The parameters that all plugins of contact share. Those of one run have to agree in the first four. */
#ifndef HK_CONTACT_PARAMS_H
#define HK_CONTACT_PARAMS_H

#include "plugins/common/surfaces/surfaces.h"

typedef struct hk_contact_params {
  double thickness, body_thickness, radius; /* m */
  hk_tuples leave;
  double friction;
  double skin; /* m; NAN: hk_contact_skin chooses */
} hk_contact_params;

/* clang-format off */
#define HK_CONTACT_PARAM_ROWS(TYPE)                                                                                    \
    {"thickness", "m", "of cloth and soft bodies: surfaces in contact are so far apart",                               \
     HK_NUMBER, {1e-3}, 0, 1e6, offsetof(TYPE, params.thickness), HK_ABOVE_MIN, NULL},                                 \
    {"body_thickness", "m", "of obstacles, surfaces that are pinned as a whole; half of it is outside",                \
     HK_NUMBER, {0}, 0, 1e6, offsetof(TYPE, params.body_thickness), 0, NULL},                                          \
    {"radius", "m", "of strands and lone particles",                                                                   \
     HK_NUMBER, {5e-4}, 0, 1e6, offsetof(TYPE, params.radius), HK_ABOVE_MIN, NULL},                                    \
    {"leave", "", "particles that have no part in contact",                                                            \
     HK_PARTICLES, {0}, 0, 0, offsetof(TYPE, params.leave), HK_OPTIONAL, NULL},                                        \
    {"friction", "", "mu, Coulomb's",                                                                                  \
     HK_NUMBER, {0}, 0, 1e6, offsetof(TYPE, params.friction), 0, NULL},                                                \
    {"skin", "m", "how far beyond contact pairs are searched: a search serves until a particle has moved by half of "  \
     "it; left out: the larger of thickness and diameter",                                                             \
     HK_NUMBER, {0}, 0, 1e6, offsetof(TYPE, params.skin), HK_OPTIONAL | HK_ABOVE_MIN, NULL}
/* clang-format on */

static inline double hk_contact_skin(const hk_contact_params *p) {
  return isnan(p->skin) ? fmax(p->thickness, 2 * p->radius) : p->skin;
}

/* m: the least distance at which two surfaces touch. */
static inline double hk_contact_scale(const hk_contact_params *p) {
  return fmin((p->thickness + p->body_thickness) / 2, fmin(p->thickness, 2 * p->radius));
}

static inline const hk_surfaces *hk_contact_join(const hk_contact_params *p, const hk_host *host, const hk_view *view,
                                                 hk_status *status) {
  const hk_surfaces *surfaces = host->query(host, HK_SURFACES_INTERFACE);
  hk_surface_request request = {p->thickness, p->body_thickness, p->radius, &p->leave};
  *status = surfaces ? surfaces->join(surfaces->self, &request, view) : HK_FAILED;
  return surfaces;
}

#endif
