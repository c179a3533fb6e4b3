/* Levels of smoothed aggregation and their V-cycle, a symmetric positive definite preconditioner: see hierarchy.c. */
#ifndef HK_HIERARCHY_H
#define HK_HIERARCHY_H

#include "plugins/common/linear/upper_matrix.h"
#include "plugins/common/multigrid/transfer.h"
#include "plugins/common/supernodal/supernodal.h"

enum { HK_LEVELS = 12 };

typedef struct hk_level {
  hk_matrix A;         /* the finest is the caller's */
  const hk_upper *use; /* for its products; the finest is the caller's */
  hk_upper upper;
  double *inverse; /* of the diagonal blocks */
  double most;     /* bound of the eigenvalues of D^-1 A */
  hk_transfer P;   /* from the next level; without columns on the last */
  double *vectors; /* x, b, r, d of the level */
  double *x, *b, *r, *d;
} hk_level;

/* Zeroed before `open`. */
typedef struct hk_hierarchy {
  const hk_host *host;
  size_t levels;
  hk_level level[HK_LEVELS];
  hk_supernodal coarsest; /* factors of the last level, where it is small enough; else it is smoothed only */
  bool direct;
  double *part; /* chunks of the finest vectors */
} hk_hierarchy;

hk_status hk_hierarchy_open(hk_hierarchy *, const hk_host *);
void hk_hierarchy_close(hk_hierarchy *);
/* Levels of A, which is symmetric; they depend on A alone. upper: its products, which must stay until the next call.
 * HK_NO_MEMORY; HK_NOT_CONVERGED: A is not positive definite; with a message. */
hk_status hk_hierarchy_build(hk_hierarchy *, const hk_matrix *A, const hk_upper *upper);
/* z = M^-1 r by one V-cycle; returns r.z. Both have eight numbers beyond their ends. */
double hk_hierarchy_apply(hk_hierarchy *, const double *r, double *z);

#endif
