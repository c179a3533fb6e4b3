/* How the particles of an impact respond to an impulse on it. */
#ifndef HK_IMPACT_RESPONSE_H
#define HK_IMPACT_RESPONSE_H

#include "plugins/common/contact/bodies/body_system.h"

/* Before the first response at a place of the bodies. */
void hk_body_response_forget(hk_body_impacts *);

/* The response of impact e. */
hk_status hk_body_response_find(hk_body_impacts *, const hk_contact_solver *, const hk_step_move *, size_t e,
                                const hk_body_response **);

/* The difference of both sides of impact e where they touch, less the level's origin; y = x or v, n x 3. */
void hk_body_relative(const hk_body_impacts *, const hk_contact_solver *, size_t e, const hk_impact_level *,
                      const double *y, double out[3]);

/* Gives impact e these impulses in place of those that it has, along n and across it, and y what they change. */
void hk_body_impulse_set(const hk_body_impacts *, hk_contact_solver *, size_t e, bool speeds, double push,
                         const double slide[3], double *y);

#endif
