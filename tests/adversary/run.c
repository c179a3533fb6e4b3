/* One run of hooke on a scene: the verdict from --json, the motion from measures.csv, the error of all frames. */
#include "tests/adversary/adversary.h"

#include <fcntl.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

enum { CPU_SECONDS = 10 };
/* Without an accuracy a run is wrong beyond this part of the way. An accuracy says nothing about channels: one is right
 * up to this part of its change, as hooke has it, and wrong only where nothing of it is left. */
static const double visible = 0.1;
/* Of the size of the scene: what every run of hooke is uncertain by, a start that is rounded in each of many steps. */
static const double rounding = 1e-14;

static void redirect(const char *path, int to) {
  int file = open(path, O_WRONLY | O_CREAT | O_TRUNC, 0644);
  if (file >= 0) dup2(file, to), close(file);
}

/* Returns the exit code, or 128 + signal. */
static int run_hooke(const char *hooke, const char *folder, const char *method) {
  int status = 0;
  pid_t child = fork();
  if (child == 0) {
    struct rlimit limit = {CPU_SECONDS, CPU_SECONDS};
    setrlimit(RLIMIT_CPU, &limit);
    if (chdir(folder) != 0) _exit(127);
    redirect("/dev/null", 0), redirect("json", 1), redirect("errors", 2);
    execl(hooke, "hooke", "run", "scene.lua", "--integrator", method, "--threads", "1", "--json", "--out", "out",
          (char *)NULL);
    _exit(127);
  }
  if (child < 0 || waitpid(child, &status, 0) != child) return 127;
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

static void slurp(const char *folder, const char *name, char *into, size_t size) {
  char path[PATH_MAX];
  snprintf(path, sizeof path, "%s/%s", folder, name);
  FILE *file = fopen(path, "r");
  size_t got = file ? fread(into, 1, size - 1, file) : 0;
  into[got] = 0;
  if (file) fclose(file);
}

/* The text behind "key":" up to the next quote. */
static void text_of(const char *json, const char *key, char *into, size_t size) {
  const char *at = strstr(json, key);
  size_t k = 0;
  if (at)
    for (at += strlen(key); *at && *at != '"' && k + 1 < size; at++) into[k++] = *at;
  into[k] = 0;
}

typedef struct errors {
  double motion, last, channel; /* largest, of the last frame, largest */
} errors;

/* Of one frame; false where its row is not complete. */
static bool frame_errors(const char *row, const adv_scene *s, const adv_answer *a, int frame, errors *worst) {
  char *end;
  adv_real sums[2] = {0};
  int count[2] = {3 * s->n, s->n * s->size};
  const adv_real *known[2] = {a->x + frame * count[0], a->c + frame * count[1]};
  double t = strtod(row, &end) / s->units.time;
  if (fabs(t * s->fps - frame) > 1e-6) return false;
  for (int part = 0; part < 2; part++)
    for (int e = 0; e < count[part]; e++) {
      if (*end != ',') return false;
      adv_real read = strtod(end + 1, &end);
      if (part == 0) read = read / s->units.length - s->units.offset[e % 3];
      adv_real off = read - known[part][e];
      sums[part] += off * off;
    }
  for (int part = 0; part < 2; part++)
    if (!isfinite(sums[part])) return false;
  worst->last = (double)sqrtl(sums[0] / s->n);
  worst->motion = fmax(worst->motion, worst->last);
  worst->channel = fmax(worst->channel, (double)sqrtl(sums[1] / s->n));
  return true;
}

/* Infinite where frames are missing. */
static errors measure(const char *folder, const adv_scene *s, const adv_answer *a) {
  char path[PATH_MAX], row[4096];
  int frames = -1; /* the first row is the head */
  errors worst = {0};
  snprintf(path, sizeof path, "%s/out/measures.csv", folder);
  FILE *file = fopen(path, "r");
  while (file && fgets(row, sizeof row, file)) {
    if (frames > s->frames || (frames >= 0 && !frame_errors(row, s, a, frames, &worst))) break;
    frames++;
  }
  if (file) fclose(file);
  return frames == s->frames + 1 ? worst : (errors){INFINITY, INFINITY, INFINITY};
}

static bool prepare(const char *folder, const adv_scene *s, double accuracy) {
  char path[PATH_MAX];
  snprintf(path, sizeof path, "%s/out/measures.csv", folder);
  remove(path);
  snprintf(path, sizeof path, "%s/scene.lua", folder);
  FILE *file = fopen(path, "w");
  if (file) adv_scene_write(s, accuracy, file);
  return file && fclose(file) == 0;
}

static adv_end end_of(int code, const char *verdict) {
  if (code == 128 + 9 || code == 128 + 24) return ADV_TOO_LONG; /* SIGKILL, SIGXCPU */
  if (code == 1 || code == 2) return ADV_REFUSED;
  if (code == 0 && strcmp(verdict, "ok") == 0) return ADV_OK;
  return code == 3 || code == 5 ? ADV_NOT_OK : ADV_BROKEN;
}

/* m, over which the particles are spread at the start, and 1 m at least. */
static double size_of(const adv_scene *s) {
  double size = 1;
  for (int i = 1; i < s->n; i++)
    for (int c = 0; c < 3; c++) size = fmax(size, fabs(s->x[i][c] - s->x[0][c]));
  return size;
}

void adv_run_make(adv_run *r, const char *hooke, const char *folder, const adv_scene *s, const adv_answer *a) {
  char json[1 << 16];
  r->family = s->family, r->seed = s->seed, r->dt = s->dt;
  r->end = ADV_BROKEN;
  r->error = r->last = INFINITY;
  r->bound = isfinite(r->accuracy) ? r->accuracy : visible * a->extent;
  r->uncertainty = a->uncertainty;
  r->luck = rounding * a->growth * size_of(s);
  if (s->size > 0 && a->channel_uncertainty > visible / 100 * a->channel_extent) r->uncertainty = INFINITY;
  if (!prepare(folder, s, r->accuracy)) return;
  int code = run_hooke(hooke, folder, r->method);
  slurp(folder, "json", json, sizeof json);
  text_of(json, "\"verdict\":\"", r->verdict, sizeof r->verdict);
  text_of(json, "\"reason\":\"", r->reason, sizeof r->reason);
  r->end = end_of(code, r->verdict);
  if (r->end == ADV_REFUSED || r->end == ADV_BROKEN) slurp(folder, "errors", r->reason, sizeof r->reason);
  errors e = measure(folder, s, a);
  r->error = e.motion, r->last = e.last;
  r->channel = s->size > 0 ? e.channel / a->channel_extent : 0;
  r->of_change = s->size > 0 ? e.channel / a->channel_change : 0;
}

bool adv_run_certain(const adv_run *r) { return r->uncertainty <= r->bound / 100; }

bool adv_run_wrong(const adv_run *r) { return r->error > r->bound + r->uncertainty || r->channel > 1; }

bool adv_run_right(const adv_run *r) { return r->error <= r->bound + r->uncertainty && r->of_change <= visible; }

bool adv_run_lucky(const adv_run *r) { return adv_run_right(r) && r->luck > r->bound; }
