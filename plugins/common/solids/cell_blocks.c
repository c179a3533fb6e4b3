/* With g = grad V and H its Hessian the force is F = -z g, and
 *     -dF/dx = stiffness g g^T + z H + damping g (H v)^T,      -dF/dv = damping g g^T.
 * g g^T couples every particle of a cell with every other one. The last term of dF/dx is not symmetric:
 * HK_WANT_SYMMETRIC omits it, and HK_WANT_DEFINITE z H as well.
 *
 * Of a triangle a b c, H_ab w = w x c/6, with c seen from any point that is the same for all triangles. Of an edge with
 * the corners c and d on its sides H_ab w = w x (c - d)/6, so that for a bound each side may be seen from the edge's
 * middle m: 2 u_a.H_ab u_b <= |c - m|/6 (s u_a^2 + u_b^2/s) for each of the two. */
#include "plugins/common/solids/cell_blocks.h"

#include "plugins/kit/vector3.h"

void hk_cells_pattern(const hk_cells *s, hk_pattern *pattern) {
  for (size_t c = 0; c < s->acting; c++) {
    const hk_cell *cell = &s->cell[c];
    const uint32_t *member = s->member + cell->member;
    for (size_t m = 0; m < cell->members && cell->members <= HK_CELL_MEMBERS; m++)
      for (size_t q = 0; q < cell->members; q++) pattern->block(pattern, member[m], member[q]);
  }
}

/* Sums the gradients of the members of a cell. */
static void gather(const hk_cells *s, const hk_cell *cell, double (*g)[3]) {
  for (size_t m = 0; m < cell->members; m++) g[m][0] = g[m][1] = g[m][2] = 0;
  for (size_t k = 3 * cell->first; k < 3 * (cell->first + cell->triangles); k++)
    hk_add_scaled(g[s->local[k]], 1, s->triangles.load[k]);
}

/* The corners of a triangle seen from the first particle of its cell. */
static void corners(const hk_cells *s, const hk_view *view, const hk_cell *cell, size_t k, double at[3][3]) {
  const double *origin = view->x + 3 * (size_t)s->member[cell->member];
  for (int c = 0; c < 3; c++) hk_subtract(at[c], view->x + 3 * (size_t)hk_tuple(&s->triangles.acting, k)[c], origin);
}

/* Hv += H v */
static void multiply(const hk_cells *s, const hk_view *view, const hk_cell *cell, double (*Hv)[3]) {
  double at[3][3], w[3];
  for (size_t m = 0; m < cell->members; m++) Hv[m][0] = Hv[m][1] = Hv[m][2] = 0;
  for (size_t k = cell->first; k < cell->first + cell->triangles; k++) {
    corners(s, view, cell, k, at);
    for (size_t a = 0; a < 3; a++)
      for (size_t b = 0; b < 3; b++) {
        if (a == b) continue;
        hk_cross(w, view->v + 3 * (size_t)hk_tuple(&s->triangles.acting, k)[b], at[3 - a - b]);
        hk_add_scaled(Hv[s->local[3 * k + a]], b == (a + 1) % 3 ? 1.0 / 6 : -1.0 / 6, w);
      }
  }
}

/* K += factor H_ab, H_ab w = w x c/6 with the triangle's third corner at c: column d of it is e_d x c/6. */
static void add_corner_pair(double *K, size_t a, size_t b, const double c[3], double factor) {
  double f = (b == (a + 1) % 3 ? factor : -factor) / 6;
  K[1] += f * c[2], K[2] -= f * c[1];
  K[3] -= f * c[2], K[5] += f * c[0];
  K[6] += f * c[1], K[7] -= f * c[0];
}

static void add_hessian(const hk_cells *s, const hk_view *view, const hk_cell *cell, double factor, const size_t *slot,
                        double *K) {
  double at[3][3];
  for (size_t k = cell->first; k < cell->first + cell->triangles; k++) {
    corners(s, view, cell, k, at);
    for (size_t a = 0; a < 3; a++)
      for (size_t b = 0; b < 3; b++)
        if (a != b)
          add_corner_pair(K + 9 * slot[cell->members * s->local[3 * k + a] + s->local[3 * k + b]], a, b, at[3 - a - b],
                          factor);
  }
}

void hk_cells_corner_pattern(const hk_cells *s, hk_pattern *pattern) {
  for (size_t c = 0; c < s->acting; c++)
    for (size_t k = s->cell[c].first; k < s->cell[c].first + s->cell[c].triangles; k++) {
      const uint32_t *corner = hk_tuple(&s->triangles.acting, k);
      for (size_t e = 0; e < 9; e++) pattern->block(pattern, corner[e / 3], corner[e % 3]);
    }
}

/* K += size (1 - a a^T/a^2) */
static void add_across(double *K, const double a[3], double size) {
  double square = hk_dot(a, a);
  for (size_t e = 0; e < 9; e++) K[e] += size * ((e % 4 == 0) - (square > 0 ? a[e / 3] * a[e % 3] / square : 0));
}

