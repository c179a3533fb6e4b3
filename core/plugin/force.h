/* Forces: they add to F, and may provide their energy, Jacobians and elements, and functions for implicit steps and
 * contact. */
#ifndef HK_PLUGIN_FORCE_H
#define HK_PLUGIN_FORCE_H

#include "core/plugin/contact.h"
#include "core/plugin/model.h"
#include "core/plugin/parts.h"

enum { HK_ELEMENT_VALUES = 16 }; /* largest number of values C per tuple */

/* A force whose energy is, up to a constant, E = 1/2 sum_k stiffness C^2 over elements, each on a tuple of particles,
 * and whose damping is -damping dC/dt dC/dx. Strain, pictures and the methods that work element by element use them.
 * All pointers are valid until the next change of topology. */
typedef struct hk_elements {
  hk_tuples node;
  unsigned values; /* numbers C per tuple, from 1 to HK_ELEMENT_VALUES; all share the tuple's stiffness and damping */
  hk_per_tuple stiffness; /* J per unit of C squared; N/m where C is a length */
  hk_per_tuple damping;   /* J s per unit of C squared; N s/m where C is a length; count 0: none */
  hk_per_tuple rest;      /* reference of the strain, in the unit of C (a length, an area); count 0: no strain */
  /* C and its gradient for the tuples [begin, end): C[(k - begin) * values + e], and
   * dC[((k - begin) * values + e) * arity + member] (3 numbers). Of x it reads the tuples' members alone, and it may be
   * called by several threads at once. NULL: the distance of an edge (arity 2) less its rest length. */
  void (*evaluate)(const void *self, const double *x, size_t begin, size_t end, double *C, double (*dC)[3]);
  const void *self; /* argument of `evaluate` */
} hk_elements;

/* Whether the elements are plain edges, whose C is the length of the edge less the rest length. */
static inline bool hk_elements_are_edges(const hk_elements *e) { return e->node.arity == 2 && !e->evaluate; }

typedef struct hk_element_list {
  const char *force; /* the force's label */
  hk_elements elements;
  size_t index; /* position of the force in hk_system.force */
  bool acts;    /* whether the force acts at present, by its `from` and `to` */
} hk_element_list;

/* First phase of a Jacobian: names the blocks, once per topology and whenever the `update` of any force reports a
 * changed pattern. */
typedef struct hk_pattern hk_pattern;
struct hk_pattern {
  void (*block)(hk_pattern *, uint32_t row, uint32_t column);
};

enum { /* hk_blocks.want: properties that a method asks of the blocks; without flags they are exact */
       HK_WANT_SYMMETRIC = 1, /* omit the unsymmetric terms of dF/dx, such as the rotation of a damping's direction */
       HK_WANT_DEFINITE = 2   /* also project each element's block to positive semi-definite */
};

/* Second phase: the e-th block named goes to K + 9*slot[e] (-dF/dx) and D + 9*slot[e] (-dF/dv). The force adds to the
 * blocks. When it uses several threads, it must not add to the same slot from two of them. */
typedef struct hk_blocks {
  const size_t *slot;
  double *K;     /* N/m */
  double *D;     /* N s/m */
  unsigned want; /* used by forces with the flags HK_OFFERS_... */
  /* Of a method that linearises once a step: the positions (n x 3) of the last linearisation and those that it led to;
   * NULL: none. Where the blocks contain a tension k C, a force may take the one that this linearisation foretold, k
   * (C(linearised) + dC/dx (reached - linearised)), for the one at the positions: of a stiff element the latter is
   * mostly what the bend of its path adds to C, which the step takes away again. */
  const double *linearised, *reached;
} hk_blocks;

enum { /* hk_force.flags */
       HK_DEPENDS_ON_X = 1,
       HK_DEPENDS_ON_V = 2,
       HK_DEPENDS_ON_T = 4,
       HK_DEPENDS_ON_CHANNELS = 8,
       HK_CONSERVES_MOMENTUM = 16,
       HK_CONSERVES_ANGULAR_MOMENTUM = 32,
       HK_SYMMETRIC_JACOBIAN = 64,
       HK_POWER = 128, /* the part of F that is not the gradient of `energy` adds its power to *view->power; a force
                          without this flag is the gradient of its energy, or, without energy, the host counts all of
                          F.v as its power (also where a parameter is a function of time) */
       HK_OFFERS_SYMMETRIC = 256, /* `jacobian` honours HK_WANT_SYMMETRIC; not needed with HK_SYMMETRIC_JACOBIAN */
       HK_OFFERS_DEFINITE = 512,  /* `jacobian` honours HK_WANT_DEFINITE; not needed where blocks are always definite */
       HK_STIFFENS = 1024,        /* may become much stiffer than at present (a slack rope, an open contact): its
                                     `stiffness_bound` determines the stable step, not its present stiffness; symplectic
                                     and reversible methods, which damp no energy of switching, take half that step */
       HK_STIFFER_BLOCKS = 2048 /* `jacobian` leaves out, or may leave out, what makes the force softer than its blocks,
                                   such as variables of its own that are always in equilibrium: u.K u is never below
                                   that of -dF/dx at rest, u.D u never below that of -dF/dv, and Newton's method
                                   converges more slowly. K may leave out how a damping changes with the positions */
};

