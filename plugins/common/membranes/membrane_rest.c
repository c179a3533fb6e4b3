/* Shapes of triangles at rest, and their elasticities. A triangle is laid into its own plane, with the u axis along the
 * projection of the warp; with `uv` its corners in the pattern are given. Its Young's moduli are Y_u, Y_v, N/m, along
 * warp and weft, and nu says how much it narrows along v when it is pulled along u; symmetry then makes nu Y_v/Y_u the
 * other one. */
#include "plugins/common/membranes/membrane.h"

#include "plugins/kit/vector3.h"

#include <string.h>

/* Twice the area over the square of the longest side below which a triangle counts as one without area: what is left of
 * its normal are four digits or fewer. */
static const double FLAT = 1e-12;
/* Length of the warp's projection over that of the warp, below which it has no direction in a triangle. */
static const double ACROSS = 1e-6;

/* ---- shape ------------------------------------------------------------------------------------------------------- */

/* The sides at rest in the plane: e_1 = (s[0], s[1]), e_2 = (s[2], s[3]). */
typedef struct sides {
  double s[4];
} sides;

static hk_status no_area(const hk_view *view, const uint32_t *corner, size_t t, const char *where) {
  const uint32_t *id = view->model->id;
  return view->host->fail(view->host, HK_BAD_PARAM,
                          "triangle %zu, of the particles %u, %u and %u, has no area %s: remove it, or move a corner",
                          t + 1, id[corner[0]], id[corner[1]], id[corner[2]], where);
}

static bool has_area(const sides *s) {
  double area = fabs(s->s[0] * s->s[3] - s->s[1] * s->s[2]), dx = s->s[2] - s->s[0], dy = s->s[3] - s->s[1];
  double longest = fmax(s->s[0] * s->s[0] + s->s[1] * s->s[1], s->s[2] * s->s[2] + s->s[3] * s->s[3]);
  return area > FLAT * fmax(longest, dx * dx + dy * dy);
}

/* The direction of the warp at a triangle with the unit normal n. Where none is given it is x, or y where the triangle
 * is across x, more or less. */
static void warp_of(const hk_membrane_params *given, const double n[3], double warp[3]) {
  const double x[3] = {1, 0, 0}, y[3] = {0, 1, 0};
  hk_copy(warp, !isnan(given->warp[0]) ? given->warp : fabs(n[0]) < 0.9 ? x : y);
}

static hk_status lay_down(const hk_view *view, const hk_membrane_params *given, const uint32_t *corner, size_t t,
                          sides *out) {
  double e[2][3], n[3], u[3], v[3], warp[3];
  for (int m = 0; m < 2; m++) hk_subtract(e[m], view->x + 3 * (size_t)corner[m + 1], view->x + 3 * (size_t)corner[0]);
  hk_cross(n, e[0], e[1]);
  double twice = hk_length(n), longest = fmax(hk_dot(e[0], e[0]), hk_dot(e[1], e[1]));
  if (!(twice > FLAT * longest)) return no_area(view, corner, t, "at the start");
  for (int c = 0; c < 3; c++) n[c] /= twice;
  warp_of(given, n, warp);
  double length = hk_length(warp), off = hk_dot(warp, n);
  for (int c = 0; c < 3; c++) u[c] = warp[c] - off * n[c];
  if (!(hk_length(u) > ACROSS * length))
    return view->host->fail(view->host, HK_BAD_PARAM,
                            "warp: {%g, %g, %g} is across triangle %zu, of the particles %u, %u and %u: it has to have "
                            "a direction in every triangle; give another one, or uv",
                            warp[0], warp[1], warp[2], t + 1, view->model->id[corner[0]], view->model->id[corner[1]],
                            view->model->id[corner[2]]);
  double scale = given->rest / hk_length(u);
  for (int c = 0; c < 3; c++) u[c] *= scale;
  hk_cross(v, n, u);
  *out = (sides){{hk_dot(e[0], u), hk_dot(e[0], v), hk_dot(e[1], u), hk_dot(e[1], v)}};
  return has_area(out) ? HK_OK : no_area(view, corner, t, "at the start");
}

