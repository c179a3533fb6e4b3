/* A scene: Lagrange's top as a rigid body on a ball joint, which kahan_li8 moves for n nutations, and of ten frames the
 * change of its energy, relative to the first. */
#ifndef HK_TEST_LAGRANGE_TOP_H
#define HK_TEST_LAGRANGE_TOP_H

/* The nutation's period is that of scripts/validation/rigid/lagrange_top.lua, s. */
static const char lagrange_top[] =
    "local n, period = param('n', 5000, 'nutations'), 0.94164945171\n"
    "local T = n * period\n"
    "local scene = hooke.scene { duration = T, fps = 10 / T, dt = 0.01, integrator = 'kahan_li8' }\n"
    "local up = { math.sin(0.5), 0, math.cos(0.5) }\n"
    "local top = scene:rigid { mass = 1, inertia = { 0.2, 0.2, 0.1 }, orientation = { 0, 0.5, 0 },\n"
    "  position = { 0.5 * up[1], 0, 0.5 * up[3] }, spin = { 40 * up[1], 0, 40 * up[3] } }\n"
    "scene:joint { kind = 'ball', a = top, at = { 0, 0, 0 } }\n"
    "scene:force('gravity', { g = { 0, 0, -9.81 } })\n"
    "local first\n"
    "scene:on_frame(function(s)\n"
    "  local E = s:energy()\n"
    "  first = first or E\n"
    "  print(('%8.0f nutations %10.2e'):format(s.t / period, E / first - 1))\n"
    "end)\n"
    "return scene\n";

#endif
