/* The channels of what warms and conducts: enthalpies, and what came from outside. */
#ifndef HK_HEAT_CHANNEL_H
#define HK_HEAT_CHANNEL_H

#include "plugins/common/channels/find_channel.h"

/* In J/kg; of each particle its enthalpy, and what it was given from outside, by sources, surroundings and held
 * temperatures, so that sum m (enthalpy - given) stays the same to rounding with explicit methods. */
typedef struct hk_heat_channel {
  const char *name, *given_name;
  const hk_channel *enthalpy, *given; /* given NULL: no account is kept */
} hk_heat_channel;

/* clang-format off */
#define HK_HEAT_CHANNELS(type, heat)                                                                                   \
  {"channel", "", "with the enthalpy, J/kg; 0 is the solid at the solidus",                                            \
     .string = HK_AT(type, heat.name), .flags = HK_REQUIRED},                                                         \
  {"account", "", "a channel for what each particle was given from outside, J/kg; left out: nobody counts it",         \
     .string = HK_AT(type, heat.given_name)}
/* clang-format on */

/* HK_BAD_PARAM: no such channel, or one of several numbers. */
static inline hk_status hk_heat_channel_find(hk_heat_channel *c, const hk_host *host, const hk_model *m) {
  hk_status status = hk_find_channel(host, m, c->name, "channel", 1, &c->enthalpy);
  if (status == HK_OK && c->given_name) status = hk_find_channel(host, m, c->given_name, "account", 1, &c->given);
  if (status == HK_OK && c->given == c->enthalpy)
    return host->fail(host, HK_BAD_PARAM,
                      "account: '%s' is the channel of the enthalpy itself: declare another one for what comes from "
                      "outside",
                      c->name);
  return status;
}

/* n each; J/kg in view->y, J/(kg s) in rates. */
static inline const double *hk_enthalpy(const hk_heat_channel *c, const hk_view *view) {
  return view->y + c->enthalpy->offset * view->n;
}

/* A particle gets `rate`, J/(kg s), from outside. */
static inline void hk_heat_give(const hk_heat_channel *c, const hk_view *view, size_t i, double rate, double *dy) {
  dy[c->enthalpy->offset * view->n + i] += rate;
  if (c->given) dy[c->given->offset * view->n + i] += rate;
}

/* J: of all particles the enthalpy less what came from outside, where an account is kept; *size: without signs. */
static inline double hk_heat_kept(const hk_heat_channel *c, const hk_view *view, double *size) {
  const double *h = hk_enthalpy(c, view), *given = view->y + c->given->offset * view->n;
  double sum = 0;
  *size = 0;
  for (size_t i = 0; i < view->n; i++) {
    sum += view->model->mass[i] * (h[i] - given[i]);
    *size += view->model->mass[i] * (fabs(h[i]) + fabs(given[i]));
  }
  return sum;
}

#endif
