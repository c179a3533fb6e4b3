/* What a strand's material and section are worth as stiffnesses. For an ellipse with the half axes a and b (a circle: a
 * = b): A   = pi a b                     area, m^2 I_1 = pi a^3 b/4                 against bending towards the axis a,
 * m^4; circle: pi r^4/4 I_2 = pi a b^3/4                 towards the axis b J   = pi a^3 b^3/(a^2 + b^2)     torsion
 * constant (Saint-Venant), m^4; circle: pi r^4/2 = 2 I G   = E/(2 (1 + nu))             shear modulus, Pa EA is a force
 * (N per unit of strain), EI and GJ are N m^2, density A a mass per length. Euler, Bernoulli and Kirchhoff's rod:
 * slender, without shear of its sections, and J without the stiffening by warping at a clamped end. */
#include "core/scene/scene/scene.h"
#include "core/engine/base/base.h"

static hk_status positive(const char *name, double value, const char *unit, hk_error *error) {
  if (value > 0 && value < INFINITY) return HK_OK;
  return hk_error_set(error, HK_BAD_PARAM, "%s: %g %s must be above 0", name, value, unit);
}

hk_status hk_section_check(const hk_section *s, hk_error *error) {
  hk_status status = positive("radius", s->half_axis[0], "m", error);
  if (status == HK_OK) status = positive("radius", s->half_axis[1], "m", error);
  if (status == HK_OK && !isnan(s->E)) status = positive("E", s->E, "Pa", error);
  if (status == HK_OK && !isnan(s->density)) status = positive("density", s->density, "kg/m^3", error);
  if (status == HK_OK && !isnan(s->nu) && !(s->nu > -1 && s->nu <= 0.5))
    return hk_error_set(error, HK_BAD_PARAM, "nu: Poisson's ratio %g is not above -1 and at most 0.5", s->nu);
  return status;
}

hk_section_numbers hk_section_of(const hk_section *s) {
  const double pi = 3.14159265358979323846, a = s->half_axis[0], b = s->half_axis[1], area = pi * a * b;
  const double torsion = pi * a * a * a * b * b * b / (a * a + b * b);
  return (hk_section_numbers){.line_mass = s->density * area,
                              .EA = s->E * area,
                              .EI = {s->E * area * a * a / 4, s->E * area * b * b / 4},
                              .GJ = s->E / (2 * (1 + s->nu)) * torsion};
}
