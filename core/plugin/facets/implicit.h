/* Facet of forces for implicit methods: the blocks of K = -dF/dx and D = -dF/dv. */
#ifndef HK_PLUGIN_IMPLICIT_H
#define HK_PLUGIN_IMPLICIT_H

#include "core/plugin/force.h"

enum { /* further hk_force.flags */
       HK_SYMMETRIC_JACOBIAN = 64,
       HK_OFFERS_SYMMETRIC = 256, /* `jacobian` honours HK_WANT_SYMMETRIC; not needed with HK_SYMMETRIC_JACOBIAN */
       HK_OFFERS_DEFINITE = 512,  /* `jacobian` honours HK_WANT_DEFINITE; not needed where blocks are always definite */
       HK_STIFFER_BLOCKS = 2048 /* `jacobian` leaves out, or may leave out, what makes the force softer than its blocks,
                                   such as variables of its own that are always in equilibrium: u.K u is never below
                                   that of -dF/dx at rest, u.D u never below that of -dF/dv, and Newton's method
                                   converges more slowly. K may leave out how a damping changes with the positions */
};

/* First phase: names the blocks, once per topology and whenever the `update` (facets/steps.h) or `evolve`
 * (facets/internal.h) of any force reports a changed pattern. */
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

#define HK_IMPLICIT_ID "implicit/1"
#define HK_IMPLICIT_FACET(...) HK_FACET(HK_IMPLICIT_ID, hk_implicit_facet, __VA_ARGS__)

/* Of a vector u (n x 3) sums are added to: of u.F the derivatives by x, by v, and by what F depends on beside these. */
typedef struct hk_transposed {
  double *x, *v; /* n x 3: (dF/dx)^T u and (dF/dv)^T u */
  /* NULL: not wanted. Otherwise one list for each row of hk_plugin.params: the derivative by that number, by the three
   * of a vector, or by that of each tuple, also where one number stands for all of them; where the list of tuples is
   * left out, and the scene's stand for it, by the one number of all. NULL for rows of other kinds. */
  double *const *parameter;
  double *mass; /* n; NULL where `parameter` is */
} hk_transposed;

/* The number u.(by_x K + by_v D) w of the blocks as `jacobian` fills them with the same `want`, `linearised` and
 * `reached`. */
typedef struct hk_bilinear {
  unsigned want;
  const double *linearised, *reached; /* n x 3; NULL: none */
  double by_x, by_v;                  /* s^2, s */
  const double *u, *w;                /* n x 3 */
  double *by_linearised, *by_reached; /* n x 3: the derivatives by these are added, where they are given */
} hk_bilinear;

/* A direction in what a force depends on, per unit of a parameter, and the change of the force along it. */
typedef struct hk_tangent {
  const double *x, *v; /* n x 3: the changes of positions and velocities */
  /* NULL: no parameter changes. Otherwise one list for each row of hk_plugin.params, as hk_transposed has them: the
   * changes of that number, of the three of a vector, or of that of each tuple. NULL for rows that do not change. */
  const double *const *parameter;
  const double *mass; /* n; NULL: masses do not change */
  double *force;      /* n x 3, N: dF/dx x + dF/dv v + dF/dp parameter + dF/dm mass is added */
} hk_tangent;

/* `pattern` and `jacobian` are required. A constant force names no blocks. With explicit methods the host may ask for
 * the blocks of a force without elements and without `update` for some of its particles alone, by their view, and for
 * `jacobian` after it. */
typedef struct hk_implicit_facet {
  size_t size;
  void (*pattern)(void *self, const hk_view *view, hk_pattern *pattern);
  hk_status (*jacobian)(void *self, const hk_view *view, const hk_blocks *into);
  /* For adjoints, in about the time of `add`: exact, whatever `jacobian` leaves out. A force that has it depends on
   * x, v and t, on masses, on what its parameters are after `create`, and on the scene's triangles, and on nothing else
   * that changes a derivative. NULL: the host takes the blocks, and derivatives by parameters by differences. */
  hk_status (*transposed)(void *self, const hk_view *view, const double *u, const hk_transposed *into);
  /* Of `transposed`: bit r is set where it gives no derivative by row r of hk_plugin.params, though that has numbers;
   * and whether F depends on the positions at `create` beside, as by a shape at rest that is no parameter. What changes
   * either is compared between runs. */
  uint64_t not_by;
  bool of_start;
  /* For adjoints of methods that linearise once a step, beside `transposed`: adds the derivatives of a bilinear form of
   * the blocks by x, v and the parameters. Needed where the blocks are not those of -dF/dx and -dF/dv with every `want`
   * and whatever was foretold; NULL: they are, or the adjoint is refused where they are not. */
  hk_status (*bilinear)(void *self, const hk_view *view, const hk_bilinear *form, const hk_transposed *into);
  /* For tangents, since 3.5: the changes along `count` directions, each in about the time of `add`, exact as those of
   * `transposed`, beside which it is given: u.along(w) = transposed(u).w, and what that says of parameters holds for
   * it. NULL: the host takes `transposed` where that is symmetric, the blocks otherwise, and differences by parameters.
   */
  hk_status (*along)(void *self, const hk_view *view, const hk_tangent *directions, size_t count);
} hk_implicit_facet;

#endif
