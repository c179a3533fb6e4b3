/* Bodies joined as trees in time and memory proportional to their number. With the inertia M of the bodies and the
 * gradients J of the links' equations, twists u and multipliers l solve
 *     M u - J^T l = p,   J u = -g.
 * Each body has one link that leads towards the root of its tree. From the leaves to the roots the body and then the
 * link are eliminated, which fills nothing in: with A = L D L^T, the inertia of the body with what hangs on it, the
 * link's matrix is J A^-1 J^T = G E G^T, and what it leaves to the parent is the inertia (G^-1 J')^T E^-1 G^-1 J', J'
 * being the link's gradients with respect to the parent. Baraff, Linear-Time Dynamics using Lagrange Multipliers
 * (SIGGRAPH 1996), section 5; the same recursion in minimal coordinates is Featherstone's (Rigid Body Dynamics
 * Algorithms, 2008, chapter 7). As both matrices are symmetric and positive definite, a heavy body on a light chain is
 * solved as exactly as an even chain.
 *
 * Two particles have no inertia about the line through them, and one has none at all; no equation of theirs turns them
 * that way, and any number above 0 in the place of it leaves them where they are. */
#include "core/numerics/rigid/rigid.h"

#include "core/plugin/widest.h"

#include <math.h>
#include <string.h>

/* A pivot below this part of its diagonal is one of dependent equations: rounding in 6 products leaves some 1e-15. */
static const double dependent = 1e-12;

/* A row of six numbers is one of four and one of two, which every width of vectors divides into its own. */
typedef double four __attribute__((vector_size(32), aligned(8), may_alias));
typedef double two __attribute__((vector_size(16), aligned(8), may_alias));

/* ---- a body ---- */

static void add_inertia(hk_rigid_node *n, int k, double into[6]) {
  const double *r = n->at[k], w = n->mass[k];
  into[0] += w * (r[1] * r[1] + r[2] * r[2]);
  into[1] -= w * r[0] * r[1];
  into[2] += w * (r[0] * r[0] + r[2] * r[2]);
  into[3] -= w * r[0] * r[2];
  into[4] -= w * r[1] * r[2];
  into[5] += w * (r[0] * r[0] + r[1] * r[1]);
}

/* About the centre of mass: xx, yx, yy, zx, zy, zz. */
static void find_inertia(hk_rigid_node *n, double mass, double I[6]) {
  memset(I, 0, 6 * sizeof *I);
  for (int k = 0; k < n->size; k++) add_inertia(n, k, I);
  if (n->size > 2) return;
  double about = n->size == 2 ? (I[0] + I[2] + I[5]) / 2 : mass;
  I[1] = I[3] = I[4] = 0;
  I[0] = I[2] = I[5] = about;
}

static void place(hk_rigid_node *n, const double *x) {
  double mass = 0, center[3] = {0, 0, 0}, I[6];
  const double *from = x + 3 * (size_t)n->particle[0];
  for (int k = 0; k < n->size; k++) {
    mass += n->mass[k];
    for (int c = 0; c < 3; c++) {
      n->at[k][c] = x[3 * (size_t)n->particle[k] + (size_t)c] - from[c];
      center[c] += n->mass[k] * n->at[k][c];
    }
  }
  for (int k = 0; k < n->size; k++)
    for (int c = 0; c < 3; c++) n->at[k][c] -= center[c] / mass;
  find_inertia(n, mass, I);
  memset(n->own, 0, sizeof n->own);
  memset(n->other, 0, sizeof n->other);
  memset(n->body, 0, sizeof n->body);
  for (int c = 0; c < 3; c++) n->body[c][c] = mass;
  for (int p = 0, at = 0; p < 3; p++)
    for (int q = 0; q <= p; q++) n->body[3 + p][3 + q] = n->body[3 + q][3 + p] = I[at++];
}

/* Adds the wrench of the force J at the place `at`. */
static void add_wrench(const hk_rigid_node *n, const double *x, const double *at, const double J[3], double *row) {
  const double *first = x + 3 * (size_t)n->particle[0];
  double r[3];
  for (int c = 0; c < 3; c++) r[c] = at[c] - first[c] + n->at[0][c];
  for (int c = 0; c < 3; c++) row[c] += J[c];
  row[3] += r[1] * J[2] - r[2] * J[1];
  row[4] += r[2] * J[0] - r[0] * J[2];
  row[5] += r[0] * J[1] - r[1] * J[0];
}

