/* What a substance does with heat: its temperature by its enthalpy, and what it conducts, with one melting range.
 *
 * The state is the enthalpy h, J/kg, which is conserved and which melting changes without a jump; 0 is the solid at the
 * solidus. The temperature is piecewise linear in it,
 *     T = solidus + h/c_s,                            h < 0,
 *     T = solidus + (liquidus - solidus) h/latent,    0 <= h <= latent,
 *     T = liquidus + (h - latent)/c_l,                above,
 * with all the heat between solidus and liquidus in `latent` (Voller and Cross 1981, Int. J. Heat Mass Transfer 24,
 * 545, the enthalpy method). Heat flows down Kirchhoff's transform of the temperature, theta = integral of k dT, W/m,
 * which is piecewise linear in h too, with k the mean of both phases within the melting range: the flux between two
 * places of one substance is (theta_1 - theta_2)/distance exactly where nothing changes in time, however different the
 * phases are (Carslaw and Jaeger 1959, Conduction of heat in solids, section 2.16). */
#ifndef HK_HEAT_LAW_H
#define HK_HEAT_LAW_H

#include "core/plugin.h"

enum { HK_SOLID, HK_MOLTEN, HK_PHASES };

typedef struct hk_heat_law {
  double solidus, liquidus;       /* K; solidus NAN: it does not melt, and h = c T */
  double latent;                  /* J/kg */
  double capacity[HK_PHASES];     /* J/(kg K) */
  double conductivity[HK_PHASES]; /* W/(m K) */
} hk_heat_law;

/* clang-format off */
#define HK_HEAT_CAPACITIES(type, law)                                                                                  \
  {"solidus", "K", "where melting begins; left out: it does not melt, and the enthalpy is capacity x temperature",     \
     .number = HK_AT(type, law.solidus), .limits = HK_AT_LEAST(0), .flags = HK_OPTIONAL},                              \
  {"liquidus", "K", "where melting ends; left out: the solidus",                                                       \
     .number = HK_AT(type, law.liquidus), .limits = HK_AT_LEAST(0), .flags = HK_OPTIONAL},                             \
  {"latent", "J/kg", "heat that melting takes, from the solidus to the liquidus",                                      \
     .number = HK_AT(type, law.latent), .limits = HK_ABOVE(0), .flags = HK_OPTIONAL},                                  \
  {"capacity", "J/(kg K)", "heat capacity of the solid",                                                               \
     .number = HK_AT(type, law.capacity[HK_SOLID]), .limits = HK_ABOVE(0), .flags = HK_REQUIRED},                      \
  {"capacity_liquid", "J/(kg K)", "of the melt; left out: as of the solid",                                            \
     .number = HK_AT(type, law.capacity[HK_MOLTEN]), .limits = HK_ABOVE(0), .flags = HK_OPTIONAL}

#define HK_HEAT_CONDUCTIVITIES(type, law)                                                                              \
  {"conductivity", "W/(m K)", "of the solid",                                                                          \
     .number = HK_AT(type, law.conductivity[HK_SOLID]), .limits = HK_AT_LEAST(0), .flags = HK_REQUIRED},               \
  {"conductivity_liquid", "W/(m K)", "of the melt; left out: as of the solid",                                         \
     .number = HK_AT(type, law.conductivity[HK_MOLTEN]), .limits = HK_AT_LEAST(0), .flags = HK_OPTIONAL}
/* clang-format on */

/* In `create`: what is left out is filled in. HK_BAD_PARAM: the liquidus below the solidus; a solidus without latent
 * heat, or the other way. */
hk_status hk_heat_law_check(hk_heat_law *, const hk_host *);

static inline bool hk_heat_melts(const hk_heat_law *l) { return !isnan(l->solidus); }

/* 0: solid, 1: molten; by the enthalpy, J/kg. */
HK_INLINE double hk_heat_molten(const hk_heat_law *l, double h) {
  if (!hk_heat_melts(l) || h < 0) return 0;
  return h < l->latent ? h / l->latent : 1;
}

/* K */
HK_INLINE double hk_heat_temperature(const hk_heat_law *l, double h) {
  if (!hk_heat_melts(l)) return h / l->capacity[HK_SOLID];
  if (h < 0) return l->solidus + h / l->capacity[HK_SOLID];
  if (h > l->latent) return l->liquidus + (h - l->latent) / l->capacity[HK_MOLTEN];
  return l->solidus + (l->liquidus - l->solidus) * (h / l->latent);
}

/* W/m, the integral of the conductivity over the temperature, 0 where h is. */
HK_INLINE double hk_heat_potential(const hk_heat_law *l, double h) {
  const double *k = l->conductivity, *c = l->capacity;
  if (!hk_heat_melts(l) || h < 0) return k[HK_SOLID] / c[HK_SOLID] * h;
  double within = (k[HK_SOLID] + k[HK_MOLTEN]) / 2 * (l->liquidus - l->solidus);
  return h < l->latent ? within * (h / l->latent) : within + k[HK_MOLTEN] / c[HK_MOLTEN] * (h - l->latent);
}

/* kg/(m s), d theta/dh; at a corner that of the warmer side. */
HK_INLINE double hk_heat_potential_slope(const hk_heat_law *l, double h) {
  const double *k = l->conductivity, *c = l->capacity;
  if (!hk_heat_melts(l) || h < 0) return k[HK_SOLID] / c[HK_SOLID];
  if (h >= l->latent) return k[HK_MOLTEN] / c[HK_MOLTEN];
  return (k[HK_SOLID] + k[HK_MOLTEN]) / 2 * (l->liquidus - l->solidus) / l->latent;
}

/* J W/(kg m): the integral of the enthalpy over the potential theta, W/m, 0 where theta is. */
HK_INLINE double hk_heat_integral(const hk_heat_law *l, double theta) {
  const double *k = l->conductivity, *c = l->capacity;
  if (!hk_heat_melts(l) || theta < 0) return theta * theta / (2 * k[HK_SOLID] / c[HK_SOLID]);
  double within = hk_heat_potential(l, l->latent), beyond = theta - within;
  if (beyond < 0) return l->latent * theta * theta / (2 * within);
  return l->latent * (within / 2 + beyond) + beyond * beyond / (2 * k[HK_MOLTEN] / c[HK_MOLTEN]);
}

/* J/kg: the least enthalpy at the temperature T, K. */
HK_INLINE double hk_heat_enthalpy(const hk_heat_law *l, double T) {
  if (!hk_heat_melts(l)) return l->capacity[HK_SOLID] * T;
  if (T <= l->solidus) return l->capacity[HK_SOLID] * (T - l->solidus);
  if (T > l->liquidus) return l->latent + l->capacity[HK_MOLTEN] * (T - l->liquidus);
  return l->latent * (T - l->solidus) / (l->liquidus - l->solidus);
}

/* J/kg: the least and the largest enthalpy at the potential theta, W/m, which a melting point and what does not conduct
 * make two; infinite where there is no end. */
double hk_heat_least_enthalpy(const hk_heat_law *, double theta);
double hk_heat_most_enthalpy(const hk_heat_law *, double theta);
double hk_heat_steepest_potential(const hk_heat_law *); /* kg/(m s), the largest d theta/dh */
double hk_heat_least_capacity(const hk_heat_law *);     /* J/(kg K) */

#endif
