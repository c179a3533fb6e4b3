/* See fake_system.h. */
#include "core/engine/base/base.h"
#include "core/engine/contract/contract.h"
#include "tests/support/fake_solver.h"

#include <dirent.h>
#include <dlfcn.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

static void *room(size_t count, size_t size) {
  void *p = calloc(count + 1, size);
  if (!p) fail_msg("no memory");
  return p;
}

/* ---- The host ---- */

static fake_system *system_of(const hk_host *host) {
  return (fake_system *)(void *)((char *)(size_t)host - offsetof(fake_system, host));
}

static hk_status host_fail(const hk_host *host, hk_status status, const char *format, ...) {
  fake_system *f = system_of(host);
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(f->message, sizeof f->message, format, arguments);
  va_end(arguments);
  return status;
}

static void host_warn(const hk_host *host, const char *format, ...) { (void)host, (void)format; }

/* In front of what is given out; 64 bytes keep the alignment. What is not released is freed with the system. */
typedef struct fake_block {
  struct fake_block *next, *last;
} fake_block;

enum { HEAD = 64 };

static void *host_allocate(const hk_host *host, size_t bytes) {
  fake_system *f = system_of(host);
  size_t rounded = HEAD + (bytes + 127) / 64 * 64;
  fake_block *b = aligned_alloc(64, rounded);
  if (!b) return NULL;
  memset(b, 0, rounded);
  b->next = f->blocks;
  if (b->next) b->next->last = b;
  f->blocks = b;
  return (char *)b + HEAD;
}

static void host_release(const hk_host *host, void *memory) {
  fake_system *f = system_of(host);
  fake_block *b = memory ? (fake_block *)(void *)((char *)memory - HEAD) : NULL;
  if (!b) return;
  if (b->next) b->next->last = b->last;
  if (b->last)
    b->last->next = b->next;
  else
    f->blocks = b->next;
  free(b);
}

static void host_parallel_for(const hk_host *host, size_t count, size_t grain,
                              void (*body)(void *context, size_t begin, size_t end, size_t chunk), void *context) {
  (void)host;
  for (size_t begin = 0, chunk = 0; begin < count; begin += grain, chunk++)
    body(context, begin, begin + grain < count ? begin + grain : count, chunk);
}

static double host_random(const hk_host *host) {
  (void)host;
  return 0.5;
}

static hk_status host_path(const hk_host *host, const char *name, char *buffer, size_t size) {
  (void)name, (void)buffer, (void)size;
  return host_fail(host, HK_IO, "no files here");
}

static const void *host_query(const hk_host *host, const char *service) {
  (void)host, (void)service;
  return NULL;
}

static hk_status host_resize(const hk_host *host, hk_array *field, size_t count) {
  (void)field, (void)count;
  return host_fail(host, HK_FAILED, "no fields that are arrays here");
}

/* ---- The system ---- */

static hk_status accelerations(hk_system *s, double t, double *x, double *v, const double *y, double *a, double *dy) {
  fake_system *f = (fake_system *)(void *)s;
  f->evaluations++;
  if (f->fails_at && f->evaluations == f->fails_at) {
    for (size_t e = 0; e < 3 * s->n; e++) a[e] = NAN; /* a failed evaluation promises nothing */
    return host_fail(&f->host, f->fails_with, "the test's evaluation %zu", f->evaluations);
  }
  memset(a, 0, 3 * s->n * sizeof *a);
  memset(dy, 0, (s->size - 6 * s->n) * sizeof *dy);
  f->problem.f(f->problem.context, t, x, v, y, a, dy);
  if (!f->takes) memset(a, 0, 3 * s->n * sizeof *a);
  if (!s->split->takes_channels) memset(dy, 0, (s->size - 6 * s->n) * sizeof *dy);
  return HK_OK;
}

static hk_status rates(hk_system *s, double t, double *X, double *dX) {
  size_t v = 3 * s->n;
  memcpy(dX, X + v, v * sizeof *dX);
  return accelerations(s, t, X, X + v, X + 2 * v, dX + v, dX + 2 * v);
}

