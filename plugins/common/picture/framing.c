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

static void begin_box(hk_view_setup *setup) {
  for (int c = 0; c < 3; c++) setup->low[c] = INFINITY, setup->high[c] = -INFINITY;
}

static void add_box(hk_view_setup *setup, const float low[3], const float high[3]) {
  for (int c = 0; c < 3; c++) {
    setup->low[c] = fmin(setup->low[c], (double)low[c]);
    setup->high[c] = fmax(setup->high[c], (double)high[c]);
  }
}

static void end_box(hk_view_setup *setup) {
  double sum = 0;
  for (int c = 0; c < 3; c++) {
    if (setup->low[c] > setup->high[c]) setup->low[c] = setup->high[c] = 0;
    double side = setup->high[c] - setup->low[c];
    sum += side * side;
  }
  setup->size = sum > 0 ? sqrt(sum) / 2 : 0.5;
}

/* The median of the frames' reach, without frames whose particles are all at the origin, since they give no size. */
static double median_reach(const hk_frame_spool *spool, float *scratch) {
  size_t count = 0, step = spool->count / SAMPLES + 1;
  for (size_t k = 0; k < spool->count; k += step)
    if (spool->entry[k].reach > 0) scratch[count++] = spool->entry[k].reach;
  qsort(scratch, count, sizeof *scratch, by_size);
  return count ? (double)scratch[(count - 1) / 2] : 0;
}

/* Chooses radii: beads on springs are a little thicker than the springs; the radius of beads without springs depends on
 * their number and the size. */
static void choose_radii(const hk_framing *framing, size_t n, size_t lines, hk_view_setup *setup) {
  double loose = fmin(fmax(0.34 / sqrt((double)n + 1), 0.004), 0.03);
  setup->tube = setup->size * (lines > 5000 ? 0.0012 : lines > 300 ? 0.0022 : 0.006);
  setup->bead = lines ? 1.9 * setup->tube : loose * setup->size;
  if (!isnan(framing->radius)) setup->bead = framing->radius;
  setup->pin = 0.0065 * setup->size;
  if (lines) setup->pin = 1.25 * setup->bead;
  setup->sprites.least = 1, setup->sprites.opacity = 1;
}

/* Chooses the floor: z = 0 for a scene whose lowest point is there or a little above, otherwise just below the lowest
 * point. */
static void choose_floor(const hk_framing *framing, const double origin[3], hk_view_setup *setup) {
  double lowest = setup->low[2] + origin[2];
  setup->floor = framing->floor;
  setup->height = setup->low[2] - fmax(0.06 * setup->size, setup->bead);
  if (lowest > -1e-3 * setup->size && lowest < 0.4 * setup->size) setup->height = -origin[2];
  if (!isnan(framing->height)) setup->height = framing->height - origin[2];
  setup->offset[0] = origin[0], setup->offset[1] = origin[1];
}

static void set_camera(const hk_framing *framing, const double origin[3], hk_view_setup *setup) {
  setup->camera.fov = framing->fov, setup->camera.aspect = framing->aspect;
  hk_camera_aim(&setup->camera, setup->low, setup->high);
  if (!isnan(framing->eye[0]))
    for (int c = 0; c < 3; c++) setup->camera.eye[c] = framing->eye[c] - origin[c];
  if (!isnan(framing->target[0]))
    for (int c = 0; c < 3; c++) setup->camera.target[c] = framing->target[c] - origin[c];
}

/* Sets near and far: the depth buffer's 24 bits suffice for a ratio of some thousands. */
static void set_depths(hk_view_setup *setup) {
  double sum = 0;
  for (int c = 0; c < 3; c++) {
    double side = setup->camera.eye[c] - (setup->low[c] + setup->high[c]) / 2;
    sum += side * side;
  }
  double distance = sqrt(sum);
  setup->camera.near = fmax(distance - 2 * setup->size, 0.01 * (distance + setup->size));
  setup->camera.far = distance + 12 * setup->size;
}

static void take_samples(sample *s, const hk_snapshot3d *snapshot) {
  for (size_t i = 0; i < snapshot->n; i++) {
    if (++s->skipped < s->stride) continue;
    s->skipped = 0;
    if (s->count < SAMPLES && isfinite(snapshot->ink[i].number)) s->number[s->count++] = snapshot->ink[i].number;
  }
}

/* Rounds up to two digits. */
static double round_up(double value) {
  if (!(value > 0)) return value;
  double unit = pow(10, floor(log10(value)) - 1);
  return unit * ceil(value / unit * (1 - 1e-9));
}

