#include "plugins/common/snapshot/snapshot3d.h"

#include <string.h>

static void *renew(const hk_host *host, void *old, size_t count, size_t bytes) {
  host->release(host, old);
  return host->allocate(host, count * bytes);
}

void hk_snapshot3d_open(hk_snapshot3d *s, const hk_host *host, const hk_appearance *appearance) {
  *s = (hk_snapshot3d){.host = host, .appearance = appearance};
}

size_t hk_snapshot3d_extra_width(const hk_snapshot3d *s, int extra) {
  bool wanted[HK_EXTRAS] = {s->appearance->sizes != HK_SIZE_SAME, s->appearance->fades, s->appearance->streak > 0,
                            s->appearance->tubes};
  return wanted[extra] ? extra == HK_EXTRA_VELOCITY ? 3 : 1 : 0;
}

/* Memory for the room's particles; false: there is none. */
static bool renew_extras(hk_snapshot3d *s) {
  bool ok = true;
  for (int k = 0; k < HK_EXTRAS; k++) {
    size_t width = hk_snapshot3d_extra_width(s, k);
    if (width) s->extra[k] = renew(s->host, s->extra[k], s->room, width * sizeof(float));
    ok = ok && (!width || s->extra[k]);
  }
  return ok;
}

static bool shows_elements(const hk_snapshot3d *s) { return hk_paints_elements(s->appearance->paint); }

hk_status hk_snapshot3d_reserve(hk_snapshot3d *s, size_t n, size_t triangles, size_t lines) {
  bool extras = true;
  if (n >= s->room) {
    s->room = n + n / 2 + 1, s->stale = true;
    s->x = renew(s->host, s->x, s->room, sizeof *s->x);
    s->colour = renew(s->host, s->colour, s->room, sizeof *s->colour);
    s->mark = renew(s->host, s->mark, s->room, sizeof *s->mark);
    s->role = renew(s->host, s->role, s->room, sizeof *s->role);
    if (shows_elements(s)) s->strain = renew(s->host, s->strain, s->room, sizeof *s->strain);
    extras = renew_extras(s);
  }
  if (triangles >= s->triangle_room) {
    s->triangle_room = triangles + triangles / 2 + 1, s->stale = true;
    s->triangle = renew(s->host, s->triangle, s->triangle_room, sizeof *s->triangle);
  }
  if (lines >= s->line_room) {
    s->line_room = lines + lines / 2 + 1, s->stale = true;
    s->line = renew(s->host, s->line, s->line_room, sizeof *s->line);
  }
  if (extras && s->x && s->colour && s->mark && s->role && (s->strain || !shows_elements(s)) && s->triangle && s->line)
    return HK_OK;
  s->room = s->triangle_room = s->line_room = 0;
  return s->host->fail(s->host, HK_NO_MEMORY, "no memory for a picture of %zu particles", n);
}

void hk_snapshot3d_free(hk_snapshot3d *s) {
  if (!s->host) return;
  void *all[] = {s->x,        s->colour,   s->mark,     s->role,     s->strain, s->triangle, s->line,
                 s->extra[0], s->extra[1], s->extra[2], s->extra[3], s->mesh,   s->mesh_face};
  for (size_t k = 0; k < sizeof all / sizeof *all; k++) s->host->release(s->host, all[k]);
  *s = (hk_snapshot3d){0};
}

/* A hash of the data that the copy of the topology depends on; pins are released and springs removed without births or
 * deaths. */
static uint64_t fingerprint(const hk_model *m) {
  uint64_t h = 14695981039346656037u;
  size_t counts[] = {m->n, m->edges.count, m->triangles.count, m->element_lists, m->join_lists};
  for (size_t k = 0; k < sizeof counts / sizeof *counts; k++) h = (h ^ counts[k]) * 1099511628211u;
  for (size_t k = 0; k < m->element_lists; k++) h = (h ^ m->element_list[k].elements.node.count) * 1099511628211u;
  for (size_t k = 0; k < m->join_lists; k++) h = (h ^ m->join[k]->count) * 1099511628211u;
  for (size_t i = 0; i < m->n; i++) h = (h ^ m->pin[i]) * 1099511628211u;
  return h;
}

/* Lists of tuples whose particles are joined by lines: of elements on pairs and of constraints; then what joins
 * particles that those leave alone, the scene's edges and elements on more than two. The k-th of the first or of the
 * second; NULL: there are no more. */
static const hk_tuples *tuples_of(const hk_model *m, bool first, size_t k) {
  if (!first && k-- == 0) return &m->edges;
  for (size_t l = 0; l < m->element_lists; l++)
    if ((m->element_list[l].elements.node.arity == 2) == first && k-- == 0) return &m->element_list[l].elements.node;
  for (size_t l = 0; first && l < m->join_lists; l++)
    if (k-- == 0) return m->join[l];
  return NULL;
}

