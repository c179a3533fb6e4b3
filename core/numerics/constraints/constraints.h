/* The equations g = 0 and g >= 0 of all constraints of a scene, with J = dg/dx, W the inverse masses after pins, and
 * A = S J W J^T S scaled by S; their active set; and the projections of x and v. constraint.c applies them. */
#ifndef HK_CONSTRAINTS_H
#define HK_CONSTRAINTS_H

#include "core/numerics/matrix/matrix.h"

/* What is known of one-sided equations that may cease to push within a step (release.c). */
typedef struct hk_releases {
  bool *acts;     /* equations: pushes in an evaluation of the step, or did in the last one before it */
  bool *freed;    /* equations: rests in an evaluation of the step, although it touched at its start */
  double *before; /* equations: multipliers at the start of the step */
  double *most;   /* equations: the largest of them so far */
  double *after;  /* equations: multipliers at the end of the step, of what acts as equalities */
  double *slope;  /* scratch of an evaluation, shaped as X */
  bool *rests;    /* equations: that of the constraints while the former are computed, and their scale */
  double *scale;
  bool weighing; /* this evaluation is for the multipliers of what acts, as equalities */
  size_t equation, cuts;
  double begin, end, left; /* the last step that was cut, for `equation`: its times, s, and the multiplier at its end */
  double until;            /* s, the end of the longest step of which `cuts` are counted */
} hk_releases;

/* Blocks of equations on riders (rider_blocks.c): term k adds weight J[given] to block `block` of J. */
typedef struct hk_rider_term {
  uint32_t given, block;
  double weight;
} hk_rider_term;

typedef struct hk_rider_blocks {
  size_t given;        /* blocks as plugins name them; 0: no equation names a rider, J is filled by them */
  uint32_t (*pair)[2]; /* given: equation and particle */
  size_t *first;       /* the first of each instance, and their number */
  double (*J)[3];      /* given: dg/dx */
  size_t terms;
  hk_rider_term *term;
} hk_rider_blocks;

/* An entry of A = S J W J^T S and its mirror, which is itself where one equation has two blocks of a particle: their
 * places in the values, and the first of its terms. */
typedef struct hk_constraint_entry {
  size_t place, mirror, first;
} hk_constraint_entry;

typedef struct hk_rigid_groups hk_rigid_groups;
typedef struct hk_rigid_links hk_rigid_links;
struct hk_rigid_group;
struct hk_rigid_bundle;
struct hk_rigid_pair;

/* What SHAKE works on: a step of h s, from `from` at t_from to x and v at t, n x 3 each. */
typedef struct hk_rattle_step {
  double t_from, t, h, *from, *x, *v;
} hk_rattle_step;

