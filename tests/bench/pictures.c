/* What pictures cost, and which part of it: 121 pictures of 1280 x 720 of a square of cloth that swings, as make run
 * draws them, and the same with one thing left out at a time. Beside the wall time stands that of all processors with
 * ffmpeg's, which a busy machine disturbs less. The least of three repeats, in turn.
 *
 * Of 5.8 s of all processors drawing takes 3 (Mesa's rasteriser with four samples, 0.8 s of it compiling), the
 * video 1.7, PNG files 0.7: half of what it was before the coder of runs (7.3 s) is below what drawing and the video
 * take alone. For the video x264's preset superfast takes 0.92 s of 121 pictures where veryfast takes 1.35, in files
 * twice as large (0.71 MB, 0.35) of the same likeness (SSIM 0.9987, 0.9981); ultrafast 0.47 s and 1.14 MB. Left as it
 * is. */
#include "tests/plugins/outputs/fake_host.h"

#include <math.h>
#include <stdio.h>
#include <sys/resource.h>
#include <time.h>

enum { SIDE = 32, N = SIDE * SIDE, FRAMES = 121, REPEATS = 3 };

typedef struct cloth {
  double x[3 * N], v[3 * N], mass[N];
  uint32_t id[N], group[N], triangle[2 * N][3];
  uint8_t pin[N];
  hk_model model;
  hk_view view;
} cloth;

typedef struct variant {
  const char *name, *off; /* a parameter that is switched off; NULL: none */
  int64_t width;
} variant;

static const variant variants[] = {
    {"all", NULL, 1280},
    {"no video", "video", 1280},
    {"no PNG files", "pictures", 1280},
    {"no shadows", "shadows", 1280},
    {"no colour bar", "legend", 1280},
    {"half the size (--draft)", NULL, 640},
};
enum { VARIANTS = sizeof variants / sizeof *variants };

static void make(cloth *c, const hk_host *host) {
  static const char *const name[] = {"all"};
  memset(c, 0, sizeof *c);
  size_t count = 0;
  for (uint32_t k = 0; k < N; k++) c->id[k] = k + 1, c->mass[k] = 1;
  for (uint32_t i = 0; i + 1 < SIDE; i++)
    for (uint32_t j = 0; j + 1 < SIDE; j++, count += 2) {
      uint32_t a = i * SIDE + j, corner[2][3] = {{a, a + SIDE, a + SIDE + 1}, {a, a + SIDE + 1, a + 1}};
      memcpy(c->triangle[count], corner, sizeof corner);
    }
  c->model = (hk_model){.n = N,
                        .mass = c->mass,
                        .inverse_mass = c->mass,
                        .id = c->id,
                        .group = c->group,
                        .pin = c->pin,
                        .groups = 1,
                        .group_name = name,
                        .triangles = {count, 3, &c->triangle[0][0]}};
  c->view = (hk_view){.n = N, .x = c->x, .v = c->v, .model = &c->model, .host = host};
}

/* Hung by one side, it swings through 150 degrees in 2 s, with a wave in it. */
static void swing(cloth *c, double t) {
  double angle = 1.3 * cos(3.1 * t);
  for (size_t i = 0; i < SIDE; i++)
    for (size_t j = 0; j < SIDE; j++) {
      double *x = c->x + 3 * (i * SIDE + j), down = (double)j / (SIDE - 1), wave = 0.05 * sin(9 * down - 8 * t);
      x[0] = (double)i / (SIDE - 1);
      x[1] = down * sin(angle) + wave * cos(angle), x[2] = -down * cos(angle) + wave * sin(angle);
      c->v[3 * (i * SIDE + j)] = wave;
    }
  c->view.t = t;
}

static double processors(void) {
  struct rusage own, child;
  getrusage(RUSAGE_SELF, &own), getrusage(RUSAGE_CHILDREN, &child);
  const struct timeval all[] = {own.ru_utime, own.ru_stime, child.ru_utime, child.ru_stime};
  double sum = 0;
  for (int k = 0; k < 4; k++) sum += (double)all[k].tv_sec + 1e-6 * (double)all[k].tv_usec;
  return sum;
}

static double now(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static bool film(const variant *v, double seconds[2]) {
  static cloth c;
  fake f;
  hk_frame frame = {.fps = 60};
  fake_open(&f, "frames");
  make(&c, &f.host);
  *(int64_t *)fake_field(&f, "width") = v->width, *(int64_t *)fake_field(&f, "height") = v->width * 9 / 16;
  *(const char **)fake_field(&f, "color") = "speed";
  if (v->off) *(bool *)fake_field(&f, v->off) = false;
  double start[2] = {now(), processors()};
  swing(&c, 0);
  hk_status status = f.plugin->create(f.self, &f.host, &c.view);
  if (status == HK_OK) status = f.plugin->output->open(f.self, &c.view, &frame);
  for (; frame.index < FRAMES && status == HK_OK; frame.index++) {
    swing(&c, (double)frame.index / 60);
    status = f.plugin->output->frame(f.self, &c.view, &frame);
  }
  if (status == HK_OK) status = f.plugin->output->close(f.self, HK_VERDICT_OK);
  seconds[0] = fmin(seconds[0], now() - start[0]), seconds[1] = fmin(seconds[1], processors() - start[1]);
  if (status != HK_OK || *f.warning) fprintf(stderr, "%s: %s%s\n", v->name, f.error, f.warning);
  fake_close(&f);
  return status == HK_OK;
}

int main(void) {
  double seconds[VARIANTS][2];
  for (int k = 0; k < VARIANTS; k++) seconds[k][0] = seconds[k][1] = INFINITY;
  for (int r = 0; r < REPEATS; r++)
    for (int k = 0; k < VARIANTS; k++)
      if (!film(variants + k, seconds[k])) return 1;
  printf("%d pictures of %d x %d particles\n  %-26s %8s %14s\n", FRAMES, SIDE, SIDE, "", "wall, s", "processors, s");
  for (int k = 0; k < VARIANTS; k++) printf("  %-26s %8.2f %14.2f\n", variants[k].name, seconds[k][0], seconds[k][1]);
  return 0;
}
