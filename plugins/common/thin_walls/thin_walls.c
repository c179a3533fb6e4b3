/* The triangles, their motion, and the faces that they cross. */
#include "plugins/common/thin_walls/thin_walls.h"
#include "plugins/kit/vector3.h"

#include <string.h>

static const double hair = 1e-9; /* of a triangle: lines that meet an edge meet both triangles beside it */

/* ---- the list ---- */

static hk_thin_vertex vertex_of(const hk_model *m, uint32_t particle) {
  hk_thin_vertex v = {.particle = particle};
  for (int c = 0; c < 9; c += 4) v.inverse[c] = m->inverse_mass[particle];
  return v;
}

static bool slides(const hk_model *m, uint32_t particle) {
  return m->pin[particle] == HK_PIN_LINE || m->pin[particle] == HK_PIN_PLANE;
}

/* Whether the triangle is of the surface of a rigid body, which is a wall by itself. */
static bool is_of_body(const hk_model *m, const uint32_t *triangle) {
  bool rides = true;
  for (int c = 0; c < 3; c++) rides &= m->pin[triangle[c]] == HK_PIN_RIDES;
  return rides;
}

/* Triangles but those of bodies, and vertices in the order in which they name them; number: n, of a particle's vertex,
 * from 1. */
static void number_vertices(hk_thin_walls *s, const hk_model *model, const hk_tuples *triangles, uint32_t *number) {
  for (size_t k = 0; k < triangles->count; k++) {
    const uint32_t *given = hk_tuple(triangles, k);
    if (is_of_body(model, given)) continue;
    for (int c = 0; c < 3; c++) {
      if (number[given[c]] == 0) {
        s->vertex[s->vertices] = vertex_of(model, given[c]);
        number[given[c]] = (uint32_t)++s->vertices;
      }
      s->triangle[s->triangles][c] = number[given[c]] - 1;
    }
    s->triangles++;
  }
}

hk_status hk_thin_walls_open(hk_thin_walls *s, const hk_host *host, const hk_view *view, const hk_tuples *triangles,
                             size_t size) {
  hk_thin_walls_close(s);
  s->host = host;
  if (triangles->count == 0) return HK_OK;
  uint32_t *number = host->allocate(host, view->n * sizeof *number);
  s->triangle = host->allocate(host, triangles->count * sizeof *s->triangle);
  s->vertex = host->allocate(host, 3 * triangles->count * sizeof *s->vertex);
  s->bin = host->allocate(host, (size + 1) * sizeof *s->bin);
  bool all = number && s->triangle && s->vertex && s->bin;
  for (int c = 0; c < 3; c++) all &= (s->face[c] = host->allocate(host, size * sizeof *s->face[c])) != NULL;
  bool sliding = false;
  if (all) number_vertices(s, view->model, triangles, number);
  s->n = view->n;
  for (size_t k = 0; k < s->vertices; k++) sliding |= slides(view->model, s->vertex[k].particle);
  if (sliding) all &= (s->allowed = host->allocate(host, 3 * s->n * sizeof *s->allowed)) != NULL;
  host->release(host, number);
  return all ? HK_OK : host->fail(host, HK_NO_MEMORY, "no memory for %zu triangles in a liquid", triangles->count);
}

void hk_thin_walls_close(hk_thin_walls *s) {
  if (!s->host) return;
  for (int c = 0; c < 3; c++) s->host->release(s->host, s->face[c]);
  s->host->release(s->host, s->allowed);
  s->host->release(s->host, s->triangle);
  s->host->release(s->host, s->vertex);
  s->host->release(s->host, s->crossing);
  s->host->release(s->host, s->bin);
  s->host->release(s->host, s->near);
  memset(s, 0, sizeof *s);
}

/* ---- the faces ---- */

static hk_status add_crossing(hk_thin_walls *s, uint32_t *face, const hk_thin_crossing *found) {
  if (*face) return HK_OK; /* of a fold, the triangle that comes first */
  if (s->crossings == s->room) {
    size_t room = 2 * s->room + 256;
    hk_thin_crossing *grown = s->host->allocate(s->host, room * sizeof *grown);
    if (!grown) return s->host->fail(s->host, HK_NO_MEMORY, "no memory for %zu faces that cloth crosses", room);
    if (s->crossings) memcpy(grown, s->crossing, s->crossings * sizeof *grown);
    s->host->release(s->host, s->crossing);
    s->crossing = grown;
    s->room = room;
  }
  s->crossing[s->crossings++] = *found;
  *face = (uint32_t)s->crossings;
  return HK_OK;
}

/* m, of the centre with the number k along axis a. */
static double centre(const hk_liquid_grid *g, int a, size_t k) {
  return g->flat[a] ? g->low[a] : g->low[a] + g->spacing[a] * ((double)k - 0.5);
}

/* Numbers of the first and the last centre along axis a between two places. */
static void centres_between(const hk_liquid_grid *g, int a, double low, double high, size_t *first, size_t *last) {
  double most = (double)g->cells[a];
  *first = 1;
  *last = low <= g->low[a] && high >= g->low[a];
  if (g->flat[a]) return;
  *first = (size_t)fmax(1, fmin(most + 1, ceil((low - g->low[a]) / g->spacing[a] + 0.5 - 1e-6)));
  *last = (size_t)fmax(0, fmin(most, floor((high - g->low[a]) / g->spacing[a] + 0.5 + 1e-6)));
}

