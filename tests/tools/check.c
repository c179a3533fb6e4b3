/* hooke check: every force and integrator of the build passes, and each fault that is put into one that is right is
 * found, by the property that it breaks. The wrong plugins are compiled here, as a user compiles one. */
#include "tests/support/command.h"

#include <dirent.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static test_result r;

static void check_all(const char *kind, size_t least) {
  char folder[512], arguments[1024];
  size_t count = 0;
  snprintf(folder, sizeof folder, "%s/plugins/%s", HK_BUILD, kind);
  DIR *directory = opendir(folder);
  assert_non_null(directory);
  for (struct dirent *entry; (entry = readdir(directory));) {
    if (!strstr(entry->d_name, ".so")) continue;
    snprintf(arguments, sizeof arguments, "check %s/%s", folder, entry->d_name);
    test_hooke(&r, NULL, arguments);
    if (r.code != 0) fail_msg("%s: exit %d: %s%s", entry->d_name, r.code, r.out, r.err);
    count++;
  }
  closedir(directory);
  assert_true(count >= least);
}

static void every_force_passes(void **state) {
  (void)state;
  check_all("forces", 5);
}

static void every_integrator_passes(void **state) {
  (void)state;
  check_all("integrators", 10);
}

/* ---- faults ---- */

/* A pull to the origin, F = -s x, and its faults. */
static const char force_source[] =
    "#include \"core/plugin.h\"\n"
    "#ifndef FLAGS\n#define FLAGS (HK_DEPENDS_ON_X | HK_SYMMETRIC_JACOBIAN)\n#endif\n"
    "#ifndef ENERGY\n#define ENERGY 0.5\n#endif\n"
    "#ifndef JACOBIAN\n#define JACOBIAN 1\n#endif\n"
    "#ifndef PULL\n#define PULL(i, x) (-p->s * (x))\n#endif\n"
    "#ifndef ACTS\n#define ACTS(view, i) (!(view)->is_active || (view)->is_active[i])\n#endif\n"
    "typedef struct pull { double s; long calls; } pull;\n"
    "static const hk_param params[] = {{\"s\", \"N/m\", \"strength\", HK_NUMBER, {2}, MIN, INFINITY, offsetof(pull, "
    "s), "
    "0, NULL}, {0}};\n"
    "static hk_status add(void *self, const hk_view *view, double *F) {\n"
    "  pull *p = self;\n"
    "  p->calls++;\n"
    "  for (size_t i = 0; i < view->n; i++)\n"
    "    for (size_t c = 3 * i; ACTS(view, i) && c < 3 * i + 3; c++) F[c] ADD PULL(i, view->x[c]);\n"
    "  return HK_OK;\n}\n"
    "static double energy(void *self, const hk_view *view) {\n"
    "  const pull *p = self;\n"
    "  double sum = 0;\n"
    "  for (size_t i = 0; i < view->n; i++)\n"
    "    for (size_t c = 3 * i; ACTS(view, i) && c < 3 * i + 3; c++) sum += p->s * view->x[c] * view->x[c];\n"
    "  return ENERGY * sum;\n}\n"
    "static void pattern(void *self, const hk_view *view, hk_pattern *into) {\n"
    "  (void)self;\n"
    "  for (uint32_t i = 0; i < view->n; i++) into->block(into, i, i);\n}\n"
    "static hk_status jacobian(void *self, const hk_view *view, const hk_blocks *into) {\n"
    "  const pull *p = self;\n"
    "  for (size_t i = 0; i < view->n; i++)\n"
    "    for (size_t c = 0; ACTS(view, i) && c < 3; c++) into->K[9 * into->slot[i] + 4 * c] += JACOBIAN * p->s;\n"
    "  return HK_OK;\n}\n"
    "static const hk_force force = {.size = sizeof(hk_force), .flags = FLAGS, .add = add, .energy = energy, .pattern = "
    "pattern, .jacobian = "
    "jacobian};\n"
    "HK_EXPORT const hk_plugin hk_plugin_main = {.abi = HK_ABI, .kind = HK_FORCE, .name = \"plugin\", .summary = \"F = "
    "-s "
    "x\", .reference = \"\", .instance_size = sizeof(pull), .params = params, .force = &force};\n";

/* Symplectic Euler and its faults. */
static const char method_source[] =
    "#include \"core/plugin.h\"\n"
    "typedef struct method { double *slope; } method;\n"
    "static const hk_field fields[] = {{\"slope\", HK_FIELD_STATE, 1, offsetof(method, slope), HK_SCRATCH}, {0}};\n"
    /* the roots of l^2 - (2 - z - g) l + 1 - g, z = (h w)^2: x and v of a step with v first */
    "static double amplification(const void *self, double hw, double hg) {\n"
    "  (void)self;\n"
    "  double z = BY * BY * hw * hw, half = 1 - (z + hg) / 2, root = half * half - (1 - hg);\n"
    "  double most = root <= 0 ? sqrt(fabs(1 - hg)) : fabs(half) + sqrt(root);\n"
    "  return most > 1 ? most : 1;\n}\n"
    "static hk_status step(void *self, hk_system *s, double t_stop, double h, hk_step *out) {\n"
    "  double *a = ((method *)self)->slope, *x = s->X, *v = s->X + 3 * s->n;\n"
    "  (void)t_stop, (void)out;\n"
    "  hk_status status = s->accelerations(s, s->t, x, v, s->X + 6 * s->n, a, a + 3 * s->n);\n"
    "  for (size_t e = 0; status == HK_OK && e < 3 * s->n; e++) {\n"
    "    v[e] += h * a[e];\n    x[e] += h * v[e];\n  }\n"
    "  return status;\n}\n"
    "static const hk_integrator integrator = {.size = sizeof(hk_integrator), .order = ORDER, .stages = 1, .flags = "
    "FLAGS, .amplification = "
    "amplification, .step = step};\n"
    "HK_EXPORT const hk_plugin hk_plugin_main = {.abi = HK_ABI, .kind = HK_INTEGRATOR, .name = \"plugin\", .summary = "
    "\"Euler\", .reference = \"\", .instance_size = sizeof(method), .fields = fields, .integrator = &integrator};\n";

