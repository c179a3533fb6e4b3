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

/* About the centre of mass. */
HK_INLINE void find_inertia(hk_rigid_node *n, double mass) {
  four sum[3] = {{0}, {0}, {0}}; /* of m r r^T */
  double(*A)[HK_RIGID_ROWS] = n->body + 3;
  for (int k = 0; k < n->size; k++) {
    const four r = *(const four *)n->at[k], by = n->mass[k] * r;
    for (int c = 0; c < 3; c++) sum[c] += by[c] * r;
  }
  if (n->size <= 2) {
    double about = n->size == 2 ? sum[0][0] + sum[1][1] + sum[2][2] : mass;
    for (int c = 0; c < 3; c++) A[c][3 + c] = about;
    return;
  }
  A[0][3] = sum[1][1] + sum[2][2];
  A[1][4] = sum[0][0] + sum[2][2];
  A[2][5] = sum[0][0] + sum[1][1];
  A[0][4] = A[1][3] = -sum[0][1];
  A[0][5] = A[2][3] = -sum[0][2];
  A[1][5] = A[2][4] = -sum[1][2];
}

/* (x, y, z, z) */
#define HK_VECTOR(of) __builtin_shufflevector(*(const two *)(of), ((two){(of)[2], (of)[2]}), 0, 1, 2, 3)

HK_INLINE void place(hk_rigid_node *n, const double *x) {
  double mass = 0;
  four center = {0};
  const double *from = x + 3 * (size_t)n->particle[0];
  for (int k = 0; k < n->size; k++) {
    const double *at = x + 3 * (size_t)n->particle[k];
    const four r = HK_VECTOR(at) - HK_VECTOR(from);
    *(four *)n->at[k] = r;
    mass += n->mass[k];
    center += n->mass[k] * r;
  }
  center /= mass;
  for (int k = 0; k < n->size; k++) *(four *)n->at[k] -= center;
  memset(n->own_across, 0, sizeof n->own_across);
  memset(n->other, 0, sizeof n->other);
  memset(n->body, 0, sizeof n->body);
  for (int c = 0; c < 3; c++) n->body[c][c] = mass;
  find_inertia(n, mass);
}

/* Adds the wrench of the force J at the place `at` to the numbers of a row that are `apart`. */
static void add_wrench(const hk_rigid_node *n, const double *x, const double *at, const double J[3], double *row,
                       size_t apart) {
  const double *first = x + 3 * (size_t)n->particle[0];
  double r[3];
  for (int c = 0; c < 3; c++) r[c] = at[c] - first[c] + n->at[0][c];
  for (size_t c = 0; c < 3; c++) row[c * apart] += J[c];
  row[3 * apart] += r[1] * J[2] - r[2] * J[1];
  row[4 * apart] += r[2] * J[0] - r[0] * J[2];
  row[5 * apart] += r[0] * J[1] - r[1] * J[0];
}

HK_VERSIONS(static void, place_any, (hk_rigid_node * list, size_t count, const double *x),
            for (hk_rigid_node *n = list; n < list + count; n++) place(n, x))

void hk_rigid_bodies_place(int width, hk_rigid_node *list, size_t count, const double *x) {
  HK_WIDEST(width, place_any)(list, count, x);
}

void hk_rigid_tree_place(int width, hk_rigid_node *list, size_t count, const hk_rigid_term *term, size_t terms,
                         const double *x, double (*J)[3]) {
  hk_rigid_bodies_place(width, list, count, x);
  for (const hk_rigid_term *e = term; e < term + terms; e++) {
    hk_rigid_node *link = &list[e->node];
    const double *at = x + 3 * (size_t)e->particle;
    if (e->other)
      add_wrench(&list[link->parent], x, at, J[e->block], link->other[e->row], 1);
    else
      add_wrench(link, x, at, J[e->block], &link->own_across[0][e->row], HK_RIGID_ROWS);
  }
}

/* Of (x, y, z, any): with p, q, r = 1, 2, 0 (y, z, x, any), with 2, 0, 1 (z, x, y, any). */
#define HK_ROTATED(a, p, q, r) __builtin_shufflevector(a, a, p, q, r, 3)

/* vector += by (u + w x r) of each particle */
HK_INLINE void turn(const hk_rigid_node *n, const double *twist, double by, double *vector) {
  const double *w = twist + 3;
  const four u = {twist[0], twist[1], twist[2], 0}, wy = {w[1], w[2], w[0], 0}, wz = {w[2], w[0], w[1], 0};
  for (int k = 0; k < n->size; k++) {
    const four r = *(const four *)n->at[k];
    const four way = by * (u + (wy * HK_ROTATED(r, 2, 0, 1) - wz * HK_ROTATED(r, 1, 2, 0)));
    double *to = vector + 3 * (size_t)n->particle[k];
    *(two *)to += __builtin_shufflevector(way, way, 0, 1);
    to[2] += way[2];
  }
}