static double area(const double *p, const double *q, const double *r, int a, int b) {
  return (q[a] - p[a]) * (r[b] - p[b]) - (q[b] - p[b]) * (r[a] - p[a]);
}

/* Barycentric coordinates of where the line along axis c through `at` meets the triangle; false: it does not. */
static bool meets(const double *const corner[3], int c, const double at[3], double weight[3]) {
  int a = (c + 1) % 3, b = (c + 2) % 3;
  double whole = area(corner[0], corner[1], corner[2], a, b);
  if (whole == 0) return false;
  for (int k = 0; k < 3; k++) {
    weight[k] = area(at, corner[(k + 1) % 3], corner[(k + 2) % 3], a, b) / whole;
    if (!(weight[k] >= -hair)) return false;
  }
  return true;
}

/* The line of centres along axis c with these numbers along the two others, and triangle k. */
static hk_status cross_line(hk_thin_walls *s, const hk_liquid_grid *g, size_t k, int c, const size_t line[3]) {
  const double *corner[3];
  hk_thin_crossing found = {.place = 0};
  double at[3];
  size_t face = 0;
  for (int v = 0; v < 3; v++) {
    found.vertex[v] = s->triangle[k][v];
    corner[v] = s->vertex[s->triangle[k][v]].x;
    at[v] = v == c ? 0 : centre(g, v, line[v]);
    if (v != c) face += line[v] * g->stride[v];
  }
  if (!meets(corner, c, at, found.weight)) return HK_OK;
  for (int v = 0; v < 3; v++) found.place += found.weight[v] * corner[v][c];
  double below = floor((found.place - g->low[c]) / g->spacing[c] + 0.5);
  if (!(below >= 1 && below < (double)g->cells[c])) return HK_OK;
  return add_crossing(s, &s->face[c][face + ((size_t)below + 1) * g->stride[c]], &found);
}

static hk_status cross_triangle(hk_thin_walls *s, const hk_liquid_grid *g, size_t k, int c) {
  size_t first[3], last[3], line[3] = {0};
  int a = (c + 1) % 3, b = (c + 2) % 3;
  hk_status status = HK_OK;
  for (int e = 0; e < 3; e++) {
    double low = INFINITY, high = -INFINITY;
    for (int v = 0; v < 3; v++) {
      low = fmin(low, s->vertex[s->triangle[k][v]].x[e]);
      high = fmax(high, s->vertex[s->triangle[k][v]].x[e]);
    }
    centres_between(g, e, low, high, &first[e], &last[e]);
  }
  for (line[a] = first[a]; line[a] <= last[a] && status == HK_OK; line[a]++)
    for (line[b] = first[b]; line[b] <= last[b] && status == HK_OK; line[b]++) status = cross_line(s, g, k, c, line);
  return status;
}

/* The directions that pins leave, from what the host leaves of those along the axes. */
static void find_allowed(hk_thin_walls *s, const hk_model *model, const hk_correction *step) {
  for (int a = 0; a < 3 && s->allowed && step->filter; a++) {
    memset(s->allowed, 0, 3 * s->n * sizeof *s->allowed);
    for (size_t k = 0; k < s->vertices; k++) s->allowed[3 * (size_t)s->vertex[k].particle + (size_t)a] = 1;
    step->filter(step, s->allowed);
    for (size_t k = 0; k < s->vertices; k++) {
      hk_thin_vertex *v = &s->vertex[k];
      const double *left = s->allowed + 3 * (size_t)v->particle;
      for (int c = 0; c < 3; c++) v->inverse[3 * c + a] = left[c] * model->inverse_mass[v->particle];
    }
  }
}

hk_status hk_thin_walls_begin(hk_thin_walls *s, const hk_liquid_grid *g, const hk_model *model,
                              const hk_correction *step) {
  hk_status status = HK_OK;
  find_allowed(s, model, step);
  for (size_t k = 0; k < s->vertices; k++) {
    hk_thin_vertex *v = &s->vertex[k];
    hk_copy(v->x, step->x_before + 3 * (size_t)v->particle);
    hk_copy(v->v, step->v + 3 * (size_t)v->particle);
    hk_copy(v->came, v->v);
  }
  s->crossings = 0;
  for (int c = 0; c < 3 && s->triangles; c++) memset(s->face[c], 0, g->size * sizeof *s->face[c]);
  for (size_t k = 0; k < s->triangles; k++)
    for (int c = 0; c < 3 && status == HK_OK; c++)
      if (!g->flat[c]) status = cross_triangle(s, g, k, c);
  return status;
}

bool hk_thin_walls_beside(const hk_thin_walls *s, const hk_liquid_grid *g, size_t i, double part) {
  for (int f = 0; f < 6 && s->crossings; f++) {
    int c = f / 2;
    const hk_thin_crossing *at = hk_thin_walls_at(s, c, f & 1 ? i + g->stride[c] : i);
    double place[3];
    if (!at) continue;
    hk_liquid_face_place(g, i, c, place);
    if (fabs(at->place - place[c] - g->spacing[c] / 2) < part * g->spacing[c]) return true;
  }
  return false;
}

double hk_thin_walls_speed(const hk_thin_walls *s, const hk_thin_crossing *at, int c) {
  double speed = 0;
  for (int k = 0; k < 3; k++) speed += at->weight[k] * s->vertex[at->vertex[k]].v[c];
  return speed;
}