/* Chooses the range of values without the outermost one per cent at each end: a few extreme values may saturate so that
 * the others differ in colour. */
static void choose_range(hk_framing *framing, sample *s) {
  if (!isnan(framing->low)) return;
  framing->low = 0, framing->high = 1;
  if (!framing->counted || !s->count) return;
  qsort(s->number, s->count, sizeof *s->number, by_size);
  double low = (double)s->number[s->count / 100], high = (double)s->number[s->count - 1 - s->count / 100];
  if (framing->centred) {
    high = fmax(round_up(fmax(fabs(low), fabs(high))), 1e-9);
    low = -high;
  } else if (low >= 0 && (low < 0.5 * high || high - low < 1e-3 * high)) {
    low = 0, high = round_up(high);
  }
  if (high <= low) high = low + fmax(fabs(low), 1) * 1e-3;
  framing->low = low, framing->high = high;
}

/* Second pass over the frames, for quantities that need every particle of every frame. */
static hk_status pass(const hk_framing *framing, const hk_frame_spool *spool, hk_snapshot3d *snapshot, double limit,
                      hk_fit *fit, sample *s, double radius) {
  bool fitted = isnan(framing->eye[0]), sampled = framing->counted && isnan(framing->low);
  for (size_t k = 0; k < spool->count && (fitted || sampled); k++) {
    if ((double)spool->entry[k].reach > limit) continue;
    hk_status status = hk_frame_spool_read(spool, k, snapshot);
    if (status != HK_OK) return status;
    for (size_t i = 0; fitted && i < snapshot->n; i++)
      if (!isnan(snapshot->x[i][0])) hk_fit_add(fit, snapshot->x[i], radius);
    if (sampled) take_samples(s, snapshot);
  }
  return HK_OK;
}

hk_status hk_framing_motion(hk_framing *framing, const hk_frame_spool *spool, hk_snapshot3d *snapshot, double wild,
                            hk_view_setup *setup) {
  const hk_host *host = spool->host;
  sample s = {.number = host->allocate(host, SAMPLES * sizeof(float))};
  hk_fit fit;
  if (!s.number) return host->fail(host, HK_NO_MEMORY, "no memory to choose the range of colours");
  double limit = wild * median_reach(spool, s.number);
  size_t n = 0, lines = 0, total = 0;
  begin_box(setup);
  for (size_t k = 0; k < spool->count; k++) {
    const hk_frame_spool_entry *e = spool->entry + k;
    n = e->n > n ? e->n : n, lines = e->lines > lines ? e->lines : lines, total += e->n;
    if ((double)e->reach <= limit) add_box(setup, e->low, e->high);
  }
  end_box(setup);
  choose_radii(framing, n, lines, setup);
  choose_floor(framing, snapshot->origin, setup);
  set_camera(framing, snapshot->origin, setup);
  s.stride = total / SAMPLES + 1;
  hk_fit_begin(&fit, &setup->camera, 0.84);
  hk_status status = pass(framing, spool, snapshot, limit, &fit, &s, fmax(setup->bead, 0.02 * setup->size));
  if (isnan(framing->eye[0])) hk_fit_end(&fit, &setup->camera);
  set_depths(setup);
  choose_range(framing, &s);
  host->release(host, s.number);
  return status;
}

/* The size is the extent that the camera sees at its target's distance; boxes may only grow to a multiple of it. */
void hk_framing_snapshot(hk_framing *framing, const hk_snapshot3d *snapshot, hk_view_setup *setup) {
  bool first = setup->size == 0;
  double sum = 0;
  begin_box(setup);
  add_box(setup, snapshot->low, snapshot->high);
  end_box(setup);
  if (first) set_camera(framing, snapshot->origin, setup);
  for (int c = 0; c < 3; c++) {
    double side = setup->camera.eye[c] - setup->camera.target[c];
    sum += side * side;
  }
  double distance = sqrt(sum);
  setup->size = fmax(distance, 1e-9) * tan(framing->fov / 2);
  for (int c = 0; c < 3; c++) {
    setup->low[c] = fmax(setup->low[c], -50 * setup->size);
    setup->high[c] = fmin(setup->high[c], 50 * setup->size);
  }
  if (!first) return;
  choose_radii(framing, snapshot->n, snapshot->lines, setup);
  choose_floor(framing, snapshot->origin, setup);
  setup->camera.near = 0.02 * distance, setup->camera.far = 60 * distance;
}
