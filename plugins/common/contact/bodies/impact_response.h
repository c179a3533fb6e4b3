/* How the particles of an impact respond to an impulse on it. */
#ifndef HK_IMPACT_RESPONSE_H
#define HK_IMPACT_RESPONSE_H

#include "plugins/common/contact/bodies/body_system.h"

/* The response of impact e. */
hk_status hk_body_response_find(hk_body_impacts *, const hk_contact_solver *, const hk_step_move *, size_t e,
                                const hk_body_response **);

#endif
