/* The volume inside a closed surface is the sum of a.(b x c)/6 over its triangles a b c, whatever the origin is; that
 * of the cell's first particle costs no digits far from that of the scene. The gradient of particle a is the sum of (b
 * x c)/6. A surface is closed where every edge of a triangle runs the other way in one other. */
#include "plugins/common/solids/cells.h"

#include "plugins/common/solids/tetrahedron.h"
#include "plugins/kit/vector3.h"

#include <stdlib.h>

enum { GRAIN = 1024 }; /* triangles of a chunk, some 30 us */

/* Volume over that of the cube of its extent below which a cell has none: less than four digits of it are known. */
static const double FLAT = 1e-12;

static hk_status no_memory(const hk_view *view, size_t count) {
  return view->host->fail(view->host, HK_NO_MEMORY, "no memory for the volumes of %zu triangles", count);
}

/* ---- surfaces ---------------------------------------------------------------------------------------------------- */

typedef struct edge {
  uint32_t low, high;
  bool turned; /* the triangle runs from high to low */
} edge;

static int by_ends(const void *left, const void *right) {
  const edge *e = left, *f = right;
  if (e->low != f->low) return e->low < f->low ? -1 : 1;
  if (e->high != f->high) return e->high < f->high ? -1 : 1;
  return (int)e->turned - (int)f->turned;
}

static hk_status refuse_edge(const hk_view *view, const edge *e, size_t count) {
  const hk_host *host = view->host;
  uint32_t a = view->model->id[e->low], b = view->model->id[e->high];
  if (count == 1)
    return host->fail(host, HK_BAD_PARAM,
                      "triangles: the edge {%u, %u} has one triangle: the surface is open and encloses nothing", a, b);
  if (count == 2)
    return host->fail(
        host, HK_BAD_PARAM,
        "triangles: two run the same way along the edge {%u, %u}: turn one round, {1, 3, 2} for {1, 2, 3}", a, b);
  return host->fail(host, HK_BAD_PARAM, "triangles: the edge {%u, %u} has %zu triangles: two enclose a volume", a, b,
                    count);
}

static hk_status check_closed(const hk_view *view, const hk_tuples *triangles) {
  size_t edges = 3 * triangles->count;
  edge *list = view->host->allocate(view->host, (edges + 1) * sizeof *list);
  hk_status status = list ? HK_OK : no_memory(view, triangles->count);
  for (size_t k = 0; k < edges && list; k++) {
    uint32_t a = triangles->index[k], b = triangles->index[k % 3 == 2 ? k - 2 : k + 1];
    list[k] = (edge){a < b ? a : b, a < b ? b : a, a > b};
  }
  if (list) qsort(list, edges, sizeof *list, by_ends);
  for (size_t k = 0, next; k < edges && status == HK_OK; k = next) {
    for (next = k + 1; next < edges && list[next].low == list[k].low && list[next].high == list[k].high;) next++;
    if (next - k != 2 || list[k].turned == list[k + 1].turned) status = refuse_edge(view, &list[k], next - k);
  }
  view->host->release(view->host, list);
  return status;
}

/* The representative of a particle's piece; halves the way on the way. */
static uint32_t find(uint32_t *up, uint32_t i) {
  while (up[i] != i) i = up[i] = up[up[i]];
  return i;
}

/* Numbers the pieces in the order of their first triangles; returns their number. `up`, `piece`: n each. */
static size_t number_pieces(const hk_tuples *triangles, size_t n, uint32_t *up, uint32_t *piece, uint32_t *cell_of) {
  size_t pieces = 0;
  for (size_t i = 0; i < n; i++) up[i] = (uint32_t)i, piece[i] = UINT32_MAX;
  for (size_t k = 0; k < triangles->count; k++)
    for (int c = 1; c < 3; c++) {
      const uint32_t *t = hk_tuple(triangles, k);
      up[find(up, t[c])] = find(up, t[0]);
    }
  for (size_t k = 0; k < triangles->count; k++) {
    uint32_t root = find(up, hk_tuple(triangles, k)[0]);
    if (piece[root] == UINT32_MAX) piece[root] = (uint32_t)pieces++;
    cell_of[k] = piece[root];
  }
  return pieces;
}

/* ---- setting up -------------------------------------------------------------------------------------------------- */

static hk_status reserve(hk_cells *s, const hk_view *view, size_t triangles) {
  const hk_host *host = view->host;
  s->cell_of = host->allocate(host, (triangles + 1) * sizeof *s->cell_of);
  s->size = host->allocate(host, (triangles + 1) * sizeof *s->size);
  s->rest = host->allocate(host, (triangles + 1) * sizeof *s->rest);
  s->cell = host->allocate(host, (triangles + 1) * sizeof *s->cell);
  s->member = host->allocate(host, (3 * triangles + 1) * sizeof *s->member);
  s->local = host->allocate(host, (3 * triangles + 1) * sizeof *s->local);
  s->part[0] = host->allocate(host, (triangles + 1) * sizeof(double));
  s->part[1] = host->allocate(host, (triangles + 1) * sizeof(double));
  bool fine = s->cell_of && s->size && s->rest && s->cell && s->member && s->local && s->part[0] && s->part[1];
  return fine ? HK_OK : no_memory(view, triangles);
}

