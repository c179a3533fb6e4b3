/* Takes a frame apart in loose particles and the rest, and puts the rest and the surface together. */
#include "plugins/common/particle_surface/surface_frame.h"
#include "plugins/common/isosurface/isosurface.h"
#include "plugins/common/particle_surface/particle_average.h"

#include <string.h>

typedef struct work {
  const hk_host *host;
  const hk_frame_data *of;
  size_t stay, loose;
  uint32_t *place;  /* of->n: in the new frame, or UINT32_MAX */
  uint32_t *source; /* of->n: those that stay, then the loose ones */
  double (*x)[3];   /* of the loose ones */
  double *number;   /* a field of the loose ones, up to `widest` numbers each */
  size_t widest;
  hk_isosurface surface;
  hk_frame_data made;
} work;

static void *take(const hk_host *host, size_t count, size_t size) { return host->allocate(host, (count + 1) * size); }

static bool sort_out(work *w) {
  const hk_frame_data *f = w->of;
  w->widest = 3;
  for (size_t k = 0; k < f->arrays; k++) w->widest = f->array[k].width > w->widest ? f->array[k].width : w->widest;
  w->place = take(w->host, f->n, sizeof *w->place);
  w->source = take(w->host, f->n, sizeof *w->source);
  w->x = take(w->host, f->cells.vertices, sizeof *w->x);
  w->number = take(w->host, f->cells.vertices * w->widest, sizeof *w->number);
  if (!w->place || !w->source || !w->x || !w->number) return false;
  for (size_t k = 0; k < f->cells.vertices; k++) w->place[f->cells.vertex[k]] = UINT32_MAX;
  for (size_t i = 0; i < f->n; i++)
    if (w->place[i] != UINT32_MAX) w->place[i] = (uint32_t)w->stay, w->source[w->stay++] = (uint32_t)i;
  for (size_t i = 0; i < f->n; i++) {
    if (w->place[i] != UINT32_MAX) continue;
    memcpy(w->x[w->loose], f->x + 3 * i, sizeof *w->x);
    w->source[w->stay + w->loose++] = (uint32_t)i;
  }
  return true;
}

/* ---- numbers ---- */

/* Those of the particles that stay, then averages at the vertices; NULL: no memory. */
static double *carry(work *w, const double *from, size_t width, const hk_particle_surface_options *o) {
  double *to = from ? take(w->host, w->made.n * width, sizeof *to) : NULL;
  if (!to) return NULL;
  for (size_t k = 0; k < w->stay; k++) memcpy(to + width * k, from + width * w->source[k], width * sizeof *to);
  for (size_t k = 0; k < w->loose; k++)
    memcpy(w->number + width * k, from + width * w->source[w->stay + k], width * sizeof *to);
  const hk_particle_values values = {(const double(*)[3])w->x, w->loose, w->number, width};
  hk_status status = hk_particle_average(w->host, &values, o, (const double(*)[3])w->surface.x, w->surface.vertices,
                                         to + width * w->stay);
  return status == HK_OK ? to : NULL;
}

static bool fill_arrays(work *w, const hk_particle_surface_options *o) {
  hk_frame_data *m = &w->made;
  m->array = take(w->host, w->of->arrays, sizeof *m->array);
  for (size_t k = 0; k < w->of->arrays && m->array; k++, m->arrays++) {
    const hk_frame_array *from = &w->of->array[k];
    m->array[k] = *from;
    m->array[k].value = carry(w, from->value, from->width, o);
    if (!m->array[k].value) return false;
    if (from->force)
      memset(m->array[k].value + from->width * w->stay, 0, from->width * w->surface.vertices * sizeof(double));
  }
  return m->array != NULL;
}

static bool fill_particles(work *w, const hk_particle_surface_options *o) {
  const hk_frame_data *f = w->of;
  hk_frame_data *m = &w->made;
  uint32_t id = 0;
  m->n = w->stay + w->surface.vertices;
  m->x = take(w->host, 3 * m->n, sizeof *m->x);
  m->mass = take(w->host, m->n, sizeof *m->mass);
  m->id = take(w->host, m->n, sizeof *m->id);
  m->pin = take(w->host, m->n, sizeof *m->pin);
  m->strain = f->strain ? take(w->host, m->n, sizeof *m->strain) : NULL;
  m->v = carry(w, f->v, 3, o);
  if (!m->x || !m->mass || !m->id || !m->pin || (f->strain && !m->strain) || !m->v) return false;
  for (size_t i = 0; i < f->n; i++) id = f->id[i] > id ? f->id[i] : id;
  for (size_t k = 0; k < w->stay; k++) {
    uint32_t i = w->source[k];
    memcpy(m->x + 3 * k, f->x + 3 * (size_t)i, 3 * sizeof *m->x);
    m->mass[k] = f->mass[i], m->id[k] = f->id[i], m->pin[k] = f->pin[i];
    if (f->strain) m->strain[k] = f->strain[i];
  }
  for (size_t k = 0; k < w->surface.vertices; k++) {
    memcpy(m->x + 3 * (w->stay + k), w->surface.x[k], sizeof *w->surface.x);
    m->id[w->stay + k] = id + 1 + (uint32_t)k;
  }
  return fill_arrays(w, o);
}