/* The momentum sum m u and the angular momentum sum r x m u. */
HK_INLINE void take(hk_rigid_node *n, const double *v) {
  four p = {0}, L = {0};
  for (int k = 0; k < n->size; k++) {
    const double *of = v + 3 * (size_t)n->particle[k];
    const four r = *(const four *)n->at[k], u = HK_VECTOR(of);
    p += n->mass[k] * u;
    L += n->mass[k] *
         (HK_ROTATED(r, 1, 2, 0) * HK_ROTATED(u, 2, 0, 1) - HK_ROTATED(r, 2, 0, 1) * HK_ROTATED(u, 1, 2, 0));
  }
  for (int c = 0; c < 3; c++) n->wrench[c] = p[c], n->wrench[3 + c] = L[c];
}

HK_VERSIONS(static void, take_any, (hk_rigid_node * list, size_t count, const double *v),
            for (hk_rigid_node *n = list; n < list + count; n++) take(n, v))

void hk_rigid_tree_take(int width, hk_rigid_node *list, size_t count, const double *v) {
  HK_WIDEST(width, take_any)(list, count, v);
}

double hk_rigid_tree_extent(const hk_rigid_node *list, size_t count, const double *x) {
  double most[3] = {0, 0, 0};
  for (const hk_rigid_node *n = list; n < list + count; n++)
    for (int k = 0; k < n->size; k++)
      for (size_t c = 0; c < 3; c++) {
        double size = fabs(x[3 * (size_t)n->particle[k] + c]);
        most[c] = size > most[c] ? size : most[c];
      }
  return fmax(fmax(most[0], most[1]), most[2]);
}

/* ---- factors ---- */

HK_INLINE four *head(double *row) { return (four *)row; }
HK_INLINE two *tail(double *row) { return (two *)(row + 4); }

/* to += the sum of b[k] times row k */
HK_INLINE void add_rows(int count, hk_rigid_rows rows, const double *b, double *to) {
  four first = *head(to);
  two last = *tail(to);
  for (int k = 0; k < count; k++) first += b[k] * *head(rows[k]), last += b[k] * *tail(rows[k]);
  *head(to) = first;
  *tail(to) = last;
}

/* to += the sum of from[k][q] times row k */
HK_INLINE void add_column(int count, hk_rigid_rows from, int q, hk_rigid_rows rows, double *to) {
  four first = *head(to);
  two last = *tail(to);
  for (int k = 0; k < count; k++) first += from[k][q] * *head(rows[k]), last += from[k][q] * *tail(rows[k]);
  *head(to) = first;
  *tail(to) = last;
}

/* The same, subtracted. */
HK_INLINE void remove_column(int count, hk_rigid_rows from, int q, hk_rigid_rows rows, double *to) {
  four first = *head(to);
  two last = *tail(to);
  for (int k = 0; k < count; k++) first -= from[k][q] * *head(rows[k]), last -= from[k][q] * *tail(rows[k]);
  *head(to) = first;
  *tail(to) = last;
}

HK_INLINE void scale_rows(int count, hk_rigid_rows from, const double *by, hk_rigid_rows to) {
  for (int k = 0; k < count; k++) *head(to[k]) = by[k] * *head(from[k]), *tail(to[k]) = by[k] * *tail(from[k]);
}

/* A call for each row below n, with its number as a constant, so that what it does with the rows before or behind it is
 * unrolled. */
#define HK_FORWARD(n, call, ...)                                                                                       \
  do {                                                                                                                 \
    call(0, __VA_ARGS__);                                                                                              \
    if ((n) > 1) call(1, __VA_ARGS__);                                                                                 \
    if ((n) > 2) call(2, __VA_ARGS__);                                                                                 \
    if ((n) > 3) call(3, __VA_ARGS__);                                                                                 \
    if ((n) > 4) call(4, __VA_ARGS__);                                                                                 \
    if ((n) > 5) call(5, __VA_ARGS__);                                                                                 \
  } while (0)

/* Row q of A, with rows before it as they were before their division by the pivots, `whole`. */
HK_INLINE void factorize_row(int q, hk_rigid_rows A, hk_rigid_rows whole, double *pivot, bool *fine) {
  double own = A[q][q];
  remove_column(q, whole, q, A, A[q]);
  *head(whole[q]) = *head(A[q]);
  *tail(whole[q]) = *tail(A[q]);
  *fine &= A[q][q] > dependent * own;
  pivot[q] = 1 / A[q][q];
  *head(A[q]) *= pivot[q];
  *tail(A[q]) *= pivot[q];
}