/* The triangles sorted by cell, as living tuples. `list`: 3 per triangle. */
static hk_status take(hk_cells *s, const hk_view *view, const hk_tuples *triangles, const uint32_t *cell_of,
                      uint32_t *list, size_t *at) {
  for (size_t k = 0; k < triangles->count; k++) s->size[cell_of[k]]++;
  for (size_t c = 1; c < s->count; c++) at[c] = at[c - 1] + s->size[c - 1];
  for (size_t k = 0; k < triangles->count; k++) {
    size_t to = at[cell_of[k]]++;
    s->cell_of[to] = cell_of[k];
    for (size_t c = 0; c < 3; c++) list[3 * to + c] = hk_tuple(triangles, k)[c];
  }
  const hk_tuples sorted = {triangles->count, 3, list};
  hk_status status = hk_living_tuples_create(&s->triangles, view, &sorted, "triangles");
  return status == HK_OK ? hk_living_tuples_load(&s->triangles, view, "triangles") : status;
}

static double extent_of(const hk_cells *s, const hk_view *view, const hk_cell *cell) {
  double extent = 0, d[3];
  for (size_t m = 1; m < cell->members; m++) {
    hk_subtract(d, view->x + 3 * (size_t)s->member[cell->member + m], view->x + 3 * (size_t)s->member[cell->member]);
    extent = fmax(extent, hk_length(d));
  }
  return extent;
}

static hk_status measure_rest(hk_cells *s, const hk_view *view) {
  hk_view all = *view;
  all.is_active = NULL; /* what does not act at present has a volume at rest as well */
  hk_status status = hk_cells_topology(s, &all);
  if (status == HK_OK) hk_cells_measure(s, &all, false);
  for (size_t c = 0; c < s->acting && status == HK_OK; c++) {
    const hk_cell *cell = &s->cell[c];
    double extent = extent_of(s, view, cell);
    s->rest[cell->number] = cell->volume;
    if (!(fabs(cell->volume) > FLAT * extent * extent * extent))
      status =
          view->host->fail(view->host, HK_BAD_PARAM, "what the particles %u, %u, %u and others enclose has no volume",
                           view->model->id[s->member[cell->member]], view->model->id[s->member[cell->member + 1]],
                           view->model->id[s->member[cell->member + 2]]);
  }
  return status == HK_OK ? hk_cells_topology(s, view) : status;
}

/* Cells of triangles whose numbers are given; releases the arrays. */
static hk_status begin(hk_cells *s, const hk_view *view, const hk_tuples *triangles, const uint32_t *cell_of) {
  const hk_host *host = view->host;
  uint32_t *list = host->allocate(host, (3 * triangles->count + 1) * sizeof *list);
  size_t *at = host->allocate(host, (s->count + 1) * sizeof *at);
  hk_status status = list && at ? reserve(s, view, triangles->count) : no_memory(view, triangles->count);
  if (status == HK_OK) status = take(s, view, triangles, cell_of, list, at);
  host->release(host, list);
  host->release(host, at);
  return status == HK_OK ? measure_rest(s, view) : status;
}

hk_status hk_cells_of_surfaces(hk_cells *s, const hk_view *view, const hk_tuples *triangles) {
  const hk_host *host = view->host;
  hk_status status = check_closed(view, triangles);
  if (status != HK_OK) return status;
  uint32_t *up = host->allocate(host, (view->n + 1) * sizeof *up),
           *piece = host->allocate(host, (view->n + 1) * sizeof *piece);
  uint32_t *cell_of = host->allocate(host, (triangles->count + 1) * sizeof *cell_of);
  if (up && piece && cell_of) {
    s->count = number_pieces(triangles, view->n, up, piece, cell_of);
    status = begin(s, view, triangles, cell_of);
  } else
    status = no_memory(view, triangles->count);
  host->release(host, up);
  host->release(host, piece);
  host->release(host, cell_of);
  return status;
}