void hk_rigid_tree_place(hk_rigid_node *list, size_t count, const hk_rigid_term *term, size_t terms, const double *x,
                         double (*J)[3]) {
  for (size_t k = 0; k < count; k++) place(&list[k], x);
  for (const hk_rigid_term *e = term; e < term + terms; e++) {
    hk_rigid_node *link = &list[e->node];
    const hk_rigid_node *body = e->other ? &list[link->parent] : link;
    add_wrench(body, x, x + 3 * (size_t)e->particle, J[e->block], (e->other ? link->other : link->own)[e->row]);
  }
}

void hk_rigid_node_turn(const hk_rigid_node *n, const double twist[6], double by, double *vector) {
  const double *w = twist + 3;
  for (int k = 0; k < n->size; k++) {
    const double *r = n->at[k];
    double *to = vector + 3 * (size_t)n->particle[k];
    to[0] += by * (twist[0] + (w[1] * r[2] - w[2] * r[1]));
    to[1] += by * (twist[1] + (w[2] * r[0] - w[0] * r[2]));
    to[2] += by * (twist[2] + (w[0] * r[1] - w[1] * r[0]));
  }
}

void hk_rigid_node_take(hk_rigid_node *n, const double *v) {
  double *p = n->wrench, *L = p + 3;
  memset(p, 0, sizeof n->wrench);
  for (int k = 0; k < n->size; k++) {
    const double *r = n->at[k], *u = v + 3 * (size_t)n->particle[k];
    double w = n->mass[k];
    for (int c = 0; c < 3; c++) p[c] += w * u[c];
    L[0] += w * (r[1] * u[2] - r[2] * u[1]);
    L[1] += w * (r[2] * u[0] - r[0] * u[2]);
    L[2] += w * (r[0] * u[1] - r[1] * u[0]);
  }
}

/* ---- factors ---- */

HK_INLINE four *head(double *row) { return (four *)row; }
HK_INLINE two *tail(double *row) { return (two *)(row + 4); }

/* to += by of */
HK_INLINE void add_row(double *to, double by, double *of) {
  *head(to) += by * *head(of);
  *tail(to) += by * *tail(of);
}

/* to += the sum of b[k] times row k */
HK_INLINE void add_rows(int count, hk_rigid_rows rows, const double *b, double *to) {
  four first = *head(to);
  two last = *tail(to);
  for (int k = 0; k < count; k++) first += b[k] * *head(rows[k]), last += b[k] * *tail(rows[k]);
  *head(to) = first;
  *tail(to) = last;
}

/* Of the symmetric A, n x n: column k of its unit lower triangle in row k, and the reciprocals of its pivots. */
HK_INLINE bool factorize_rows(int n, hk_rigid_rows A, double *pivot) {
  bool fine = true;
  double found[HK_RIGID_ROWS];
  for (int q = 0; q < n; q++) {
    double own = A[q][q];
    for (int k = 0; k < q; k++) add_row(A[q], -A[k][q] * found[k], A[k]);
    found[q] = A[q][q];
    fine &= found[q] > dependent * own;
    pivot[q] = 1 / found[q];
    *head(A[q]) *= pivot[q];
    *tail(A[q]) *= pivot[q];
  }
  return fine;
}

/* b := L^-1 b, of numbers and of rows. */
HK_INLINE void lower(int n, hk_rigid_rows L, double *b) {
  for (int q = 1; q < n; q++)
    for (int k = 0; k < q; k++) b[q] -= L[k][q] * b[k];
}

HK_INLINE void lower_rows(int n, hk_rigid_rows L, hk_rigid_rows b) {
  for (int q = 1; q < n; q++)
    for (int k = 0; k < q; k++) add_row(b[q], -L[k][q], b[k]);
}

/* b := L^-T b */
HK_INLINE void upper(int n, hk_rigid_rows L, double *b) {
  for (int k = n - 2; k >= 0; k--)
    for (int q = k + 1; q < n; q++) b[k] -= L[k][q] * b[q];
}

HK_INLINE void transpose(int n, hk_rigid_rows from, int m, hk_rigid_rows to) {
  for (int c = 0; c < m; c++)
    for (int r = 0; r < n; r++) to[c][r] = from[r][c];
}

/* ---- from the leaves to the roots, and back ---- */

/* What an eliminated link leaves to the parent: the sum of its rows' squares over the pivots. */
HK_INLINE void add_to_parent(hk_rigid_node *n, hk_rigid_node *parent, int rows) {
  for (int p = 0; p < 6; p++) {
    double part[HK_RIGID_ROWS];
    for (int r = 0; r < rows; r++) part[r] = n->other_across[p][r] * n->link_pivot[r];
    add_rows(rows, n->other, part, parent->body[p]);
  }
}

