/* Finds an implicit surface in four passes over blocks, each of them parallel: which blocks it crosses; which edges it
 * crosses there, counted, so that every block knows the number of its first vertex and triangle; whether neighbours
 * agree on the points that they share, which bounds could spoil; vertices and triangles. What is allocated is checked
 * before. */
#include "plugins/common/isosurface/isosurface.h"
#include "plugins/common/isosurface/grid_blocks.h"

#include <string.h>

enum { GRAIN = 4 }; /* blocks a thread takes at a time */

enum { CROSSED = 1, NOT_ALLOWED, LEAVES }; /* hk_surface_work.slot during the first pass, 0: no surface */

/* ---- what is asked for ---- */

static hk_status check_axis(const hk_host *host, const hk_isosurface_grid *g, int c) {
  const char axis = (char)('x' + c);
  if (g->points[c] < 2 || g->points[c] > 1000000000)
    return host->fail(host, HK_BAD_PARAM, "isosurface: a grid of %zu points along %c: give from 2 to 1e9", g->points[c],
                      axis);
  double last = g->origin[c] + (double)(g->points[c] - 1) * g->spacing[c], before = last - g->spacing[c];
  if (!(g->spacing[c] > 0) || !(fabs(g->origin[c]) <= 1e300) || !(fabs(last) <= 1e300) || !(before < last) ||
      !(g->origin[c] < g->origin[c] + g->spacing[c]))
    return host->fail(
        host, HK_BAD_PARAM,
        "isosurface: points along %c from %g m, %g m apart, are no finite, rising places: give a spacing above 0 "
        "that is not lost beside the origin",
        axis, g->origin[c], g->spacing[c]);
  return HK_OK;
}

static hk_status check(const hk_surface_work *w) {
  const hk_host *host = w->host;
  const hk_isosurface_options *o = w->options;
  hk_status status = HK_OK;
  for (int c = 0; c < 3 && status == HK_OK; c++) status = check_axis(host, w->grid, c);
  if (status != HK_OK) return status;
  if (!w->field->values == !w->field->evaluate || (w->field->bounds && !w->field->evaluate))
    return host->fail(host, HK_BAD_PARAM,
                      "isosurface: give a field by values or by a function, one of them, and bounds "
                      "beside a function only");
  if (!hk_value_allowed(o->level))
    return host->fail(host, HK_BAD_PARAM, "isosurface: a level of %g: give a number of at most 1e300 in size",
                      o->level);
  if (!(o->margin >= 0 && o->margin <= 0.5))
    return host->fail(host, HK_BAD_PARAM, "isosurface: a margin of %g: give a part of an edge from 0 to 0.5",
                      o->margin);
  if (o->method != HK_MARCHING_TETRAHEDRA && o->method != HK_MARCHING_CUBES)
    return host->fail(host, HK_BAD_PARAM, "isosurface: method %d is neither marching tetrahedra nor marching cubes",
                      (int)o->method);
  return HK_OK;
}

/* ---- memory ---- */

static void release_work(hk_surface_work *w) {
  w->host->release(w->host, w->slot);
  w->host->release(w->host, w->bits);
  w->host->release(w->host, w->block);
  w->host->release(w->host, w->kept);
  w->host->release(w->host, w->cases);
  w->host->release(w->host, w->points.slot);
  w->host->release(w->host, w->points.visited);
  w->host->release(w->host, w->points.seed);
  w->host->release(w->host, w->points.value);
  w->host->release(w->host, w->points.is_known);
}

void hk_isosurface_free(hk_isosurface *s, const hk_host *host) {
  host->release(host, s->x);
  host->release(host, s->normal);
  host->release(host, s->triangle);
  *s = (hk_isosurface){0};
}

/* ---- which blocks the surface crosses ---- */

/* Which points of a block are inside. */
static bool look(const hk_surface_work *w, size_t number, double *value, uint16_t *inside, size_t *bad) {
  if (w->field->evaluate) return hk_block_evaluate(w, number, value, inside, bad);
  hk_inside_read(w, number, inside);
  return true;
}

static void survey_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  hk_surface_work *w = context;
  double value[HK_BLOCK_POINTS];
  uint16_t inside[HK_BLOCK_ROWS];
  (void)chunk;
  for (size_t number = begin; number < end; number++) {
    size_t point;
    if (hk_block_excluded(w, number)) continue;
    bool allowed = look(w, number, value, inside, &point);
    bool leaves = allowed && !w->options->close && hk_block_at_border(w, number, inside, &point);
    w->slot[number] = !allowed ? NOT_ALLOWED : leaves ? LEAVES : hk_block_mixed(inside) ? CROSSED : 0;
  }
}

