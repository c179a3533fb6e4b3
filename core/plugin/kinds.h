/* All that core/plugin.h includes: what plugins of every kind may ask of the host and the scene, the contract of each
 * kind, and the facets. */
#ifndef HK_PLUGIN_KINDS_H
#define HK_PLUGIN_KINDS_H

#include "core/plugin/host.h"
#include "core/plugin/model.h"
#include "core/plugin/force.h"
#include "core/plugin/constraint.h"
#include "core/plugin/corrector.h"
#include "core/plugin/source.h"
#include "core/plugin/solver.h"
#include "core/plugin/integrator.h"
#include "core/plugin/output.h"
#include "core/plugin/service.h"

#include "core/plugin/facets/implicit.h"
#include "core/plugin/facets/bounds.h"
#include "core/plugin/facets/elements.h"
#include "core/plugin/facets/parts.h"
#include "core/plugin/facets/steps.h"
#include "core/plugin/facets/internal.h"
#include "core/plugin/facets/surfaces.h"
#include "core/plugin/facets/encounters.h"
#include "core/plugin/facets/approximation.h"
#include "core/plugin/facets/pictures.h"
#include "core/plugin/facets/by_hand.h"
#include "core/plugin/facets/figures.h"
#include "core/plugin/facets/adaptive.h"
#include "core/plugin/facets/constrained.h"
#include "core/plugin/facets/corrected.h"
#include "core/plugin/facets/stages.h"
#include "core/plugin/facets/linear.h"
#include "core/plugin/facets/moves.h"
#include "core/plugin/facets/split.h"
#include "core/plugin/facets/tile.h"
#include "core/plugin/widest.h"

#endif