HK_INLINE bool factorize_link(hk_rigid_node *n, hk_rigid_node *parent, int rows) {
  transpose(rows, n->own, 6, n->own_across);
  lower_rows(6, n->body, n->own_across);
  transpose(6, n->own_across, rows, n->own);
  for (int r = 0; r < rows; r++) {
    double part[HK_RIGID_ROWS];
    for (int c = 0; c < 6; c++) part[c] = n->own[r][c] * n->body_pivot[c], n->link[r][c] = 0;
    add_rows(6, n->own_across, part, n->link[r]);
  }
  if (!factorize_rows(rows, n->link, n->link_pivot)) return false;
  if (!parent) return true;
  lower_rows(rows, n->link, n->other);
  transpose(rows, n->other, 6, n->other_across);
  add_to_parent(n, parent, rows);
  return true;
}

/* link_part = G^-1 (-g - J A^-1 wrench), whose part goes over to the parent's wrench. */
HK_INLINE void gather_link(hk_rigid_node *n, hk_rigid_node *parent, int rows, const double *g) {
  double part[HK_RIGID_ROWS], sum[HK_RIGID_ROWS] = {0};
  for (int c = 0; c < 6; c++) part[c] = -n->body_part[c] * n->body_pivot[c];
  for (int r = 0; r < rows; r++) sum[r] = -g[r];
  add_rows(6, n->own_across, part, sum);
  lower(rows, n->link, sum);
  memcpy(n->link_part, sum, sizeof sum);
  if (!parent) return;
  for (int r = 0; r < rows; r++) part[r] = sum[r] * n->link_pivot[r];
  add_rows(rows, n->other, part, parent->wrench);
}

/* The multipliers G^-T E^-1 (link_part - G^-1 J' u), u the parent's twist, and what they do to the body. */
HK_INLINE void spread_link(hk_rigid_node *n, const hk_rigid_node *parent, int rows) {
  double part[HK_RIGID_ROWS], by[HK_RIGID_ROWS];
  memcpy(part, n->link_part, sizeof part);
  for (int c = 0; c < 6 && parent; c++) by[c] = -parent->twist[c];
  if (parent) add_rows(6, n->other_across, by, part);
  for (int r = 0; r < rows; r++) part[r] *= n->link_pivot[r];
  upper(rows, n->link, part);
  add_rows(rows, n->own, part, n->body_part);
}

/* With the usual numbers of rows as constants: a ball joint has 3, one that turns or slides in one way 5, a fixed one
 * 6. */
#define HK_EACH_ROWS(call, n, ...)                                                                                     \
  ((n)->rows == 3   ? call(n, __VA_ARGS__, 3)                                                                          \
   : (n)->rows == 5 ? call(n, __VA_ARGS__, 5)                                                                          \
   : (n)->rows == 6 ? call(n, __VA_ARGS__, 6)                                                                          \
                    : call(n, __VA_ARGS__, (int)(n)->rows))

HK_INLINE hk_rigid_node *parent_of(hk_rigid_node *list, const hk_rigid_node *n) {
  return n->parent == HK_RIGID_NOTHING ? NULL : &list[n->parent];
}

#define HK_GATHER(n, parent, g, rows) gather_link(n, parent, rows, g)

HK_INLINE bool factorize(hk_rigid_node *list, size_t count) {
  bool fine = true;
  for (hk_rigid_node *n = list + count; n-- > list && fine;) {
    fine = factorize_rows(6, n->body, n->body_pivot);
    if (fine && n->rows) fine = HK_EACH_ROWS(factorize_link, n, parent_of(list, n));
  }
  return fine;
}

HK_INLINE void solve(hk_rigid_node *list, size_t count, const double *g) {
  for (hk_rigid_node *n = list + count; n-- > list;) {
    memcpy(n->body_part, n->wrench, sizeof n->body_part);
    lower(6, n->body, n->body_part);
    if (n->rows) HK_EACH_ROWS(HK_GATHER, n, parent_of(list, n), g + n->row);
  }
  for (hk_rigid_node *n = list; n < list + count; n++) {
    if (n->rows) HK_EACH_ROWS(spread_link, n, parent_of(list, n));
    for (int c = 0; c < 6; c++) n->twist[c] = n->body_part[c] * n->body_pivot[c];
    upper(6, n->body, n->twist);
  }
}

HK_VERSIONS(static bool, factorize_any, (hk_rigid_node * list, size_t count), return factorize(list, count))
HK_VERSIONS(static void, solve_any, (hk_rigid_node * list, size_t count, const double *g), solve(list, count, g))

bool hk_rigid_tree_factorize(int width, hk_rigid_node *list, size_t count) {
  return HK_WIDEST(width, factorize_any)(list, count);
}

void hk_rigid_tree_solve(int width, hk_rigid_node *list, size_t count, const double *g) {
  HK_WIDEST(width, solve_any)(list, count, g);
}
