#include "plugins/common/picture/framing.h"

#include <stdlib.h>

enum { SAMPLES = 1 << 16 };

typedef struct sample {
  float *number; /* SAMPLES */
  size_t count, stride, skipped;
} sample;

static int by_size(const void *a, const void *b) {
  float x = *(const float *)a, y = *(const float *)b;
  return (x > y) - (x < y);
}

static void begin_box(hk_view_setup *stage) {
  for (int c = 0; c < 3; c++) stage->low[c] = INFINITY, stage->high[c] = -INFINITY;
}

static void add_box(hk_view_setup *stage, const float low[3], const float high[3]) {
  for (int c = 0; c < 3; c++) {
    stage->low[c] = fmin(stage->low[c], (double)low[c]);
    stage->high[c] = fmax(stage->high[c], (double)high[c]);
  }
}

static void end_box(hk_view_setup *stage) {
  double sum = 0;
  for (int c = 0; c < 3; c++) {
    if (stage->low[c] > stage->high[c]) stage->low[c] = stage->high[c] = 0;
    double side = stage->high[c] - stage->low[c];
    sum += side * side;
  }
  stage->size = sum > 0 ? sqrt(sum) / 2 : 0.5;
}

/* A frame whose particles all lie at the origin says nothing of the size; the median is that of the others. */
static double median_reach(const hk_frame_spool *spool, float *scratch) {
  size_t count = 0, step = spool->count / SAMPLES + 1;
  for (size_t k = 0; k < spool->count; k += step)
    if (spool->entry[k].reach > 0) scratch[count++] = spool->entry[k].reach;
  qsort(scratch, count, sizeof *scratch, by_size);
  return count ? (double)scratch[(count - 1) / 2] : 0;
}

/* Radii: beads on springs are a little thicker than these; alone they share the room. */
static void choose_radii(const hk_framing *plan, size_t n, size_t lines, hk_view_setup *stage) {
  double loose = fmin(fmax(0.34 / sqrt((double)n + 1), 0.004), 0.03);
  stage->tube = stage->size * (lines > 5000 ? 0.0012 : lines > 300 ? 0.0022 : 0.006);
  stage->bead = lines ? 1.9 * stage->tube : loose * stage->size;
  if (!isnan(plan->radius)) stage->bead = plan->radius;
  stage->pin = 0.0065 * stage->size;
  if (lines) stage->pin = 1.25 * stage->bead;
  stage->bead_pixels = 1;
}

/* A scene that stands on z = 0 or a little above has its floor there; any other just below its lowest point. */
static void choose_floor(const hk_framing *plan, const double origin[3], hk_view_setup *stage) {
  double lowest = stage->low[2] + origin[2];
  stage->floor = plan->floor;
  stage->height = stage->low[2] - fmax(0.06 * stage->size, stage->bead);
  if (lowest > -1e-3 * stage->size && lowest < 0.4 * stage->size) stage->height = -origin[2];
  if (!isnan(plan->height)) stage->height = plan->height - origin[2];
  stage->offset[0] = origin[0], stage->offset[1] = origin[1];
}

static void set_camera(const hk_framing *plan, const double origin[3], hk_view_setup *stage) {
  stage->camera.fov = plan->fov, stage->camera.aspect = plan->aspect;
  hk_camera_aim(&stage->camera, stage->low, stage->high);
  if (!isnan(plan->eye[0]))
    for (int c = 0; c < 3; c++) stage->camera.eye[c] = plan->eye[c] - origin[c];
  if (!isnan(plan->target[0]))
    for (int c = 0; c < 3; c++) stage->camera.target[c] = plan->target[c] - origin[c];
}

/* The depth buffer's 24 bits reach over a factor of some thousands. */
static void set_depths(hk_view_setup *stage) {
  double sum = 0;
  for (int c = 0; c < 3; c++) {
    double side = stage->camera.eye[c] - (stage->low[c] + stage->high[c]) / 2;
    sum += side * side;
  }
  double distance = sqrt(sum);
  stage->camera.near = fmax(distance - 2 * stage->size, 0.01 * (distance + stage->size));
  stage->camera.far = distance + 12 * stage->size;
}

static void take_samples(sample *s, const hk_snapshot3d *shot) {
  for (size_t i = 0; i < shot->n; i++) {
    if (++s->skipped < s->stride) continue;
    s->skipped = 0;
    if (s->count < SAMPLES && isfinite(shot->ink[i].number)) s->number[s->count++] = shot->ink[i].number;
  }
}

