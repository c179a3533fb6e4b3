/* How bodies respond to an impulse; see hk_body_service for what these do. */
#ifndef HK_BODY_RESPONSE_H
#define HK_BODY_RESPONSE_H

#include "core/numerics/constraints/body_list.h"

hk_status hk_body_linearise(void *self, double t, const double *x, const double *v);
hk_status hk_body_respond(void *self, const hk_weighted_point *, const double impulse[3], double *response);
hk_status hk_body_mobility(void *self, const hk_weighted_point *, const double n[3], double *mobility);
hk_status hk_body_push(void *self, const hk_weighted_point *, const double impulse[3], double *v);

#endif
