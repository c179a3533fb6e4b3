/* Forces: they add to F, and may give their energy, Jacobians, elements and what implicit steps and contact need. */
#ifndef HK_PLUGIN_FORCE_H
#define HK_PLUGIN_FORCE_H

#include "core/plugin/model.h"

/* A force whose energy is E = 1/2 sum_k stiffness C^2 over elements, each on a tuple of particles, and whose damping is
 * -damping dC/dt dC/dx: what strain, pictures and the methods that work element by element need.
 * All pointers are valid until the next change of topology. */
typedef struct hk_elements {
  hk_tuples node;
  unsigned values;        /* numbers C per tuple, at least 1; all share the tuple's stiffness and damping */
  hk_per_tuple stiffness; /* J per unit of C squared; N/m where C is a length */
  hk_per_tuple damping;   /* J s per unit of C squared; N s/m where C is a length; count 0: none */
  hk_per_tuple rest; /* what strain is relative to, in the unit of C (a length, an area); count 0: it has no strain */
  /* C and its gradient for the tuples [begin, end): C[(k - begin) * values + e], and
   * dC[((k - begin) * values + e) * arity + member] (3 numbers). NULL: the distance of an edge less its rest length. */
  void (*evaluate)(const void *self, const double *x, size_t begin, size_t end, double *C, double (*dC)[3]);
  const void *self; /* of evaluate */
} hk_elements;

typedef struct hk_element_list {
  const char *force; /* the force's label */
  hk_elements elements;
  size_t index; /* the force's place in hk_system.force */
  bool acts;    /* at present, by its `from` and `to` */
} hk_element_list;

/* First phase of a Jacobian: names the blocks, once per topology and whenever `update` says so. */
typedef struct hk_pattern hk_pattern;
struct hk_pattern {
  void (*block)(hk_pattern *, uint32_t row, uint32_t column);
};

enum {                        /* hk_blocks.want: what a method makes of the blocks; without any, they are exact */
       HK_WANT_SYMMETRIC = 1, /* leave out what makes dF/dx unsymmetric, such as the turning of a damping's direction */
       HK_WANT_DEFINITE = 2   /* and project each element's block to positive semi-definite */
};

/* Second phase: the e-th block named goes to K + 9*slot[e] (-dF/dx) and D + 9*slot[e] (-dF/dv). Blocks are added to.
 * Blocks that share a slot are the force's to keep apart when it uses several threads. */
typedef struct hk_blocks {
  const size_t *slot;
  double *K;     /* N/m */
  double *D;     /* N s/m */
  unsigned want; /* honoured by forces that say so, HK_OFFERS_... */
} hk_blocks;

enum { /* hk_force.flags */
       HK_DEPENDS_ON_X = 1,
       HK_DEPENDS_ON_V = 2,
       HK_DEPENDS_ON_T = 4,
       HK_DEPENDS_ON_CHANNELS = 8,
       HK_CONSERVES_MOMENTUM = 16,
       HK_CONSERVES_ANGULAR_MOMENTUM = 32,
       HK_SYMMETRIC_JACOBIAN = 64,
       HK_POWER = 128, /* what is not the gradient of `energy` adds its power to *view->power; a force without this
                          flag is wholly the gradient of its energy, or, without energy, accounted for by the host:
                          all of F.v is its work (also where a parameter is a function of time) */
       HK_OFFERS_SYMMETRIC = 256, /* `jacobian` honours HK_WANT_SYMMETRIC; not needed with HK_SYMMETRIC_JACOBIAN */
       HK_OFFERS_DEFINITE = 512,  /* `jacobian` honours HK_WANT_DEFINITE; not needed where it always is */
       HK_STIFFENS = 1024 /* may become much stiffer than it is at present (a slack rope, a contact that is still open):
                             for the stable step its `stiffness_bound` counts, not what it does now */
};

/* What a force is asked to bound. */
typedef enum hk_stiffness_part {
  HK_STIFFNESS_WHOLE,    /* K = -dF/dx, N/m */
  HK_STIFFNESS_UNDAMPED, /* the part of it that the damping of the force's elements does not reach, such as the tension
                            across an edge; of a force without elements all of it */
  HK_DAMPING_WHOLE       /* D = -dF/dv, N s/m */
} hk_stiffness_part;

typedef struct hk_force {
  size_t size;
  unsigned flags;
  /* F[3*i..] += force on particle i, N, for active particles only (a tuple acts when all its members are active). */
  hk_status (*add)(void *self, const hk_view *view, double *F);
  double (*energy)(void *self, const hk_view *view);                             /* J; NULL: has none */
  hk_status (*rates)(void *self, const hk_view *view, double *dy);               /* dy += channel rates; NULL */
  void (*elements)(void *self, const hk_view *view, hk_elements *out);           /* those that act; NULL: has none */
  void (*pattern)(void *self, const hk_view *view, hk_pattern *pattern);         /* NULL with jacobian */
  hk_status (*jacobian)(void *self, const hk_view *view, const hk_blocks *into); /* NULL: has none (no blocks) */
  /* Adds to block[i] (xx, xy, xz, yy, yz, zz) so that u.K u <= sum_i u_i.block[i] u_i for all u, K being that of the
   * present positions and, with HK_STIFFENS, of whatever it may become. NULL: it is measured. */
  void (*stiffness_bound)(void *self, const hk_view *view, hk_stiffness_part part, double (*block)[6]);
  /* Contact and the like: what may act between the positions of `from` and x_to (n x 3). Called at the start of every
   * step and before every line search of an implicit one, never during evaluations. *pattern_changed, false on entry:
   * the blocks are others than before. NULL. */
  hk_status (*update)(void *self, const hk_view *from, const double *x_to, bool *pattern_changed);
  /* The part of the move dx (n x 3) from `from`, in (0, 1], that is safe (continuous collision); NULL: all of it. */
  double (*step_limit)(void *self, const hk_view *from, const double *dx);
  /* dF += (dF/dx) dx + (dF/dv) dv without a matrix; all n x 3. NULL: taken from the blocks. */
  hk_status (*product)(void *self, const hk_view *view, const double *dx, const double *dv, double *dF);
  double (*longest_step)(void *self, const hk_view *view); /* s, the next step is to be no longer; NULL: any */
  /* A step of h s was accepted and ended at `view`: what changes only then (lagged friction, plastic flow). NULL. */
  hk_status (*accepted)(void *self, const hk_view *view, double h);
} hk_force;

#endif