static hk_status energy(hk_system *s, double t, const double *X, double *kinetic, double *potential) {
  (void)t;
  *kinetic = *potential = 0;
  for (size_t e = 3 * s->n; e < 6 * s->n; e++) *kinetic += X[e] * X[e] / 2;
  return HK_OK;
}

static void impose(hk_system *s, double t, double *x, double *v) { (void)s, (void)t, (void)x, (void)v; }

static void filter(hk_system *s, double *vector) { (void)s, (void)vector; }

/* f is one force that acts everywhere, has no energy of its own and states nothing of its stiffness. */
static hk_status update(hk_system *s, double t, const double *X, const double *x_to) {
  (void)s, (void)t, (void)X, (void)x_to;
  return HK_OK;
}

static double step_limit(hk_system *s, double t, const double *X, const double *dx) {
  (void)s, (void)t, (void)X, (void)dx;
  return 1;
}

static hk_status potential(hk_system *s, double t, const double *X, double *joule) {
  (void)s, (void)t, (void)X;
  *joule = 0;
  return HK_OK;
}

static bool stiffness_bound(hk_system *s, hk_stiffness_part part, bool stiffening, double (*block)[6]) {
  (void)part, (void)stiffening;
  memset(block, 0, s->n * sizeof *block);
  return !(s->queries->flags & HK_DEPENDS_ON_X);
}

static hk_status fused(hk_system *s, double t, double *x, double *v, const double *y, double *a, double *dy,
                       const hk_fused *w) {
  if (w->before) w->before(w->context, 0, s->n);
  hk_status status = s->accelerations(s, t, x, v, y, a, dy);
  if (status == HK_OK && w->after) w->after(w->context, 0, s->n);
  return status;
}

/* X keeps its address, since tests do. */
static void exchange(hk_system *s) {
  for (size_t e = 0; e < s->size; e++) {
    double number = s->X[e];
    s->X[e] = s->spare[e];
    s->spare[e] = number;
  }
}

fake_system *fake_system_create(const fake_problem *problem) {
  fake_system *f = room(1, sizeof *f);
  size_t n = problem->n;
  f->problem = *problem;
  f->host = (hk_host){HK_ABI,        hk_processor_lanes(), host_fail,         host_warn,
                      host_allocate, host_release,         host_parallel_for, host_random,
                      host_path,     host_query,           host_resize,       NULL,
                      NULL};
  f->mass = room(n, sizeof *f->mass);
  f->id = room(n, sizeof *f->id);
  f->group = room(n, sizeof *f->group);
  f->pin = room(n, 1);
  f->group_name = "all";
  for (size_t i = 0; i < n; i++) {
    f->mass[i] = 1;
    f->id[i] = (uint32_t)i + 1;
  }
  f->channel = (hk_channel){"heat", problem->width, 0};
  f->partition = (hk_partition){.n = n, .bits = 31, .blocks = 1, .width = 1, .domains = 1, .parts = 2};
  f->model = (hk_model){.n = n,
                        .partition = &f->partition,
                        .mass = f->mass,
                        .inverse_mass = f->mass,
                        .id = f->id,
                        .group = f->group,
                        .pin = f->pin,
                        .groups = 1,
                        .group_name = &f->group_name,
                        .channels = problem->width > 0,
                        .channel = &f->channel};
  size_t size = (6 + problem->width) * n + 1;
  f->system = (hk_system){.host = &f->host,
                          .model = &f->model,
                          .X = room(size, sizeof(double)),
                          .spare = room(size, sizeof(double)),
                          .fused = fused,
                          .exchange = exchange,
                          .n = n,
                          .size = size,
                          .tol = 1e-6,
                          .accelerations = accelerations,
                          .rates = rates,
                          .impose = impose,
                          .filter = filter,
                          .linear = &f->linear,
                          .split = &f->split,
                          .queries = &f->queries};
  f->contact = (hk_contact_table){update, step_limit, potential, energy};
  f->split = (hk_split_table){.forces = 1, .force = &f->force, .takes = &f->takes, .takes_channels = true};
  f->queries = (hk_system_queries){.flags = problem->flags, .stiffness_bound = stiffness_bound};
  f->force = (hk_force_info){"f", problem->flags | HK_SYMMETRIC_JACOBIAN, true, false, false};
  f->takes = true;
  fake_solver_attach(f);
  return f;
}

