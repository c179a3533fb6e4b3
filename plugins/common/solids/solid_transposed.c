/* Products of a solid for adjoints. With U the deformation gradient of u as of positions, u.F = -volume (P : U) of a
 * tetrahedron, so that its derivative by x is the load of
 *     dP(U) + U S(E(R)) + R S(E(U)),      E(A) = sym(F^T A),
 * and that by v the load of F S(E(U)): dP(U) is the derivative of the elastic stress along U, symmetric as that of an
 * energy, and S(E) = 2 mu E + lambda tr E the viscous stress of the rate R (viscosity.c). Both stresses are linear in
 * their mu and lambda, and these in E and in the damping. */
#include "plugins/common/solids/solid.h"

#include "plugins/common/solids/matrix3.h"

#include <math.h>

static double product(const double A[9], const double B[9]) {
  double sum = 0;
  for (int e = 0; e < 9; e++) sum += A[e] * B[e];
  return sum;
}

/* The derivative of the cofactor of F along U. */
static void turn_of_cofactor(const double F[9], const double U[9], double G[9]) {
  for (int r = 0; r < 3; r++)
    for (int c = 0; c < 3; c++) {
      int r1 = 3 * ((r + 1) % 3), r2 = 3 * ((r + 2) % 3), c1 = (c + 1) % 3, c2 = (c + 2) % 3;
      G[3 * r + c] =
          F[r1 + c1] * U[r2 + c2] + U[r1 + c1] * F[r2 + c2] - F[r1 + c2] * U[r2 + c1] - U[r1 + c2] * F[r2 + c1];
    }
}

/* What u.F is per volume, less its sign: by mu and by lambda. */
typedef struct by_moduli {
  double mu, lambda;
} by_moduli;

/* T += dP(U), of P = mu I/(I + 1) F + (lambda (J - 1) - 3/4 mu) G (neo_hookean.c). */
static by_moduli add_elastic(hk_neo_hookean m, const double F[9], const double U[9], double T[9]) {
  double G[9], turn[9], I = product(F, F), J = hk_matrix3_cofactor(F, G), along = product(F, U), swell = product(G, U);
  double a = m.mu * I / (I + 1), b = 2 * m.mu / ((I + 1) * (I + 1)) * along, p = m.lambda * (J - 1) - 0.75 * m.mu;
  turn_of_cofactor(F, U, turn);
  for (int e = 0; e < 9; e++) T[e] += a * U[e] + b * F[e] + m.lambda * swell * G[e] + p * turn[e];
  return (by_moduli){I / (I + 1) * along - 0.75 * swell, (J - 1) * swell};
}

/* sym(F^T A), and S of it. */
static void strain_of(hk_viscosity v, const double F[9], const double A[9], double E[9], double S[9]) {
  for (int r = 0; r < 3; r++)
    for (int c = 0; c < 3; c++) {
      double sum = 0;
      for (int k = 0; k < 9; k += 3) sum += F[k + r] * A[k + c] + F[k + c] * A[k + r];
      E[3 * r + c] = sum / 2;
    }
  for (int e = 0; e < 9; e++) S[e] = 2 * v.mu * E[e] + (e % 4 == 0 ? v.lambda * (E[0] + E[4] + E[8]) : 0);
}

/* T += A S */
static void add_product(const double A[9], const double S[9], double T[9]) {
  for (int r = 0; r < 9; r += 3)
    for (int c = 0; c < 3; c++) T[r + c] += A[r] * S[c] + A[r + 1] * S[3 + c] + A[r + 2] * S[6 + c];
}

static by_moduli add_viscous(hk_viscosity v, const double F[9], const double R[9], const double U[9], double T[9],
                             double by_rate[9]) {
  double E[9], S[9], EU[9], SU[9];
  strain_of(v, F, R, E, S);
  strain_of(v, F, U, EU, SU);
  add_product(U, S, T);
  add_product(R, SU, T);
  add_product(F, SU, by_rate);
  return (by_moduli){2 * product(E, EU), (E[0] + E[4] + E[8]) * (EU[0] + EU[4] + EU[8])};
}

