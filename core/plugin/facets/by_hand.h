/* Facet of a force that a user's hand moves while the run goes on. No other run repeats what the hand did, so such a
 * run is compared with none. */
#ifndef HK_PLUGIN_BY_HAND_H
#define HK_PLUGIN_BY_HAND_H

#include "core/plugin/force.h"

#define HK_BY_HAND_ID "by_hand/1"
#define HK_BY_HAND_FACET(...) HK_FACET(HK_BY_HAND_ID, hk_by_hand_facet, __VA_ARGS__)

typedef struct hk_by_hand_facet {
  size_t size;
  /* Called at frames: whether the hand has done something so far; *work, J: what it did. Required. */
  bool (*moved)(const void *self, double *work);
} hk_by_hand_facet;

#endif
