/* The parameters that all plugins of contact share. Those of one run have to agree in the first four. */
#ifndef HK_CONTACT_PARAMS_H
#define HK_CONTACT_PARAMS_H

#include "plugins/common/contact/surfaces/surfaces.h"

typedef struct hk_contact_params {
  double thickness, body_thickness, radius; /* m */
  hk_tuples leave;
  double friction;
  double skin; /* m; NAN: hk_contact_skin chooses */
} hk_contact_params;

/* Of some steps, for reports. */
typedef struct hk_contact_sums {
  double impulse, energy; /* N s; J, taken by impacts and friction */
  double closest;         /* m, the least gap */
} hk_contact_sums;

/* clang-format off */
#define HK_CONTACT_PARAM_ROWS(TYPE)                                                                                    \
    {"thickness", "m", "of cloth and soft bodies: surfaces in contact are so far apart",                               \
     .number = HK_AT(TYPE, params.thickness), .initial = {1e-3}, .limits = HK_ABOVE_TO(0, 1e6)},                       \
    {"body_thickness", "m", "of obstacles, surfaces that are pinned as a whole; half of it is outside",                \
     .number = HK_AT(TYPE, params.body_thickness), .limits = HK_WITHIN(0, 1e6)},                                       \
    {"radius", "m", "of strands, bars and isolated particles", .number = HK_AT(TYPE, params.radius), .initial = {5e-4},          \
     .limits = HK_ABOVE_TO(0, 1e6)},                                                                                   \
    {"leave", "", "particles that have no part in contact", .particles = HK_AT(TYPE, params.leave),                    \
     .flags = HK_OPTIONAL},                                                                                            \
    {"friction", "", "mu, Coulomb's", .number = HK_AT(TYPE, params.friction), .limits = HK_WITHIN(0, 1e6)},            \
    {"skin", "m",                                                                                                      \
     "how far beyond contact pairs are searched: a search serves until a particle has moved by half of "               \
     "it; left out: the larger of thickness and diameter", .number = HK_AT(TYPE, params.skin),                         \
     .limits = HK_ABOVE_TO(0, 1e6), .flags = HK_OPTIONAL}
/* clang-format on */

static inline double hk_contact_skin(const hk_contact_params *p) {
  return isnan(p->skin) ? fmax(p->thickness, 2 * p->radius) : p->skin;
}

/* m: the least distance at which two surfaces touch. */
static inline double hk_contact_scale(const hk_contact_params *p) {
  return fmin((p->thickness + p->body_thickness) / 2, fmin(p->thickness, 2 * p->radius));
}

/* `plugin`: its name, or NULL, see hk_surface_request. */
static inline const hk_surfaces *hk_contact_join(const hk_contact_params *p, const char *plugin, const hk_host *host,
                                                 const hk_view *view, hk_status *status) {
  const hk_surfaces *surfaces = host->query(host, HK_SURFACES_INTERFACE);
  hk_surface_request request = {p->thickness, p->body_thickness, p->radius, &p->leave, plugin, p->friction};
  *status = surfaces ? surfaces->join(surfaces->self, &request, view) : HK_FAILED;
  return surfaces;
}

#endif
