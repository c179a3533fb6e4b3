/* Every loop that is compiled for several widths of vectors (core/plugin/widest.h) gives the same bits with each: short
 * runs that take the loop, with vectors of 2, 4 and 8 doubles as far as this processor has them. Where
 * multiplications and additions are fused, which vectors of two are not (the factors of supernodal), the widths from 4
 * on are compared; nbody, whose estimates of roots differ, is compared to rounding in common/gravity. */
#include "core/app/lua/lua.h"
#include "core/run/run/run.h"
#include "tests/support/command.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

typedef struct example {
  const char *what;
  bool fused;
  const char *script; /* after `head` */
} example;

static const char head[] =
    "local scene = hooke.scene { duration = 0.02, fps = 100, dt = 1e-3 }\n"
    "local function sheet(n)\n"
    "  local s = scene:grid { nx = n, ny = n + 2, width = 1, height = 1.1, mass = 1 }\n"
    "  scene:pin { s:at(1, 1), s:at(n, 1) }\n"
    "  scene:force('gravity', { g = { 0.3, 2, -9.81 } })\n"
    "  return s\n"
    "end\n"
    "local function springs(s, c)\n"
    "  scene:force('springs', { edges = s:structural(), k = 500, damping = c, label = 'structural' })\n"
    "  scene:force('springs', { edges = s:shear(), k = 100, damping = c, rest = 0.05, label = 'shear' })\n"
    "end\n";

#define SHEET "local s = sheet(23)\n"
#define SPRINGS SHEET "springs(s, 0.01)\n"

/* A shaken cube, denser than the liquid at rest. */
#define DROP                                                                                                           \
  "for i = 0, 124 do\n"                                                                                                \
  "  scene:particle { position = { 0.09 * (i % 5) + 0.02 * math.random(), 0.09 * (i // 5 % 5), 0.09 * (i // 25) },\n"  \
  "    mass = 1 }\n"                                                                                                   \
  "end\n"

static const example examples[] = {
    {"runs of springs, leapfrog, gravity", false, SPRINGS},
    {"springs without damping, drag", false, SHEET "springs(s, 0)\nscene:force('drag', { rate = 3 })\n"},
    {"springs in lists", false,
     "local ids, edges = {}, {}\n"
     "for i = 0, 299 do ids[i] = scene:particle { position = { i % 7, i * i % 11, i * i * i % 13 }, mass = 1 } end\n"
     "for i = 0, 299 do for j = 1, 5 do\n"
     "  edges[#edges + 1] = { ids[i], ids[(i + 1 + (i + j * j) * 37 % 297) % 300] }\n"
     "end end\n"
     "for k = #edges, 1, -1 do if edges[k][1] == edges[k][2] then table.remove(edges, k) end end\n"
     "scene:force('springs', { edges = edges, k = 50, damping = 0.2, rest = 1 })\n"},
    {"symplectic Euler", false, SPRINGS "scene:integrator('symplectic_euler')\n"},
    {"Stoermer", false, SPRINGS "scene:integrator('stoermer')\n"},
    {"local leapfrog", false,
     SPRINGS "scene:integrator('local_leapfrog')\nscene:force('springs',\n"
             "  { edges = { { s:at(3, 3), s:at(4, 3) } }, k = 1e6, label = 'stiff' })\n"},
    {"xpbd", false, SHEET "springs(s, 0.01)\nscene:integrator('xpbd')\n"},
    {"multigrid", true, SPRINGS "scene:integrator('backward_euler')\nscene:solver('multigrid')\n"},
    {"implicit, sparse products", false, SPRINGS "scene:integrator('backward_euler')\nscene:solver('pcg')\n"},
    {"incomplete Cholesky", false,
     SPRINGS "scene:integrator('backward_euler')\nscene:solver('pcg', { preconditioner = 'incomplete_cholesky' })\n"},
    {"supernodal", true, SPRINGS "scene:integrator('backward_euler')\nscene:solver('supernodal')\n"},
    {"local and global steps", true, SPRINGS "scene:integrator('local_global')\n"},
    {"triangular factors", false, SPRINGS "scene:integrator('local_global')\nscene:solver('cholmod')\n"},
    {"membrane", false,
     SHEET "scene:force('membrane', { triangles = s:triangles(), stiffness = 0.2, damping = 0.01 })\n"},
    {"membrane, implicit", false,
     SHEET "scene:force('membrane', { triangles = s:triangles(), stiffness = 1e3, damping = 0.01 })\n"
           "scene:integrator('backward_euler')\nscene:solver('pcg')\n"},
    {"membrane of Neo-Hooke, implicit", false,
     SHEET "scene:force('membrane', { triangles = s:triangles(), stiffness = 1e3, model = 'neo_hookean' })\n"
           "scene:integrator('backward_euler')\nscene:solver('pcg')\n"},
    {"hinges", false,
     SPRINGS "scene:force('hinges', { triangles = s:triangles(), rigidity = 1e-7, damping = 1e-9 })\n"},
    {"hinges, implicit", false,
     SPRINGS "scene:force('hinges', { triangles = s:triangles(), rigidity = 1e-3, damping = 1e-5 })\n"
             "scene:integrator('backward_euler')\nscene:solver('pcg')\n"},
    {"hair", false,
     "local h = scene:hair { on = { centre = { 0, 0, 0 }, radius = 0.09, cap = 1.3 }, strands = 7, n = 9, length = "
     "0.3,\n"
     "  spread = 0.05, seed = 1, radius = 4e-5, E = 4e8, nu = 0.4, density = 1300 }\n"
     "scene:force('gravity')\n"
     "scene:force('springs', { edges = h:edges(), k = 10 })\n"
     "scene:force('angle_springs', { edges = h:edges(), EI = h.EI, damping = 1e-9 })\n"
     "scene:integrator('backward_euler')\nscene:solver('banded')\n"},
    {"rods", false,
     "local h = scene:hair { on = { centre = { 0, 0, 0 }, radius = 0.09, cap = 1.3 }, strands = 7, n = 9, length = "
     "0.3,\n"
     "  spread = 0.05, seed = 1, radius = 4e-5, E = 4e8, nu = 0.4, density = 1300,\n"
     "  curl = { radius = 0.01, pitch = 0.06 } }\n"
     "scene:force('gravity')\n"
     "scene:force('springs', { edges = h:edges(), k = 10 })\n"
     "scene:force('rods', { edges = h:edges(), EI = h.EI, GJ = h.GJ })\n"
     "scene:integrator('backward_euler')\nscene:solver('pcg')\n"},
    {"turbulence", false, SPRINGS "scene:force('turbulence', { speed = 3, rate = 2 })\n"},
    {"vortex", false,
     SPRINGS "scene:force('vortex', { strength = 3, core = 0.2, rate = 2 })\n"
             "scene:force('vortex', { strength = 2, profile = 'rankine', rate = 1, label = 'b' })\n"},
    {"strain limits", false, SPRINGS "scene:corrector('strain_limit', { edges = s:structural(), limit = 1e-4 })\n"},
    {"liquids by particles", false, DROP "scene:force('sph', { c = 5, spacing = 0.1 })\n"},
    {"incompressible liquids by particles", false, DROP "scene:corrector('incompressible', { spacing = 0.1 })\n"},
};

