/* The tetrahedra of a filling, from those of the lattice: whole ones without an outside corner, and what is inside of
 * the others, a tetrahedron, a pyramid or a prism whose quadrilaterals are halved alike on both sides of a face. Such a
 * quadrilateral has two inside corners p, q and the cuts towards an outside corner: its diagonal ends in the cut of the
 * long edge, where there is one, else it is the shorter one, or that of the corner with the lower number. The two
 * faces at a long cut then meet in it, and a prism can always be cut in three. */
#include "plugins/common/isosurface/fill_lattice.h"

typedef struct cells {
  hk_fill_work *w;
  bool counting;
  size_t vertices, tetrahedra;
} cells;

typedef struct corner { /* of a piece: a point of the lattice or a cut */
  uint32_t at;
  bool is_cut;
} corner;

static void place_of(const hk_fill_work *w, corner c, double x[3]) {
  uint32_t cut = c.is_cut ? c.at : w->moved[c.at];
  if (cut == hk_fill_none) hk_fill_place(w, c.at, x);
  for (int k = 0; k < 3 && cut != hk_fill_none; k++) x[k] = w->cut[cut].x[k];
}

static double distance2(const hk_fill_work *w, corner a, corner b) {
  double p[3], q[3], sum = 0;
  place_of(w, a, p);
  place_of(w, b, q);
  for (int c = 0; c < 3; c++) sum += (p[c] - q[c]) * (p[c] - q[c]);
  return sum;
}

static corner cut_between(const hk_fill_work *w, uint32_t inside, uint32_t outside) {
  uint32_t k = w->first[inside];
  while (w->cut[k].outside != outside) k = w->cut[k].next[0];
  return (corner){k, true};
}

/* ---- into the filling ---- */

static uint32_t number_of(cells *s, corner c) {
  uint32_t *number = c.is_cut ? &s->w->cut[c.at].number : &s->w->number[c.at];
  if (*number == hk_fill_none) {
    *number = (uint32_t)s->vertices++;
    if (!s->counting) place_of(s->w, c, s->w->found.x[*number]);
  }
  return *number;
}

static double determinant(const double (*x)[3], const uint32_t t[4]) {
  double e[3][3];
  for (int k = 0; k < 3; k++)
    for (int c = 0; c < 3; c++) e[k][c] = x[t[k + 1]][c] - x[t[0]][c];
  return e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) + e[0][1] * (e[1][2] * e[2][0] - e[1][0] * e[2][2]) +
         e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0]);
}

static void add(cells *s, corner a, corner b, corner c, corner d) {
  uint32_t t[4] = {number_of(s, a), number_of(s, b), number_of(s, c), number_of(s, d)};
  size_t at = s->tetrahedra++;
  if (s->counting) return;
  bool turned = determinant((const double(*)[3])s->w->found.x, t) < 0;
  for (int k = 0; k < 4; k++) s->w->found.tetrahedron[at][k] = t[turned && k > 1 ? 5 - k : k];
}

/* ---- pieces ---- */

/* Whether the diagonal of the quadrilateral p, q, cut at q, cut at p goes from p to the cut at q. */
static bool from_first(const hk_fill_work *w, uint32_t p, uint32_t q, uint32_t outside) {
  bool p_long = hk_fill_is_long(w, p, outside), q_long = hk_fill_is_long(w, q, outside);
  if (p_long != q_long) return q_long;
  double to_q = distance2(w, (corner){p, false}, cut_between(w, q, outside));
  double to_p = distance2(w, (corner){q, false}, cut_between(w, p, outside));
  return to_q != to_p ? to_q < to_p : p < q;
}

/* A prism with edges from a[k] to b[k]; from[i][j]: the quadrilateral of i and j has the diagonal from a[i] to b[j].
 * Whichever order of the three has its diagonals from earlier to later gives the three tetrahedra. */
static bool add_prism(cells *s, const corner a[3], const corner b[3], bool from[3][3]) {
  static const unsigned char orders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
  for (int k = 0; k < 6; k++) {
    unsigned p = orders[k][0], q = orders[k][1], r = orders[k][2];
    if (!from[p][q] || !from[p][r] || !from[q][r]) continue;
    add(s, a[p], b[p], b[q], b[r]);
    add(s, a[p], a[q], b[q], b[r]);
    add(s, a[p], a[q], a[r], b[r]);
    return true;
  }
  return false;
}

static void set_diagonal(bool from[3][3], int i, int j, bool first) { from[i][j] = first, from[j][i] = !first; }

/* Three corners inside, one outside. */
static void add_three(cells *s, const uint32_t in[3], uint32_t out) {
  corner a[3], b[3];
  bool from[3][3] = {{false}};
  for (int k = 0; k < 3; k++) a[k] = (corner){in[k], false}, b[k] = cut_between(s->w, in[k], out);
  for (int k = 0; k < 3; k++) {
    int next = (k + 1) % 3;
    set_diagonal(from, k, next, from_first(s->w, in[k], in[next], out));
  }
  add_prism(s, a, b, from);
}

/* Two inside, two outside: the quadrilateral on the surface, which no other tetrahedron has, is halved by its shorter
 * diagonal where the prism can then be cut. */
