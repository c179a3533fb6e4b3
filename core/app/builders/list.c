/* The list of builders. */
#include "core/app/builders/builders.h"

const luaL_Reg hk_builders[] = {
    {"particle", hk_build_particle},     {"particles", hk_build_particles}, {"grid", hk_build_grid},
    {"strand", hk_build_strand},         {"hair", hk_build_hair},           {"mesh", hk_build_mesh},
    {"membrane", hk_build_membrane},     {"surface", hk_build_surface},     {"block", hk_build_block},
    {"tetrahedra", hk_build_tetrahedra}, {"body", hk_build_body},           {"implicit", hk_build_implicit},
    {"rigid", hk_build_rigid},           {"joint", hk_build_joint},         {NULL, NULL}};