hk_status hk_cells_of_tetrahedra(hk_cells *s, const hk_view *view, const hk_tuples *tetrahedra) {
  static const int OUTWARDS[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
  const hk_host *host = view->host;
  size_t triangles = 4 * tetrahedra->count;
  uint32_t *list = host->allocate(host, (3 * triangles + 1) * sizeof *list);
  uint32_t *cell_of = host->allocate(host, (triangles + 1) * sizeof *cell_of);
  hk_status status = list && cell_of ? HK_OK : no_memory(view, triangles);
  for (size_t k = 0; k < triangles && status == HK_OK; k++) {
    cell_of[k] = (uint32_t)(k / 4);
    for (int c = 0; c < 3; c++) list[3 * k + (size_t)c] = hk_tuple(tetrahedra, k / 4)[OUTWARDS[k % 4][c]];
  }
  s->count = tetrahedra->count;
  const hk_tuples faces = {triangles, 3, list};
  if (status == HK_OK) status = begin(s, view, &faces, cell_of);
  host->release(host, list);
  host->release(host, cell_of);
  return status;
}

/* ---- topology ---------------------------------------------------------------------------------------------------- */

/* Lists the particles of a cell behind those that are there. */
static void list_members(hk_cells *s, hk_cell *cell) {
  const uint32_t *corner = s->triangles.acting.index;
  cell->members = 0;
  for (size_t k = 3 * cell->first; k < 3 * (cell->first + cell->triangles); k++) {
    uint32_t *mark = &s->mark[corner[k]];
    if (*mark == 0) {
      s->member[cell->member + cell->members++] = corner[k];
      *mark = (uint32_t)cell->members;
    }
    s->local[k] = *mark - 1;
  }
  for (size_t m = 0; m < cell->members; m++) s->mark[s->member[cell->member + m]] = 0;
}

hk_status hk_cells_topology(hk_cells *s, const hk_view *view) {
  const hk_host *host = view->host;
  hk_status status = hk_living_tuples_find(&s->triangles, view);
  size_t members = 0;
  host->release(host, s->mark);
  s->mark = host->allocate(host, (view->n + 1) * sizeof *s->mark);
  if (status == HK_OK && !s->mark) status = no_memory(view, s->triangles.count);
  s->acting = 0;
  for (size_t k = 0, next; k < s->triangles.acting.count && status == HK_OK; k = next) {
    uint32_t number = s->cell_of[s->triangles.number[k]];
    for (next = k + 1; next < s->triangles.acting.count && s->cell_of[s->triangles.number[next]] == number;) next++;
    if (next - k != s->size[number]) continue;
    hk_cell *cell = &s->cell[s->acting++];
    *cell = (hk_cell){.number = number, .first = k, .triangles = next - k, .member = members};
    list_members(s, cell);
    members += cell->members;
  }
  return status;
}

/* ---- volumes ----------------------------------------------------------------------------------------------------- */

typedef struct task {
  hk_cells *s;
  const hk_view *view;
  bool rates;
} task;

static void measure_triangle(const task *t, size_t k, const double *origin) {
  const uint32_t *corner = hk_tuple(&t->s->triangles.acting, k);
  double(*load)[3] = t->s->triangles.load + 3 * k, at[3][3], rate = 0;
  for (int c = 0; c < 3; c++) hk_subtract(at[c], t->view->x + 3 * (size_t)corner[c], origin);
  for (int c = 0; c < 3; c++) {
    hk_cross(load[c], at[(c + 1) % 3], at[(c + 2) % 3]);
    for (int d = 0; d < 3; d++) load[c][d] /= 6;
    if (t->rates) rate += hk_dot(load[c], t->view->v + 3 * (size_t)corner[c]);
  }
  t->s->part[0][k] = hk_dot(at[0], load[0]);
  t->s->part[1][k] = rate;
}

/* The cell of an acting triangle among the acting ones is found by halving. */
static void measure_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  const task *t = context;
  size_t low = 0, high = t->s->acting;
  (void)chunk;
  while (high - low > 1) {
    size_t middle = low + (high - low) / 2;
    if (t->s->cell[middle].first <= begin)
      low = middle;
    else
      high = middle;
  }
  for (size_t c = low; c < t->s->acting && t->s->cell[c].first < end; c++) {
    const hk_cell *cell = &t->s->cell[c];
    const double *origin = t->view->x + 3 * (size_t)t->s->member[cell->member];
    size_t from = cell->first > begin ? cell->first : begin, to = cell->first + cell->triangles;
    for (size_t k = from; k < (to < end ? to : end); k++) measure_triangle(t, k, origin);
  }
}

void hk_cells_measure(hk_cells *s, const hk_view *view, bool rates) {
  task t = {s, view, rates};
  if (s->acting == 0) return;
  view->host->parallel_for(view->host, s->triangles.acting.count, GRAIN, measure_chunk, &t);
  for (size_t c = 0; c < s->acting; c++) {
    hk_cell *cell = &s->cell[c];
    cell->volume = cell->rate = 0;
    for (size_t k = cell->first; k < cell->first + cell->triangles; k++) {
      cell->volume += s->part[0][k];
      cell->rate += s->part[1][k];
    }
  }
}