struct hk_constraints {
  hk_constraint_table table; /* hk_system.constraint */
  size_t equations, blocks, terms;
  size_t *equation_first;   /* first equation of each instance, and the number of equations */
  size_t *block_first;      /* first block of each instance, and the number of blocks */
  hk_block_matrix list;     /* pair[b]: equation and particle of block b; its matrix is not built */
  double (*J)[3], (*WJ)[3]; /* blocks: dg/dx, and W J: J with the pins applied, divided by the mass */
  hk_rider_blocks riding;
  hk_rigid_groups *groups; /* all equations are of free rigid groups, or join them as trees; NULL: they are solved
                              together */
  const hk_model *model;
  uint32_t *pin, *place;  /* blocks: position in d->pins->item, and of the particle in it; UINT32_MAX: never pinned */
  hk_block_matrix matrix; /* pattern of A: 1 x 1 blocks; the diagonal is named first */
  uint32_t (*term)[2];    /* terms: blocks p and q of two equations, of which J[p] . WJ[q] is a part of an entry of A;
                             the equation of p is not behind that of q; entry by entry */
  size_t entries;         /* beside the diagonal's */
  hk_constraint_entry *entry;     /* entries, and one that has `terms` as its first */
  double *value;                  /* values of A */
  double *own;                    /* equations: diagonal of J W J^T */
  double *full;                   /* equations: diagonal of S if all equations acted; 0 where no particle can move */
  double *scale;                  /* equations: diagonal of S; 0 where an equation rests or no particle can move */
  double *g, *c, *rhs, *solution; /* equations */
  double *speed;                  /* equations: dg/dt at fixed x, m/s; zeros where a constraint has none */
  double *g_start, *rate_start;   /* equations: g and dg/dt at the start of the step; of one-sided ones */
  double *residual, *correction;  /* equations: residual and correction of a refinement; also scratch */
  double *moved;                  /* n x 3: W J^T solution */
  double *impulse;                /* equations: the sum of the solutions of SHAKE's rounds */
  double *lambda;                 /* equations: multipliers of the last evaluation */
  /* The set of equations that act (active_set.c). */
  size_t one_sided_count;
  bool *one_sided; /* equations */
  bool *implied;   /* equations linearly dependent on others in this scene: their multiplier is 0 */
  bool *touches;   /* one-sided equations that were met with equality at the start of the step */
  bool *pushes;    /* one-sided equations whose multiplier was positive in the last evaluation of this step */
  bool *allowed;   /* one-sided equations that may act in the present problem */
  bool *held;      /* one-sided equations that are treated as equalities in the present problem */
  bool *met;       /* one-sided equations that are met at met_at, s, where a step was cut; impact.c */
  double *bounce, *still, *opening; /* equations: coefficient of restitution, the speed below which it is 0, and that
                                       after the present impact, m/s; NULL: no constraint has any */
  double met_at;
  bool meets;     /* the state to be projected is that of met_at, and those are met with equality */
  bool *rests;    /* equations that do not act in the present problem */
  double soft;    /* the present factors are those of A + soft I */
  bool dependent; /* the present problem has linearly dependent equations */
  bool struck;    /* velocities jumped in the present projection */
  bool has_speed; /* some constraint has `speed` */
  bool jumped;    /* since hk_constraints_jumped was last called: contact began or ended, equations changed, velocities
                     jumped */
  bool kept;      /* J, speed, A and the factors are those of kept_x and kept_t (constraint_projection.c) */
  double kept_t, *kept_x;
  hk_releases releases;
  uint64_t revision; /* of the pattern */
  bool *path_used;   /* pins: a constraint acts on a particle of it */
  hk_linear_system linear;
  hk_linear_system mixed;      /* J_end W J^T, unsymmetric; opened on demand */
  double (*J_end)[3];          /* blocks: J at the end of the step */
  hk_plugin_spec *unsymmetric; /* spec of its solver; NULL: the scene's */
};

