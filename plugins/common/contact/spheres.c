#include "plugins/common/contact/spheres.h"

#include <string.h>

static hk_status find(const hk_view *view, const char *parameter, const char *name, size_t size,
                      const hk_channel **channel) {
  for (size_t k = 0; name && k < view->model->channels; k++)
    if (strcmp(view->model->channel[k].name, name) == 0) *channel = &view->model->channel[k];
  if (!name || (*channel && (*channel)->size == size)) return HK_OK;
  return view->host->fail(view->host, HK_BAD_PARAM,
                          "%s: the scene has no channel '%s' of %zu number%s: scene:channel(\"%s\", { size = %zu })",
                          parameter, name, size, size > 1 ? "s" : "", name, size);
}

hk_status hk_spheres_open(hk_spheres *s, const hk_view *view) {
  s->radius_channel = s->spin_channel = NULL;
  if (isnan(s->radius) == !s->radii)
    return view->host->fail(view->host, HK_BAD_PARAM, "give either radius = NUMBER or radii = \"CHANNEL\"");
  hk_status status = find(view, "radii", s->radii, 1, &s->radius_channel);
  if (status == HK_OK) status = find(view, "spin", s->spin, 3, &s->spin_channel);
  return status == HK_OK ? hk_spheres_measure(s, view) : status;
}

hk_status hk_spheres_measure(hk_spheres *s, const hk_view *view) {
  s->smallest = s->largest = s->radius;
  if (!s->radius_channel) return HK_OK;
  s->smallest = INFINITY, s->largest = 0;
  for (size_t i = 0; i < view->n; i++) {
    double R = hk_sphere_radius(s, view, i);
    if (!(R > 0 && R < INFINITY))
      return view->host->fail(view->host, HK_BAD_PARAM, "particle %u has the radius %g m: it must be above 0",
                              view->model->id[i], R);
    s->smallest = fmin(s->smallest, R);
    s->largest = fmax(s->largest, R);
  }
  return HK_OK;
}
