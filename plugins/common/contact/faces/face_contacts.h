/* Faces on faces: two rigid bodies that lie on each other by faces of several triangles touch in some sixty pairs of
 * features, of which the corners of the patch in which they meet say all. Where neither side is bent, both inequalities
 * of an impact (impact.h) are affine functions of its place in the patch, before and after any impulses: those of
 * places in the convex hull of others hold where these do, and the impulses on the corners have every sum of force and
 * moment that impulses in the patch have, friction's among them. So only the corners of the hull are solved
 * (Moravanszky and Terdiman 2004, Game Programming Gems 4, "Fast contact reduction for dynamics simulation", which
 * keeps some of them; here none is lost). Impacts whose functions are not affine, by more than a small part of the
 * thickness, stay. */
#ifndef HK_FACE_CONTACTS_H
#define HK_FACE_CONTACTS_H

#include "plugins/common/contact/bodies/body_system.h"
#include "plugins/common/contact/surfaces/surfaces.h"

/* Puts the impacts that are solved in front, in their order, with `chosen`, which runs beside them, and returns their
 * number. `close`, m: what an inequality may be off an affine function. HK_NO_MEMORY. */
hk_status hk_face_contacts_reduce(hk_body_impacts *, const hk_surface_mesh *, const hk_step_move *, double close,
                                  hk_contact_solver *, uint32_t *chosen);

#endif