void fake_system_destroy(fake_system *f) {
  while (f->blocks) host_release(&f->host, (char *)f->blocks + HEAD);
  fake_solver_detach(f);
  free(f->system.X);
  free(f->system.spare);
  free(f->mass);
  free(f->id);
  free(f->group);
  free(f->pin);
  free(f);
}

void fake_system_fail(fake_system *f, size_t at, hk_status with) {
  f->evaluations = 0;
  f->fails_at = at;
  f->fails_with = with;
}

/* ---- The method ---- */

static int by_name(const void *a, const void *b) { return strcmp(*(char *const *)a, *(char *const *)b); }

size_t fake_integrator_names(const char *names[FAKE_METHODS]) {
  static char text[FAKE_METHODS][64];
  size_t count = 0;
  DIR *folder = opendir(HK_BUILD "/plugins/integrators");
  if (!folder) fail_msg("no folder %s", HK_BUILD "/plugins/integrators");
  for (struct dirent *entry = readdir(folder); entry; entry = readdir(folder)) {
    size_t length = strlen(entry->d_name);
    if (length < 4 || length > 60 || strcmp(entry->d_name + length - 3, ".so") != 0) continue;
    if (count == FAKE_METHODS) fail_msg("more than %d integrators", (int)FAKE_METHODS);
    memcpy(text[count], entry->d_name, length - 3);
    text[count][length - 3] = 0;
    names[count] = text[count];
    count++;
  }
  closedir(folder);
  qsort(names, count, sizeof *names, by_name);
  return count;
}

static size_t length_of(const fake_method *m, const hk_field *field) {
  if (field->state) return field->width * m->system->system.size;
  return field->per_particle ? field->width * m->system->system.n : 0;
}

static void set_default(const fake_method *m, const hk_param *p) {
  void *to = hk_param_in(p, m->self);
  switch (hk_param_type(p)) {
  case HK_NUMBER:
    *(double *)to = p->flags & HK_OPTIONAL ? NAN : p->initial[0];
    break;
  case HK_INTEGER:
    *(int64_t *)to = (int64_t)p->initial[0];
    break;
  case HK_BOOLEAN:
    *(bool *)to = p->initial[0] != 0;
    break;
  case HK_CHOICE:
    *(int *)to = (int)p->initial[0];
    break;
  case HK_STRING:
    *(const char **)to = p->text;
    break;
  case HK_VECTOR:
    memcpy(to, p->initial, sizeof p->initial);
    break;
  default:
    break;
  }
}

fake_method fake_method_open(const char *name, fake_system *system) {
  char path[4096];
  snprintf(path, sizeof path, "%s/plugins/integrators/%s.so", HK_BUILD, name);
  fake_method m = {.handle = dlopen(path, RTLD_NOW | RTLD_LOCAL), .system = system};
  if (!m.handle) fail_msg("%s", dlerror());
  const hk_plugin *constant = dlsym(m.handle, "hk_plugin_main");
  if (!constant) fail_msg("%s has no hk_plugin_main", path);
  m.plugin = hk_contract_copy(constant);
  if (!m.plugin) fail_msg("no memory for %s", path);
  assert_int_equal(m.plugin->kind, HK_INTEGRATOR);
  assert_string_equal(m.plugin->name, name);
  m.self = room(1, m.plugin->instance_size);
  for (const hk_param *p = m.plugin->params; p && p->name; p++) set_default(&m, p);
  for (const hk_field *field = m.plugin->fields; field && field->name; field++)
    if (length_of(&m, field)) *(double **)hk_field_in(field, m.self) = room(length_of(&m, field), sizeof(double));
  hk_view view = {.n = system->system.n,
                  .x = system->system.X,
                  .v = system->system.X + 3 * system->system.n,
                  .y = system->system.X + 6 * system->system.n,
                  .model = &system->model,
                  .host = &system->host,
                  .acting = system->system.n};
  if (m.plugin->create && m.plugin->create(m.self, &system->host, &view) != HK_OK)
    fail_msg("%s: %s", name, system->message);
  return m;
}