/* From the pattern; all triangles have to be turned the same way, or the pattern is folded over. */
static hk_status from_pattern(const hk_view *view, const hk_membrane_params *given, const uint32_t *corner, size_t t,
                              sides *out) {
  const double *p = given->uv.value + 6 * t, *first = given->uv.value;
  double r = given->rest;
  *out = (sides){{r * (p[2] - p[0]), r * (p[3] - p[1]), r * (p[4] - p[0]), r * (p[5] - p[1])}};
  if (!has_area(out)) return no_area(view, corner, t, "in uv");
  double area = out->s[0] * out->s[3] - out->s[1] * out->s[2];
  double other = (first[2] - first[0]) * (first[5] - first[1]) - (first[3] - first[1]) * (first[4] - first[0]);
  if ((area > 0) == (other > 0)) return HK_OK;
  return view->host->fail(view->host, HK_BAD_PARAM,
                          "uv: triangle %zu, of the particles %u, %u and %u, is turned the other way than the first "
                          "one: the pattern is folded over there",
                          t + 1, view->model->id[corner[0]], view->model->id[corner[1]], view->model->id[corner[2]]);
}

/* ---- elasticity -------------------------------------------------------------------------------------------------- */

static hk_status check(const hk_view *view, const hk_membrane_params *p, size_t triangles) {
  const hk_host *host = view->host;
  if (triangles == 0)
    return host->fail(host, HK_BAD_PARAM, "there are no triangles%s; scene:grid and scene:mesh make some",
                      view->is_active ? " among `only` or `group`" : "");
  if (p->uv.count && p->uv.count != 6 * p->triangles.count)
    return host->fail(host, HK_BAD_PARAM,
                      "uv: %zu numbers for %zu triangles: give six for each of `triangles`, {u, v} of its corners",
                      p->uv.count, p->triangles.count);
  if (p->model == HK_BARAFF_WITKIN && p->nu != 0)
    return host->fail(host, HK_BAD_PARAM,
                      "nu: %g: the conditions of baraff_witkin have no Poisson's ratio; model = \"stvk\" has one",
                      p->nu);
  if (p->model == HK_NEO_HOOKEAN && p->nu > 0.5)
    return host->fail(host, HK_BAD_PARAM, "nu: %g: neo_hookean has 0 to 0.5, where the volume stays the same", p->nu);
  if (p->model == HK_NEO_HOOKEAN && (p->weft.count || p->shear.count))
    return host->fail(host, HK_BAD_PARAM,
                      "%s: neo_hookean is the same in all directions: give stiffness and nu, or model = \"stvk\"",
                      p->weft.count ? "weft" : "shear");
  return HK_OK;
}

/* Per area. HK_BAD_PARAM: pulled along the warp it would narrow without end. */
static hk_status elasticity(const hk_view *view, const hk_membrane_params *p, size_t k, hk_elasticity *e) {
  double u = hk_tuple_value(&p->stiffness, k), v = p->weft.count ? hk_tuple_value(&p->weft, k) : u;
  double shear = p->shear.count ? hk_tuple_value(&p->shear, k) : sqrt(u * v) / (2 * (1 + p->nu));
  double rest = 1 - p->nu * p->nu * v / u;
  *e = (hk_elasticity){u / rest, v / rest, p->nu * v / rest, shear};
  if (rest > 0) return HK_OK;
  return view->host->fail(view->host, HK_BAD_PARAM,
                          "nu: %g is too much for %g N/m along the warp and %g N/m along the weft: it has to be below "
                          "the root of their ratio, %g",
                          p->nu, u, v, sqrt(u / v));
}

static hk_status measure(hk_membrane *m, const hk_view *view, const hk_membrane_params *p, const uint32_t *corner,
                         size_t t) {
  sides r = {{0}};
  hk_elasticity e = {0};
  hk_status status = elasticity(view, p, t, &e);
  if (status == HK_OK) status = p->uv.count ? from_pattern(view, p, corner, t, &r) : lay_down(view, p, corner, t, &r);
  if (status != HK_OK) return status;
  double det = r.s[0] * r.s[3] - r.s[1] * r.s[2], area = fabs(det) / 2;
  m->triangle[m->count] = (hk_membrane_triangle){{r.s[3] / det, -r.s[2] / det, -r.s[1] / det, r.s[0] / det},
                                                 {e.c11 * area, e.c22 * area, e.c12 * area, e.c66 * area}};
  for (int c = 0; c < 3; c++) m->id[m->count][c] = view->model->id[corner[c]];
  m->listed[m->count++] = (uint32_t)t;
  return HK_OK;
}

