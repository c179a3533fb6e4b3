/* A scene beside two in which one of its parameters is larger and smaller, as derivatives of its steps need them. */
#ifndef HK_TEST_VARIED_SCENES_H
#define HK_TEST_VARIED_SCENES_H

#include "tests/support/engine.h"

#include "core/numerics/sensitivity/sensitivity.h"

enum { VARIED_PARAMETERS = 4, VARIED_METHODS = 6, VARIED_ALL = 10 };

/* Methods that state their stages: VARIED_METHODS explicit ones, and then those with implicit stages. */
extern const char *const varied_method[VARIED_ALL];

typedef void varied_scene(test_engine *, const double p[VARIED_PARAMETERS]);

typedef struct varied_runs {
  varied_scene *scene;
  const char *integrator;
  double p[VARIED_PARAMETERS], dt;
  size_t count; /* of parameters that are varied */
  test_engine base, more[VARIED_PARAMETERS], less[VARIED_PARAMETERS];
  hk_varied by[VARIED_PARAMETERS];
  hk_sensitivity *s;
} varied_runs;

/* A stretched, moving tetrahedron, one particle of which is held: springs of p[0] N/m with a damping of p[1] N s/m,
 * whose D changes with the positions, a drag of 0.4 N s/m, a pull, and a start at p[3] times some speeds; p[2] kg is a
 * mass. */
void varied_tetrahedron(test_engine *, const double p[VARIED_PARAMETERS]);
void varied_open(varied_runs *, varied_scene *, const char *integrator, const double p[VARIED_PARAMETERS], size_t count,
                 double dt);
/* Runs the base to t, and takes its steps again. */
void varied_run(varied_runs *, double t);
/* In place of all points, states are kept every so many steps. */
void varied_keep(varied_runs *, size_t stride);
/* x and v (6n) at t of a run of its own, whose parameter k is p[k] + by. */
void varied_end(const varied_runs *, size_t k, double by, double t, double *X);
void varied_close(varied_runs *);
/* A watch that copies the tangents of all parameters, hk_sensitivity.wide numbers each, to the context: the last ones
 * stay. */
hk_status varied_keep_tangents(void *context, double t, const double *X, const double *tangents);
typedef struct varied_tangents {
  size_t numbers; /* of all */
  double last[VARIED_PARAMETERS * 18 * 8], X[6 * 8];
  size_t n;
} varied_tangents;

#endif