/* Chains of up to three, and tetrahedra with all of their sides. */
static size_t lines_of(const hk_tuples *t) { return t->arity == 4 ? 6 : t->arity < 2 ? 0 : t->arity - 1; }

static size_t all_lines(const hk_model *m) {
  size_t count = 0;
  const hk_tuples *tuples;
  for (int first = 0; first < 2; first++)
    for (size_t k = 0; (tuples = tuples_of(m, first, k)); k++) count += lines_of(tuples) * tuples->count;
  return count;
}

enum { IN_TRIANGLE = 1, JOINED = 2, IN_BODY = 4 }; /* hk_snapshot3d.role */

/* Appends the pairs to draw: all, or those with an end that belongs to no triangle. */
static void add_pairs(hk_snapshot3d *s, const hk_tuples *pairs, bool all) {
  for (size_t e = 0; e < pairs->count; e++) {
    const uint32_t *pair = hk_tuple(pairs, e);
    if (!all && s->role[pair[0]] == IN_TRIANGLE && s->role[pair[1]] == IN_TRIANGLE) continue;
    if (s->role[pair[0]] == IN_BODY && s->role[pair[1]] == IN_BODY) continue;
    memcpy(s->line[s->lines++], pair, sizeof s->line[0]);
  }
}

/* Appends the lines of tuples that have a particle which nothing shows. */
static void add_others(hk_snapshot3d *s, const hk_tuples *tuples) {
  static const uint8_t side[][2] = {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {0, 2}, {1, 3}};
  for (size_t e = 0; e < tuples->count; e++) {
    const uint32_t *node = hk_tuple(tuples, e);
    bool shown = true;
    for (size_t i = 0; i < tuples->arity; i++) shown = shown && s->role[node[i]] > 0;
    for (size_t k = 0; !shown && k < lines_of(tuples); k++, s->lines++) {
      bool solid = tuples->arity == 4;
      s->line[s->lines][0] = node[solid ? side[k][0] : k], s->line[s->lines][1] = node[solid ? side[k][1] : k + 1];
    }
  }
}

/* `all`: with those between particles of one surface. */
static void take_lines(hk_snapshot3d *s, const hk_model *m, bool all) {
  const hk_tuples *tuples;
  for (size_t k = 0; (tuples = tuples_of(m, true, k)); k++) add_pairs(s, tuples, all);
  for (size_t k = 0; k < s->lines; k++)
    for (int i = 0; i < 2; i++)
      if (s->role[s->line[k][i]] == 0) s->role[s->line[k][i]] = JOINED;
  for (size_t k = 0; (tuples = tuples_of(m, false, k)); k++) add_others(s, tuples);
}

static bool is_held(const hk_model *m, size_t i) { return m->pin[i] == HK_PIN_FIXED || m->pin[i] == HK_PIN_PATH; }

/* A triangle with a corner that is of no body takes its others out of theirs; whether it did. */
static bool release_corners(uint8_t *mark, const uint32_t corner[3]) {
  int inside = 0;
  for (int i = 0; i < 3; i++) inside += (mark[corner[i]] & HK_MARK_BODY) != 0;
  if (inside == 3 || inside == 0) return false;
  for (int i = 0; i < 3; i++) mark[corner[i]] &= (uint8_t)~HK_MARK_BODY;
  return true;
}

/* Marks the particles of bodies: goes to and fro along the list until nothing changes. */
static void mark_bodies(hk_snapshot3d *s, const hk_model *m) {
  for (size_t i = 0; i < m->n; i++) s->mark[i] = s->role[i] > 0 && is_held(m, i) ? HK_MARK_BODY : 0;
  for (bool changed = true; changed;) {
    changed = false;
    for (size_t k = 0; k < s->triangles; k++) changed |= release_corners(s->mark, m->triangles.index + 3 * k);
    for (size_t k = s->triangles; changed && k-- > 0;) release_corners(s->mark, m->triangles.index + 3 * k);
  }
}

typedef enum triangle_kind { CLOTH, RIGID, PINNED } triangle_kind;

static triangle_kind kind_of(const hk_snapshot3d *s, const hk_model *m, const uint32_t corner[3]) {
  if (s->mark[corner[0]] & HK_MARK_BODY) return PINNED;
  for (int i = 0; i < 3; i++)
    if (m->pin[corner[i]] != HK_PIN_RIDES) return CLOTH;
  return RIGID;
}