static void add_two(cells *s, const uint32_t in[2], const uint32_t out[2]) {
  const hk_fill_work *w = s->w;
  corner a[3] = {{in[0], false}, cut_between(w, in[0], out[0]), cut_between(w, in[0], out[1])};
  corner b[3] = {{in[1], false}, cut_between(w, in[1], out[0]), cut_between(w, in[1], out[1])};
  bool from[3][3] = {{false}}, shorter = distance2(w, a[1], b[2]) <= distance2(w, a[2], b[1]);
  for (int k = 0; k < 2; k++) set_diagonal(from, 0, k + 1, from_first(w, in[0], in[1], out[k]));
  set_diagonal(from, 1, 2, shorter);
  if (add_prism(s, a, b, from)) return;
  set_diagonal(from, 1, 2, !shorter);
  add_prism(s, a, b, from);
}

/* Two inside, one on the surface, one outside. */
static void add_pyramid(cells *s, const uint32_t in[2], uint32_t on, uint32_t out) {
  corner p = {in[0], false}, q = {in[1], false}, top = {on, false};
  corner at_p = cut_between(s->w, in[0], out), at_q = cut_between(s->w, in[1], out);
  bool first = from_first(s->w, in[0], in[1], out);
  add(s, top, p, q, first ? at_q : at_p);
  add(s, top, first ? p : q, at_q, at_p);
}

/* One inside: its cuts and the corners on the surface. */
static void add_one(cells *s, uint32_t in, const uint32_t v[4]) {
  corner c[4] = {{in, false}};
  int count = 1;
  for (int k = 0; k < 4; k++)
    if (v[k] != in) c[count++] = s->w->side[v[k]] == 0 ? (corner){v[k], false} : cut_between(s->w, in, v[k]);
  add(s, c[0], c[1], c[2], c[3]);
}

static void add_cell(cells *s, const uint32_t v[4]) {
  uint32_t in[4], on[4], out[4];
  int inside = 0, zero = 0, outside = 0;
  for (int k = 0; k < 4; k++) {
    int side = s->w->side[v[k]];
    if (side > 0) in[inside++] = v[k];
    if (side == 0) on[zero++] = v[k];
    if (side < 0) out[outside++] = v[k];
  }
  if (inside == 0) return;
  if (outside == 0)
    add(s, (corner){v[0], false}, (corner){v[1], false}, (corner){v[2], false}, (corner){v[3], false});
  else if (inside == 1)
    add_one(s, in[0], v);
  else if (inside == 2)
    zero ? add_pyramid(s, in, on[0], out[0]) : add_two(s, in, out);
  else
    add_three(s, in, out[0]);
}

/* ---- the lattice ---- */

/* Between the centre of a cell and the next one along an axis: four tetrahedra, one for each side of their square. */
static void add_bridge(cells *s, const size_t cell[3], int axis) {
  const size_t *n = s->w->grid->points, stride[3] = {1, n[0], n[0] * n[1]};
  const size_t over[3] = {1, n[0] - 1, (n[0] - 1) * (n[1] - 1)};
  static const unsigned char square[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  uint32_t first = (uint32_t)(s->w->corners + cell[0] + cell[1] * over[1] + cell[2] * over[2]), ring[4];
  size_t base = cell[0] + cell[1] * stride[1] + cell[2] * stride[2] + stride[axis];
  size_t u = stride[(axis + 1) % 3], v = stride[(axis + 2) % 3];
  for (int k = 0; k < 4; k++) ring[k] = (uint32_t)(base + square[k][0] * u + square[k][1] * v);
  for (int k = 0; k < 4; k++) {
    const uint32_t corners[4] = {first, (uint32_t)(first + over[axis]), ring[k], ring[(k + 1) % 4]};
    add_cell(s, corners);
  }
}

static void walk(cells *s) {
  const size_t *n = s->w->grid->points;
  size_t cell[3];
  for (cell[2] = 0; cell[2] + 1 < n[2]; cell[2]++)
    for (cell[1] = 0; cell[1] + 1 < n[1]; cell[1]++)
      for (cell[0] = 0; cell[0] + 1 < n[0]; cell[0]++)
        for (int axis = 0; axis < 3; axis++)
          if (cell[axis] + 2 < n[axis]) add_bridge(s, cell, axis);
}

hk_status hk_fill_cells(hk_fill_work *w) {
  cells s = {.w = w, .counting = true};
  walk(&s);
  hk_filling *f = &w->found;
  f->vertices = s.vertices, f->tetrahedra = s.tetrahedra;
  hk_status status = hk_fill_allocate(w, &f->x, f->vertices, sizeof *f->x, "vertices");
  if (status == HK_OK)
    status = hk_fill_allocate(w, &f->tetrahedron, f->tetrahedra, sizeof *f->tetrahedron, "tetrahedra");
  if (status != HK_OK) return status;
  for (size_t p = 0; p < w->points; p++) w->number[p] = hk_fill_none;
  for (size_t k = 0; k < w->cuts; k++) w->cut[k].number = hk_fill_none;
  s = (cells){.w = w};
  walk(&s);
  return HK_OK;
}
