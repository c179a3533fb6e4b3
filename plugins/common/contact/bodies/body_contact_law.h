/* One contact of bodies with Coulomb's friction, by its own 3 x 3 matrix. */
#ifndef HK_BODY_CONTACT_LAW_H
#define HK_BODY_CONTACT_LAW_H

#include "plugins/common/contact/impulses/impact.h"

/* Two unit vectors across n and each other. */
void hk_vectors_across(const double n[3], double a[3], double b[3]);

/* G across n: g[0] = a.G a, g[1] = a.G b, g[2] = b.G b. */
typedef struct hk_contact_tangent {
  double a[3], b[3], g[3], most; /* `most`: no eigenvalue is larger */
} hk_contact_tangent;

hk_contact_tangent hk_contact_tangent_of(const double G[9], const double n[3]);

/* Solves one impact for its own impulses by its matrix G, with r = sum w y - origin: the changes of its normal and its
 * tangential impulse are added to change[3]. mu: friction. */
void hk_body_contact_solve(const hk_impact *, hk_impact_level *, const double G[9], const hk_contact_tangent *,
                           double mu, const double r[3], double change[3]);

#endif