/* The quantity that `stiffness_bound` bounds. */
typedef enum hk_stiffness_part {
  HK_STIFFNESS_WHOLE,    /* K = -dF/dx, N/m */
  HK_STIFFNESS_UNDAMPED, /* the part of K that the force's elements do not damp, such as the tension across an edge; of
                            a force without elements all of K */
  HK_DAMPING_WHOLE       /* D = -dF/dv, N s/m */
} hk_stiffness_part;

/* ---- Passages: forces of short range that a step passes by --------------------------------------------------------
 *
 * A method knows a force at a few points of a step only. A particle that goes by a force of short range between two of
 * them misses its impulse, with the energy conserved, and with half the step, too. A force of short range therefore
 * names the moves that come near, for the verdict. Forces that do not end with the distance (elements between given
 * particles, uniform fields, drag) need not: at the ends of a step they are never absent, and half the step shows their
 * errors. */

/* The straight move of the vector from what acts to particle i in a step. */
typedef struct hk_passage {
  uint32_t i;
  uint32_t other; /* the particle on which -F acts; i: none */
  double r[3];    /* m, at the start of the step */
  double dr[3];   /* m, its change */
  double range;   /* m, the length over which F changes by its own size, where r is least: r/p for F = r^-p */
} hk_passage;

/* Collects passages. The host integrates F along them; moves of 4 ranges or less are none and may be left out. */
typedef struct hk_passages hk_passages;
struct hk_passages {
  /* `F` gives the force on particle i, N, at any r; self is its argument. */
  void (*add)(hk_passages *, const hk_passage *, void (*F)(const void *self, const double r[3], double force[3]),
              const void *self);
};

/* m^2, the least square of r + u dr for 0 <= u < 1; INFINITY: it is least before or after the move. */
static inline double hk_nearest_square(const double r[3], const double dr[3]) {
  double along = -(r[0] * dr[0] + r[1] * dr[1] + r[2] * dr[2]), length2 = dr[0] * dr[0] + dr[1] * dr[1] + dr[2] * dr[2];
  if (!(along >= 0 && along < length2)) return INFINITY;
  return fmax(0, r[0] * r[0] + r[1] * r[1] + r[2] * r[2] - along * along / length2);
}

/* ---- Forces that are approximations --------------------------------------------------------------------------------
 *
 * A force that is not computed to rounding (by a tree or a mesh) says how large its errors are: the energy balance and
 * half the step do not show them. */

/* From a sample of the particles, whose forces are computed exactly. */
typedef struct hk_force_errors {
  size_t particles;         /* in the sample */
  double rms, p99, largest; /* relative to the exact force: root mean square, 99th percentile, largest */
  double power;             /* W, of all particles: sum of the size of the errors' power, |dF.v| */
} hk_force_errors;