/* Compiles with these macros and checks; `broken`: the only line that may be WRONG, NULL: none. */
static void compile_and_check(const char *source, const char *macros, const char *broken) {
  char before[1024];
  test_write("plugin.c", source);
  snprintf(before, sizeof before, "cc -O1 -shared -fPIC %s $(%s/hooke --cflags) plugin.c -o plugin.so && ", macros,
           HK_BUILD);
  test_hooke(&r, before, "check plugin.so");
  if (r.code != (broken ? 1 : 0)) fail_msg("%s: exit %d: %s%s", macros, r.code, r.out, r.err);
  size_t wrong = 0;
  for (const char *at = r.out; (at = strstr(at, "  WRONG ")); at += 8) {
    wrong++;
    if (!broken || strncmp(at + 8, broken, strlen(broken)) != 0) fail_msg("%s: not '%s': %s", macros, broken, r.out);
  }
  if (broken && !wrong) fail_msg("%s: exit 1 and nothing WRONG: %s%s", macros, r.out, r.err);
}

static void faults_of_forces_are_found_and_named(void **state) {
  (void)state;
  static const char *const faults[][2] = {
      {"-DADD=+= -DMIN=0", NULL},
      {"-DADD=+= -DMIN=0 -DENERGY=0.505", "force is minus the gradient of its energy"},
      {"-DADD=+= -DMIN=0 -DJACOBIAN=1.01", "K = -dF/dx"},
      {"-DADD=+= -DMIN=0 -DJACOBIAN=-1", "K = -dF/dx"},
      {"-DADD=+= -DMIN=0 '-DFLAGS=HK_DEPENDS_ON_X|HK_CONSERVES_MOMENTUM'", "momentum is kept"},
      {"-DADD=+= -DMIN=0 -DFLAGS=0", "it does not depend on positions"},
      {"-DADD=+= -DMIN=0 '-DPULL(i,x)=(-p->s*(x)*((x)/(x)))'", "finite with"},
      {"-DADD=+= -DMIN=0 '-DPULL(i,x)=(-p->s*(x)*(1+1e-9*(p->calls%2)))'", "the same twice"},
      {"-DADD=+= -DMIN=0 '-DACTS(view,i)=((void)(view),1)'", "it leaves particles alone"},
      {"-DADD== -DMIN=0", "it adds to what is there"},
  };
  for (size_t k = 0; k < sizeof faults / sizeof *faults; k++)
    compile_and_check(force_source, faults[k][0], faults[k][1]);
}

static void faults_of_integrators_are_found_and_named(void **state) {
  (void)state;
  static const char *const faults[][2] = {
      {"-DORDER=1 -DFLAGS=0 -DBY=1", NULL},
      {"-DORDER=2 -DFLAGS=0 -DBY=1", "order 2"},                                    /* order 1 posing as 2 */
      {"-DORDER=1 -DFLAGS=0 -DBY=0.9", "damping ratio 0"},                          /* stable to 2.2 instead of 2 */
      {"-DORDER=1 -DFLAGS=HK_REVERSIBLE -DBY=1", "it returns when velocities are"}, /* it is not */
  };
  for (size_t k = 0; k < sizeof faults / sizeof *faults; k++)
    compile_and_check(method_source, faults[k][0], faults[k][1]);
}

static void what_cannot_be_checked_is_said(void **state) {
  (void)state;
  char arguments[1024];
  static const char *const bad[][2] = {
      {"check", "no plugin given"},
      {"check none.so", "none.so"},
      {"check %s/tests/fixtures/no_symbol.so", "exports no hk_plugin_main"},
      {"check %s/tests/fixtures/wrong_abi.so", "built for plugin interface 3.0"},
      {"check %s/plugins/forces/springs.so stiffnes=3", "no parameter 'stiffnes'"},
      {"check %s/plugins/forces/springs.so k=soft", "'soft' is not a number"},
  };
  for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
    snprintf(arguments, sizeof arguments, bad[k][0], HK_BUILD);
    test_hooke(&r, NULL, arguments);
    if (r.code != 1 || !strstr(r.err, bad[k][1])) fail_msg("%s: exit %d: %s", arguments, r.code, r.err);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(every_force_passes),
      cmocka_unit_test(every_integrator_passes),
      cmocka_unit_test(faults_of_forces_are_found_and_named),
      cmocka_unit_test(faults_of_integrators_are_found_and_named),
      cmocka_unit_test(what_cannot_be_checked_is_said),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
