/* A scene's linear equations at its present state, and the largest stable step of a method on them: the truth that a
 * foretold step is compared with. */
#ifndef HK_TEST_LINEAR_SCENE_H
#define HK_TEST_LINEAR_SCENE_H

#include "tests/support/engine.h"
#include "tests/support/step_matrix.h"

enum { LINEAR_NUMBERS = 27 };

/* x'' = -K x - D x' in the coordinates sqrt(m) x of the particles that are not pinned to places, scaled to steps of
 * 1 s by h. */
typedef struct linear_scene {
  size_t numbers;
  double K[LINEAR_NUMBERS][LINEAR_NUMBERS], D[LINEAR_NUMBERS][LINEAR_NUMBERS]; /* 1/s^2, 1/s */
  double h;                                                                    /* s */
} linear_scene;

/* K and D by differences of the accelerations at the present state of the run, which stays. */
linear_scene linear_scene_of(test_engine *);
/* Whether the equations themselves do not grow: K is positive definite (D takes energy or turns velocities). */
bool linear_scene_rests(const linear_scene *);
/* An instance of the method on the equations, steps being of h. */
fake_method linear_scene_open(const char *method, linear_scene *, double h);
void linear_scene_close(fake_method *);
/* Whether the matrix of a step of h grows by no more than LINEAR_EXCESS a step. */
bool linear_scene_stable(const char *method, linear_scene *, double h);
/* The foretold limit over the true one, by bisection to LINEAR_PRECISION; not followed below 1/10. */
double linear_scene_ratio(const char *method, linear_scene *, double foretold);

/* Half more than the growth that a foretold limit allows (core/numerics/stability/largest_step.c). */
#define LINEAR_EXCESS 3e-7
#define LINEAR_PRECISION 0.01

#endif