void fake_method_close(fake_method *m) {
  if (m->plugin->destroy) m->plugin->destroy(m->self, &m->system->host);
  for (const hk_field *field = m->plugin->fields; field && field->name; field++)
    if (length_of(m, field)) free(*(double **)hk_field_in(field, m->self));
  free(m->self);
  free((void *)(uintptr_t)m->plugin);
  dlclose(m->handle);
}

bool fake_method_explicit(const fake_method *m) {
  return !(m->plugin->integrator->flags & (HK_IMPLICIT | HK_NEEDS_JACOBIAN));
}

bool fake_method_implicit(const fake_method *m) {
  unsigned both = HK_IMPLICIT | HK_NEEDS_JACOBIAN;
  return (m->plugin->integrator->flags & both) == both && strcmp(m->plugin->name, "cvode") != 0 &&
         strcmp(m->plugin->name, "arkode") != 0;
}

bool fake_method_set(const fake_method *m, const char *name, double value) {
  for (const hk_param *p = m->plugin->params; p && p->name; p++)
    if (strcmp(p->name, name) == 0 && p->number) {
      *(double *)hk_param_in(p, m->self) = value;
      return true;
    }
  return false;
}

double fake_method_growth(const fake_method *m, double hw, double hg, double hb) {
  return m->plugin->integrator->growth(m->self, m->plugin->integrator->method, hw, hg, hb);
}

hk_status fake_method_step(fake_method *m, double h, hk_step *out) {
  hk_system *s = &m->system->system;
  hk_step own;
  if (!out) out = &own;
  *out = (hk_step){h, h, NAN};
  hk_status status = m->plugin->integrator->step(m->self, m->plugin->integrator->method, s, s->t + h, h, out);
  m->system->takes = s->split->takes_channels = true;
  if (status == HK_OK) s->t += out->h;
  return status;
}

void fake_method_run(fake_method *m, double t_end, size_t steps) {
  double begin = m->system->system.t, h = (t_end - begin) / (double)steps;
  for (size_t i = 1; i <= steps; i++) {
    if (fake_method_step(m, h, NULL) != HK_OK) fail_msg("%s: %s", m->plugin->name, m->system->message);
    m->system->system.t = i == steps ? t_end : begin + (double)i * h;
  }
}

size_t fake_method_memory(const fake_method *m, double **address, size_t most) {
  size_t count = 0;
  for (size_t e = 0; e < m->system->system.size && count < most; e++) address[count++] = m->system->system.X + e;
  for (const hk_field *field = m->plugin->fields; field && field->name; field++)
    for (size_t e = 0; !(field->flags & HK_SCRATCH) && e < length_of(m, field) && count < most; e++)
      address[count++] = *(double **)hk_field_in(field, m->self) + e;
  return count;
}

size_t fake_method_save(const fake_method *m, char *buffer) {
  size_t used = 0;
  for (const hk_field *field = m->plugin->fields; field && field->name; field++)
    if (!length_of(m, field)) {
      memcpy(buffer + used, hk_field_in(field, m->self), 8);
      used += 8;
    }
  return used;
}

void fake_method_load(const fake_method *m, const char *buffer) {
  for (const hk_field *field = m->plugin->fields; field && field->name; field++)
    if (!length_of(m, field)) {
      memcpy(hk_field_in(field, m->self), buffer, 8);
      buffer += 8;
    }
}