/* Appends those of a kind; the number of all then. */
static size_t take_triangles(hk_snapshot3d *s, const hk_model *m, triangle_kind kind) {
  for (size_t k = 0; k < m->triangles.count; k++) {
    const uint32_t *corner = m->triangles.index + 3 * k;
    if (kind_of(s, m, corner) == kind) memcpy(s->triangle[s->triangles++], corner, sizeof *s->triangle);
  }
  return s->triangles;
}

/* The particles of a rigid body whose surface is drawn, and the distances between them. */
static void hide_bodies(hk_snapshot3d *s, const hk_model *m) {
  for (size_t k = 0; k < m->skins; k++)
    for (uint32_t c = 0; c < m->skin[k].carriers; c++) s->role[m->skin[k].carrier[c]] = IN_BODY;
}

/* Copies the topology. During the call `role` says which particles belong to a triangle or a line. */
static void take_topology(hk_snapshot3d *s, const hk_model *m) {
  const hk_appearance *appearance = s->appearance;
  s->triangles = m->triangles.count;
  s->lines = 0;
  memset(s->role, 0, m->n * sizeof *s->role);
  for (size_t k = 0; k < 3 * s->triangles; k++) s->role[m->triangles.index[k]] = IN_TRIANGLE;
  mark_bodies(s, m);
  hide_bodies(s, m);
  s->triangles = 0;
  s->cloth = take_triangles(s, m, CLOTH);
  s->rigid = take_triangles(s, m, RIGID);
  take_triangles(s, m, PINNED);
  for (size_t i = 0; i < m->n; i++) {
    if (s->mark[i] & HK_MARK_BODY) continue;
    bool rides = m->pin[i] == HK_PIN_RIDES;
    bool point = appearance->particles == 1 || (appearance->particles == 0 && s->role[i] == 0 && !rides);
    bool pin = appearance->particles != 2 && is_held(m, i);
    s->mark[i] = (uint8_t)((point ? HK_MARK_POINT : 0) | (pin ? HK_MARK_PIN : 0));
  }
  if (appearance->springs != 2) take_lines(s, m, appearance->springs == 1);
}

/* Surfaces that are pinned as a whole and pins have colours of their own. */
static bool shows_colours(const hk_snapshot3d *s, size_t n) {
  bool any = s->rigid > 0 || s->lines > 0;
  for (size_t i = 0; i < n && !any; i++) any = (s->mark[i] & (HK_MARK_POINT | HK_MARK_PIN)) == HK_MARK_POINT;
  return any;
}

/* Sets the origin to the middle of the finite positions. */
static void find_origin(hk_snapshot3d *s, const hk_view *view) {
  double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
  for (size_t i = 0; i < view->n; i++) {
    double x[3];
    hk_to_z_up(s->appearance->y_up, view->x + 3 * i, x);
    for (int c = 0; c < 3; c++)
      if (isfinite(x[c])) low[c] = fmin(low[c], x[c]), high[c] = fmax(high[c], x[c]);
  }
  for (int c = 0; c < 3; c++) s->origin[c] = low[c] <= high[c] ? low[c] / 2 + high[c] / 2 : 0;
}

static void take_positions(hk_snapshot3d *s, const hk_view *view) {
  s->reach = 0;
  for (int c = 0; c < 3; c++) s->low[c] = INFINITY, s->high[c] = -INFINITY;
  for (size_t i = 0; i < view->n; i++) {
    double turned[3];
    float *x = s->x[i];
    hk_to_z_up(s->appearance->y_up, view->x + 3 * i, turned);
    for (int c = 0; c < 3; c++) x[c] = (float)(turned[c] - s->origin[c]);
    float reach = sqrtf(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
    if (!isfinite(reach)) {
      x[0] = x[1] = x[2] = NAN;
      continue;
    }
    s->reach = fmaxf(s->reach, reach);
    for (int c = 0; c < 3; c++) s->low[c] = fminf(s->low[c], x[c]), s->high[c] = fmaxf(s->high[c], x[c]);
  }
}

hk_status hk_snapshot3d_take(hk_snapshot3d *s, const hk_view *view, bool changed) {
  const hk_model *m = view->model;
  bool first = !s->room;
  hk_status status =
      hk_snapshot3d_reserve(s, view->n, m->triangles.count, s->appearance->springs == 2 ? 0 : all_lines(m));
  if (status != HK_OK) return status;
  if (first) find_origin(s, view);
  uint64_t print = fingerprint(m);
  if (changed || s->stale || print != s->fingerprint) {
    take_topology(s, m);
    s->painted = shows_colours(s, m->n);
    s->fingerprint = print;
    s->stale = false;
    s->topology++;
  }
  s->n = view->n;
  take_positions(s, view);
  return HK_OK;
}