static void add_load(const hk_tetrahedron *shape, const uint32_t *member, const double T[9], double *to) {
  double load[4][3];
  hk_tetrahedron_load(shape, T, load);
  for (size_t e = 0; e < 12; e++) to[3 * (size_t)member[e / 3] + e % 3] += load[e / 3][e % 3];
}

/* Lame's mu = M/(2 (1 + nu)) and lambda = M nu/((1 + nu) (1 - 2 nu)) of a modulus M, by nu. */
static by_moduli lame_by_nu(double modulus, double nu) {
  double one = 1 + nu, two = 1 - 2 * nu;
  return (by_moduli){-modulus / (2 * one * one), modulus * (1 + 2 * nu * nu) / (one * one * two * two)};
}

static void add_slopes(const hk_solid_params *given, size_t k, double volume, by_moduli elastic, by_moduli viscous,
                       double *const row[3]) {
  double nu = hk_tuple_value(&given->nu, k);
  hk_neo_hookean one = hk_neo_hookean_of(1, nu);
  hk_viscosity creep = hk_viscosity_of(1, nu);
  by_moduli of_E = lame_by_nu(hk_tuple_value(&given->E, k), nu),
            of_c = lame_by_nu(hk_tuple_value(&given->damping, k), nu);
  row[0][k] -= volume * (elastic.mu * one.mu + elastic.lambda * one.lambda);
  row[1][k] -= volume * (elastic.mu * 4 / 3 * of_E.mu + elastic.lambda * (of_E.lambda + 5.0 / 6 * of_E.mu) +
                         viscous.mu * of_c.mu + viscous.lambda * of_c.lambda);
  row[2][k] -= volume * (viscous.mu * creep.mu + viscous.lambda * creep.lambda);
}

void hk_solid_transposed(const hk_solid *s, const hk_view *view, const hk_solid_params *given, const double *u,
                         const hk_transposed *into, double *const row[3]) {
  for (size_t k = 0; k < s->tuples.acting.count; k++) {
    const hk_solid_part *p = hk_solid_part_of(s, k);
    const uint32_t *member = hk_tuple(&s->tuples.acting, k);
    double F[9], U[9], R[9], T[9] = {0}, by_rate[9] = {0};
    by_moduli viscous = {0};
    hk_tetrahedron_gradient(&p->shape, view->x, member, F);
    hk_tetrahedron_gradient(&p->shape, u, member, U);
    by_moduli elastic = add_elastic(p->elastic, F, U, T);
    if (p->viscous.mu > 0 || row) {
      hk_tetrahedron_gradient(&p->shape, view->v, member, R);
      viscous = add_viscous(p->viscous, F, R, U, T, by_rate);
      add_load(&p->shape, member, by_rate, into->v);
    }
    add_load(&p->shape, member, T, into->x);
    if (row) add_slopes(given, s->tuples.number[k], p->shape.volume, elastic, viscous, row);
  }
}

hk_solid_moduli hk_solid_moduli_along(double E, double nu, double by_E, double by_nu) {
  hk_neo_hookean one = hk_neo_hookean_of(1, nu);
  by_moduli of_nu = lame_by_nu(E, nu);
  return (hk_solid_moduli){by_E * one.mu + by_nu * 4 / 3 * of_nu.mu,
                           by_E * one.lambda + by_nu * (of_nu.lambda + 5.0 / 6 * of_nu.mu)};
}

hk_solid_moduli hk_solid_creep_along(double damping, double nu, double by_damping, double by_nu) {
  hk_viscosity one = hk_viscosity_of(1, nu);
  by_moduli of_nu = lame_by_nu(damping, nu);
  return (hk_solid_moduli){by_damping * one.mu + by_nu * of_nu.mu, by_damping * one.lambda + by_nu * of_nu.lambda};
}