/* Upwards to two digits. */
static double round_up(double value) {
  if (!(value > 0)) return value;
  double unit = pow(10, floor(log10(value)) - 1);
  return unit * ceil(value / unit * (1 - 1e-9));
}

/* All but the outermost one per cent at each end: a few corners may saturate so that the rest shows. */
static void choose_range(hk_framing *plan, sample *s) {
  if (!isnan(plan->low)) return;
  plan->low = 0, plan->high = 1;
  if (!plan->counted || !s->count) return;
  qsort(s->number, s->count, sizeof *s->number, by_size);
  double low = (double)s->number[s->count / 100], high = (double)s->number[s->count - 1 - s->count / 100];
  if (plan->centred) {
    high = fmax(round_up(fmax(fabs(low), fabs(high))), 1e-9);
    low = -high;
  } else if (low >= 0 && (low < 0.5 * high || high - low < 1e-3 * high)) {
    low = 0, high = round_up(high);
  }
  if (high <= low) high = low + fmax(fabs(low), 1) * 1e-3;
  plan->low = low, plan->high = high;
}

/* Second pass: what needs every particle of every frame. */
static hk_status pass(const hk_framing *plan, const hk_frame_spool *spool, hk_snapshot3d *shot, double limit,
                      hk_fit *fit, sample *s, double radius) {
  bool fitted = isnan(plan->eye[0]), sampled = plan->counted && isnan(plan->low);
  for (size_t k = 0; k < spool->count && (fitted || sampled); k++) {
    if ((double)spool->entry[k].reach > limit) continue;
    hk_status status = hk_frame_spool_read(spool, k, shot);
    if (status != HK_OK) return status;
    for (size_t i = 0; fitted && i < shot->n; i++)
      if (!isnan(shot->x[i][0])) hk_fit_add(fit, shot->x[i], radius);
    if (sampled) take_samples(s, shot);
  }
  return HK_OK;
}

hk_status hk_framing_motion(hk_framing *plan, const hk_frame_spool *spool, hk_snapshot3d *shot, double wild,
                            hk_view_setup *stage) {
  const hk_host *host = spool->host;
  sample s = {.number = host->allocate(host, SAMPLES * sizeof(float))};
  hk_fit fit;
  if (!s.number) return host->fail(host, HK_NO_MEMORY, "no memory to choose the range of colours");
  double limit = wild * median_reach(spool, s.number);
  size_t n = 0, lines = 0, total = 0;
  begin_box(stage);
  for (size_t k = 0; k < spool->count; k++) {
    const hk_frame_spool_entry *e = spool->entry + k;
    n = e->n > n ? e->n : n, lines = e->lines > lines ? e->lines : lines, total += e->n;
    if ((double)e->reach <= limit) add_box(stage, e->low, e->high);
  }
  end_box(stage);
  choose_radii(plan, n, lines, stage);
  choose_floor(plan, shot->origin, stage);
  set_camera(plan, shot->origin, stage);
  s.stride = total / SAMPLES + 1;
  hk_fit_begin(&fit, &stage->camera, 0.84);
  hk_status status = pass(plan, spool, shot, limit, &fit, &s, fmax(stage->bead, 0.02 * stage->size));
  if (isnan(plan->eye[0])) hk_fit_end(&fit, &stage->camera);
  set_depths(stage);
  choose_range(plan, &s);
  host->release(host, s.number);
  return status;
}

/* What the camera sees at its target's distance is the size; boxes may only grow to many times that. */
void hk_framing_snapshot(hk_framing *plan, const hk_snapshot3d *shot, hk_view_setup *stage) {
  bool first = stage->size == 0;
  double sum = 0;
  begin_box(stage);
  add_box(stage, shot->low, shot->high);
  end_box(stage);
  if (first) set_camera(plan, shot->origin, stage);
  for (int c = 0; c < 3; c++) {
    double side = stage->camera.eye[c] - stage->camera.target[c];
    sum += side * side;
  }
  double distance = sqrt(sum);
  stage->size = fmax(distance, 1e-9) * tan(plan->fov / 2);
  for (int c = 0; c < 3; c++) {
    stage->low[c] = fmax(stage->low[c], -50 * stage->size);
    stage->high[c] = fmin(stage->high[c], 50 * stage->size);
  }
  if (!first) return;
  choose_radii(plan, shot->n, shot->lines, stage);
  choose_floor(plan, shot->origin, stage);
  stage->camera.near = 0.02 * distance, stage->camera.far = 60 * distance;
}