/* One side of a triangle, with the corners a and b, and its arm from the middle of the side to the third corner: M = (0
 * S; S^T 0), S w = z w x arm/6, whose eigenvalues are s = |z arm|/6, -s and 0, the first two twice. Its definite part
 * is (M + |M|)/2, |M| = s (1 - arm arm^T/arm^2) at both corners. */
static void add_side(const hk_blocks *into, const size_t slot[9], size_t a, size_t b, const double arm[3], double z) {
  bool definite = into->want & HK_WANT_DEFINITE;
  double part = definite ? z / 2 : z;
  add_corner_pair(into->K + 9 * slot[3 * a + b], a, b, arm, part);
  add_corner_pair(into->K + 9 * slot[3 * b + a], b, a, arm, part);
  if (!definite) return;
  double size = fabs(part) * hk_length(arm) / 6;
  add_across(into->K + 9 * slot[4 * a], arm, size);
  add_across(into->K + 9 * slot[4 * b], arm, size);
}

void hk_cells_corner_jacobian(const hk_cells *s, const hk_view *view, size_t c, double z, const hk_blocks *into,
                              size_t *next) {
  const hk_cell *cell = &s->cell[c];
  double at[3][3], arm[3];
  for (size_t k = cell->first; k < cell->first + cell->triangles; k++, *next += 9) {
    corners(s, view, cell, k, at);
    for (size_t e = 0; e < 3; e++) {
      size_t a = (e + 1) % 3, b = (e + 2) % 3;
      for (int d = 0; d < 3; d++) arm[d] = at[e][d] - (at[a][d] + at[b][d]) / 2;
      add_side(into, into->slot + *next, a, b, arm, z);
    }
  }
}

void hk_cells_jacobian(const hk_cells *s, const hk_view *view, size_t c, hk_cell_pressure p, const hk_blocks *into,
                       size_t *next, double (*g)[3]) {
  const hk_cell *cell = &s->cell[c];
  const size_t *slot = into->slot + *next, n = cell->members;
  bool definite = into->want & HK_WANT_DEFINITE,
       turns = p.damping > 0 && !definite && !(into->want & HK_WANT_SYMMETRIC);
  double(*Hv)[3] = g + n;
  gather(s, cell, g);
  if (turns) multiply(s, view, cell, Hv);
  for (size_t m = 0; m < n; m++)
    for (size_t q = 0; q < n; q++)
      for (size_t e = 0; e < 9; e++) {
        size_t at = 9 * slot[n * m + q] + e;
        double square = g[m][e / 3] * g[q][e % 3];
        into->K[at] += p.stiffness * square + (turns ? p.damping * g[m][e / 3] * Hv[q][e % 3] : 0);
        into->D[at] += p.damping * square;
      }
  if (!definite) add_hessian(s, view, cell, p.z, slot, into->K);
  *next += n * n;
}

/* ---- bound of the stiffness -------------------------------------------------------------------------------------- */

static double root_of(const hk_view *view, size_t i) { return sqrt(view->model->inverse_mass[i]); }

static void bound_curvature(const hk_cells *s, const hk_view *view, const hk_cell *cell, double z, double (*block)[6]) {
  double at[3][3], arm[3];
  for (size_t k = cell->first; k < cell->first + cell->triangles; k++) {
    const uint32_t *corner = hk_tuple(&s->triangles.acting, k);
    corners(s, view, cell, k, at);
    for (size_t c = 0; c < 3; c++) {
      size_t a = corner[(c + 1) % 3], b = corner[(c + 2) % 3];
      for (int d = 0; d < 3; d++) arm[d] = at[c][d] - (at[(c + 1) % 3][d] + at[(c + 2) % 3][d]) / 2;
      double norm = fabs(z) * hk_length(arm) / 6, ra = root_of(view, a), rb = root_of(view, b);
      for (int e = 0; e < 6; e += e ? 2 : 3) { /* xx, yy, zz: 0, 3, 5 */
        if (ra > 0) block[a][e] += norm * rb / ra;
        if (rb > 0) block[b][e] += norm * ra / rb;
      }
    }
  }
}

void hk_cells_bound(const hk_cells *s, const hk_view *view, size_t c, hk_cell_pressure p, bool curved, double (*g)[3],
                    double (*block)[6]) {
  const hk_cell *cell = &s->cell[c];
  const uint32_t *member = s->member + cell->member;
  double sum = 0;
  gather(s, cell, g);
  for (size_t m = 0; m < cell->members; m++) sum += root_of(view, member[m]) * hk_length(g[m]);
  for (size_t m = 0; m < cell->members; m++) {
    double size = hk_length(g[m]), r = root_of(view, member[m]);
    if (!(size * r > 0)) continue;
    for (int e = 0, row = 0; row < 3; row++)
      for (int d = row; d < 3; d++, e++) block[member[m]][e] += p.stiffness * sum / (size * r) * g[m][row] * g[m][d];
  }
  if (curved) bound_curvature(s, view, cell, p.z, block);
}
