/* What families build scenes with. */
#ifndef HK_TEST_ADVERSARY_BUILD_H
#define HK_TEST_ADVERSARY_BUILD_H

#include "tests/adversary/adversary.h"

int adv_add_particle(adv_scene *, double mass, const double x[3], const double v[3]); /* its index */
adv_force *adv_add_force(adv_scene *, adv_law);                                /* always there, on all, of strength 0 */
void adv_add_edge(const adv_scene *, adv_force *, int i, int j, double slack); /* rest: the distance and slack more */
adv_pin *adv_add_pin(adv_scene *, int particle, adv_hold);
void adv_add_gravity(adv_scene *, double x, double y, double z);
void adv_add_drag(adv_scene *, double rate);
adv_force *adv_add_spring(adv_scene *, adv_law, int i, int j, double k, double damping, double slack);
void adv_set_constant(adv_vector *, double x, double y, double z);
/* Frames of a random rate, some 10 to 120 within about `end` seconds. */
void adv_set_end(adv_scene *, uint64_t *seed, double end);
/* A step for motions that take `time` to turn: hooke's choice in half of the cases, or well to badly resolved. */
void adv_set_step(adv_scene *, uint64_t *seed, double time);

void adv_make_rope(adv_scene *, uint64_t *);
void adv_make_kepler(adv_scene *, uint64_t *);
void adv_make_flyby(adv_scene *, uint64_t *);
void adv_make_ringing(adv_scene *, uint64_t *);
void adv_make_light(adv_scene *, uint64_t *);
void adv_make_shaking(adv_scene *, uint64_t *);
void adv_make_pulses(adv_scene *, uint64_t *);
void adv_make_wells(adv_scene *, uint64_t *);
void adv_make_tumbling(adv_scene *, uint64_t *);
void adv_make_late(adv_scene *, uint64_t *);
void adv_make_channels(adv_scene *, uint64_t *);
void adv_make_plain(adv_scene *, uint64_t *);
void adv_make_network(adv_scene *, uint64_t *);
void adv_make_parametric(adv_scene *, uint64_t *);
void adv_make_buckling(adv_scene *, uint64_t *);
void adv_make_bars(adv_scene *, uint64_t *);
void adv_make_turns(adv_scene *, uint64_t *);
void adv_make_units(adv_scene *, uint64_t *);

#endif