static inline double hk_constraint_dot(const double a[3], const double b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Largest g that counts as contact, relative to the largest coordinate, at rest, where the projections leave less than
 * that, and while it closes: what is left to close then is motion, and its end is found (impact.c). */
static const double hk_constraint_touching = 1e-10, hk_constraint_met = 1e-12;

/* Largest rate that counts as rest, relative to the sum of |J||v| plus the largest coordinate per second, since the
 * speed of a resting contact is only rounding. It may be generous, because an equation in contact acts only while it
 * pushes. */
static const double hk_constraint_resting = 1e-9;

/* ---- constraint_values.c ---- */

hk_view hk_constraint_view(const hk_dynamics *, const hk_instance *, double t, const double *x, const double *v);
/* Returns `status`, the result of a call of a constraint; on failure it makes sure that the error has a message. */
hk_status hk_constraint_failed(hk_dynamics *, const hk_instance *, double t, hk_status status);
hk_status hk_constraint_value(hk_dynamics *, double t, const double *x, const double *v);     /* g */
hk_status hk_constraint_speed(hk_dynamics *, double t, const double *x, const double *v);     /* speed */
hk_status hk_constraint_curvature(hk_dynamics *, double t, const double *x, const double *v); /* c */
hk_status hk_constraint_gradients(hk_dynamics *, double t, const double *x, const double *v,
                                  double (*J)[3]); /* of the blocks that plugins name */
hk_status hk_constraint_jacobian(hk_dynamics *, double t, const double *x, const double *v, double (*J)[3]);
int hk_constraint_order(const hk_dynamics *);                         /* of the scene's method; 0: it has none */
double hk_constraint_extent(const hk_constraints *, const double *x); /* the largest coordinate in an equation, m */
/* rate = J v + g_t, sum = the sum of the magnitudes of its terms; sum NULL: it is not wanted. */
void hk_constraint_rate(hk_constraints *, const double *v, double *rate, double *sum);
/* The power of the constraint forces along what moves with time, their equations and scripted particles, W: minus
 * solution (g_t + J v of those particles). Of an impulse it is the work, J. */
double hk_constraint_power(const hk_dynamics *, const double *v);
/* The instance of an equation, and the equation's number within it, from 1. */
const hk_instance *hk_constraint_of(const hk_dynamics *, size_t equation, size_t *number);

/* Equation k, of g, holds with equality; c->residual and c->correction: its rate, and the sum of the magnitudes of the
 * rate's terms. `size`: the largest coordinate, m. */
bool hk_constraint_touches(const hk_constraints *, size_t k, double size);

/* "equation 3 (particles 3 and 4)": the ids of at most four. */
void hk_constraint_name(const hk_dynamics *, size_t equation, char *text, size_t size);

/* The pair that begins with an equation: its points and what it keeps, and the particles of its ends. Returns how many
 * equations it has; 0: the pair begins before it, -1: it is of another kind, or of what changes with time. */
int hk_rigid_pair_of(const hk_dynamics *, size_t equation, uint32_t end[2], struct hk_rigid_pair *);

/* Written to `text`: what may keep the equation from being solved, and what to do about it. */
const char *hk_constraint_doubt(const hk_dynamics *, size_t equation, char *text, size_t size);

/* ---- restitution.c ---- */

hk_status hk_restitution_open(hk_dynamics *); /* once the equations are numbered */
/* Finds which one-sided equations may take part in an impact at x and v, and how fast each opens after it. */
void hk_restitution_begin(hk_constraints *, const double *x, const double *v);
void hk_restitution_subtract(const hk_constraints *, double *rate); /* what the present impact leaves */

/* ---- constraint.c ---- */

/* Finds which one-sided equations touch at x and v. */
hk_status hk_constraint_find_contacts(hk_dynamics *, double t, const double *x, const double *v);

hk_status hk_constraints_project_velocity(hk_system *, double *vector); /* see hk_system */
/* Whether the computing time of this evaluation or step is measured; only a sample is. */
bool hk_constraint_sampled(const hk_dynamics *);
/* Distributes the time since `begin`, s, among the constraints by their numbers of equations; `whole`: the evaluation
 * or step is complete. */
void hk_constraint_account(hk_dynamics *, double begin, bool whole);

/* ---- constraint_pattern.c ---- */

hk_status hk_constraint_matrix_build(hk_dynamics *); /* the pattern, after every change of topology */
void hk_constraint_matrix_free(hk_constraints *);

/* Whether that pin, UINT32_MAX: none, holds its particles to the end of the run, so that they join no equations. */
bool hk_constraint_held(const hk_dynamics *, uint32_t pin);

/* ---- rider_blocks.c ---- */

/* Of the blocks that plugins have named, those of riders become those of their carriers. HK_NO_MEMORY. */
hk_status hk_rider_blocks_spread(hk_dynamics *);
void hk_rider_blocks_carry(const hk_constraints *, double (*J)[3]); /* J of the carriers from riding.J */
void hk_rider_blocks_free(hk_rider_blocks *);

/* ---- rigid_groups.c ---- */

hk_status hk_rigid_groups_find(hk_dynamics *); /* at the state; HK_NO_MEMORY */
void hk_rigid_groups_close(hk_constraints *);
/* As hk_constraint_table.shake and .rattle, where there are groups; all of n x 3. False: one did not converge. */
bool hk_rigid_groups_shake(hk_dynamics *, double t_from, double *from, double t, double h, double *x, double *v);
/* False: equations follow from others at this place, and v is as it was. */
bool hk_rigid_groups_rattle(hk_dynamics *, double t, double *x, double h, double *v);

/* ---- rigid_links.c ---- */

/* The links by which all equations but those with `kept`, distances within the `count` groups, join these; of: n, the
 * group of a particle or UINT32_MAX; bundles: how many the groups fill. *links NULL: they are no trees. HK_NO_MEMORY.
 */
hk_status hk_rigid_links_find(const hk_dynamics *, const struct hk_rigid_group *, size_t count, const uint32_t *of,
                              const bool *kept, size_t bundles, hk_rigid_links **links);
void hk_rigid_links_close(hk_rigid_links *);
/* As the former two, of the bundles of those groups. */
bool hk_rigid_links_shake(hk_dynamics *, hk_rigid_links *, const struct hk_rigid_bundle *, size_t bundles,
                          const hk_rattle_step *);
bool hk_rigid_links_rattle(hk_dynamics *, hk_rigid_links *, double t, double *x, double *v);

/* ---- constraint_matrix.c ---- */

/* Computes J, WJ, full, and scale for the equations that do not rest. */
hk_status hk_constraint_matrix_linearise(hk_dynamics *, double t, const double *x, const double *v);
/* After that, W is as if all masses were 1, until the next linearisation. */
void hk_constraint_matrix_forget_masses(hk_dynamics *);
void hk_constraint_matrix_rest(hk_constraints *);          /* updates scale after a change of `rests` */
hk_matrix hk_constraint_matrix_assemble(hk_constraints *); /* A, whose values are c->value */
/* Factorizes A of the equations that act; where A is singular, A + soft_shift I, and solutions are then refined. */
hk_status hk_constraint_matrix_factorize(hk_dynamics *);
hk_status hk_constraint_matrix_factorize_shifted(hk_dynamics *, double by); /* A + by I */
/* solution = -(J' W J^T)^-1 g, J' at x and J of the last linearisation: a round of Newton's iteration. A and its
 * factors are no longer those of the linearisation. */
hk_status hk_constraint_matrix_newton(hk_dynamics *, double t, const double *x, const double *v);
/* Its two parts: J_end = J' at x, and the factors of J' W J^T, with J of the last linearisation; solution = (J' W
 * J^T)^-1 rhs, 0 where an equation rests, and rhs is overwritten. HK_NOT_CONVERGED: it is singular. */
hk_status hk_constraint_matrix_mix(hk_dynamics *, double t, const double *x, const double *v);
hk_status hk_constraint_matrix_solve_mixed(hk_dynamics *);
/* solution = (J W J^T)^-1 rhs, 0 where an equation rests or no particle can move; rhs is overwritten. For equations
 * that depend on each other: the multipliers of minimal norm. */
hk_status hk_constraint_matrix_solve(hk_dynamics *);
void hk_constraint_matrix_move(const hk_constraints *, double *vector); /* vector += W J^T solution, n x 3 */
/* vector += `by` W J^T of the equations' numbers. */
void hk_constraint_matrix_push(const hk_constraints *, const double *of, double by, double *vector);

hk_status hk_constraints_project_equalities(hk_system *, double t, double *x, double *v);
hk_status hk_constraints_shake(hk_system *, double t, double *from, double h, double *x, double *v, double *work);
hk_status hk_constraints_shake_from(hk_system *, double t_from, double *from, double t, double h, double *x, double *v,
                                    double *work);
hk_status hk_constraints_rattle(hk_system *, double t, double *x, double h, double *v, double *work);

/* ---- impact.c ---- */

void hk_constraint_note_start(hk_constraints *); /* g and, in c->residual, dg/dt of the state that a step starts from */
/* *part: the part of a step of h s to x and v, in (0, 1), at which a one-sided equation is met that was not met at its
 * start; 1: none is before the end. */
hk_status hk_constraints_impact(hk_dynamics *, double t, double *x, double *v, double h, double *part);

/* ---- bodies.c: particles that equations join, "bodies/1" (core/plugin/constraint.h) ---- */

const hk_body_service *hk_bodies_table(hk_dynamics *); /* NULL: no memory */
void hk_bodies_close(hk_dynamics *);

/* ---- release.c ---- */

enum { HK_RELEASE_MATTERS = 2 };           /* to methods of an order above that */
hk_status hk_releases_open(hk_dynamics *); /* for the equations that there are */
void hk_releases_close(hk_releases *);
void hk_release_begin(hk_constraints *); /* of a step */
/* After an evaluation, of the equations that touch; at_start: of the state that the step starts from. */
void hk_release_note(hk_constraints *, bool at_start);
void hk_release_end(hk_constraints *);      /* of a step that counts, by its last evaluation */
hk_status hk_release_solve(hk_dynamics *d); /* c->solution of an evaluation with `weighing`, by c->c */
/* As hk_constraints_impact, where an equation is released: *part becomes less where that is earlier. */
hk_status hk_constraints_release(hk_dynamics *, double t, double *x, double *v, double h, double *part);

/* ---- active_set.c ---- */

/* Computes in `solution` the multipliers with J W J^T lambda + q = 0 for equalities and with lambda >= 0, J W J^T
 * lambda + q >= 0, at least one of the two being 0, for one-sided equations that are `allowed` and not `held`.
 * `factorized`: the present factors are those of the equalities. q is c->g, c->c or any other vector of `equations`
 * numbers. */
hk_status hk_active_set_solve(hk_dynamics *, const double *q, bool factorized);

/* ---- constraint.c. `a` is F/m with pins on entry, and includes constraint forces on return ---- */

void hk_constraints_install(hk_dynamics *); /* the functions of the system that keep constraints */
hk_status hk_constraints_open(hk_dynamics *);
/* At the state, once it is projected: which equations follow from others, which touch. */
hk_status hk_constraints_review(hk_dynamics *);
void hk_constraints_close(hk_dynamics *);
/* As hk_constraint_calls, here and below. */
hk_status hk_constraints_update(hk_dynamics *);
hk_status hk_constraints_topology(hk_dynamics *);
hk_status hk_constraints_accelerate(hk_dynamics *, double t, const double *x, const double *v, double *a,
                                    double *power);
/* Brings x onto g(x) = 0 and v onto J v + g_t = 0 (mass-weighted Newton); part of every step. */
hk_status hk_constraints_project(hk_dynamics *, double t, double *x, double *v);
void hk_constraints_forget(hk_dynamics *); /* what is kept from one step to the next */
/* Whether contact began or ended, equations changed or velocities jumped since the last call: histories of methods are
 * void. */
bool hk_constraints_jumped(hk_dynamics *);
hk_status hk_constraints_violation(hk_dynamics *, double *violation); /* m, of the state */

/* ---- constraint_forces.c: multipliers of the state, N for equations in metres; J^T lambda acts on the particles ----
 */

hk_status hk_constraint_multipliers(hk_dynamics *,
                                    double *lambda); /* of all equations; by one evaluation, without side effects */
void hk_constraint_range(const hk_dynamics *, size_t k, size_t *begin, size_t *end); /* equations of constraint k */
/* Of equations that act between two particles along their line: lambda |dg/dx|, positive in tension, by J of the last
 * evaluation. */
void hk_constraint_bar_forces(const hk_dynamics *, const double *lambda, const hk_pair_forces *into);
/* N, the force of constraint k on a particle, by J of the last evaluation. */
void hk_constraint_force_on(const hk_dynamics *, size_t k, const double *lambda, size_t particle, double F[3]);

#endif
