/* Functions shared by the plugins that use SUNDIALS: vectors over the state, weights of errors, f, Newton's matrix
 * solved by the scene's solver, and the differences between SUNDIALS 6 and 7. SUNDIALS allocates inside its steps,
 * which only these plugins may do. Its history is in no field, since SUNDIALS owns it: a resumed run starts the method
 * again. */
#ifndef HK_SUNDIALS_H
#define HK_SUNDIALS_H

#include "plugins/common/integrate/channels.h"

#include <nvector/nvector_serial.h>
#include <sundials/sundials_config.h>
#include <sundials/sundials_linearsolver.h>
#include <sundials/sundials_matrix.h>
#include <sundials/sundials_nonlinearsolver.h>
#include <sundials/sundials_types.h>

enum { HK_PRECONDITION_FACTOR, HK_PRECONDITION_BLOCK_JACOBI, HK_PRECONDITION_NONE };

/* First member of an instance, whose address SUNDIALS passes to its callbacks. */
typedef struct hk_sundials {
  double *state; /* a field `state`, scratch: the last result of SUNDIALS, and X */
  double *work;  /* a field `state` x 2, scratch: vectors of a solve */
  int preconditioner;
  const hk_host *host;
  hk_system *system; /* system of the current step */
  SUNContext context;
  N_Vector X; /* a vector over `state` */
  SUNMatrix matrix;
  SUNLinearSolver linear;
  SUNNonlinearSolver nonlinear;
  size_t channels;
  double length, speed, *channel; /* scales of errors: m, m/s, one per number of the channels */
  double acceleration;            /* m/s^2, the largest RMS so far */
  hk_channels rates;              /* the channels' Jacobians */
  hk_status status;               /* status of the last function of the host that failed */
  char message[256];              /* SUNDIALS' last error */
  hk_matrix K, D, A;
  double gamma;
  double *inverse; /* n x 9, of the diagonal blocks (block Jacobi); NULL */
} hk_sundials;

/* Creates context, vector and scales for the particles of `view`; existing ones are freed. */
hk_status hk_sundials_open(hk_sundials *, const hk_host *host, const hk_view *view);
void hk_sundials_close(hk_sundials *);

/* Whether s->X is the last result of SUNDIALS, except for pins and for corrections below `tol`. Changes
 * `state`. */
bool hk_sundials_follows(hk_sundials *, hk_system *s, double tol);
/* Computes the scales from the state and, at a start, from its rates, with 1 or 2 evaluations. `span`: s, time to the
 * next stop. */
hk_status hk_sundials_scale(hk_sundials *, hk_system *s, double span);

/* s, the longest that a step may be, where the host gives h and SUNDIALS plans `planned` (INFINITY: nothing yet). After
 * one that the host made shorter SUNDIALS may take more than it plans, so that limit, *most, stays (0: there is none)
 * until the host offers more; and a piece between two cuts that is very short says nothing of later steps. */
double hk_sundials_longest(double h, double planned, double *most);

/* s, the length planned for the step after one of `taken`; `said`: what SUNDIALS says, `left`: what was left until its
 * stop time. It says no more than that, and at the stop no more than before, though it might grow: under a limit `most`
 * of the host, whose stops are no others' (0: there is none), such a step would be the longest for ever. */
double hk_sundials_next(double said, double taken, double left, double most);

void hk_sundials_notice(hk_sundials *, double h); /* after a step of h from s->X to `state` */

/* The return value of a callback: 0, or a code after which SUNDIALS tries a shorter step (not finite, not converged) or
 * fails; stores the status. */
int hk_sundials_code(hk_sundials *, hk_status status);

/* Callbacks; `self` is the hk_sundials. */
int hk_sundials_rates(double t, N_Vector X, N_Vector dX, void *self);
int hk_sundials_weights(N_Vector X, N_Vector weight, void *self); /* 1 / (tol scale); the work has none. Only
                                                                    increases the scales. */
int hk_sundials_precondition(double t, N_Vector X, N_Vector f, int reuse, int *current, double gamma, void *self);
int hk_sundials_preconditioned(double t, N_Vector X, N_Vector f, N_Vector b, N_Vector z, double gamma, double delta,
                               int side, void *self);

/* sundials_newton.c. Newton's matrix I - gamma J: evaluated unless `reuse`, reduced to the velocities and factorised by
 * the scene's solver. Returns the value of a callback of SUNDIALS. */
int hk_sundials_factorize(hk_sundials *, double t, N_Vector X, N_Vector f, bool reuse, int *current, double gamma);
/* Attaches a linear solver that uses this factorisation, with the matrix object that SUNDIALS requires; or GMRES. */
hk_status hk_sundials_direct(hk_sundials *);
hk_status hk_sundials_krylov(hk_sundials *);

/* SUNDIALS' errors go to `message`; in SUNDIALS 6 this is set for the memory of each method. */
#if SUNDIALS_VERSION_MAJOR < 7
void hk_sundials_hear(int code, const char *module, const char *function, char *message, void *self);
#endif
/* The status of a failed step: that of the host's function which failed, or HK_NOT_CONVERGED with the message of
 * SUNDIALS. `flag` is SUNDIALS' return value; `rates`: the flag means a failure of f. */
hk_status hk_sundials_failed(hk_sundials *, int flag, bool rates);
hk_status hk_sundials_stuck(hk_sundials *); /* for a step too short to move the time */
/* The status of a call that can fail only for lack of memory. */
hk_status hk_sundials_setup(hk_sundials *, int flag);
/* The norm of an error with the weights, the largest component: 1 is the tolerance. */
double hk_sundials_norm(N_Vector error, N_Vector weight);

#endif