/* The sentence for a block that ends the search. */
static hk_status refuse_block(const hk_surface_work *w, size_t number) {
  double value[HK_BLOCK_POINTS], x[3];
  uint16_t inside[HK_BLOCK_ROWS];
  size_t corner[3], i[3], k = 0;
  hk_block_corner(w, number, corner);
  bool allowed = look(w, number, value, inside, &k);
  if (allowed) hk_block_at_border(w, number, inside, &k);
  k = k < HK_BLOCK_POINTS ? k : 0; /* a field that gave something else before */
  for (size_t c = 0, n = k; c < 3; c++, n /= HK_POINTS) {
    i[c] = hk_grid_point(w, (int)c, corner[c] + n % HK_POINTS);
    x[c] = hk_point_place(w, (int)c, i[c] + 1);
  }
  if (!allowed) return hk_surface_refuse(w, i, value[k]);
  return w->host->fail(
      w->host, HK_BAD_PARAM,
      "isosurface: the surface leaves the box: at (%g, %g, %g), on its border, the field is %g and the "
      "level %g: take a larger box, or close the surface there",
      x[0], x[1], x[2], w->field->evaluate ? value[k] : w->field->values[hk_grid_index(w, i)], w->options->level);
}

/* The range of the values, which is of use here only, so that those of a function are asked for again; low > high:
 * none. */
static void find_range(const hk_surface_work *w, size_t blocks, double *low, double *high) {
  const size_t *n = w->grid->points, points = w->field->values ? n[0] * n[1] * n[2] : 0;
  double value[HK_BLOCK_POINTS];
  uint16_t inside[HK_BLOCK_ROWS];
  *low = INFINITY, *high = -INFINITY;
  for (size_t k = 0; w->known && k < w->known->seeds; k++)
    *low = fmin(*low, w->known->seed[k]), *high = fmax(*high, w->known->seed[k]);
  for (size_t k = 0; k < points; k++) *low = fmin(*low, w->field->values[k]), *high = fmax(*high, w->field->values[k]);
  for (size_t number = 0, bad; number < blocks && !points; number++) {
    if (hk_block_excluded(w, number)) continue;
    hk_block_evaluate(w, number, value, inside, &bad);
    for (size_t k = 0; k < HK_BLOCK_POINTS; k++) *low = fmin(*low, value[k]), *high = fmax(*high, value[k]);
  }
}

static hk_status refuse_empty(const hk_surface_work *w, size_t blocks) {
  double low, high;
  find_range(w, blocks, &low, &high);
  if (w->known && w->options->coarse > 1)
    return w->host->fail(
        w->host, HK_BAD_PARAM,
        "isosurface: no surface in the box: the field is from %g to %g on every point %u and the level %g: take "
        "another level, another box, or look at more points",
        low, high, w->options->coarse, w->options->level);
  if (low > high)
    return w->host->fail(w->host, HK_BAD_PARAM,
                         "isosurface: no surface in the box: the bounds of the field exclude a level of %g everywhere: "
                         "take another level or another box",
                         w->options->level);
  return w->host->fail(
      w->host, HK_BAD_PARAM,
      "isosurface: no surface in the box: the field is from %g to %g on the grid and the level %g: take "
      "another level, another box or a smaller spacing",
      low, high, w->options->level);
}

/* Slots for the blocks that the survey has marked. */
static hk_status list_blocks(hk_surface_work *w, size_t blocks) {
  hk_status status = HK_OK;
  for (size_t k = 0; k < blocks; k++) w->count += w->slot[k];
  if (w->count == 0) return w->options->may_be_empty ? HK_OK : refuse_empty(w, blocks);
  if (w->count >= hk_no_slot)
    return w->host->fail(w->host, HK_BAD_PARAM, "isosurface: %zu blocks at the surface: take a larger spacing",
                         w->count);
  status = hk_surface_allocate(w, &w->block, w->count, sizeof *w->block, "blocks at the surface");
  for (size_t k = 0, slot = 0; k < blocks && status == HK_OK; k++) {
    bool crossed = w->slot[k];
    w->slot[k] = crossed ? (uint32_t)slot : hk_no_slot;
    if (crossed) w->block[slot++].number = k;
  }
  return status;
}

