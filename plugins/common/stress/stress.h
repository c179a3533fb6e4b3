/* The forces within what a scene is made of, as pictures, recordings and pages show them: of a particle the largest by
 * magnitude of all elements that it belongs to, with its sign, positive in tension; 0: of none. They are elastic: what
 * damping adds is left out. An element on particles x_m with the nodal forces f_m of its energy has
 *
 *   tension  -f_1 . u, of an edge along u, N; of bars and cables what the host tells (hk_frame.bar_forces);
 *   stress   of sheets and solids the principal value of -(1/V) sum f_m x_m^T that is largest by magnitude, with the
 *            area or volume V of the element as it is now: Cauchy's stress, for the strain of an element is constant
 *            (Bonet and Wood 2008, Nonlinear continuum mechanics for finite element analysis, section 9.4).
 */
#ifndef HK_STRESS_H
#define HK_STRESS_H

#include "core/plugin.h"

typedef enum hk_stress_kind {
  HK_TENSION,      /* of springs, bars and cables, N */
  HK_SHEET_STRESS, /* of triangles with a strain: stress times thickness, N/m */
  HK_SOLID_STRESS, /* of tetrahedra of forces with a strain, Pa */
  HK_STRESS_KINDS
} hk_stress_kind;

extern const char *const hk_stress_names[HK_STRESS_KINDS], *const hk_stress_units[HK_STRESS_KINDS];

/* Whether the scene has elements of that kind at present. */
bool hk_stress_any(const hk_model *, hk_stress_kind);
/* Of `count` particles shown. place: of each particle of the view its index among them, UINT32_MAX: it is not shown;
 * NULL: all are, in their order. The status of hk_frame.bar_forces. */
hk_status hk_particle_stresses(const hk_view *, const hk_frame *, hk_stress_kind, const uint32_t *place, size_t count,
                               double *value);

#endif
