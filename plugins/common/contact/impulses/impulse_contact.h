/* What the correctors that keep surfaces apart by impulses share: parameters, pair cache, candidates, and the account
 * of impulses, energy and the least gap. A step enters the account once the next one starts at its end: until then
 * another corrector may take it back. Instances of such plugins begin with an hk_impulse_contact. */
#ifndef HK_IMPULSE_CONTACT_H
#define HK_IMPULSE_CONTACT_H

#include "plugins/common/contact/impulses/contact_candidates.h"
#include "plugins/common/contact/surfaces/contact_params.h"

typedef struct hk_impulse_contact {
  hk_contact_params params;
  double restitution;
  int64_t sweeps;
  hk_contact_sums settled, last; /* of the last step, which ended at last_t; `closest`: since the last report */
  double last_t;                 /* s */
  double *free;                  /* 2 x n x 3: positions and velocities before the corrections */
  hk_pair_cache cache;
  hk_contact_candidates candidates;
  const hk_surfaces *surfaces;
  const hk_host *host;
} hk_impulse_contact;

/* clang-format off */
#define HK_IMPULSE_CONTACT_FIELDS                                                                                      \
  {"impulse", .number = HK_AT(hk_impulse_contact, settled.impulse)},                                                   \
  {"energy", .number = HK_AT(hk_impulse_contact, settled.energy)},                                                     \
  {"closest", .number = HK_AT(hk_impulse_contact, settled.closest)},                                                   \
  {"last_impulse", .number = HK_AT(hk_impulse_contact, last.impulse)},                                                 \
  {"last_energy", .number = HK_AT(hk_impulse_contact, last.energy)},                                                   \
  {"last_closest", .number = HK_AT(hk_impulse_contact, last.closest)},                                                 \
  {"last_t", .number = HK_AT(hk_impulse_contact, last_t)}
/* clang-format on */

/* In `create`, of the plugin of that name (see hk_surface_request), and in `topology`. */
hk_status hk_impulse_contact_create(hk_impulse_contact *, const char *plugin, const hk_host *, const hk_view *);
hk_status hk_impulse_contact_topology(hk_impulse_contact *, const hk_view *);
/* Before a step: enters the last one into the account, or drops it. */
void hk_impulse_contact_begin(hk_impulse_contact *, const hk_view *, const hk_correction *);
/* Keeps the end of the step as it is now, before the first correction. */
void hk_impulse_contact_keep_free(hk_impulse_contact *, const hk_view *, const hk_correction *);
/* After all corrections, which lead to x_to. Where they changed something, sets their work: the change of the kinetic
 * energy at the end of the step less the work of the step's accelerations between its two ends. That is the energy lost
 * in impacts and to friction, and the energy from moving obstacles. */
void hk_impulse_contact_end(hk_impulse_contact *, const hk_view *, hk_correction *, const double *x_to);
/* For hk_corrector.contacts. */
bool hk_impulse_contact_report(void *self, const hk_view *, hk_contact_report *out);

#endif
