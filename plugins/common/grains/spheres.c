#include "plugins/common/grains/spheres.h"

#include <string.h>

static const double travel = 0.25; /* of the smallest radius, in a step */

static hk_status find(const hk_view *view, const char *parameter, const char *name, size_t size,
                      const hk_channel **channel) {
  for (size_t k = 0; name && k < view->model->channels; k++)
    if (strcmp(view->model->channel[k].name, name) == 0) *channel = &view->model->channel[k];
  if (!name || (*channel && (*channel)->size == size)) return HK_OK;
  return view->host->fail(view->host, HK_BAD_PARAM,
                          "%s: the scene has no channel '%s' of %zu number%s: scene:channel(\"%s\", { size = %zu })",
                          parameter, name, size, size > 1 ? "s" : "", name, size);
}

static hk_status join(hk_spheres *s, const hk_host *host) {
  s->spins = host->query(host, HK_SPINS_INTERFACE);
  if (!s->spins)
    return host->fail(
        host, HK_FAILED,
        "spin: it needs the service 'spins/1', and no plugin of that name is installed in services/; see: "
        "hooke plugins");
  s->number = s->spins->join(s->spins->self);
  return HK_OK;
}

hk_status hk_spheres_open(hk_spheres *s, const hk_view *view) {
  s->radius_channel = s->spin_channel = NULL;
  if (isnan(s->radius) == !s->radii)
    return view->host->fail(view->host, HK_BAD_PARAM, "give either radius = NUMBER or radii = \"CHANNEL\"");
  hk_status status = find(view, "radii", s->radii, 1, &s->radius_channel);
  if (status == HK_OK) status = find(view, "spin", s->spin, 3, &s->spin_channel);
  if (status == HK_OK && s->spin) status = join(s, view->host);
  return status == HK_OK ? hk_spheres_check(s, view) : status;
}

hk_status hk_spheres_topology(const hk_spheres *s, const hk_view *view) {
  if (s->spins) s->spins->claim(s->spins->self, view, s->number);
  return hk_spheres_check(s, view);
}

hk_radii hk_spheres_measure(const hk_spheres *s, const hk_view *view) {
  hk_radii all = {INFINITY, 0};
  if (!s->radius_channel) return (hk_radii){s->radius, s->radius};
  for (size_t i = 0; i < view->n; i++) {
    double R = hk_sphere_radius(s, view, i);
    all.smallest = fmin(all.smallest, R);
    all.largest = fmax(all.largest, R);
  }
  return all;
}

hk_status hk_spheres_check(const hk_spheres *s, const hk_view *view) {
  for (size_t i = 0; s->radius_channel && i < view->n; i++) {
    double R = hk_sphere_radius(s, view, i);
    if (!(R > 0 && R < INFINITY))
      return view->host->fail(view->host, HK_BAD_PARAM,
                              "particle %u has the radius %g m at t = %g s: it must be above 0", view->model->id[i], R,
                              view->t);
  }
  return HK_OK;
}

static size_t acting(const hk_view *view, size_t k) { return view->active ? view->active[k] : k; }

void hk_spheres_turn(const hk_spheres *s, const hk_view *view, const double *torque, double *dy) {
  if (!s->spin_channel) return;
  double *spin = dy + s->spin_channel->offset * view->n;
  for (size_t k = 0; k < view->acting; k++) {
    size_t i = acting(view, k);
    double inertia = hk_sphere_inertia(s, view, i);
    for (size_t a = 3 * i; a < 3 * i + 3; a++) spin[a] += torque[a] / inertia;
  }
}

void hk_spheres_keep_spin(const hk_spheres *s, const hk_view *view, double *spin) {
  if (s->spin_channel && view->n) memcpy(spin, hk_sphere_spin(s, view, 0), 3 * view->n * sizeof *spin);
}

double hk_spheres_longest_step(const hk_spheres *s, const hk_view *view) {
  double most2 = 0;
  for (size_t k = 0; k < view->acting; k++) {
    const double *v = view->v + 3 * acting(view, k);
    most2 = fmax(most2, v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
  }
  return travel * hk_spheres_measure(s, view).smallest / sqrt(most2);
}

double hk_spheres_least_mass(const hk_view *view, bool fixed) {
  double least = INFINITY, second = INFINITY;
  for (size_t k = 0; k < view->acting; k++) {
    double m = view->model->mass[acting(view, k)];
    second = fmin(second, fmax(least, m));
    least = fmin(least, m);
  }
  if (fixed) return least;
  return isinf(second) ? INFINITY : least * second / (least + second);
}