/* Of the symmetric A, n x n: column k of its unit lower triangle in row k, and the reciprocals of its pivots. */
HK_INLINE bool factorize_rows(int n, hk_rigid_rows A, double *pivot) {
  bool fine = true;
  hk_rigid_rows whole;
  HK_FORWARD(n, factorize_row, A, whole, pivot, &fine);
  return fine;
}

/* b := L^-1 b, of numbers and of rows. */
HK_INLINE void lower_row(int q, hk_rigid_rows L, double *b) {
  for (int k = 0; k < q; k++) b[q] -= L[k][q] * b[k];
}

HK_INLINE void lower(int n, hk_rigid_rows L, double *b) { HK_FORWARD(n, lower_row, L, b); }

HK_INLINE void lower_row_of_rows(int q, hk_rigid_rows L, hk_rigid_rows b) { remove_column(q, L, q, b, b[q]); }

HK_INLINE void lower_rows(int n, hk_rigid_rows L, hk_rigid_rows b) { HK_FORWARD(n, lower_row_of_rows, L, b); }

/* b := L^-T b */
HK_INLINE void upper_row(int up, int n, hk_rigid_rows L, double *b) {
  for (int q = n - up, k = q - 1; q < n; q++) b[k] -= L[k][q] * b[q];
}

HK_INLINE void upper(int n, hk_rigid_rows L, double *b) { HK_FORWARD(n, upper_row, n, L, b); }

HK_INLINE void transpose(int n, hk_rigid_rows from, int m, hk_rigid_rows to) {
  for (int c = 0; c < m; c++)
    for (int r = 0; r < n; r++) to[c][r] = from[r][c];
}

/* ---- from the leaves to the roots, and back ---- */

#define HK_ADD_SQUARE(q, count, from, part, to) add_column(count, from, q, part, (to)[q])

/* What an eliminated link leaves to the parent: the sum of its rows' squares over the pivots. */
HK_INLINE void add_to_parent(hk_rigid_node *n, hk_rigid_node *parent, int rows) {
  hk_rigid_rows part;
  scale_rows(rows, n->other, n->link_pivot, part);
  HK_FORWARD(6, HK_ADD_SQUARE, rows, n->other, part, parent->body);
}

HK_INLINE bool factorize_link(hk_rigid_node *n, hk_rigid_node *parent, int rows) {
  hk_rigid_rows part;
  lower_rows(6, n->body, n->own_across);
  transpose(6, n->own_across, rows, n->own);
  scale_rows(6, n->own_across, n->body_pivot, part);
  memset(n->link, 0, sizeof n->link);
  HK_FORWARD(rows, HK_ADD_SQUARE, 6, n->own_across, part, n->link);
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
    double part[HK_RIGID_ROWS];
    memcpy(part, n->wrench, sizeof part);
    lower(6, n->body, part);
    memcpy(n->body_part, part, sizeof part);
    if (n->rows) HK_EACH_ROWS(HK_GATHER, n, parent_of(list, n), g + n->row);
  }
  for (hk_rigid_node *n = list; n < list + count; n++) {
    if (n->rows) HK_EACH_ROWS(spread_link, n, parent_of(list, n));
    double part[HK_RIGID_ROWS];
    for (int c = 0; c < 6; c++) part[c] = n->body_part[c] * n->body_pivot[c];
    upper(6, n->body, part);
    memcpy(n->twist, part, sizeof part);
  }
}

HK_VERSIONS(static bool, factorize_any, (hk_rigid_node * list, size_t count), return factorize(list, count))
HK_VERSIONS(static void, solve_any, (hk_rigid_node * list, size_t count, const double *g), solve(list, count, g))

HK_VERSIONS(static void, turn_any, (const hk_rigid_node *list, size_t count, double by, double *vector),
            for (const hk_rigid_node *n = list; n < list + count; n++) turn(n, n->twist, by, vector))
HK_VERSIONS(static void, push_any, (const hk_rigid_node *list, size_t count, double by, double *vector),
            for (const hk_rigid_node *n = list; n < list + count; n++) turn(n, n->moved, by, vector))

void hk_rigid_tree_turn(int width, const hk_rigid_node *list, size_t count, double by, double *vector) {
  HK_WIDEST(width, turn_any)(list, count, by, vector);
}

void hk_rigid_tree_push(int width, const hk_rigid_node *list, size_t count, double by, double *vector) {
  HK_WIDEST(width, push_any)(list, count, by, vector);
}

bool hk_rigid_tree_factorize(int width, hk_rigid_node *list, size_t count) {
  return HK_WIDEST(width, factorize_any)(list, count);
}

void hk_rigid_tree_solve(int width, hk_rigid_node *list, size_t count, const double *g) {
  HK_WIDEST(width, solve_any)(list, count, g);
}