static hk_registry registry;

typedef struct state {
  size_t size;
  double *X;
} state;

static state run_with(const example *x, int lanes) {
  char text[6000];
  hk_error error = {0};
  hk_run_options options = {
      .dt = NAN, .tol = NAN, .until = NAN, .accuracy = NAN, .no_output = true, .progress = -1, .lanes = lanes};
  hk_script_options how = {.registry = &registry, .memory_limit = (size_t)256 << 20, .run = &options};
  hk_script *script = NULL;
  hk_run *run = NULL;
  snprintf(text, sizeof text, "%s%sreturn scene\n", head, x->script);
  hk_status status = hk_script_open(test_write("t.lua", text), &how, &script, &error);
  if (status == HK_OK) status = hk_run_open(hk_script_scene(script), &options, &run, &error);
  if (status == HK_OK) status = hk_run_advance(run, hk_run_end(run), &error);
  if (status != HK_OK) fail_msg("%s, vectors of %d: %s", x->what, lanes, error.text);
  state s = {run->state.size, malloc(run->state.size * sizeof(double))};
  memcpy(s.X, run->state.X, s.size * sizeof *s.X);
  hk_run_close(run, NULL);
  hk_run_destroy(run);
  hk_script_close(script);
  return s;
}

static void all_widths_give_the_same_bits(void **unused) {
  (void)unused;
  for (size_t k = 0; k < sizeof examples / sizeof *examples; k++) {
    const example *x = &examples[k];
    int first = x->fused ? 4 : 2;
    if (first > hk_processor_lanes()) continue;
    const state expected = run_with(x, first);
    for (int lanes = 2 * first; lanes <= hk_processor_lanes(); lanes *= 2) {
      const state got = run_with(x, lanes);
      if (got.size != expected.size || memcmp(got.X, expected.X, got.size * sizeof *got.X) != 0)
        fail_msg("%s: vectors of %d and of %d give different bits", x->what, first, lanes);
      free(got.X);
    }
    free(expected.X);
  }
}

int main(void) {
  hk_error error = {0};
  if (hk_registry_open(&registry, HK_BUILD "/plugins", NULL, &error) != HK_OK) return 1;
  const struct CMUnitTest tests[] = {cmocka_unit_test(all_widths_give_the_same_bits)};
  int failed = cmocka_run_group_tests(tests, NULL, NULL);
  hk_registry_close(&registry);
  return failed;
}