typedef struct hk_force {
  size_t size;
  unsigned flags;
  /* F[3*i..] += force on particle i, N, for active particles only (a tuple acts when all its members are active). */
  hk_status (*add)(void *self, const hk_view *view, double *F);
  double (*energy)(void *self, const hk_view *view);               /* J; NULL: no energy */
  hk_status (*rates)(void *self, const hk_view *view, double *dy); /* dy += rates of the channels; may be NULL */
  /* All elements that act; with `values` 0 in the first list the force has none with the parameters of this run. NULL:
   * it never has. */
  void (*elements)(void *self, const hk_view *view, hk_elements *out);
  /* NULL where jacobian is NULL. With explicit methods the host may ask for the blocks of a force without elements and
   * `update` for some of its particles alone, by their view, and for `jacobian` after that. */
  void (*pattern)(void *self, const hk_view *view, hk_pattern *pattern);
  hk_status (*jacobian)(void *self, const hk_view *view, const hk_blocks *into); /* NULL: no blocks */
  /* Adds to block[i] (xx, xy, xz, yy, yz, zz) so that u.K u <= sum_i u_i.block[i] u_i for all u, where K is that of the
   * present positions and, with HK_STIFFENS, of all states that may follow. NULL: the host measures the stiffness. */
  void (*stiffness_bound)(void *self, const hk_view *view, hk_stiffness_part part, double (*block)[6]);
  /* For contact: finds the elements that may act between the positions of `from` and x_to (n x 3), on the straight
   * line. Called at the start of a run, after births, deaths, events and corrections (x_to is then the present
   * positions), at the start of every step (x_to is predicted with the present velocities) and before every line search
   * of an implicit step, never during evaluations. Explicit methods also evaluate forces off the line, by the effect of
   * accelerations within a step, so elements must be found with a margin. *pattern_changed, false on entry: whether the
   * blocks differ from those before. May be NULL. */
  hk_status (*update)(void *self, const hk_view *from, const double *x_to, bool *pattern_changed);
  /* The safe fraction in (0, 1] of the displacement dx (n x 3) from `from` (continuous collision detection), called
   * after `update` for the same displacement; NULL: it is 1. */
  double (*step_limit)(void *self, const hk_view *from, const double *dx);
  /* dF += (dF/dx) dx + (dF/dv) dv without a matrix; all n x 3. NULL: the host uses the blocks. */
  hk_status (*product)(void *self, const hk_view *view, const double *dx, const double *dv, double *dF);
  double (*longest_step)(void *self, const hk_view *view); /* s, upper bound of the next step; NULL: no bound */
  /* Called after an accepted step of h s that ended at `view`: updates data that change once per step (lagged friction,
   * plastic flow). May be NULL. */
  hk_status (*accepted)(void *self, const hk_view *view, double h);
  unsigned element_lists; /* number of hk_elements that `elements` fills, such as triangles and edges; 0: one */
  /* For a force of short range: adds the passages of the straight moves from x_from (n x 3, the positions at the start
   * of a step) to `to`, the state after it. Called after every step; it should drop a particle with a few operations
   * where it can. False: this run has no passages, and the force is not asked again. NULL: as false. */
  bool (*passages)(const void *self, const hk_view *to, const double *x_from, hk_passages *passages);
  /* For an approximation: the errors that `add` makes at `view`. Called at frames; it should cost less than an `add`.
   * False: here it is exact to rounding. NULL: as false. */
  bool (*errors)(void *self, const hk_view *view, hk_force_errors *out);
  /* Makes the errors `part` times (0 to 1) of what they were, at most: called before the first step of a run that
   * another one is compared with. Required where `errors` is not NULL. */
  void (*sharpen)(void *self, double part);
  /* For contact of surfaces: called at frames. False: this run has none. NULL: as false. */
  bool (*contacts)(void *self, const hk_view *view, hk_contact_report *out);
  /* For a force that a user's hand moves while the run goes on: whether it has done something so far, and *work, J,
   * what it did. No other run repeats that, so such a run is compared with none. Called at frames. NULL: as false. */
  bool (*by_hand)(const void *self, double *work);
  /* For a force of a medium that moves: its velocity u (count x 3, m/s) at the places x (count x 3, m) at
   * view->t. For pictures, at frames; it changes nothing. NULL: there is no such medium. */
  void (*flow)(const void *self, const hk_view *view, const double *x, size_t count, double *u);
  /* For contact of any kind: adds the places where something touches at `view`. As `flow`. NULL: nothing ever does. */
  void (*contact_points)(const void *self, const hk_view *view, const hk_contact_points *points);
  /* For a force that is a sum over elements or particles: adds to F what belongs to one part (core/plugin/parts.h) of
   * view->model->partition, and its power to *view->power. The parts in any order are `add`, up to rounding. It may be
   * called by several threads at once, for parts without a common particle; it reads of x and v the particles of its
   * part alone, since others may not have been computed yet, and calls no function of the host. Not for a force with
   * `rates` or published fields: the host calls its `add`. NULL: the host always calls `add`. */
  void (*add_part)(void *self, const hk_view *view, size_t part, double *F);
  /* With add_part: notes all elements that act (hk_part_touch). Called when the force has been created and after every
   * `topology`. NULL: it acts on each particle alone, so that part b < blocks is that of the particles of block b. */
  void (*parts)(void *self, const hk_view *view, const hk_part_use *use);
} hk_force;

#endif
