/* Scenes of colliding spheres on the fixture barrier_spheres, and what its counters say. */
#ifndef HK_TEST_SPHERES_H
#define HK_TEST_SPHERES_H

#include "tests/support/engine.h"

/* Opens an engine with two spheres of radius 0.1 m and 1 and 2 kg, head-on at 1 m/s each, 0.1 m apart. */
hk_plugin_spec *test_two_spheres(test_engine *);
/* Ten spheres above a floor, a little askew, under gravity. */
hk_plugin_spec *test_heap(test_engine *);
/* A field of a plugin by name; fails the test when there is none. */
int64_t test_counter(test_engine *, const hk_plugin_spec *, const char *name);
double test_field(test_engine *, const hk_plugin_spec *, const char *name);
double test_momentum(test_engine *, int axis); /* kg m/s */

#endif
