/* Scenes of elements with more than two members, of the forces of tests/fixtures. */
#ifndef HK_TEST_ELEMENT_SCENES_H
#define HK_TEST_ELEMENT_SCENES_H

#include "tests/support/engine.h"

/* The same numbers in [-1/2, 1/2) after every elements_open. */
double elements_noise(void);
/* An empty scene with frames and steps of h s. */
void elements_open(test_engine *, double h);
/* A sheet of side x side particles 0.1 m apart, each displaced by up to rough/2 m and moving at up to 10 rough m/s,
 * with two triangles a cell and struts along its sides: area_springs, whose k and edge_k are still to be given. */
hk_plugin_spec *elements_sheet(test_engine *, uint32_t side, double rough);
void elements_stiffen(test_engine *, hk_plugin_spec *sheet, double k, double damping, double edge_k);
/* A cube of side^3 particles, with six tetrahedra around the diagonal of each cell: volume_springs. `swelling`: rest
 * volumes over those of the cube. */
hk_plugin_spec *elements_blob(test_engine *, uint32_t side, double rough, double swelling, double k, double damping);
void elements_gravity(test_engine *);

#endif
