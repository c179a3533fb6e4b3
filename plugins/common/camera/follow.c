#include "plugins/common/camera/follow.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Of the picture: room on both sides for what the mean comes after. s, half the width of the mean. */
static const double wide = 2. / 3, calm = 0.4;

typedef struct pose { /* relative to the origin */
  double target[3], distance;
} pose;

static double length(const double v[3]) { return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }

/* Frames without particles, or far out of the motion, are shown as the one before. */
static bool can_be_seen(const hk_frame_spool_entry *e, const hk_view_setup *setup) {
  for (int c = 0; c < 3; c++)
    if (!(e->low[c] <= e->high[c]) || fabs((double)e->low[c] - setup->middle[c]) > 50 * setup->size ||
        fabs((double)e->high[c] - setup->middle[c]) > 50 * setup->size)
      return false;
  return true;
}

static pose pose_of(const hk_frame_spool_entry *e, const hk_camera *from, const hk_view_setup *setup) {
  hk_camera camera = *from;
  hk_fit fit;
  double way[3];
  hk_fit_begin(&fit, &camera, wide);
  for (int corner = 0; corner < 8; corner++) {
    float point[3];
    for (int c = 0; c < 3; c++) point[c] = (corner >> c & 1 ? e->high : e->low)[c];
    hk_fit_add(&fit, point, fmax(setup->point, 0.02 * setup->size));
  }
  hk_fit_end(&fit, &camera);
  for (int c = 0; c < 3; c++) way[c] = camera.eye[c] - camera.target[c];
  pose s = {.distance = length(way)};
  memcpy(s.target, camera.target, sizeof s.target);
  return s;
}

/* Beyond an end the motion goes on as it does on this side of it, turned about the end. */
static pose continued(const pose *all, long count, long at) {
  long end = at < 0 ? 0 : count - 1, mirror = 2 * end - at;
  if (at >= 0 && at < count) return all[at];
  mirror = mirror < 0 ? 0 : mirror >= count ? count - 1 : mirror;
  pose s = all[mirror];
  for (int c = 0; c < 3; c++) s.target[c] = 2 * all[end].target[c] - s.target[c];
  return s;
}

static pose mean_around(const pose *all, size_t count, size_t k, long half) {
  pose mean = {{0}, 0};
  double weights = 0;
  for (long j = -half; j <= half; j++) {
    pose s = continued(all, (long)count, (long)k + j);
    double weight = 1 - (double)labs(j) / (double)(half + 1);
    for (int c = 0; c < 3; c++) mean.target[c] += weight * s.target[c];
    mean.distance += weight * s.distance, weights += weight;
  }
  for (int c = 0; c < 3; c++) mean.target[c] /= weights;
  mean.distance /= weights;
  return mean;
}

hk_status hk_follow(const hk_viewport *port, const hk_frame_spool *spool, const double origin[3], double fps,
                    const hk_view_setup *setup, hk_camera_place *way) {
  const hk_host *host = spool->host;
  const hk_camera *camera = &port->camera;
  pose *all = host->allocate(host, (spool->count + 1) * sizeof *all);
  double back[3], whole;
  if (!all) return host->fail(host, HK_NO_MEMORY, "no memory for the camera's way of %zu frames", spool->count);
  for (int c = 0; c < 3; c++) back[c] = camera->eye[c] - camera->target[c];
  whole = length(back);
  for (size_t k = 0; k < spool->count; k++) {
    bool seen = can_be_seen(spool->entry + k, setup);
    all[k] = seen ? pose_of(spool->entry + k, camera, setup) : k ? all[k - 1] : (pose){{0}, whole};
  }
  long half = (long)fmin(ceil(calm * fps), (double)spool->count);
  for (size_t k = 0; k < spool->count; k++) {
    pose s = mean_around(all, spool->count, k, half);
    double ratio = isnan(port->given.eye[0]) && whole > 0 ? s.distance / whole : 1;
    for (int c = 0; c < 3; c++)
      way[k].target[c] = origin[c] + s.target[c], way[k].eye[c] = way[k].target[c] + ratio * back[c];
  }
  host->release(host, all);
  return HK_OK;
}