/* ---- memory ------------------------------------------------------------------------------------------------------ */

static hk_status reserve(hk_membrane *m, const hk_host *host, size_t count) {
  size_t n = count + 1;
  m->id = host->allocate(host, n * sizeof *m->id);
  m->triangle = host->allocate(host, n * sizeof *m->triangle);
  m->listed = host->allocate(host, n * sizeof *m->listed);
  m->number = host->allocate(host, n * sizeof *m->number);
  m->node = (hk_tuples){0, 3, host->allocate(host, n * sizeof *m->id)};
  m->energy = host->allocate(host, (n / HK_MEMBRANE_GRAIN + 2) * sizeof *m->energy);
  double *rows = host->allocate(host, HK_MEMBRANE_ROWS * n * sizeof *rows);
  m->creep = host->allocate(host, n * sizeof *m->creep);
  m->one = 1;
  for (size_t r = 0; rows && r < HK_MEMBRANE_ROWS; r++) m->row[r] = rows + r * n;
  if (m->id && m->triangle && m->listed && m->number && m->node.index && m->energy && m->creep && rows) return HK_OK;
  return host->fail(host, HK_NO_MEMORY, "no memory for %zu triangles", count);
}

static bool acts(const hk_view *view, const uint32_t *corner) {
  return !view->is_active || (view->is_active[corner[0]] && view->is_active[corner[1]] && view->is_active[corner[2]]);
}

hk_status hk_membrane_create(hk_membrane *m, const hk_view *view, const hk_membrane_params *given) {
  const hk_tuples *list = given->triangles.count ? &given->triangles : &view->model->triangles;
  m->model = (hk_membrane_model)given->model;
  m->damping = given->damping;
  m->exponent = given->nu / (1 - given->nu);
  hk_status status = check(view, given, list->count);
  if (status == HK_OK) status = reserve(m, view->host, list->count);
  for (size_t t = 0; t < list->count && status == HK_OK; t++)
    if (acts(view, hk_tuple(list, t))) status = measure(m, view, given, hk_tuple(list, t), t);
  if (status == HK_OK && m->count == 0) status = check(view, given, 0);
  return status == HK_OK ? hk_membrane_topology(m, view) : status;
}

hk_status hk_membrane_topology(hk_membrane *m, const hk_view *view) {
  uint32_t *index = (uint32_t *)(uintptr_t)m->node.index;
  size_t kept = 0;
  for (size_t k = 0; k < m->count; k++) {
    const hk_membrane_triangle *t = &m->triangle[k];
    const double number[HK_MEMBRANE_ROWS] = {
        t->B[0], t->B[1], t->B[2], t->B[3], t->times_area.c11, t->times_area.c22, t->times_area.c12, t->times_area.c66};
    bool alive = true;
    for (size_t c = 0; c < 3; c++) {
      size_t i = hk_model_find(view->model, m->id[k][c]);
      alive = alive && i < view->n && (!view->is_active || view->is_active[i]);
      index[3 * kept + c] = (uint32_t)i;
    }
    for (size_t r = 0; r < HK_MEMBRANE_ROWS; r++) m->row[r][kept] = number[r];
    m->creep[kept] = m->damping * number[HK_C11];
    m->number[kept] = m->listed[k];
    kept += alive;
  }
  m->node.count = kept;
  bool has = m->model != HK_NEO_HOOKEAN;
  m->elements = (hk_elements){.node = m->node,
                              .values = has ? 3 : 0,
                              .stiffness = {kept, m->row[HK_C11]},
                              .damping = {kept, m->creep},
                              .rest = {1, &m->one},
                              .evaluate = hk_membrane_conditions,
                              .self = m};
  hk_status status = hk_part_sums_sort(&m->sums, view, &m->node, NULL);
  return status == HK_OK ? hk_chunk_rounds_sort(&m->rounds, view->host, view->n, &m->node) : status;
}