static hk_status find_blocks(hk_surface_work *w) {
  size_t blocks = 1, bad[3];
  for (int c = 0; c < 3; c++) {
    w->blocks[c] = (w->grid->points[c] + HK_SIDE) / HK_SIDE; /* points + 1 cells with the layer */
    blocks = blocks > SIZE_MAX / 2 / w->blocks[c] ? SIZE_MAX / 2 : blocks * w->blocks[c];
  }
  hk_status status = hk_surface_allocate(w, &w->slot, blocks, sizeof *w->slot, "blocks of the box");
  if (status == HK_OK && w->field->values)
    status = hk_surface_allocate(w, &w->bits, hk_inside_bytes(w), sizeof *w->bits, "bytes of bits");
  if (status != HK_OK) return status;
  if (w->field->values && !hk_inside_pack(w, bad))
    return hk_surface_refuse(w, bad, w->field->values[hk_grid_index(w, bad)]);
  if (w->options->coarse > 0 && w->field->evaluate) status = hk_surface_seek(w);
  if (status != HK_OK) return status;
  w->host->parallel_for(w->host, blocks, GRAIN, survey_chunk, w);
  for (size_t k = 0; k < blocks; k++)
    if (w->slot[k] > CROSSED) return refuse_block(w, k);
  return list_blocks(w, blocks);
}

/* ---- what they hold ---- */

static void count_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  hk_surface_work *w = context;
  (void)chunk;
  for (size_t slot = begin; slot < end; slot++) {
    hk_surface_block *b = &w->block[slot];
    size_t bad;
    look(w, b->number, w->kept ? w->kept + HK_BLOCK_POINTS * slot : NULL, b->inside, &bad);
    hk_block_count(w, b);
  }
}

static hk_status count_all(hk_surface_work *w) {
  hk_status status = hk_surface_allocate(w, &w->cases, 256, sizeof *w->cases, "cases of a cell");
  if (status == HK_OK && w->field->evaluate)
    status = hk_surface_allocate(w, &w->kept, w->count, HK_BLOCK_POINTS * sizeof *w->kept, "blocks of values");
  if (status != HK_OK) return status;
  w->options->method == HK_MARCHING_CUBES ? hk_cell_cases_cubes(w->cases) : hk_cell_cases_tetrahedra(w->cases);
  w->host->parallel_for(w->host, w->count, GRAIN, count_chunk, w);
  hk_isosurface *s = &w->found;
  for (size_t slot = 0; slot < w->count; slot++) {
    hk_surface_block *b = &w->block[slot];
    b->first_vertex = s->vertices, b->first_triangle = s->triangles;
    s->vertices += b->vertices, s->triangles += b->triangles;
  }
  if (s->vertices > UINT32_MAX)
    return w->host->fail(w->host, HK_BAD_PARAM,
                         "isosurface: %zu vertices, and at most 4294967295 have numbers: take a "
                         "larger spacing",
                         s->vertices);
  status = hk_surface_allocate(w, &s->x, s->vertices, sizeof *s->x, "vertices");
  if (status == HK_OK && !w->options->without_normals)
    status = hk_surface_allocate(w, &s->normal, s->vertices, sizeof *s->normal, "normals");
  if (status == HK_OK) status = hk_surface_allocate(w, &s->triangle, s->triangles, sizeof *s->triangle, "triangles");
  return status;
}

/* ---- vertices and triangles ---- */

static void write_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  hk_surface_work *w = context;
  (void)chunk;
  for (size_t slot = begin; slot < end; slot++) {
    hk_block_vertices(w, slot);
    hk_block_triangles(w, slot);
  }
}

static hk_status write_all(hk_surface_work *w) {
  w->host->parallel_for(w->host, w->count, GRAIN, write_chunk, w);
  for (size_t slot = 0; slot < w->count; slot++) {
    const hk_surface_block *b = &w->block[slot];
    if (b->not_finite)
      return w->host->fail(
          w->host, HK_NOT_FINITE,
          "isosurface: the field is not finite at (%g, %g, %g), between points of the grid: give a number of "
          "at most 1e300 in size there, or take no steps",
          b->place[0], b->place[1], b->place[2]);
  }
  return HK_OK;
}

hk_status hk_isosurface_find(hk_isosurface *surface, const hk_host *host, const hk_isosurface_grid *grid,
                             const hk_isosurface_field *field, const hk_isosurface_options *options) {
  hk_surface_work w = {.host = host, .grid = grid, .field = field, .options = options};
  hk_status status = check(&w);
  if (status == HK_OK) status = find_blocks(&w);
  bool any = w.count > 0;
  if (status == HK_OK && any) status = count_all(&w);
  if (status == HK_OK && any && field->evaluate) status = hk_blocks_agree(&w);
  if (status == HK_OK && any) status = write_all(&w);
  release_work(&w);
  if (status != HK_OK) hk_isosurface_free(&w.found, host);
  if (status != HK_OK) return status;
  hk_isosurface_free(surface, host);
  *surface = w.found;
  return HK_OK;
}
