/* What the plugins on SUNDIALS share: vectors over the state, weights of errors, f, Newton's matrix through the scene's
 * solver, and what differs between SUNDIALS 6 and 7. SUNDIALS allocates inside its steps, which these plugins alone may
 * do; it counts, chooses and remembers by itself, so its history is in no field: a resumed run starts it anew. */
#ifndef HK_SUNDIALS_H
#define HK_SUNDIALS_H

#include "core/plugin.h"

#include <nvector/nvector_serial.h>
#include <sundials/sundials_config.h>
#include <sundials/sundials_linearsolver.h>
#include <sundials/sundials_matrix.h>
#include <sundials/sundials_nonlinearsolver.h>
#include <sundials/sundials_types.h>

enum { HK_PRECONDITION_FACTOR, HK_PRECONDITION_BLOCK_JACOBI, HK_PRECONDITION_NONE };

/* First member of an instance, which is what SUNDIALS hands to its callbacks. */
typedef struct hk_sundials {
  double *state; /* HK_FIELD_STATE, scratch: what SUNDIALS returned last, and X */
  double *work;  /* HK_FIELD_STATE x 2, scratch: vectors of a solve */
  int preconditioner;
  const hk_host *host;
  hk_system *system; /* of the step under way */
  SUNContext context;
  N_Vector X; /* over `state` */
  SUNMatrix matrix;
  SUNLinearSolver linear;
  SUNNonlinearSolver nonlinear;
  size_t channels;
  double length, speed, *channel; /* scales of errors: m, m/s, one per channel */
  hk_status status;               /* of the service that failed last */
  char message[256];              /* SUNDIALS' last error */
  hk_matrix K, D, A;
  double gamma;
  double *inverse; /* n x 9, of the diagonal blocks (block Jacobi); NULL */
} hk_sundials;

/* Context, vector and scales for the particles of `view`; what was there goes. */
hk_status hk_sundials_open(hk_sundials *, const hk_host *host, const hk_view *view);
void hk_sundials_close(hk_sundials *);

/* Whether s->X is what SUNDIALS returned, but for the pins and for repairs below the tolerance. Changes `state`. */
bool hk_sundials_follows(hk_sundials *, hk_system *s);
/* Scales from the state and, at a start, from its rates: 1 or 2 evaluations. `span`: s, to the next stop. */
hk_status hk_sundials_scale(hk_sundials *, hk_system *s, double span);
void hk_sundials_rescale(hk_sundials *, hk_system *s); /* larger ones only */

/* What a callback returns, 0 or a code after which SUNDIALS tries a shorter step (not finite, not converged) or gives
 * up; keeps the status. */
int hk_sundials_code(hk_sundials *, hk_status status);

/* Callbacks; `self` is the hk_sundials. */
int hk_sundials_rates(double t, N_Vector X, N_Vector dX, void *self);
int hk_sundials_weights(N_Vector X, N_Vector weight, void *self); /* 1 / (tol (|X| + scale)); the work has none */
int hk_sundials_precondition(double t, N_Vector X, N_Vector f, int reuse, int *current, double gamma, void *self);
int hk_sundials_preconditioned(double t, N_Vector X, N_Vector f, N_Vector b, N_Vector z, double gamma, double delta,
                               int side, void *self);

/* sundials_newton.c. Newton's matrix I - gamma J: evaluated unless `reuse`, reduced to the velocities and factorised by
 * the scene's solver. Returns what SUNDIALS expects of a callback. */
int hk_sundials_factorize(hk_sundials *, double t, N_Vector X, bool reuse, int *current, double gamma);
/* A linear solver that uses that, with the matrix that SUNDIALS wants to see beside it; or GMRES. */
hk_status hk_sundials_direct(hk_sundials *);
hk_status hk_sundials_krylov(hk_sundials *);

/* SUNDIALS' errors go to `message`; in SUNDIALS 6 each method's memory has to be told. */
#if SUNDIALS_VERSION_MAJOR < 7
void hk_sundials_hear(int code, const char *module, const char *function, char *message, void *self);
#endif
/* The status of a failed step: that of the service which failed, or HK_NOT_CONVERGED with SUNDIALS' words. `flag` is
 * SUNDIALS' return value; `rates`: it stands for a failure of f. */
hk_status hk_sundials_failed(hk_sundials *, int flag, bool rates);
hk_status hk_sundials_stuck(hk_sundials *); /* for a step too short to move the time */
/* The status of a call that cannot fail but for memory. */
hk_status hk_sundials_setup(hk_sundials *, int flag);
/* WRMS norm of an error with the weights: 1 is the tolerance. */
double hk_sundials_norm(N_Vector error, N_Vector weight);

#endif
