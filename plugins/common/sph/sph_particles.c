#include "plugins/common/sph/sph_particles.h"

/* ---- who takes part ---- */

static bool is_held(const hk_model *m, size_t i) {
  return ((m->pin[i] == HK_PIN_FIXED || m->pin[i] == HK_PIN_PATH) && m->mass[i] > 0) || m->pin[i] == HK_PIN_RIDES;
}

/* Places that joints are fixed to have no mass, and are neither walls nor liquid. */
static bool is_inside(const hk_model *m, size_t i) {
  return (m->inside && m->inside[i]) || !(m->mass[i] > 0 || m->pin[i] == HK_PIN_RIDES);
}

static void give_listed(hk_sph *s, const hk_tuples *list, hk_sph_role role) {
  for (size_t k = 0; k < list->count; k++) s->role[*hk_tuple(list, k)] = (uint8_t)role;
}

/* What is in an edge or triangle is solid: a wall that moves, until nothing joins it any more. */
static void give_joined(hk_sph *s, const hk_model *m, const hk_tuples *list) {
  for (size_t k = 0; k < list->count * list->arity && !s->takes_joined; k++)
    if (!is_inside(m, list->index[k])) s->role[list->index[k]] = s->walls.count ? HK_SPH_NONE : HK_SPH_WALL;
}

static void give_roles(hk_sph *s, const hk_view *view) {
  const hk_model *m = view->model;
  for (size_t i = 0; i < view->n; i++) {
    hk_sph_role free = s->particles.count ? HK_SPH_NONE : HK_SPH_LIQUID,
                held = s->walls.count ? HK_SPH_NONE : HK_SPH_WALL;
    s->role[i] = (uint8_t)(is_inside(m, i) ? HK_SPH_NONE : is_held(m, i) ? held : free);
  }
  give_joined(s, m, &m->edges);
  give_joined(s, m, &m->triangles);
  give_listed(s, &s->walls, HK_SPH_WALL);
  give_listed(s, &s->particles, HK_SPH_LIQUID);
}

hk_status hk_sph_topology(hk_sph *s, const hk_view *view) {
  const hk_host *host = s->host;
  host->release(host, s->role);
  host->release(host, s->point);
  host->release(host, s->sums);
  s->role = host->allocate(host, view->n + 1);
  s->point = host->allocate(host, (view->n + 1) * sizeof *s->point);
  s->sums = host->allocate(host, 2 * (view->n / HK_SPH_GRAIN + 1) * sizeof *s->sums);
  if (!s->role || !s->point || !s->sums) return host->fail(host, HK_NO_MEMORY, "no memory for %zu particles", view->n);
  give_roles(s, view);
  return HK_OK;
}

/* ---- the start ---- */

static void warn_of_masses(const hk_sph *s, const hk_view *view) {
  double mass = 0, count = 0;
  for (size_t i = 0; i < view->n; i++)
    if (s->role[i] == HK_SPH_LIQUID) mass += view->model->mass[i], count++;
  double own = pow(mass / (count * s->density), 1.0 / 3);
  if (count > 0 && fabs(own / s->spacing - 1) > 0.1)
    s->host->warn(
        s->host,
        "spacing: particles of this mass are %.3g m apart at the density of %g kg/m^3, not %.3g m: the liquid "
        "will shrink or swell; give them density x spacing^3 = %.3g kg",
        own, s->density, s->spacing, s->density * s->spacing * s->spacing * s->spacing);
}

/* Pressure pushes what leaves the plane by ever so little out of it. */
static void warn_of_plane(const hk_sph *s, const hk_view *view) {
  for (size_t i = 0; i < view->n && s->dimensions == 2; i++) {
    if (s->role[i] != HK_SPH_LIQUID || view->model->pin[i] != HK_FREE) continue;
    s->host->warn(s->host, "dimensions: a liquid that nothing keeps in its plane buckles: pin its particles to it, "
                           "scene:pin(ids, { normal = { 0, 1, 0 } })");
    return;
  }
}

