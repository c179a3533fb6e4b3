/* An hk_system over a function of the test's, and integrators opened from their .so files, without the engine. */
#ifndef HK_TEST_FAKE_SYSTEM_H
#define HK_TEST_FAKE_SYSTEM_H

#include "core/engine/contract/contract.h"

/* n particles of mass 1; `width` channel numbers per particle. */
typedef struct fake_problem {
  size_t n, width;
  unsigned flags; /* HK_DEPENDS_ON_... */
  /* Sets a (n x 3) and dy (n x width, then the power); both come zeroed. */
  void (*f)(const void *context, double t, const double *x, const double *v, const double *y, double *a, double *dy);
  const void *context;
} fake_problem;

typedef struct fake_system {
  hk_system system; /* first member */
  hk_linear_table linear;
  hk_contact_table contact; /* system.contact is NULL until a test sets it */
  hk_split_table split;
  hk_system_queries queries;
  fake_problem problem;
  hk_host host;
  hk_model model;
  hk_partition partition; /* one block */
  hk_channel channel;
  double *mass;
  uint32_t *id, *group;
  uint8_t *pin;
  const char *group_name;
  hk_force_info force; /* one, all of f but the channels */
  bool takes;
  struct fake_solver *solver;
  struct fake_block *blocks; /* what host->allocate has given out */
  size_t evaluations, jacobians, factorizations;
  size_t fails_at; /* the evaluation, counted from 1, that fails; 0: none */
  hk_status fails_with;
  char message[512]; /* of host->fail */
} fake_system;

typedef struct fake_method {
  const hk_plugin *plugin;
  void *handle, *self;
  fake_system *system;
} fake_method;

enum { FAKE_METHODS = 64 };

fake_system *fake_system_create(const fake_problem *); /* at t = 0, X = 0 */
void fake_system_destroy(fake_system *);
/* Counts failures of evaluations from here. */
void fake_system_fail(fake_system *, size_t at, hk_status with);

/* Names of the integrators in HK_BUILD, sorted, as strings that live as long as the program; how many. */
size_t fake_integrator_names(const char *names[FAKE_METHODS]);
/* Loads the integrator of that name and makes an instance with default parameters; fails the test when it cannot. */
fake_method fake_method_open(const char *name, fake_system *);
void fake_method_close(fake_method *);
/* Whether the method needs no more than f. */
bool fake_method_explicit(const fake_method *);
/* Whether it needs f and its Jacobians, and is the project's own; a plugin on another library's integrators is not. */
bool fake_method_implicit(const fake_method *);
/* Sets a parameter that is a number; false: it has none of that name. */
bool fake_method_set(const fake_method *, const char *name, double value);
/* hk_integrator.growth, which the method has. */
double fake_method_growth(const fake_method *, double hw, double hg, double hb);
/* One step of h; moves the system's t. */
hk_status fake_method_step(fake_method *, double h, hk_step *out);
/* `steps` equal steps to t_end; fails the test when one fails. */
void fake_method_run(fake_method *, double t_end, size_t steps);
/* Addresses of the doubles that a step hands on to the next: X and arrays of fields that are no scratch; how many. */
size_t fake_method_memory(const fake_method *, double **address, size_t most);
/* The other fields that evolve, numbers and integers, to and from a buffer of 16 words; how many bytes. */
size_t fake_method_save(const fake_method *, char *buffer);
void fake_method_load(const fake_method *, const char *buffer);

#endif