/* ---- cells ---- */

static bool fill_cells(work *w) {
  const hk_frame_cells *f = &w->of->cells;
  hk_frame_cells *m = &w->made.cells;
  m->vertex = take(w->host, 0, sizeof *m->vertex);
  m->segment = take(w->host, f->segments, sizeof *m->segment);
  m->triangle = take(w->host, f->triangles + w->surface.triangles, sizeof *m->triangle);
  if (!m->vertex || !m->segment || !m->triangle) return false;
  for (size_t k = 0; k < 2 * f->segments; k++) m->segment[k / 2][k % 2] = w->place[f->segment[k / 2][k % 2]];
  for (size_t k = 0; k < 3 * f->triangles; k++) m->triangle[k / 3][k % 3] = w->place[f->triangle[k / 3][k % 3]];
  for (size_t k = 0; k < 3 * w->surface.triangles; k++)
    m->triangle[f->triangles + k / 3][k % 3] = (uint32_t)w->stay + w->surface.triangle[k / 3][k % 3];
  m->segments = f->segments, m->triangles = f->triangles + w->surface.triangles;
  return true;
}

static bool fill_cell_strains(work *w) {
  const hk_frame_data *f = w->of;
  hk_frame_data *m = &w->made;
  if (!f->cell_strain) return true;
  m->cell_strain = take(w->host, hk_cell_count(&m->cells), sizeof *m->cell_strain);
  if (!m->cell_strain) return false;
  for (size_t k = 0; k < hk_cell_count(&m->cells); k++)
    m->cell_strain[k] = k < f->cells.segments + f->cells.triangles ? f->cell_strain[f->cells.vertices + k] : NAN;
  return true;
}

void hk_surface_frame_free(hk_surface_frame *s, const hk_host *host) {
  hk_frame_data *d = &s->data;
  void *const all[] = {d->x,
                       d->v,
                       d->mass,
                       d->id,
                       d->pin,
                       d->cell_strain,
                       d->strain,
                       d->cells.vertex,
                       d->cells.segment,
                       d->cells.triangle};
  for (size_t k = 0; k < sizeof all / sizeof *all; k++) host->release(host, all[k]);
  for (size_t k = 0; k < d->arrays; k++) host->release(host, d->array[k].value);
  host->release(host, d->array);
  *s = (hk_surface_frame){.data = {0}};
}

hk_status hk_surface_frame_make(hk_surface_frame *frame, const hk_host *host, const hk_frame_data *of,
                                const hk_particle_surface_options *options, const hk_solid_list *solids) {
  hk_particle_walls walls = {hk_solids_distance, solids};
  work w = {.host = host, .of = of};
  hk_particle_surface_options o = *options;
  o.without_normals = true;
  if (solids && solids->count > 0) o.walls = &walls;
  bool fine = sort_out(&w);
  hk_status status = fine ? HK_OK : HK_NO_MEMORY;
  if (fine && w.loose > 0) status = hk_particle_surface_find(&w.surface, host, (const double(*)[3])w.x, w.loose, &o);
  if (fine && status == HK_OK) fine = fill_particles(&w, &o) && fill_cells(&w) && fill_cell_strains(&w);
  if (!fine)
    status = host->fail(host, HK_NO_MEMORY, "surface of particles: no memory for %zu vertices", w.surface.vertices);
  w.made.t = of->t;
  w.made.solids = of->solids, w.made.solid = of->solid, w.made.marks = of->marks;
  hk_isosurface_free(&w.surface, host);
  host->release(host, w.place);
  host->release(host, w.source);
  host->release(host, w.x);
  host->release(host, w.number);
  hk_surface_frame made = {.data = w.made};
  if (status == HK_OK) hk_surface_frame_free(frame, host);
  if (status == HK_OK)
    *frame = made;
  else
    hk_surface_frame_free(&made, host);
  return status;
}