hk_status hk_sph_open(hk_sph *s, const hk_host *host, const hk_view *view) {
  s->host = host;
  s->service = host->query(host, "neighbours/1");
  if (!s->service)
    return host->fail(host, HK_FAILED,
                      "it needs the service 'neighbours/1', and no plugin of that name is installed in services/; see: "
                      "hooke plugins");
  hk_status status = hk_sph_topology(s, view);
  if (status != HK_OK) return status;
  warn_of_masses(s, view);
  warn_of_plane(s, view);
  hk_sph_kernel_prepare(&s->kernel, s->spacing, s->reach, (int)s->dimensions);
  return s->service->reach_images(s->service->self, s->kernel.radius);
}

/* ---- walls ---- */

double hk_sph_between(const hk_view *view, size_t i, size_t j, double d[3]) {
  for (size_t c = 0; c < 3; c++) d[c] = view->x[3 * i + c] - view->x[3 * j + c];
  if (view->model->box) hk_nearest_image(view->model->box, d);
  return d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
}

/* Walls may share a place, as points on the edges of bodies do. */
static hk_status check_place(const hk_sph *s, const hk_view *view, size_t i, size_t j) {
  if (s->role[j] == HK_SPH_NONE || (s->role[i] == HK_SPH_WALL && s->role[j] == HK_SPH_WALL)) return HK_OK;
  if (view->is_active && !(view->is_active[i] && view->is_active[j])) return HK_OK;
  double d[3], least = 1e-6 * s->spacing;
  if (hk_sph_between(view, i, j, d) > least * least) return HK_OK;
  return s->host->fail(s->host, HK_FAILED,
                       "particles %u and %u are in the same place at t = %g s, where pressure has no direction: put "
                       "them about %.3g m apart",
                       view->model->id[i], view->model->id[j], view->t, s->spacing);
}

static double wall_volume(const hk_sph *s, const hk_view *view, const hk_neighbour_rows *rows, size_t i) {
  double d[3], sum = s->kernel.amplitude;
  if (!isnan(s->wall_volume)) return s->wall_volume;
  for (size_t e = rows->row_start[i]; e < rows->row_start[i + 1]; e++)
    if (s->role[rows->other[e]] == HK_SPH_WALL)
      sum += hk_sph_value(&s->kernel, hk_sph_between(view, i, rows->other[e], d));
  return 1 / sum;
}

/* A volume above 0, also of the liquid (where it is not used), says that the particle's start was looked at. */
hk_status hk_sph_update(hk_sph *s, const hk_view *view) {
  hk_neighbour_rows rows = {0};
  hk_status status = HK_OK;
  for (size_t i = 0; i < view->n && status == HK_OK; i++) {
    if (s->role[i] == HK_SPH_NONE || s->volume[i] > 0) continue;
    if (!rows.row_start) status = s->service->rows(s->service->self, view, view->x, &rows);
    if (status != HK_OK) return status;
    for (size_t e = rows.row_start[i]; e < rows.row_start[i + 1] && status == HK_OK; e++)
      status = check_place(s, view, i, rows.other[e]);
    s->volume[i] = s->role[i] == HK_SPH_WALL ? wall_volume(s, view, &rows, i) : view->model->mass[i] / s->density;
  }
  return status;
}

/* ---- sums ---- */

static double counted_mass(const hk_sph *s, const hk_view *view, size_t i) {
  if (view->is_active && !view->is_active[i]) return 0;
  return s->role[i] == HK_SPH_LIQUID ? view->model->mass[i] : s->role[i] == HK_SPH_WALL ? s->density * s->volume[i] : 0;
}

hk_status hk_sph_begin(hk_sph *s, const hk_view *view, hk_neighbour_rows *rows) {
  hk_status status = s->service->rows(s->service->self, view, view->x, rows);
  for (size_t i = 0; i < view->n && status == HK_OK; i++) {
    memcpy(s->point[i], view->x + 3 * i, 3 * sizeof(double));
    s->point[i][3] = counted_mass(s, view, i);
  }
  return status;
}

void hk_sph_bound_unknown(const hk_view *view, double (*block)[6]) {
  for (size_t i = 0; i < view->n; i++)
    for (int c = 0; c < 6; c++) block[i][c] = INFINITY;
}

double hk_sph_total(const hk_sph *s, const hk_view *view) {
  double sum = 0;
  for (size_t k = 0; k * HK_SPH_GRAIN < view->acting; k++) sum += s->sums[k];
  return sum;
}
